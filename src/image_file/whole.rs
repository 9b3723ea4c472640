//! The common part of the formats that `image` encodes from a whole picture.

use std::io::{self, BufWriter, Write};

use image::{ExtendedColorType, ImageEncoder, ImageError, ImageResult};

use crate::{
    diagnostic::error::Error,
    film::size::Size,
    image_file::{
        Encoding, Form, buffer,
        output::{Draw, Output},
        pixel::{Pixel, Sample},
    },
};

/// The Exif 2.3 data of sRGB pixels: a header, a directory with only a pointer to the Exif
/// directory, and the Exif directory with the version and the tag `ColorSpace`.
const SRGB: [u8; 56] = [
    // Little-endian; the first directory follows.
    b'I', b'I', 42, 0, 8, 0, 0, 0, //
    // One entry: the Exif directory is at offset 26.
    1, 0, 0x69, 0x87, 4, 0, 1, 0, 0, 0, 26, 0, 0, 0, 0, 0, 0, 0, //
    // Two entries: the version is `0230`, the color space 1.
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
    /// Writes the picture with an encoder.
    pub(super) fn by(&self, encoder: impl ImageEncoder) -> ImageResult<()> {
        let (width, height) = (self.size.width(), self.size.height());
        encoder.write_image(&self.pixels, width, height, self.color)
    }
}

/// Draws a whole picture in gray, RGB or RGBA, as the format supports it, and passes it to `write`.
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

/// Returns the encoder with the color space stated, if the numbers are colors.
pub(super) fn with_space<E: ImageEncoder>(mut encoder: E, encoding: Encoding) -> ImageResult<E> {
    if encoding.colors {
        let done = encoder.set_exif_metadata(SRGB.to_vec());
        done.map_err(ImageError::Unsupported)?;
    }
    Ok(encoder)
}
