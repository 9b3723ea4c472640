//! TIFF 6.0 and `BigTIFF`, written strip by strip as bands arrive; the directory is at the end.

use std::io::{self, Seek, Write};

use ::tiff::{
    Directory, TiffError, TiffResult,
    encoder::{DirectoryEncoder, Rational, TiffEncoder, TiffKind, TiffKindBig, TiffKindStandard},
    tags::{
        CompressionMethod, ExtraSamples, PhotometricInterpretation, PlanarConfiguration,
        SampleFormat, Tag, Type,
    },
};

impl ImageFormat {
    /// Tagged Image File Format, lossless; `BigTIFF` if the file may exceed 4 GiB.
    pub const TIFF: Self = Self(&Format {
        endings: &["tiff", "tif"],
        content: Content::Either,
        holds: |pixel| layout(pixel).is_some(),
        compressions: &[Compression::Fast, Compression::Small, Compression::None],
        has_metadata: true,
        decoder: Some(image::ImageFormat::Tiff),
        encode,
        ..Format::PLAIN
    });
}

use crate::{
    diagnostic::error::Error,
    film::size::Size,
    image_file::{
        Compression, Content, Encoding, Form, Format, ImageFormat,
        deflate::zlib,
        format::cannot_hold_pixel,
        output::{Draw, Output, WriteSeek},
        pixel::{Pixel, Sample},
    },
};

/// The maximum number of bytes in a strip, unless one row has more.
const STRIP: usize = 1 << 18;
/// Number of pixel bytes from which a file may exceed 4 GiB: compressed data may be slightly longer
/// than its input, and there are tables.
const BIG: u64 = 4_000_000_000;
/// The tags of the white point and primaries, and those of sRGB in the chromaticity diagram, in
/// units of 1/10,000 (ITU-R BT.709).
const WHITE_POINT: Tag = Tag::Unknown(318);
const PRIMARIES: Tag = Tag::Unknown(319);
const D65: [u32; 2] = [3127, 3290];
const SRGB: [u32; 6] = [6400, 3300, 3000, 6000, 1500, 600];
/// The orientation: rows from the top, columns from the left.
const TOP_LEFT: u16 = 1;

/// Returns the number of samples per pixel and their type, if the format supports them.
fn layout(pixel: Pixel) -> Option<(usize, Sample)> {
    let (count, sample) = pixel.samples()?;
    match sample {
        Sample::U8 | Sample::U16 | Sample::U32 | Sample::F32 => Some((count, sample)),
        Sample::F16 | Sample::F64 => None,
    }
}

fn encode(output: Output, form: Form, draw: Draw) -> Result<(), Error> {
    let bytes = form.size.pixels() * form.pixel.bytes() as u64;
    output.going_back(|file| {
        if bytes < BIG {
            write::<TiffKindStandard>(file, form, draw)
        } else {
            write::<TiffKindBig>(file, form, draw)
        }
    })
}

fn write<K: TiffKind>(file: &mut dyn WriteSeek, form: Form, draw: Draw) -> Result<(), Error> {
    let Form {
        size,
        pixel,
        encoding,
    } = form;
    let samples = layout(pixel).ok_or_else(|| cannot_hold_pixel(ImageFormat::TIFF, pixel))?;
    let row = size.width() as usize * pixel.bytes();
    let rows = (STRIP / row).clamp(1, size.height() as usize);
    let mut tiff = TiffEncoder::<_, K>::new_generic(file).map_err(error)?;
    let mut strips = Strips {
        directory: tiff.image_directory().map_err(error)?,
        compression: encoding.compression,
        offsets: Vec::new(),
        lengths: Vec::new(),
    };
    let mut strip = Vec::new();
    draw(&mut |bytes| {
        for row in bytes.chunks(row) {
            strip.extend(row);
            if strip.len() == rows * row.len() {
                strips.push(&strip).map_err(error)?;
                strip.clear();
            }
        }
        Ok(())
    })?;
    if !strip.is_empty() {
        strips.push(&strip).map_err(error)?;
    }
    let mut directory = strips.finish(rows).map_err(error)?;
    describe(&mut directory, size, pixel, samples, encoding.colors).map_err(error)?;
    annotate(&mut directory, encoding).map_err(error)?;
    directory.finish().map_err(error)
}

/// The strips written so far, and their offsets.
struct Strips<'a, W: Write + Seek, K: TiffKind> {
    directory: DirectoryEncoder<'a, W, K>,
    compression: Compression,
    offsets: Vec<K::OffsetType>,
    lengths: Vec<u32>,
}

impl<'a, W: Write + Seek, K: TiffKind> Strips<'a, W, K> {
    fn push(&mut self, strip: &[u8]) -> TiffResult<()> {
        let compressed;
        let strip = if self.compression == Compression::None {
            strip
        } else {
            compressed = zlib(strip, self.compression);
            &compressed
        };
        let offset = self.directory.write_data(strip)?;
        self.offsets.push(K::convert_offset(offset)?);
        self.lengths.push(u32::try_from(strip.len())?);
        Ok(())
    }

    fn finish(mut self, rows: usize) -> TiffResult<DirectoryEncoder<'a, W, K>> {
        let method = match self.compression {
            Compression::None => CompressionMethod::None,
            _ => CompressionMethod::Deflate,
        };
        let directory = &mut self.directory;
        directory.write_tag(Tag::Compression, method.to_u16())?;
        directory.write_tag(Tag::RowsPerStrip, u32::try_from(rows)?)?;
        directory.write_tag(Tag::StripOffsets, K::convert_slice(&self.offsets))?;
        directory.write_tag(Tag::StripByteCounts, &*self.lengths)?;
        Ok(self.directory)
    }
}

/// Writes the tags that describe the pixels.
fn describe<W: Write + Seek, K: TiffKind>(
    directory: &mut DirectoryEncoder<W, K>,
    size: Size,
    pixel: Pixel,
    (count, sample): (usize, Sample),
    colors: bool,
) -> TiffResult<()> {
    let format = match sample {
        Sample::F32 => SampleFormat::IEEEFP,
        _ => SampleFormat::Uint,
    };
    let photometric = match pixel {
        Pixel::Gray(_) => PhotometricInterpretation::BlackIsZero,
        _ => PhotometricInterpretation::RGB,
    };
    directory.write_tag(Tag::ImageWidth, size.width())?;
    directory.write_tag(Tag::ImageLength, size.height())?;
    directory.write_tag(Tag::BitsPerSample, &*vec![8 * sample.bytes() as u16; count])?;
    directory.write_tag(Tag::PhotometricInterpretation, photometric.to_u16())?;
    directory.write_tag(Tag::Orientation, TOP_LEFT)?;
    directory.write_tag(Tag::SamplesPerPixel, count as u16)?;
    directory.write_tag(
        Tag::PlanarConfiguration,
        PlanarConfiguration::Chunky.to_u16(),
    )?;
    directory.write_tag(Tag::SampleFormat, &*vec![format.to_u16(); count])?;
    if let (true, Pixel::Rgb(_) | Pixel::Rgba(_)) = (colors, pixel) {
        let parts = |part: u32| Rational { n: part, d: 10_000 };
        directory.write_tag(WHITE_POINT, &D65.map(parts)[..])?;
        directory.write_tag(PRIMARIES, &SRGB.map(parts)[..])?;
    }
    if let Pixel::Rgba(_) = pixel {
        directory.write_tag(Tag::ExtraSamples, ExtraSamples::UnassociatedAlpha.to_u16())?;
    }
    Ok(())
}

/// Writes the metadata: `Software` into the field of that name, everything else into the
/// description.
fn annotate<W: Write + Seek, K: TiffKind>(
    directory: &mut DirectoryEncoder<W, K>,
    encoding: Encoding,
) -> TiffResult<()> {
    let (mut software, mut description) = (String::new(), Vec::new());
    for ((name, text), line) in encoding.metadata.iter().zip(encoding.lines()) {
        if name == "Software" {
            software.clone_from(text);
        } else {
            description.push(line);
        }
    }
    for (tag, text) in [
        (Tag::Software, software),
        (Tag::ImageDescription, description.join("\n")),
    ] {
        if !text.is_empty() {
            // The crate accepts only ASCII, but readers accept UTF-8.
            let entry = directory.write_entry_bytes(Type::ASCII, (text + "\0").as_bytes())?;
            directory.extend_from(&Directory::from_iter([(tag, entry)]));
        }
    }
    Ok(())
}

fn error(error: TiffError) -> Error {
    Error::writing(match error {
        TiffError::IoError(error) => error,
        other => io::Error::other(other),
    })
}

#[cfg(test)]
mod tests {
    use std::io::Cursor;

    use ::tiff::decoder::Decoder;

    use super::*;
    use crate::image_file::output::Sink;

    #[test]
    fn a_file_that_may_pass_4_gib_has_offsets_of_64_bits() {
        let (size, pixel) = (Size::new(2, 2).unwrap(), Pixel::Rgb(Sample::U8));
        let pixels: Vec<u8> = (0..12).collect();
        let mut file = Cursor::new(Vec::new());
        let draw = &mut |sink: Sink| sink(&pixels);
        write::<TiffKindBig>(&mut file, Form::new(size, pixel), draw).unwrap();
        assert_eq!(
            u16::from_ne_bytes([file.get_ref()[2], file.get_ref()[3]]),
            43
        );
        let mut image = Decoder::new(Cursor::new(file.into_inner()))
            .unwrap()
            .read_image()
            .unwrap();
        assert_eq!(image.as_buffer(0).as_bytes(), pixels);
    }

    #[test]
    fn only_such_files_have_them() {
        let version = |side| {
            let (size, mut file) = (Size::new(side, side).unwrap(), Cursor::new(Vec::new()));
            let output = Output::File(&mut file);
            let form = Form::new(size, Pixel::Rgb(Sample::U8));
            // Nothing is drawn, and the file is dropped.
            let draw = &mut |_: Sink| Err(Error::interrupted());
            encode(output, form, draw).unwrap_err();
            u16::from_ne_bytes([file.get_ref()[2], file.get_ref()[3]])
        };
        assert_eq!((version(36_514), version(36_515)), (42, 43));
    }
}
