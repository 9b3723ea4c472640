//! NPY of `NumPy`, version 1.0: an array with axes for rows, columns and, for colors, the numbers
//! of a pixel.

use crate::{
    diagnostic::error::Error,
    film::size::Size,
    image_file::{
        Content, Form, Format, ImageFormat,
        format::cannot_hold_pixel,
        output::{Draw, Output},
        pixel::{Pixel, Sample},
    },
};

impl ImageFormat {
    /// A `NumPy` array.
    pub const NPY: Self = Self(&Format {
        endings: &["npy"],
        content: Content::Array,
        holds: |pixel| layout(pixel).is_some(),
        encode,
        ..Format::PLAIN
    });
}

/// Returns the number of samples per pixel and their type, if the format supports them.
pub(super) fn layout(pixel: Pixel) -> Option<(usize, Sample)> {
    pixel.samples()
}

fn encode(output: Output, form: Form, draw: Draw) -> Result<(), Error> {
    let Form { size, pixel, .. } = form;
    let (count, sample) =
        layout(pixel).ok_or_else(|| cannot_hold_pixel(ImageFormat::NPY, pixel))?;
    let header = header(size, count, sample);
    output.write_rows(&header, draw, |rows| sample.little_endian(rows))
}

/// Returns the header: a Python literal, padded so that the numbers begin at a multiple of 64.
pub(super) fn header(size: Size, count: usize, sample: Sample) -> Vec<u8> {
    let kind = match sample {
        Sample::U8 => "|u1",
        Sample::U16 => "<u2",
        Sample::U32 => "<u4",
        Sample::F16 => "<f2",
        Sample::F32 => "<f4",
        Sample::F64 => "<f8",
    };
    let (width, height) = (size.width(), size.height());
    let shape = match count {
        1 => format!("({height}, {width})"),
        _ => format!("({height}, {width}, {count})"),
    };
    let text = format!("{{'descr': '{kind}', 'fortran_order': False, 'shape': {shape}, }}");
    let whole = (10 + text.len() + 1).next_multiple_of(64);
    let mut header = b"\x93NUMPY\x01\x00".to_vec();
    header.extend(((whole - 10) as u16).to_le_bytes());
    header.extend(text.as_bytes());
    header.resize(whole - 1, b' ');
    header.push(b'\n');
    header
}
