//! What the formats have in common that `image` encodes from a whole picture.

use std::io::{self, BufWriter, Write};

use image::{ExtendedColorType, ImageEncoder, ImageError, ImageResult};

use crate::{
    diagnostic::error::Error,
    film::size::Size,
    image_file::{
        Draw, Encoding, Form, buffer,
        output::Output,
        pixel::{Pixel, Sample},
    },
};

/// What Exif 2.3 says of pixels in sRGB: a header, a directory with nothing but the way to that of
/// Exif, and in this the version and the tag `ColorSpace`.
const SRGB: [u8; 56] = [
    // Least byte first; the first directory follows.
    b'I', b'I', 42, 0, 8, 0, 0, 0, //
    // One entry: the directory of Exif is at 26.
    1, 0, 0x69, 0x87, 4, 0, 1, 0, 0, 0, 26, 0, 0, 0, 0, 0, 0, 0, //
    // Two: the version is `0230`, the color space 1.
    2, 0, 0x00, 0x90, 7, 0, 4, 0, 0, 0, b'0', b'2', b'3', b'0', //
    0x01, 0xa0, 3, 0, 1, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0,
];

/// A whole picture.
pub(super) struct Whole {
    pixels: Vec<u8>,
    size: Size,
    color: ExtendedColorType,
}

impl Whole {
    /// Writes it by an encoder.
    pub(super) fn by(&self, encoder: impl ImageEncoder) -> ImageResult<()> {
        let (width, height) = (self.size.width(), self.size.height());
        encoder.write_image(&self.pixels, width, height, self.color)
    }
}

/// Draws a picture of gray, of colors or of colors and alpha, as a format knows them, and lets
/// `write` write all of it.
pub(super) fn encode(
    output: Output,
    form: Form,
    draw: Draw,
    write: impl FnOnce(&mut BufWriter<Output>, &Whole) -> ImageResult<()>,
) -> Result<(), Error> {
    let Form { size, pixel, .. } = form;
    let mut pixels = buffer(size, pixel.bytes())?;
    draw(&mut |bytes| {
        pixels.extend_from_slice(bytes);
        Ok(())
    })?;
    let color = match pixel {
        Pixel::Gray(Sample::U8) => ExtendedColorType::L8,
        Pixel::Rgba(Sample::U8) => ExtendedColorType::Rgba8,
        _ => ExtendedColorType::Rgb8,
    };
    let picture = Whole {
        pixels,
        size,
        color,
    };
    let mut writer = BufWriter::new(output);
    write(&mut writer, &picture).map_err(|error| {
        Error::writing(match error {
            ImageError::IoError(error) => error,
            other => io::Error::other(other),
        })
    })?;
    writer.flush().map_err(Error::writing)
}

/// An encoder that states the space of colors.
pub(super) fn with_space<E: ImageEncoder>(mut encoder: E, encoding: Encoding) -> ImageResult<E> {
    if encoding.colors {
        let done = encoder.set_exif_metadata(SRGB.to_vec());
        done.map_err(ImageError::Unsupported)?;
    }
    Ok(encoder)
}
