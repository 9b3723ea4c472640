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
