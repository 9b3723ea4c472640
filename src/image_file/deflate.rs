//! Deflate in the zlib form, as TIFF, EXR and small PNG have it.
//!
//! `miniz_oxide` has one code for every processor. zlib-rs, which `flate2` also offers, chooses by
//! what the processor can do, and with that the bytes.

use miniz_oxide::{
    DataFormat,
    deflate::{compress_to_vec_zlib, core::CompressorOxide},
};

use crate::image_file::Compression;

/// All at once.
pub(super) fn zlib(bytes: &[u8], compression: Compression) -> Vec<u8> {
    compress_to_vec_zlib(bytes, level(compression))
}

/// What takes the bytes piece by piece.
pub(super) fn stream(compression: Compression) -> Box<CompressorOxide> {
    let mut stream = Box::<CompressorOxide>::default();
    stream.set_format_and_level(DataFormat::Zlib, level(compression));
    stream
}

fn level(compression: Compression) -> u8 {
    match compression {
        // Level 9 takes up to four times as long for a twentieth of the size.
        Compression::Small => 6,
        _ => 1,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A compressor that has been exchanged for another version writes other bytes. That is a
    /// change to be noted.
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
