//! WebP, lossless, with or without alpha.

use image::codecs::webp::WebPEncoder;

use crate::image_file::{
    Format, ImageFormat,
    format::longest,
    pixel::{Pixel, Sample},
    whole::{self, with_space},
};

impl ImageFormat {
    /// WebP, lossless.
    pub const WEBP: Self = Self(&Format {
        endings: &["webp"],
        holds: |pixel| matches!(pixel, Pixel::Rgb(Sample::U8) | Pixel::Rgba(Sample::U8)),
        exceeded: |size, _| longest(16_383, size),
        decoder: Some(image::ImageFormat::WebP),
        encode: |output, form, draw| {
            whole::encode(output, form, draw, |writer, picture| {
                picture.by(with_space(
                    WebPEncoder::new_lossless(writer),
                    form.encoding,
                )?)
            })
        },
        ..Format::PLAIN
    });
}
