//! PNG, written row by row as bands arrive.

pub(super) mod error;
mod rows;

use std::{cell::Cell, io::Write};

impl ImageFormat {
    /// Portable Network Graphics, lossless.
    pub const PNG: Self = Self(&Format {
        endings: &["png"],
        holds: |pixel| layout(pixel).is_some(),
        compressions: &[Compression::Fast, Compression::Small],
        has_metadata: true,
        decoder: Some(image::ImageFormat::Png),
        encode,
        ..Format::PLAIN
    });
}

use png::{BitDepth, ColorType, Encoder, SrgbRenderingIntent};

use self::rows::Rows;
use crate::{
    diagnostic::error::Error,
    image_file::{
        Compression, Form, Format, ImageFormat,
        format::cannot_hold_pixel,
        output::{Draw, Output},
        pixel::{Pixel, Sample},
        png::error::error,
    },
};

/// Returns the color type and the bit depth, if the format supports the pixel type.
fn layout(pixel: Pixel) -> Option<(ColorType, BitDepth)> {
    let depth = |sample| match sample {
        Sample::U8 => Some(BitDepth::Eight),
        Sample::U16 => Some(BitDepth::Sixteen),
        _ => None,
    };
    Some(match pixel {
        Pixel::Gray(sample) => (ColorType::Grayscale, depth(sample)?),
        Pixel::Rgb(sample) => (ColorType::Rgb, depth(sample)?),
        Pixel::Rgba(sample) => (ColorType::Rgba, depth(sample)?),
        Pixel::Indexed(palette) => (ColorType::Indexed, depth_of(palette)),
        Pixel::Channels(_) | Pixel::Arrays(_) => return None,
    })
}

fn encode(mut writer: Output, form: Form, draw: Draw) -> Result<(), Error> {
    let Form {
        size,
        pixel,
        encoding,
    } = form;
    let (color, depth) = layout(pixel).ok_or_else(|| cannot_hold_pixel(ImageFormat::PNG, pixel))?;
    let failure = Cell::new(None);
    let writer: &mut dyn Write = &mut writer;
    let mut encoder = Encoder::new(writer, size.width(), size.height());
    if encoding.colors {
        encoder.set_source_srgb(SrgbRenderingIntent::Perceptual);
    }
    for (name, text) in encoding.metadata {
        let (name, text) = (name.clone(), text.replace('\0', " "));
        encoder.add_itxt_chunk(name, text).map_err(error)?;
    }
    encoder.set_color(color);
    encoder.set_depth(depth);
    if let Pixel::Indexed(palette) = pixel {
        encoder.set_palette(palette.as_flattened());
    }
    let writer = encoder.write_header().map_err(error)?;
    let bits = color.samples() * depth as usize;
    let width = (size.width() as usize * bits).div_ceil(8);
    let mut rows = Rows::new(writer, width, encoding.compression, &failure)?;
    let mut packed = Vec::new();
    draw(&mut |bytes| {
        packed.clear();
        let width = size.width() as usize;
        rows.write(&match depth {
            BitDepth::One => pack::<1>(bytes, width, &mut packed).into(),
            BitDepth::Two => pack::<2>(bytes, width, &mut packed).into(),
            BitDepth::Four => pack::<4>(bytes, width, &mut packed).into(),
            BitDepth::Eight => bytes.into(),
            BitDepth::Sixteen => Sample::U16.big_endian(bytes),
        })
    })?;
    rows.finish()
}

/// Returns the smallest bit depth for the indices of a palette.
fn depth_of(palette: &[[u8; 3]]) -> BitDepth {
    match palette.len() {
        ..=2 => BitDepth::One,
        3..=4 => BitDepth::Two,
        5..=16 => BitDepth::Four,
        _ => BitDepth::Eight,
    }
}

/// Packs rows of one byte per pixel into `BITS` bits per pixel, the first pixel into the high bits.
/// Each row begins with a new byte.
fn pack<'a, const BITS: usize>(pixels: &[u8], width: usize, packed: &'a mut Vec<u8>) -> &'a [u8] {
    for row in pixels.chunks(width) {
        let (eights, rest) = row.as_chunks();
        packed.reserve((eights.len() + 1) * BITS);
        for eight in eights {
            packed.extend_from_slice(&join::<BITS>(*eight));
        }
        let mut last = [0; 8];
        last[..rest.len()].copy_from_slice(rest);
        packed.extend_from_slice(&join::<BITS>(last)[..(rest.len() * BITS).div_ceil(8)]);
    }
    packed
}

/// Packs eight pixels into `BITS` bits each: neighbors are joined, then pairs, then the two halves.
fn join<const BITS: usize>(pixels: [u8; 8]) -> [u8; BITS] {
    let mut all = u64::from_be_bytes(pixels);
    all = (all >> (8 - BITS) | all) & 0x00FF_00FF_00FF_00FF;
    all = (all >> (16 - 2 * BITS) | all) & 0x0000_FFFF_0000_FFFF;
    all = all >> (32 - 4 * BITS) | all;
    let bytes = all.to_be_bytes();
    std::array::from_fn(|byte| bytes[8 - BITS + byte])
}

#[cfg(test)]
mod tests {
    use std::io;

    use png::Transformations;

    use super::*;
    use crate::{diagnostic::error::ErrorKind, film::size::Size, image_file::Encoding};

    /// Returns a row of noise, 3 bytes per pixel.
    fn noise(width: usize) -> Vec<u8> {
        let mut state = 1_u32;
        let bytes = (0..3 * width).map(|_| {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 24) as u8
        });
        bytes.collect()
    }

    fn written(
        mut writer: impl Write,
        encoding: Encoding,
        size: Size,
        bytes: &[u8],
    ) -> Result<(), Error> {
        let output = Output::Stream(&mut writer);
        encode(
            output,
            Form {
                size,
                pixel: RGB,
                encoding,
            },
            &mut |sink| sink(bytes),
        )
    }

    const RGB: Pixel = Pixel::Rgb(Sample::U8);

    const BOTH: [Compression; 2] = [Compression::Fast, Compression::Small];

    #[test]
    fn palettes_have_the_smallest_possible_depth() {
        for (count, depth) in [
            (1, 1),
            (2, 1),
            (3, 2),
            (4, 2),
            (5, 4),
            (16, 4),
            (17, 8),
            (256, 8),
        ] {
            let palette: Vec<_> = (0..count)
                .map(|place| [(place % 256) as u8, 7, 9])
                .collect();
            for (width, compression) in (1..20).flat_map(|width| BOTH.map(|one| (width, one))) {
                let size = Size::new(width, 2).unwrap();
                let places = (0..2 * width).map(|pixel| (pixel * 37 % count) as u8);
                let places: Vec<_> = places.collect();
                let mut file = Vec::new();
                let encoding = Encoding {
                    compression,
                    ..Encoding::default()
                };
                let pixel = Pixel::Indexed(&palette);
                let output = Output::Stream(&mut file);
                encode(
                    output,
                    Form {
                        size,
                        pixel,
                        encoding,
                    },
                    &mut |sink| sink(&places),
                )
                .unwrap();
                let mut decoder = png::Decoder::new(io::Cursor::new(&file));
                decoder.set_transformations(Transformations::EXPAND);
                let mut reader = decoder.read_info().unwrap();
                assert_eq!(reader.info().bit_depth as u32, depth);
                assert_eq!(reader.info().color_type, ColorType::Indexed);
                let found = reader.info().palette.clone().unwrap();
                assert_eq!(&*found, palette.as_flattened());
                let mut pixels = vec![0; 6 * width as usize];
                reader.next_frame(&mut pixels).unwrap();
                let expected = places.iter().flat_map(|place| palette[usize::from(*place)]);
                assert!(
                    pixels.into_iter().eq(expected),
                    "{count} colors, {width} columns"
                );
            }
        }
    }

    #[test]
    fn all_chunks_except_the_last_are_full() {
        let (width, size) = (90_000, Size::new(90_000, 1).unwrap());
        let pixels = noise(width);
        for compression in BOTH {
            let mut file = Vec::new();
            let encoding = Encoding {
                compression,
                ..Encoding::default()
            };
            written(&mut file, encoding, size, &pixels).unwrap();
            let (mut rest, mut lengths) = (&file[8..], Vec::new());
            while let Some((length, after)) = rest.split_first_chunk() {
                let length = u32::from_be_bytes(*length) as usize;
                if after.starts_with(b"IDAT") {
                    lengths.push(length);
                }
                rest = &after[length + 8..];
            }
            let (last, full) = lengths.split_last().unwrap();
            assert!(*last <= 1 << 16 && full.len() > 3);
            assert!(full.iter().all(|length| *length == 1 << 16), "{lengths:?}");
            let mut reader = png::Decoder::new(io::Cursor::new(&file))
                .read_info()
                .unwrap();
            let mut found = vec![0; pixels.len()];
            reader.next_frame(&mut found).unwrap();
            assert!(found == pixels);
        }
    }

    /// A compressor of another version, or another one that some crate selects through a feature of
    /// `flate2`, writes other bytes. That change must be noted.
    #[test]
    fn the_bytes_of_a_file_are_known() {
        let size = Size::new(64, 48).unwrap();
        let disc = |pixel: i32| {
            let (x, y) = (pixel % 64 - 32, pixel / 64 - 20);
            if x * x + y * y < 200 {
                [250, 130, 0]
            } else {
                [2, 48, 71]
            }
        };
        let pixels: Vec<_> = (0..64 * 48).flat_map(disc).collect();
        for (compression, length, sum) in [
            (Compression::Fast, 802, 996_561_668),
            (Compression::Small, 229, 793_942_736),
        ] {
            let encoding = Encoding {
                compression,
                ..Encoding::default()
            };
            let mut file = Vec::new();
            written(&mut file, encoding, size, &pixels).unwrap();
            // FNV-1a, by Fowler, Noll and Vo.
            let hash = |sum: u32, byte: &u8| (sum ^ u32::from(*byte)).wrapping_mul(16_777_619);
            let found = file.iter().fold(2_166_136_261, hash);
            assert_eq!((file.len(), found), (length, sum), "{compression:?}");
        }
    }

    #[test]
    fn any_byte_may_fail_to_be_written() {
        /// A writer with room for this many bytes.
        struct Full(usize);
        impl Write for Full {
            fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
                if self.0 == 0 {
                    return Err(io::ErrorKind::StorageFull.into());
                }
                let taken = self.0.min(bytes.len());
                self.0 -= taken;
                Ok(taken)
            }

            fn flush(&mut self) -> io::Result<()> {
                Ok(())
            }
        }
        // Finds the width at which the compressor's last bytes fill a chunk.
        let chunks = |width: usize| {
            let (mut file, size) = (Vec::new(), Size::new(width as u32, 1).unwrap());
            written(&mut file, Encoding::default(), size, &noise(width)).unwrap();
            file.windows(4).filter(|name| name == b"IDAT").count()
        };
        let (mut one, mut two) = (1, 40_000);
        while two - one > 1 {
            let middle = usize::midpoint(one, two);
            *(if chunks(middle) > 1 {
                &mut two
            } else {
                &mut one
            }) = middle;
        }
        for width in one - 20..two + 20 {
            let (size, pixels) = (Size::new(width as u32, 1).unwrap(), noise(width));
            for room in [0, 40, 60] {
                let refused = written(Full(room), Encoding::default(), size, &pixels);
                assert_eq!(refused.unwrap_err().kind(), ErrorKind::Unavailable);
            }
        }
    }
}
