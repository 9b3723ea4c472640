//! Deflate in zlib format, as used by TIFF, EXR and small PNG files.
//!
//! `miniz_oxide` runs the same code on every processor. zlib-rs, which `flate2` also offers,
//! selects its code by the features of the processor, and the bytes differ.

use miniz_oxide::{
    DataFormat,
    deflate::{compress_to_vec_zlib, core::CompressorOxide},
};

use crate::image_file::Compression;

/// Compresses all bytes at once.
pub(super) fn zlib(bytes: &[u8], compression: Compression) -> Vec<u8> {
    compress_to_vec_zlib(bytes, level(compression))
}

/// Creates a compressor that takes the bytes piece by piece.
pub(super) fn stream(compression: Compression) -> Box<CompressorOxide> {
    let mut stream = Box::<CompressorOxide>::default();
    stream.set_format_and_level(DataFormat::Zlib, level(compression));
    stream
}

fn level(compression: Compression) -> u8 {
    match compression {
        // Level 9 takes up to four times as long to save a twentieth of the size.
        Compression::Small => 6,
        _ => 1,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Another version of the compressor writes other bytes. That change must be noted.
    #[test]
    fn the_bytes_are_known() {
        let bytes: Vec<u8> = (0..40_000_u32)
            .map(|place| (place / 7 * place / 300) as u8)
            .collect();
        for (compression, length, sum) in [
            (Compression::Fast, 29_045, 1_203_210_790),
            (Compression::Small, 25_397, 3_050_399_388),
        ] {
            let found = zlib(&bytes, compression);
            let found = (found.len(), crc32fast::hash(&found));
            assert_eq!(found, (length, sum), "{compression:?}");
        }
    }
}
