//! PFM, the portable float map by Paul Debevec: three lines of text, then the rows from bottom to
//! top.

use std::io::SeekFrom;

use crate::{
    diagnostic::error::Error,
    image_file::{
        Content, Form, Format, ImageFormat,
        format::cannot_hold_pixel,
        output::{Draw, Output},
        pixel::{Pixel, Sample},
    },
};

impl ImageFormat {
    /// Portable float map, uncompressed.
    pub const PFM: Self = Self(&Format {
        endings: &["pfm"],
        content: Content::Floats,
        holds: |pixel| layout(pixel).is_some(),
        encode,
        ..Format::PLAIN
    });
}

/// Returns the first line, for gray or color.
fn layout(pixel: Pixel) -> Option<&'static str> {
    match pixel {
        Pixel::Gray(Sample::F32) => Some("Pf"),
        Pixel::Rgb(Sample::F32) => Some("PF"),
        _ => None,
    }
}

fn encode(output: Output, form: Form, draw: Draw) -> Result<(), Error> {
    let Form { size, pixel, .. } = form;
    let name = layout(pixel).ok_or_else(|| cannot_hold_pixel(ImageFormat::PFM, pixel))?;
    // A negative scale means little-endian.
    let header = format!("{name}\n{} {}\n-1.0\n", size.width(), size.height());
    let row = size.width() as usize * pixel.bytes();
    output.going_back(|file| {
        file.write_all(header.as_bytes()).map_err(Error::writing)?;
        // Each band has its place; the first one is at the end.
        let mut place = header.len() as u64 + row as u64 * u64::from(size.height());
        let mut reversed = Vec::new();
        draw(&mut |rows| {
            reversed.clear();
            rows.rchunks(row).for_each(|row| reversed.extend(row));
            place -= rows.len() as u64;
            let found = file.seek(SeekFrom::Start(place));
            let written = found.and_then(|_| file.write_all(&Sample::F32.little_endian(&reversed)));
            written.map_err(Error::writing)
        })
    })
}
