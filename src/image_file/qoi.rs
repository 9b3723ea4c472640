//! QOI, with or without alpha.

use image::codecs::qoi::QoiEncoder;

use crate::image_file::{
    Format, ImageFormat,
    pixel::{Pixel, Sample},
    whole,
};

/// The maximum number of pixels in a file.
const PIXELS: u64 = 400_000_000;

impl ImageFormat {
    /// The Quite OK Image Format, lossless.
    pub const QOI: Self = Self(&Format {
        endings: &["qoi"],
        holds: |pixel| matches!(pixel, Pixel::Rgb(Sample::U8) | Pixel::Rgba(Sample::U8)),
        exceeded: |size, _| (size.pixels() > PIXELS).then(|| format!("at most {PIXELS} pixels")),
        decoder: Some(image::ImageFormat::Qoi),
        encode: |output, form, draw| {
            whole::encode(output, form, draw, |writer, picture| {
                picture.by(QoiEncoder::new(writer))
            })
        },
        ..Format::PLAIN
    });
}
