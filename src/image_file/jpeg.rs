//! JPEG, in gray or color, with the metadata as comments.

use std::io::Write;

use image::{ImageResult, codecs::jpeg::JpegEncoder};

use crate::image_file::{
    Encoding, Format, ImageFormat,
    format::longest,
    pixel::{Pixel, Sample},
    whole::{self, Whole, with_space},
};

/// The maximum number of bytes in a JPEG comment: its 16-bit length counts two more.
const COMMENT: usize = 65_533;

impl ImageFormat {
    /// JPEG, the only lossy format here.
    pub const JPEG: Self = Self(&Format {
        endings: &["jpg", "jpeg"],
        holds: |pixel| matches!(pixel, Pixel::Gray(Sample::U8) | Pixel::Rgb(Sample::U8)),
        exceeded: |size, _| longest(65_535, size),
        has_quality: true,
        has_metadata: true,
        decoder: Some(image::ImageFormat::Jpeg),
        encode: |output, form, draw| {
            whole::encode(output, form, draw, |writer, picture| {
                write(writer, picture, form.encoding)
            })
        },
        ..Format::PLAIN
    });
}

fn write(writer: &mut impl Write, picture: &Whole, encoding: Encoding) -> ImageResult<()> {
    let mut file = Vec::new();
    let encoder = JpegEncoder::new_with_quality(&mut file, encoding.quality);
    picture.by(with_space(encoder, encoding)?)?;
    // A file begins with a two-byte marker and a segment; the segment's length follows its own
    // two-byte marker. Comments go after that segment.
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
