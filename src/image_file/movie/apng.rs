//! Animated PNG: the frames of a movie, repeated forever by a browser.

use std::io::Write;

use png::{BitDepth, ColorType, DeflateCompression, Encoder, Filter, SrgbRenderingIntent};

use super::{FrameSink, Reel, fraction::fraction};
use crate::{diagnostic::error::Error, film::Image, image_file::png::error::error};

pub(super) fn write<E: From<Error>>(
    writer: impl Write,
    reel: Reel,
    draw: impl FnOnce(FrameSink) -> Result<(), E>,
) -> Result<(), E> {
    let mut encoder = Encoder::new(writer, reel.size.width(), reel.size.height());
    encoder.set_color(ColorType::Rgb);
    encoder.set_depth(BitDepth::Eight);
    encoder.set_source_srgb(SrgbRenderingIntent::Perceptual);
    // As for a single picture with fast compression.
    encoder.set_deflate_compression(DeflateCompression::FdeflateUltraFast);
    encoder.set_filter(Filter::Up);
    // 0 means forever. The time of a frame is a fraction of 16-bit integers.
    encoder.set_animated(reel.frames, 0).map_err(error)?;
    let (below, above) = fraction(reel.fps, u16::MAX.into());
    let delay = encoder.set_frame_delay(above as u16, below as u16);
    delay.map_err(error)?;
    let mut writer = encoder.write_header().map_err(error)?;
    draw(&mut |image: &Image| writer.write_image_data(image.pixels()).map_err(error))?;
    Ok(writer.finish().map_err(error)?)
}
