//! Every format with every pixel type: written, read back, and written to a full disk.

mod files;
mod full;
mod readers;

use std::io::Cursor;

use exr::prelude::f16;

use crate::{
    diagnostic::error::Error,
    film::size::Size,
    image_file::{
        Compression, Encoding, Form, ImageFormat,
        output::{Output, Sink},
        pixel::{Array, Channel, Pixel, Sample},
    },
};

const SAMPLES: [(Sample, &str); 6] = [
    (Sample::U8, "u1"),
    (Sample::U16, "u2"),
    (Sample::U32, "u4"),
    (Sample::F16, "f2"),
    (Sample::F32, "f4"),
    (Sample::F64, "f8"),
];
/// Not sorted by name.
const CHANNELS: [(&str, Sample); 8] = [
    ("R", Sample::F16),
    ("G", Sample::F16),
    ("B", Sample::F16),
    ("A", Sample::F16),
    ("Z", Sample::F32),
    ("N.X", Sample::F32),
    ("id", Sample::U32),
    ("a name that is longer than others", Sample::F32),
];
const SIZE: (u32, u32) = (37, 21);

/// A file to write.
struct Case {
    /// The name, such as `rgb-u1-fast.png`: the pixel type, the sample type and the compression.
    name: String,
    format: ImageFormat,
    pixel: Pixel<'static>,
    compression: Compression,
}

/// Returns every format with every pixel type that it supports and every compression that it has.
fn cases() -> Vec<Case> {
    let channels = CHANNELS.map(|(name, sample)| Channel {
        name: name.to_owned(),
        sample,
    });
    let arrays = [
        ("color", Pixel::Rgb(Sample::U8)),
        ("depth", Pixel::Gray(Sample::F32)),
        ("position", Pixel::Rgb(Sample::F64)),
    ];
    let arrays = arrays.map(|(name, pixel)| Array {
        name: name.to_owned(),
        pixel,
    });
    let palette = [[1, 2, 3], [4, 5, 6], [7, 8, 9], [200, 100, 0], [0, 0, 255]];
    let mut pixels = vec![
        (
            "indexed-u1".to_owned(),
            Pixel::Indexed(Vec::leak(palette.to_vec())),
        ),
        (
            "channels".to_owned(),
            Pixel::Channels(Vec::leak(channels.to_vec())),
        ),
        (
            "arrays".to_owned(),
            Pixel::Arrays(Vec::leak(arrays.to_vec())),
        ),
    ];
    for (sample, name) in SAMPLES {
        pixels.push((format!("gray-{name}"), Pixel::Gray(sample)));
        pixels.push((format!("rgb-{name}"), Pixel::Rgb(sample)));
        pixels.push((format!("rgba-{name}"), Pixel::Rgba(sample)));
    }
    let mut cases = Vec::new();
    for (kind, pixel) in &pixels {
        for format in ImageFormat::ALL {
            for compression in Compression::ALL.iter().copied() {
                let encoding = Encoding {
                    compression,
                    ..Encoding::default()
                };
                if format
                    .check(Form {
                        size: size(SIZE),
                        pixel: *pixel,
                        encoding,
                    })
                    .is_ok()
                {
                    cases.push(Case {
                        name: format!("{kind}-{}.{}", compression.name(), format.name()),
                        format: *format,
                        pixel: *pixel,
                        compression,
                    });
                }
            }
        }
    }
    cases
}

fn size((width, height): (u32, u32)) -> Size {
    Size::new(width, height).unwrap()
}

/// Returns the bytes of a number in patches of equal numbers; `tests/files/check.py` expects the
/// same. Without colors, the first float is infinite and the first 32-bit integer is the largest.
fn number(sample: Sample, column: u32, row: u32, part: u32, color: bool) -> Vec<u8> {
    let number = column / 4 * 31 + row / 3 * 17 + part * 101;
    let first = !color && (column, row) == (0, 0);
    let float = if first {
        f64::INFINITY
    } else {
        f64::from(number) / 8.0
    };
    match sample {
        Sample::U8 => vec![number as u8],
        Sample::U16 => (number.wrapping_mul(257) as u16).to_ne_bytes().to_vec(),
        Sample::U32 if first => vec![255; 4],
        Sample::U32 => number.wrapping_mul(65_537).to_ne_bytes().to_vec(),
        Sample::F16 => f16::from_f64(float).to_ne_bytes().to_vec(),
        Sample::F32 => (float as f32).to_ne_bytes().to_vec(),
        Sample::F64 => float.to_ne_bytes().to_vec(),
    }
}

/// Returns a picture as it is passed to a sink.
fn picture(pixel: Pixel, (width, height): (u32, u32)) -> Vec<u8> {
    (0..height)
        .flat_map(|row| part(pixel, width, row))
        .collect()
}

fn part(pixel: Pixel, width: u32, row: u32) -> Vec<u8> {
    let columns = 0..width;
    match pixel {
        Pixel::Indexed(palette) => {
            let place = |column: u32| (column / 4 + row / 3) as usize % palette.len();
            columns.map(|column| place(column) as u8).collect()
        }
        Pixel::Arrays(arrays) => {
            let rows = arrays.iter().map(|array| part(array.pixel, width, row));
            rows.flatten().collect()
        }
        Pixel::Channels(channels) => {
            let rows = channels.iter().zip(0..).flat_map(|(channel, part)| {
                let columns = columns.clone();
                columns.flat_map(move |column| number(channel.sample, column, row, part, false))
            });
            rows.collect()
        }
        Pixel::Gray(_) | Pixel::Rgb(_) | Pixel::Rgba(_) => {
            let (count, sample) = pixel.samples().unwrap();
            let color = count > 1;
            let pixels = columns.flat_map(|column| {
                (0..count as u32).flat_map(move |part| number(sample, column, row, part, color))
            });
            pixels.collect()
        }
    }
}

impl Case {
    fn write(
        &self,
        output: Output,
        side: (u32, u32),
        metadata: &[(String, String)],
    ) -> Result<(), Error> {
        let encoding = Encoding {
            compression: self.compression,
            metadata,
            ..Encoding::default()
        };
        let picture = picture(self.pixel, side);
        let row = side.0 as usize * self.pixel.bytes();
        // Bands of one row, two rows, three rows and so on.
        let draw = &mut |sink: Sink| {
            let mut rest = &*picture;
            let mut rows = 1;
            while !rest.is_empty() {
                let band = rest.split_at(rest.len().min(rows * row));
                sink(band.0)?;
                (rest, rows) = (band.1, rows + 1);
            }
            Ok(())
        };
        self.format.encode(
            output,
            Form {
                size: size(side),
                pixel: self.pixel,
                encoding,
            },
            draw,
        )
    }

    fn file(&self, side: (u32, u32)) -> Vec<u8> {
        let mut file = Cursor::new(Vec::new());
        let written = self.write(Output::File(&mut file), side, &[]);
        written.unwrap_or_else(|error| panic!("{}: {error}", self.name));
        file.into_inner()
    }

    fn find(name: &str) -> Self {
        let mut cases = cases().into_iter();
        cases.find(|case| case.name == name).unwrap()
    }
}

#[test]
fn the_number_of_cases_is_as_documented() {
    let count = |format| cases().iter().filter(|case| case.format == format).count();
    let counts = ImageFormat::ALL
        .iter()
        .map(|format| (*format, count(*format)));
    let expected = [
        (ImageFormat::PNG, 2 * 7),
        (ImageFormat::JPEG, 2 * 2),
        (ImageFormat::BMP, 2),
        (ImageFormat::TIFF, 3 * 12),
        (ImageFormat::PPM, 2 * 2),
        (ImageFormat::PFM, 2 * 2),
        (ImageFormat::QOI, 2 * 2),
        (ImageFormat::WEBP, 2 * 2),
        (ImageFormat::HDR, 2),
        (ImageFormat::EXR, 6),
        (ImageFormat::NPY, 2 * 18),
        (ImageFormat::NPZ, 2),
    ];
    assert_eq!(counts.collect::<Vec<_>>(), expected);
}

#[test]
fn a_stream_gets_the_bytes_of_a_file_for_any_bands() {
    for case in cases() {
        let file = case.file(SIZE);
        let mut stream = Vec::new();
        case.write(Output::Stream(&mut stream), SIZE, &[]).unwrap();
        assert!(stream == file, "{}", case.name);
        let whole = picture(case.pixel, SIZE);
        let mut at_once = Vec::new();
        let encoding = Encoding {
            compression: case.compression,
            ..Encoding::default()
        };
        let output = Output::Stream(&mut at_once);
        let written = case.format.encode(
            output,
            Form {
                size: size(SIZE),
                pixel: case.pixel,
                encoding,
            },
            &mut |sink| sink(&whole),
        );
        written.unwrap();
        assert!(at_once == file, "{}", case.name);
    }
}
