//! PPM, the binary kind: a line of text, then the pixels as they are.

use std::io::Write;

use crate::{
    error::Error,
    film::size::Size,
    image_file::{
        ImageFormat, Sink,
        limits::cannot_hold_pixel,
        pixel::{Pixel, Sample},
    },
};

/// The type of a number.
pub(super) fn layout(pixel: Pixel) -> Option<Sample> {
    match pixel {
        Pixel::Rgb(sample @ (Sample::U8 | Sample::U16)) => Some(sample),
        _ => None,
    }
}

pub(super) fn encode(
    mut writer: impl Write,
    size: Size,
    pixel: Pixel,
    draw: impl FnOnce(Sink) -> Result<(), Error>,
) -> Result<(), Error> {
    let sample = layout(pixel).ok_or_else(|| cannot_hold_pixel(ImageFormat::Ppm, pixel))?;
    let (width, height) = (size.width(), size.height());
    let most = (1_u32 << (8 * sample.bytes())) - 1;
    write!(writer, "P6\n{width} {height}\n{most}\n").map_err(Error::writing)?;
    draw(&mut |rows| {
        let rows = sample.big_endian(rows);
        writer.write_all(&rows).map_err(Error::writing)
    })?;
    writer.flush().map_err(Error::writing)
}
