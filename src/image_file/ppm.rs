//! Binary PPM: a text header, then the uncompressed pixels.

use crate::{
    diagnostic::error::Error,
    image_file::{
        Form, Format, ImageFormat,
        format::cannot_hold_pixel,
        output::{Draw, Output},
        pixel::{Pixel, Sample},
    },
};

impl ImageFormat {
    /// Binary portable pixmap, uncompressed.
    pub const PPM: Self = Self(&Format {
        endings: &["ppm"],
        holds: |pixel| layout(pixel).is_some(),
        decoder: Some(image::ImageFormat::Pnm),
        encode,
        ..Format::PLAIN
    });
}

/// Returns the sample type, if the format supports the pixel type.
fn layout(pixel: Pixel) -> Option<Sample> {
    match pixel {
        Pixel::Rgb(sample @ (Sample::U8 | Sample::U16)) => Some(sample),
        _ => None,
    }
}

fn encode(output: Output, form: Form, draw: Draw) -> Result<(), Error> {
    let Form { size, pixel, .. } = form;
    let sample = layout(pixel).ok_or_else(|| cannot_hold_pixel(ImageFormat::PPM, pixel))?;
    let (width, height) = (size.width(), size.height());
    let most = (1_u32 << (8 * sample.bytes())) - 1;
    let header = format!("P6\n{width} {height}\n{most}\n");
    output.write_rows(header.as_bytes(), draw, |rows| sample.big_endian(rows))
}
