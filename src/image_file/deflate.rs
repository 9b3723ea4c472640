//! Deflate in the zlib form, for TIFF and EXR.

use miniz_oxide::deflate::compress_to_vec_zlib;

use crate::image_file::Compression;

pub(super) fn zlib(bytes: &[u8], compression: Compression) -> Vec<u8> {
    let level = match compression {
        // That of `png.rs`.
        Compression::Small => 6,
        _ => 1,
    };
    compress_to_vec_zlib(bytes, level)
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
