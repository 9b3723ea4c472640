//! BMP, with 8 bits of red, green and blue.

use image::codecs::bmp::BmpEncoder;

use crate::image_file::{Format, ImageFormat, whole};

/// Bytes reserved for the headers: a file must stay below 4 GiB.
const HEADERS: u64 = 4096;

impl ImageFormat {
    /// Windows bitmap, uncompressed.
    pub const BMP: Self = Self(&Format {
        endings: &["bmp"],
        exceeded: |size, pixel| {
            let row = u64::from(size.width()) * pixel.bytes() as u64;
            let bytes = row.next_multiple_of(4) * u64::from(size.height()) + HEADERS;
            (bytes > u64::from(u32::MAX)).then(|| "less than 4 GiB of pixels".to_owned())
        },
        decoder: Some(image::ImageFormat::Bmp),
        encode: |output, form, draw| {
            whole::encode(output, form, draw, |mut writer, picture| {
                picture.by(BmpEncoder::new(&mut writer))
            })
        },
        ..Format::PLAIN
    });
}
