//! Pictures in a form that browsers show.

use crate::{
    compare::picture::{Picture, Samples},
    diagnostic::error::Error,
    image_file::{
        self,
        pixel::{Pixel, Sample},
    },
    tracer::srgb::{quantize, to_display},
};

impl Picture {
    /// Returns the picture as a PNG file with 8 bits per channel. Light outside 0..1 is clamped.
    ///
    /// # Errors
    ///
    /// Fails if the picture is too large for the format.
    pub fn to_png(&self) -> Result<Vec<u8>, Error> {
        let mut file = Vec::new();
        let pixel = if self.has_alpha() {
            Pixel::Rgba(Sample::U8)
        } else {
            Pixel::Rgb(Sample::U8)
        };
        let row = self.size().width() as usize * self.channels;
        image_file::to_png(&mut file, self.size(), pixel, |sink| {
            let mut bytes = Vec::new();
            for y in 0..self.size().height() as usize {
                bytes.clear();
                self.append(row * y..row * (y + 1), &mut bytes);
                sink(&bytes)?;
            }
            Ok(())
        })?;
        Ok(file)
    }

    /// Appends the bytes of some samples, with gray as RGB.
    fn append(&self, samples: std::ops::Range<usize>, bytes: &mut Vec<u8>) {
        let spread = |pixel: &[u8], bytes: &mut Vec<u8>| match *pixel {
            [gray] => bytes.extend([gray; 3]),
            [gray, alpha] => bytes.extend([gray, gray, gray, alpha]),
            _ => bytes.extend(pixel),
        };
        let mut pixel = [0; 4];
        let pixel = &mut pixel[..self.channels];
        match &self.samples {
            Samples::Bytes(all) => {
                for bare in all[samples].chunks_exact(self.channels) {
                    spread(bare, bytes);
                }
            }
            Samples::Words(all) => {
                for bare in all[samples].chunks_exact(self.channels) {
                    for (byte, word) in pixel.iter_mut().zip(bare) {
                        *byte = ((u32::from(*word) + 128) / 257) as u8;
                    }
                    spread(pixel, bytes);
                }
            }
            Samples::Floats(all) => {
                for bare in all[samples].chunks_exact(self.channels) {
                    self.show(bare, pixel);
                    spread(pixel, bytes);
                }
            }
        }
    }

    fn show(&self, light: &[f32], pixel: &mut [u8]) {
        let byte = |part: f64| quantize(part, u8::MAX.into()) as u8;
        let colors = self.channels - usize::from(self.has_alpha());
        let alpha = light.get(colors).map_or(1.0, |alpha| f64::from(*alpha));
        let covers = if self.premultiplied && alpha > 0.0 {
            alpha
        } else {
            1.0
        };
        for (byte_of, light) in pixel.iter_mut().zip(&light[..colors]) {
            let light = (f64::from(*light) / covers).clamp(0.0, 1.0);
            *byte_of = byte(to_display(light));
        }
        if let Some(last) = pixel.get_mut(colors) {
            *last = byte(alpha);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::size::Size;

    #[test]
    fn every_kind_of_sample_is_shown() {
        let size = Size::new(2, 1).unwrap();
        for (channels, samples, expected) in [
            (
                1,
                Samples::Bytes(vec![7, 255]),
                &[7, 7, 7, 255, 255, 255][..],
            ),
            (
                2,
                Samples::Bytes(vec![7, 8, 9, 10]),
                &[7, 7, 7, 8, 9, 9, 9, 10],
            ),
            (
                1,
                Samples::Words(vec![257, 65_535]),
                &[1, 1, 1, 255, 255, 255],
            ),
            (
                3,
                Samples::Floats(vec![0.0, 1.0, 9.0, f32::NAN, -1.0, f32::INFINITY]),
                &[0, 255, 255, 0, 0, 255],
            ),
            (
                4,
                Samples::Floats(vec![0.5, 0.0, 0.0, 0.5, 0.0, 0.0, 0.0, 0.0]),
                &[255, 0, 0, 128, 0, 0, 0, 0],
            ),
        ] {
            let picture = Picture::new(size, channels, samples, true).unwrap();
            let image = image::load_from_memory(&picture.to_png().unwrap()).unwrap();
            assert_eq!(image.as_bytes(), expected);
        }
    }
}
