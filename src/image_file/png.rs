//! PNG, row by row as the bands arrive.

use std::{
    cell::Cell,
    io::{self, Write},
};

use png::{
    BitDepth, ColorType, DeflateCompression, Encoder, EncodingError, Filter, SrgbRenderingIntent,
};

use crate::{
    error::Error,
    film::size::Size,
    image_file::{
        Compression, Encoding, ImageFormat, Sink,
        limits::cannot_hold,
        pixel::{Pixel, Sample},
    },
};

/// How much compressed data one chunk of the file holds.
const CHUNK: usize = 1 << 16;

/// The kind of a pixel and the bits of a number.
pub(super) fn layout(pixel: Pixel) -> Option<(ColorType, BitDepth)> {
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

pub(super) fn encode(
    writer: impl Write,
    size: Size,
    pixel: Pixel,
    encoding: Encoding,
    draw: impl FnOnce(Sink) -> Result<(), Error>,
) -> Result<(), Error> {
    let (color, depth) = layout(pixel).ok_or_else(|| cannot_hold(ImageFormat::Png, pixel))?;
    let failure = Cell::new(None);
    let failed = || {
        failure
            .take()
            .map_or(Ok(()), |error| Err(Error::writing(error)))
    };
    let writer = Patient {
        writer,
        works: true,
        failure: &failure,
    };
    let mut encoder = Encoder::new(writer, size.width(), size.height());
    if encoding.colors {
        encoder.set_source_srgb(SrgbRenderingIntent::Perceptual);
    }
    for (name, text) in encoding.metadata {
        let (name, text) = (name.clone(), text.replace('\0', " "));
        encoder.add_itxt_chunk(name, text).map_err(error)?;
    }
    let (deflate, filter) = settings(encoding.compression);
    encoder.set_deflate_compression(deflate);
    encoder.set_filter(filter);
    encoder.set_color(color);
    encoder.set_depth(depth);
    if let Pixel::Indexed(palette) = pixel {
        encoder.set_palette(palette.as_flattened());
    }
    let mut writer = encoder.write_header().map_err(error)?;
    let mut rows = writer.stream_writer_with_size(CHUNK).map_err(error)?;
    failed()?;
    let mut packed = Vec::new();
    draw(&mut |bytes| {
        packed.clear();
        let width = size.width() as usize;
        let bytes = match depth {
            BitDepth::One => pack::<8>(bytes, width, &mut packed).into(),
            BitDepth::Two => pack::<4>(bytes, width, &mut packed).into(),
            BitDepth::Four => pack::<2>(bytes, width, &mut packed).into(),
            BitDepth::Eight => bytes.into(),
            BitDepth::Sixteen => Sample::U16.big_endian(bytes),
        };
        rows.write_all(&bytes).map_err(Error::writing)?;
        failed()
    })?;
    rows.finish().map_err(error)?;
    writer.finish().map_err(error)?;
    failed()
}

/// The compressor and the filter of the rows, as `cargo bench --bench encode` has found them.
///
/// `fdeflate` and, for levels, `miniz_oxide` have one code for every processor. zlib-rs, which
/// `flate2` also offers, chooses by what the processor can do, and with that the bytes.
fn settings(compression: Compression) -> (DeflateCompression, Filter) {
    match compression {
        // This search finds the rows above by itself, and better: a filter leaves a trace at
        // each edge. Level 9 takes up to four times as long for a twentieth of the size.
        Compression::Small => (DeflateCompression::Level(6), Filter::NoFilter),
        // `fdeflate` finds nothing but runs of zeros: without a filter a file becomes larger
        // than its pixels, and a flat picture is nothing but zeros once each row has the one
        // above it taken off.
        _ => (DeflateCompression::FdeflateUltraFast, Filter::Up),
    }
}

/// The fewest bits that number the colors of a palette.
fn depth_of(palette: &[[u8; 3]]) -> BitDepth {
    match palette.len() {
        ..=2 => BitDepth::One,
        3..=4 => BitDepth::Two,
        5..=16 => BitDepth::Four,
        _ => BitDepth::Eight,
    }
}

/// Packs rows of one byte a pixel, `PER` of them into a byte, the first one into the high bits;
/// each row begins with a byte of its own.
fn pack<'a, const PER: usize>(pixels: &[u8], width: usize, packed: &'a mut Vec<u8>) -> &'a [u8] {
    let depth = 8 / PER;
    let pack = |pixels: &[u8]| pixels.iter().fold(0, |bits, pixel| bits << depth | pixel);
    for row in pixels.chunks(width) {
        let (whole, rest) = row.as_chunks::<PER>();
        packed.extend(whole.iter().map(|pixels| pack(pixels)));
        if !rest.is_empty() {
            packed.push(pack(rest) << (8 - depth * rest.len()));
        }
    }
    packed
}

fn error(error: EncodingError) -> Error {
    Error::writing(match error {
        EncodingError::IoError(error) => error,
        other => io::Error::other(other),
    })
}

/// A writer that takes everything and keeps its first failure for later: `fdeflate` panics when
/// its last bytes cannot be written.
struct Patient<'a, W> {
    writer: W,
    works: bool,
    failure: &'a Cell<Option<io::Error>>,
}

impl<W: Write> Patient<'_, W> {
    fn attempt(&mut self, work: impl FnOnce(&mut W) -> io::Result<()>) {
        if self.works
            && let Err(error) = work(&mut self.writer)
        {
            self.works = false;
            self.failure.set(Some(error));
        }
    }
}

impl<W: Write> Write for Patient<'_, W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.attempt(|writer| writer.write_all(bytes));
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        self.attempt(W::flush);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use png::Transformations;

    use super::*;
    use crate::error::ErrorKind;

    /// A row of noise, 3 bytes a pixel.
    fn noise(width: usize) -> Vec<u8> {
        let mut state = 1_u32;
        let bytes = (0..3 * width).map(|_| {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 24) as u8
        });
        bytes.collect()
    }

    fn written(
        writer: impl Write,
        encoding: Encoding,
        size: Size,
        bytes: &[u8],
    ) -> Result<(), Error> {
        encode(writer, size, RGB, encoding, |sink| sink(bytes))
    }

    const RGB: Pixel = Pixel::Rgb(Sample::U8);

    const BOTH: [Compression; 2] = [Compression::Fast, Compression::Small];

    #[test]
    fn palettes_are_as_shallow_as_they_can_be() {
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
                encode(&mut file, size, pixel, encoding, |sink| sink(&places)).unwrap();
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

    /// A compressor that has been exchanged, for another version or by a feature of `flate2` that
    /// some crate has turned on, writes other bytes. That is a change to be noted.
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
            (Compression::Small, 247, 2_708_855_686),
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
    fn any_byte_may_find_no_room() {
        /// Takes so many bytes.
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
        // Where the compressor's last bytes are those that fill a chunk.
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
