//! The legend of a color map: a bar with ticks and a label, as a picture or as SVG.

mod draw;
mod svg;
mod ticks;

use self::ticks::{Tick, ticks};
use crate::{
    diagnostic::{error::Error, setters::setters},
    film::size::Size,
    tracer::{
        color::Color,
        colormap::{Colormap, position},
    },
};

/// The legend of a color map.
///
/// # Examples
///
/// ```
/// use strahl::render::{Colormap, Legend};
///
/// let legend = Legend::new(Colormap::viridis(), [-1.0, 1.0]).label("energy");
/// let image = legend.image()?;
/// assert!(image.height() > image.width());
/// assert!(legend.svg()?.contains(">energy</text>"));
/// # Ok::<(), strahl::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct Legend {
    map: Colormap,
    range: [f64; 2],
    label: String,
    missing: Option<Color>,
    is_horizontal: bool,
    size: Option<Size>,
}

/// The length of a bar whose legend has no given size, in pixels.
const LENGTH: u32 = 320;
/// The shortest bar, in heights of a line of text.
const SHORTEST: u32 = 4;
/// The text of the color of missing values.
const MISSING: &str = "no value";
/// The heights of a line of text, in pixels.
const TEXT: [u32; 3] = [16, 24, 32];
/// The side of a picture for each pixel of the height of its text.
const SIDE_PER_TEXT: u32 = 20;

/// The places of a legend's parts, in pixels from the top left.
struct Layout {
    size: Size,
    /// The height of a line of text.
    text: u32,
    /// The bar: left, top, width and height.
    bar: [u32; 4],
    /// Each tick: its distance along the bar from the low end, and its label.
    ticks: Vec<(f64, String)>,
    /// The color of missing values, as a square of the given left, top and side.
    missing: Option<([u32; 3], Color)>,
}

impl Legend {
    /// The largest number of letters of the label.
    const LONGEST_LABEL: usize = 1000;

    /// Creates the legend of a map, whose first and last colors are those of the values in `range`.
    pub fn new(map: Colormap, range: [f64; 2]) -> Self {
        Self {
            map,
            range,
            label: String::new(),
            missing: None,
            is_horizontal: false,
            size: None,
        }
    }

    /// Sets the label above the bar: one line of at most 1,000 letters.
    #[must_use]
    pub fn label(mut self, label: impl Into<String>) -> Self {
        // A control character would end the line, or the file.
        let label: String = label.into();
        self.label = label.replace(|letter: char| letter.is_control(), "\u{fffd}");
        self
    }

    setters! {
        /// Adds the color of values that are missing.
        missing(color: Color) => missing = Some(color);

        /// Draws the bar from left to right instead of from bottom to top.
        horizontal(is_horizontal: bool) => is_horizontal = is_horizontal;

        /// Sets the size in pixels; by default, the bar has 320 pixels, and all else has room.
        size(size: impl Into<Option<Size>>) => size = size.into();
    }

    fn layout(&self) -> Result<Layout, Error> {
        let letters = self.label.chars().count();
        if letters > Self::LONGEST_LABEL {
            let most = Self::LONGEST_LABEL;
            let message = format!("a label has at most {most} letters, found {letters}");
            return Err(Error::refused(message));
        }
        let Some(size) = self.size else {
            return self.fit(TEXT[0], None);
        };
        // The largest text that has room.
        let side = size.width().max(size.height());
        let sizes = TEXT.iter().rev().copied();
        let fitting = sizes.filter(|text| *text == TEXT[0] || text * SIDE_PER_TEXT <= side);
        let mut result = self.fit(TEXT[0], Some(size));
        for text in fitting {
            result = self.fit(text, Some(size));
            if result.is_ok() {
                break;
            }
        }
        result
    }

    /// Arranges the parts for text of a height.
    fn fit(&self, text: u32, size: Option<Size>) -> Result<Layout, Error> {
        let width_of = |label: &str| label.chars().count() as u32 * draw::width(text);
        let (margin, gap, thick) = (text * 3 / 4, text / 2, text * 5 / 4);
        let label = if self.label.is_empty() { 0 } else { text + gap };
        let missing = match self.missing {
            None => 0,
            Some(_) => text + gap,
        };
        let of_missing = self.missing.map_or(0, |_| thick + gap + width_of(MISSING));
        let shortest = text * SHORTEST;
        let along = |length: u32| {
            let one = match self.is_horizontal {
                // Labels have a gap of a letter or more between them.
                true => self.widest(length, text) + 2 * draw::width(text),
                false => text * 2,
            };
            ticks(self.range, 1 + (length / one.max(1)).max(1) as usize)
        };
        let widest = |ticks: &[Tick]| {
            let widths = ticks.iter().map(|tick| width_of(&tick.label));
            widths.max().unwrap_or(0)
        };
        // The ends of labels stand out beyond the bar.
        let (rest, ticks, around) = if self.is_horizontal {
            let width = size.map_or(LENGTH + 2 * margin, Size::width);
            let beyond = self.widest(width, text).div_ceil(2).max(margin);
            let bar = width.saturating_sub(2 * beyond);
            let rest = [
                2 * beyond,
                2 * margin + label + thick + gap + text + missing,
            ];
            (rest, along(bar), beyond)
        } else {
            let across = 2 * margin + label + missing + text;
            let bar = size.map_or(LENGTH, |size| size.height().saturating_sub(across));
            let ticks = along(bar);
            let rest = [2 * margin + thick + gap + widest(&ticks), across];
            (rest, ticks, margin)
        };
        let text_width = 2 * margin + width_of(&self.label).max(of_missing);
        let smallest = if self.is_horizontal {
            [(rest[0] + shortest).max(text_width), rest[1]]
        } else {
            [rest[0].max(text_width), rest[1] + shortest]
        };
        let [width, height] = match size {
            Some(size) => [size.width(), size.height()],
            None if self.is_horizontal => [smallest[0].max(LENGTH + 2 * margin), smallest[1]],
            None => [smallest[0], smallest[1] - shortest + LENGTH],
        };
        let no_room = || {
            let [width, height] = smallest;
            let message = format!("a legend with this text needs at least {width}x{height} pixels");
            Error::refused(message)
        };
        if width < smallest[0] || height < smallest[1] {
            return Err(no_room());
        }
        let size = Size::new(width, height).map_err(|_| no_room())?;
        let top = margin + label;
        let bar = if self.is_horizontal {
            [around, top, width - 2 * around, height - rest[1] + thick]
        } else {
            let top = top + text / 2;
            [margin, top, thick, height - rest[1]]
        };
        let length = f64::from(if self.is_horizontal { bar[2] } else { bar[3] });
        let ticks = ticks.into_iter().map(|tick| {
            let place = position(tick.value, self.range) * length;
            (place, tick.label)
        });
        Ok(Layout {
            size,
            text,
            bar,
            ticks: ticks.collect(),
            missing: self
                .missing
                .map(|color| ([margin, height - margin - text, text], color)),
        })
    }

    /// Returns the width of the widest label that ticks along a horizontal bar may have.
    fn widest(&self, length: u32, text: u32) -> u32 {
        let most = 1 + (length / (4 * draw::width(text)).max(1)).max(1) as usize;
        let labels = ticks(self.range, most.min(12));
        let widths = labels.iter().map(|tick| tick.label.chars().count() as u32);
        widths.max().unwrap_or(1) * draw::width(text)
    }
}

impl Layout {
    /// The margin around everything.
    const fn margin(&self) -> u32 {
        self.text * 3 / 4
    }

    /// The gap between a bar and its labels.
    const fn gap(&self) -> u32 {
        self.text / 2
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_label_has_a_limit() {
        let legend = |letters: usize| {
            let legend = Legend::new(Colormap::viridis(), [0.0, 1.0]);
            legend.label("µ".repeat(letters)).svg()
        };
        assert!(legend(1000).is_ok());
        let refused = legend(120_000).unwrap_err().to_string();
        assert_eq!(refused, "a label has at most 1000 letters, found 120000");
    }
}
