//! The formats that `image` encodes from a whole picture.

use std::io::{self, BufWriter, Write};

use image::{
    ExtendedColorType, ImageEncoder, ImageError, ImageResult,
    codecs::{bmp::BmpEncoder, jpeg::JpegEncoder, qoi::QoiEncoder, webp::WebPEncoder},
};

use crate::{
    error::Error,
    film::size::Size,
    image_file::{
        Encoding, ImageFormat, Sink, buffer,
        limits::cannot_hold_pixel,
        pixel::{Pixel, Sample},
    },
};

/// The most bytes of a comment in a JPEG file: its length, two bytes more, has 16 bits.
const COMMENT: usize = 65_533;

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

/// The kind of a pixel.
pub(super) fn layout(format: ImageFormat, pixel: Pixel) -> Option<ExtendedColorType> {
    let (gray, alpha) = match format {
        ImageFormat::Jpeg => (true, false),
        ImageFormat::Qoi | ImageFormat::WebP => (false, true),
        _ => (false, false),
    };
    match pixel {
        Pixel::Gray(Sample::U8) if gray => Some(ExtendedColorType::L8),
        Pixel::Rgb(Sample::U8) => Some(ExtendedColorType::Rgb8),
        Pixel::Rgba(Sample::U8) if alpha => Some(ExtendedColorType::Rgba8),
        _ => None,
    }
}

pub(super) fn encode(
    format: ImageFormat,
    writer: impl Write,
    size: Size,
    pixel: Pixel,
    encoding: Encoding,
    draw: impl FnOnce(Sink) -> Result<(), Error>,
) -> Result<(), Error> {
    let color = layout(format, pixel).ok_or_else(|| cannot_hold_pixel(format, pixel))?;
    let mut pixels = buffer(size, pixel.bytes())?;
    draw(&mut |bytes| {
        pixels.extend_from_slice(bytes);
        Ok(())
    })?;
    let mut writer = BufWriter::new(writer);
    let picture = (&*pixels, size.width(), size.height(), color);
    let encoded = match format {
        ImageFormat::Bmp => whole(BmpEncoder::new(&mut &mut writer), picture),
        ImageFormat::Qoi => whole(QoiEncoder::new(&mut writer), picture),
        ImageFormat::WebP => {
            let encoder = WebPEncoder::new_lossless(&mut writer);
            with_space(encoder, encoding).and_then(|encoder| whole(encoder, picture))
        }
        _ => jpeg(&mut writer, picture, encoding),
    };
    encoded.map_err(|error| {
        Error::writing(match error {
            ImageError::IoError(error) => error,
            other => io::Error::other(other),
        })
    })?;
    writer.flush().map_err(Error::writing)
}

type Picture<'a> = (&'a [u8], u32, u32, ExtendedColorType);

fn whole(encoder: impl ImageEncoder, (pixels, width, height, color): Picture) -> ImageResult<()> {
    encoder.write_image(pixels, width, height, color)
}

/// An encoder that states the space of colors.
fn with_space<E: ImageEncoder>(mut encoder: E, encoding: Encoding) -> ImageResult<E> {
    if encoding.colors {
        let done = encoder.set_exif_metadata(SRGB.to_vec());
        done.map_err(ImageError::Unsupported)?;
    }
    Ok(encoder)
}

fn jpeg(writer: &mut impl Write, picture: Picture, encoding: Encoding) -> ImageResult<()> {
    let mut file = Vec::new();
    let encoder = JpegEncoder::new_with_quality(&mut file, encoding.quality);
    whole(with_space(encoder, encoding)?, picture)?;
    // A file begins with two bytes and a segment of its own, whose length comes after two more;
    // comments stand behind it.
    let length = match file[..] {
        [_, _, _, _, high, low, ..] => usize::from(u16::from_be_bytes([high, low])),
        _ => 0,
    };
    let (begin, rest) = file.split_at((4 + length).min(file.len()));
    writer.write_all(begin)?;
    for line in encoding.lines() {
        for comment in line.as_bytes().chunks(COMMENT) {
            writer.write_all(&[0xff, 0xfe])?;
            writer.write_all(&(comment.len() as u16 + 2).to_be_bytes())?;
            writer.write_all(comment)?;
        }
    }
    Ok(writer.write_all(rest)?)
}
