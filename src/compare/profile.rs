//! What a picture file says about its colors other than sRGB.

use std::{io::Cursor, iter};

use image::{ImageDecoder, ImageFormat, ImageReader};

use crate::{
    compare::limit::PictureOptions,
    parallel::{Cancel, reader::UntilCancelled},
};

/// The gamma of sRGB in a PNG file, in 100,000ths.
const GAMMA: u32 = 45_455;

/// Returns what a picture file has that gives its display values other colors than sRGB, if it has something: an ICC
/// profile, or a gamma; `None` once cancelled.
pub(crate) fn other_than_srgb(file: &[u8], cancel: Option<&Cancel>) -> Option<&'static str> {
    let format = image::guess_format(file).ok()?;
    let mut gamma = None;
    if format == ImageFormat::Png {
        for (name, data) in png_chunks(file) {
            match name {
                // It outranks the others.
                b"sRGB" => return None,
                b"gAMA" => gamma = data.first_chunk().map(|bytes| u32::from_be_bytes(*bytes)),
                _ => {}
            }
        }
    }
    let file = UntilCancelled::new(Cursor::new(file), cancel);
    let mut reader = ImageReader::with_format(file, format);
    reader.limits(PictureOptions::decoder_limits(0));
    let profile = reader.into_decoder().ok()?.icc_profile().ok()?;
    match (profile, gamma) {
        (Some(profile), _) => (!is_srgb(&profile)).then_some("ICC profile"),
        (None, Some(gamma)) => (gamma.abs_diff(GAMMA) > GAMMA / 100).then_some("gamma"),
        (None, None) => None,
    }
}

/// Returns true if a profile calls itself one of sRGB, in either version of the format.
fn is_srgb(profile: &[u8]) -> bool {
    let has = |name: &[u8]| profile.windows(name.len()).any(|part| part == name);
    has(b"sRGB") || has(b"s\0R\0G\0B")
}

/// Returns the names and the data of the chunks of a PNG file before its pixels.
fn png_chunks(file: &[u8]) -> impl Iterator<Item = (&[u8; 4], &[u8])> {
    let mut rest = file.get(8..).unwrap_or_default();
    iter::from_fn(move || {
        let (length, after) = rest.split_first_chunk()?;
        let (name, after) = after.split_first_chunk()?;
        let length = u32::from_be_bytes(*length) as usize;
        let (data, checksum) = after.split_at_checked(length)?;
        rest = checksum.get(4..)?;
        (name != b"IDAT").then_some((name, data))
    })
}

#[cfg(test)]
mod tests {
    use image::{ImageEncoder, codecs::jpeg::JpegEncoder, codecs::png::PngEncoder};

    use super::*;

    /// Returns a picture of one pixel with a profile.
    fn with_profile(profile: &[u8]) -> [Vec<u8>; 2] {
        let (mut png, mut jpeg) = (Vec::new(), Vec::new());
        let color = image::ExtendedColorType::Rgb8;
        let mut encoder = PngEncoder::new(&mut png);
        encoder.set_icc_profile(profile.to_vec()).unwrap();
        encoder.write_image(&[9; 3], 1, 1, color).unwrap();
        let mut encoder = JpegEncoder::new(&mut jpeg);
        encoder.set_icc_profile(profile.to_vec()).unwrap();
        encoder.write_image(&[9; 3], 1, 1, color).unwrap();
        [png, jpeg]
    }

    /// Returns a PNG file of one pixel with a chunk behind its header, whose checksum is missing.
    fn with_chunk(name: &[u8; 4], data: &[u8]) -> Vec<u8> {
        let mut png = Vec::new();
        let color = image::ExtendedColorType::Rgb8;
        PngEncoder::new(&mut png)
            .write_image(&[9; 3], 1, 1, color)
            .unwrap();
        let length = (data.len() as u32).to_be_bytes();
        let chunk = [&length[..], name, data, &[0; 4]].concat();
        png.splice(33..33, chunk);
        png
    }

    #[test]
    fn profiles_of_srgb_are_no_others() {
        for file in with_profile(b"a profile of Display P3") {
            assert_eq!(other_than_srgb(&file, None), Some("ICC profile"));
        }
        for profile in [&b"this is sRGB IEC61966-2.1"[..], b"mluc\0s\0R\0G\0B\0"] {
            for file in with_profile(profile) {
                assert_eq!(other_than_srgb(&file, None), None);
            }
        }
    }

    #[test]
    fn chunks_of_png_files() {
        for (name, number, other) in [
            (b"gAMA", 45_455_u32, None),
            (b"gAMA", 45_100, None),
            (b"gAMA", 100_000, Some("gamma")),
            (b"tEXt", 100_000, None),
        ] {
            let file = with_chunk(name, &number.to_be_bytes());
            let names: Vec<_> = png_chunks(&file).map(|(name, _)| *name).collect();
            assert_eq!(names, [*b"IHDR", *name]);
            let gamma = png_chunks(&file).find(|(name, _)| *name == b"gAMA");
            assert_eq!(gamma.is_some(), name == b"gAMA");
            // The decoder needs no checksum of what it may skip.
            assert_eq!(other_than_srgb(&file, None), other, "{name:?} {number}");
        }
        for file in [
            &b""[..],
            b"\x89PNG\r\n\x1a\n",
            b"BM",
            b"\x89PNG\r\n\x1a\n\xff\xff\xff\xff",
        ] {
            assert_eq!(other_than_srgb(file, None), None);
            assert_eq!(png_chunks(file).count(), 0);
        }
    }
}
