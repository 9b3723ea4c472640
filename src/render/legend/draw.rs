//! A legend as a picture.
//!
//! The letters are those of Noto Sans Mono (SIL Open Font License 1.1) in the sizes of
//! `noto-sans-mono-bitmap`: gray pixels that are the same on every machine.

use noto_sans_mono_bitmap::{
    FontWeight, RasterHeight, RasterizedChar, get_raster, get_raster_width,
};

use super::{Layout, Legend, MISSING};
use crate::{diagnostic::error::Error, film::Image, image_file::buffer, tracer::color::Color};

const fn height(text: u32) -> RasterHeight {
    match text {
        ..24 => RasterHeight::Size16,
        24..32 => RasterHeight::Size24,
        _ => RasterHeight::Size32,
    }
}

/// Returns the width of a letter in text of a height.
pub(super) const fn width(text: u32) -> u32 {
    get_raster_width(FontWeight::Regular, height(text)) as u32
}

/// Returns the picture of a letter, if the font has it or an equal one.
fn raster(letter: char, text: RasterHeight) -> Option<RasterizedChar> {
    let equal = match letter {
        // The Greek letter mu and the sign for a millionth, the sign of the angstrom and the letter.
        'μ' => 'µ',
        '\u{212b}' => 'Å',
        // The minus sign, and hyphens and spaces of other widths.
        '\u{2212}' | '\u{2010}'..='\u{2013}' => '-',
        '\u{a0}' | '\u{2000}'..='\u{200a}' | '\u{202f}' | '\u{205f}' => ' ',
        _ => letter,
    };
    get_raster(equal, FontWeight::Regular, text)
}

impl Legend {
    /// Draws the legend, in black on white.
    ///
    /// # Errors
    ///
    /// A label with letters that the font does not have, such as Greek ones; a size without room for
    /// the text and the bar, or one that does not fit into memory.
    pub fn image(&self) -> Result<Image, Error> {
        let layout = self.layout()?;
        let is_unknown = |letter: &char| raster(*letter, height_of(&layout)).is_none();
        if let Some(letter) = self.label.chars().find(is_unknown) {
            let message = format!(
                "a legend as a picture has no letter `{letter}` for its label `{}`; write an svg \
                 file, or give another label",
                self.label
            );
            return Err(Error::refused(message));
        }
        let [left, top, wide, high] = layout.bar;
        let (text, gap, margin) = (layout.text, layout.gap(), layout.margin());
        let mut canvas = Canvas::new(&layout)?;
        canvas.text(margin, margin, &self.label);
        let length = if self.is_horizontal { wide } else { high };
        for place in 0..length {
            let color = self.map.color((f64::from(place) + 0.5) / f64::from(length));
            if self.is_horizontal {
                canvas.fill([left + place, top, 1, high], color);
            } else {
                canvas.fill([left, top + high - 1 - place, wide, 1], color);
            }
        }
        canvas.frame(layout.bar);
        for (place, label) in &layout.ticks {
            // Halves go up: a place is in 0..=length.
            let place = ((*place + 0.5) as u32).min(length - 1);
            if self.is_horizontal {
                let x = left + place;
                canvas.fill([x, top + high, 1, gap / 2], Color::BLACK);
                let half = label.chars().count() as u32 * width(text) / 2;
                canvas.text(x.saturating_sub(half), top + high + gap / 2, label);
            } else {
                let y = top + high - 1 - place;
                canvas.fill([left + wide, y, gap / 2, 1], Color::BLACK);
                canvas.text(left + wide + gap, y.saturating_sub(text / 2), label);
            }
        }
        if let Some(([x, y, side], color)) = layout.missing {
            canvas.fill([x, y, side, side], color);
            canvas.frame([x, y, side, side]);
            canvas.text(x + side + gap, y, MISSING);
        }
        Ok(Image::new(layout.size, canvas.pixels))
    }
}

/// A picture that is being drawn.
struct Canvas {
    width: usize,
    height: usize,
    text: RasterHeight,
    pixels: Vec<u8>,
}

impl Canvas {
    fn new(layout: &Layout) -> Result<Self, Error> {
        let (width, height) = (layout.size.width() as usize, layout.size.height() as usize);
        let mut pixels = buffer(layout.size, 3)?;
        pixels.resize(width * height * 3, 255);
        Ok(Self {
            width,
            height,
            text: height_of(layout),
            pixels,
        })
    }

    /// Returns a pixel, if it lies in the picture.
    fn pixel(&mut self, x: usize, y: usize) -> Option<&mut [u8]> {
        let is_inside = x < self.width && y < self.height;
        let at = (y * self.width + x) * 3;
        self.pixels.get_mut(at..at + 3).filter(|_| is_inside)
    }

    /// Fills a rectangle, given by its left, top, width and height.
    fn fill(&mut self, [left, top, wide, high]: [u32; 4], color: Color) {
        for y in top..top + high {
            for x in left..left + wide {
                if let Some(pixel) = self.pixel(x as usize, y as usize) {
                    pixel.copy_from_slice(&color.to_rgb8());
                }
            }
        }
    }

    /// Draws the edge of a rectangle, inside of it.
    fn frame(&mut self, [left, top, wide, high]: [u32; 4]) {
        for edge in [
            [left, top, wide, 1],
            [left, top + high - 1, wide, 1],
            [left, top, 1, high],
            [left + wide - 1, top, 1, high],
        ] {
            self.fill(edge, Color::BLACK);
        }
    }

    /// Writes a line with its top left corner at a place.
    fn text(&mut self, left: u32, top: u32, line: &str) {
        let mut left = left as usize;
        for letter in line.chars() {
            let Some(raster) = raster(letter, self.text) else {
                continue;
            };
            for (row, cells) in raster.rows().enumerate() {
                for (column, ink) in cells.iter().enumerate() {
                    if let Some(pixel) = self.pixel(left + column, top as usize + row) {
                        pixel
                            .iter_mut()
                            .for_each(|channel| *channel = (*channel).min(255 - ink));
                    }
                }
            }
            left += raster.width();
        }
    }
}

const fn height_of(layout: &Layout) -> RasterHeight {
    height(layout.text)
}
