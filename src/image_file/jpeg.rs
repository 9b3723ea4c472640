//! JPEG, gray or in color, with the metadata as comments.

use std::io::Write;

use image::{ImageResult, codecs::jpeg::JpegEncoder};

use crate::image_file::{
    Encoding, Format, ImageFormat,
    format::longest,
    pixel::{Pixel, Sample},
    whole::{self, Whole, with_space},
};

/// The most bytes of a comment in a JPEG file: its length, two bytes more, has 16 bits.
const COMMENT: usize = 65_533;

impl ImageFormat {
    /// JPEG: the only format here that loses something.
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
