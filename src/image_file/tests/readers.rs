//! The files as other crates read them, and the properties they state.

use std::io::Cursor;

use exr::prelude::{FlatSamples, ReadChannels, ReadLayers};
use tiff::{decoder::Decoder, tags::Tag};

use super::{CHANNELS, Case, SIZE, cases, number, picture, size};
use crate::image_file::{
    Encoding, Form, ImageFormat,
    output::Output,
    pixel::{Pixel, Sample},
};

#[test]
fn integers_are_read_again() {
    let mut read = 0;
    for case in cases() {
        let known = [
            ImageFormat::BMP,
            ImageFormat::PNG,
            ImageFormat::PPM,
            ImageFormat::QOI,
            ImageFormat::WEBP,
        ]
        .contains(&case.format);
        if !known || matches!(case.pixel, Pixel::Indexed(_)) {
            continue;
        }
        let format = image::ImageFormat::from_extension(case.format.name()).unwrap();
        for side in [SIZE, (1, 1), (1, 9), (9, 1)] {
            let image = image::load_from_memory_with_format(&case.file(side), format).unwrap();
            assert_eq!((image.width(), image.height()), side, "{}", case.name);
            assert!(
                image.as_bytes() == picture(case.pixel, side),
                "{}",
                case.name
            );
            read += 1;
        }
    }
    assert_eq!(read, 4 * (12 + 2 + 4 + 4 + 4));
}

#[test]
fn a_tiff_file_is_read_again() {
    for case in cases() {
        if case.format != ImageFormat::TIFF {
            continue;
        }
        for side in [SIZE, (1, 1), (1, 9), (9, 1), (1, 70_000)] {
            let mut decoder = Decoder::new(Cursor::new(case.file(side))).unwrap();
            assert_eq!(decoder.dimensions().unwrap(), side);
            let mut image = decoder.read_image().unwrap();
            let pixels = image.as_buffer(0);
            assert!(
                pixels.as_bytes() == picture(case.pixel, side),
                "{}",
                case.name
            );
            let tag = |tag| {
                decoder
                    .find_tag(tag)
                    .unwrap()
                    .map(|value| value.into_u32().unwrap())
            };
            let mut tag = tag;
            assert_eq!(tag(Tag::Orientation), Some(1));
            let alpha = matches!(case.pixel, Pixel::Rgba(_)).then_some(2);
            assert_eq!(tag(Tag::ExtraSamples), alpha);
        }
    }
}

#[test]
fn exr_channels_are_read_again() {
    let mut read = 0;
    for case in cases() {
        if case.format != ImageFormat::EXR {
            continue;
        }
        for side in [SIZE, (1, 1), (3, 16), (1, 40), (40, 1)] {
            let reader = exr::prelude::read()
                .no_deep_data()
                .largest_resolution_level();
            let reader = reader.all_channels().first_valid_layer().all_attributes();
            let image = reader.from_buffered(Cursor::new(case.file(side))).unwrap();
            let layer = image.layer_data;
            let found = layer.channel_data.list;
            assert_eq!(found.len(), CHANNELS.len());
            assert!(found.is_sorted_by_key(|channel| channel.name.as_slice()));
            for ((name, sample), part) in CHANNELS.iter().zip(0..) {
                let mut channels = found.iter();
                let found = channels.find(|channel| channel.name.to_string() == *name);
                let bytes: Vec<_> = match &found.unwrap().sample_data {
                    FlatSamples::F16(all) => all.iter().flat_map(|n| n.to_ne_bytes()).collect(),
                    FlatSamples::F32(all) => all.iter().flat_map(|n| n.to_ne_bytes()).collect(),
                    FlatSamples::U32(all) => all.iter().flat_map(|n| n.to_ne_bytes()).collect(),
                };
                let pixels = (0..side.1).flat_map(|row| (0..side.0).map(move |x| (x, row)));
                let expected = pixels.flat_map(|(x, row)| number(*sample, x, row, part, false));
                assert!(bytes.into_iter().eq(expected), "{} {name}", case.name);
                read += 1;
            }
        }
    }
    assert_eq!(read, 6 * 5 * CHANNELS.len());
}

#[test]
fn radiance_colors_are_read_again() {
    let case = Case::find("rgb-f4-fast.hdr");
    // Wide enough for runs, too narrow for them, and too wide.
    for side in [SIZE, (8, 3), (7, 9), (40_000, 2)] {
        let file = case.file(side);
        let image = image::load_from_memory_with_format(&file, image::ImageFormat::Hdr).unwrap();
        assert_eq!((image.width(), image.height()), side);
        let expected = picture(case.pixel, side);
        let expected = expected.as_chunks::<4>().0;
        for (pixel, expected) in image.to_rgb32f().pixels().zip(expected.chunks(3)) {
            let expected: Vec<_> = expected.iter().map(|n| f32::from_ne_bytes(*n)).collect();
            let most = expected.iter().copied().fold(0.0, f32::max);
            for (found, expected) in pixel.0.iter().zip(expected) {
                assert!(
                    (found - expected).abs() <= most / 255.0,
                    "{found} {expected}"
                );
            }
        }
    }
}

#[test]
fn a_float_map_begins_at_the_bottom() {
    let file = Case::find("rgb-f4-fast.pfm").file((5, 11));
    let pixels = file.strip_prefix(b"PF\n5 11\n-1.0\n").unwrap();
    let expected = picture(Pixel::Rgb(Sample::F32), (5, 11));
    let expected = Sample::F32.little_endian(&expected);
    assert!(pixels.chunks(60).eq(expected.rchunks(60)));
    let gray = Case::find("gray-f4-fast.pfm").file((5, 11));
    assert!(gray.starts_with(b"Pf\n5 11\n-1.0\n"));
}

#[test]
fn an_array_declares_its_type() {
    for (name, header) in [
        (
            "gray-u1",
            "{'descr': '|u1', 'fortran_order': False, 'shape': (11, 5), }",
        ),
        (
            "rgb-f2",
            "{'descr': '<f2', 'fortran_order': False, 'shape': (11, 5, 3), }",
        ),
        (
            "rgba-f8",
            "{'descr': '<f8', 'fortran_order': False, 'shape': (11, 5, 4), }",
        ),
    ] {
        let case = Case::find(&format!("{name}-fast.npy"));
        let file = case.file((5, 11));
        let (found, numbers) = file.split_at(128);
        assert_eq!(found[..10], *b"\x93NUMPY\x01\x00\x76\x00");
        assert_eq!(str::from_utf8(&found[10..]).unwrap().trim_end(), header);
        let (_, sample) = case.pixel.samples().unwrap();
        assert!(*numbers == *sample.little_endian(&picture(case.pixel, (5, 11))));
    }
}

#[test]
fn an_archive_contains_the_arrays_in_sequence() {
    let case = Case::find("arrays-fast.npz");
    let Pixel::Arrays(arrays) = case.pixel else {
        panic!("no arrays");
    };
    let file = case.file((5, 11));
    let mut rest = &*file;
    for array in arrays {
        let (header, after) = rest.split_at(30 + array.name.len() + 4 + 20);
        assert!(header.starts_with(b"PK\x03\x04"));
        assert_eq!(header[30..30 + array.name.len()], *array.name.as_bytes());
        let bytes = array.pixel.bytes() * 5 * 11 + 128;
        assert_eq!(header[header.len() - 8..], (bytes as u64).to_le_bytes());
        let (data, after) = after.split_at(bytes);
        assert_eq!(header[14..18], crc32fast::hash(data).to_le_bytes());
        let (_, sample) = array.pixel.samples().unwrap();
        let expected = picture(array.pixel, (5, 11));
        assert!(data[128..] == *sample.little_endian(&expected));
        rest = after;
    }
    assert!(rest.starts_with(b"PK\x01\x02"));
}

#[test]
fn lower_quality_gives_a_smaller_file() {
    let written = |quality| {
        let (pixel, mut file) = (Pixel::Rgb(Sample::U8), Vec::new());
        let encoding = Encoding {
            quality,
            ..Encoding::default()
        };
        let picture = picture(pixel, SIZE);
        let output = Output::Stream(&mut file);
        let draw = &mut |sink: super::Sink| sink(&picture);
        let written = ImageFormat::JPEG.encode(
            output,
            Form {
                size: size(SIZE),
                pixel,
                encoding,
            },
            draw,
        );
        written.unwrap();
        file.len()
    };
    assert!(written(1) < written(90) && written(90) < written(100));
}

#[test]
fn data_is_not_declared_as_colors() {
    let colors = |name: &str, colors| {
        let (case, mut file) = (Case::find(name), Vec::new());
        let encoding = Encoding {
            colors,
            ..Encoding::default()
        };
        let picture = picture(case.pixel, SIZE);
        let output = Output::Stream(&mut file);
        let draw = &mut |sink: super::Sink| sink(&picture);
        let written = case.format.encode(
            output,
            Form {
                size: size(SIZE),
                pixel: case.pixel,
                encoding,
            },
            draw,
        );
        written.unwrap();
        file
    };
    for (name, mark) in [
        ("rgb-u1-fast.png", "sRGB"),
        ("rgb-f4-fast.hdr", "PRIMARIES="),
        ("channels-fast.exr", "chromaticities"),
        ("rgb-u1-fast.jpg", "Exif\0\0"),
        ("rgb-u1-fast.webp", "EXIF"),
    ] {
        let has = |file: Vec<u8>| file.windows(mark.len()).any(|part| part == mark.as_bytes());
        assert!(
            has(colors(name, true)) && !has(colors(name, false)),
            "{name}"
        );
    }
}

#[test]
fn metadata_is_in_the_file() {
    let metadata = [("Software", "strahl 1"), ("Camera", "Grüße\n2")];
    let metadata = metadata.map(|(name, text)| (name.to_owned(), text.to_owned()));
    let written = |name: &str| {
        let (case, mut file) = (Case::find(name), Vec::new());
        case.write(Output::Stream(&mut file), SIZE, &metadata)
            .unwrap();
        file
    };
    let png = written("rgb-u1-fast.png");
    let reader = png::Decoder::new(Cursor::new(&png)).read_info().unwrap();
    let texts = reader.info().utf8_text.iter();
    let texts: Vec<_> = texts
        .map(|text| (text.keyword.clone(), text.get_text().unwrap()))
        .collect();
    assert_eq!(texts, metadata);

    let mut tiff = Decoder::new(Cursor::new(written("rgb-u1-fast.tiff"))).unwrap();
    assert_eq!(
        tiff.get_tag_ascii_string(Tag::Software).unwrap(),
        "strahl 1"
    );
    assert!(tiff.find_tag(Tag::ImageDescription).unwrap().is_some());

    let reader = exr::prelude::read()
        .no_deep_data()
        .largest_resolution_level();
    let reader = reader.all_channels().first_valid_layer().all_attributes();
    let exr = reader
        .from_buffered(Cursor::new(written("channels-fast.exr")))
        .unwrap();
    assert_eq!(exr.layer_data.attributes.other.len(), 2);

    for (name, lines) in [
        ("rgb-u1-fast.jpg", ["Software: strahl 1", "Camera: Grüße 2"]),
        (
            "rgb-f4-fast.hdr",
            ["# Software: strahl 1\n", "# Camera: Grüße 2\n"],
        ),
    ] {
        let file = written(name);
        for line in lines {
            let found = file.windows(line.len()).any(|part| part == line.as_bytes());
            assert!(found, "{name}: {line}");
        }
        assert!(image::load_from_memory(&file).is_ok(), "{name}");
    }
}
