//! The formats that `image` encodes from a whole picture.

use std::io::{self, BufWriter, Cursor, Write};

use image::{
    ExtendedColorType, ImageEncoder, ImageError, ImageResult,
    codecs::{
        bmp::BmpEncoder, jpeg::JpegEncoder, qoi::QoiEncoder, tiff::TiffEncoder, webp::WebPEncoder,
    },
};

use crate::{
    error::Error,
    film::Size,
    image_file::{Sink, buffer},
};

/// Where flat colors stay clean and files are still small.
const JPEG_QUALITY: u8 = 90;

pub(super) fn encode<W: Write>(
    writer: W,
    size: Size,
    draw: impl FnOnce(Sink) -> Result<(), Error>,
    encode: impl FnOnce(&mut BufWriter<W>, &[u8], Size) -> ImageResult<()>,
) -> Result<(), Error> {
    let mut pixels = buffer(size)?;
    draw(&mut |bytes| {
        pixels.extend_from_slice(bytes);
        Ok(())
    })?;
    let mut writer = BufWriter::new(writer);
    encode(&mut writer, &pixels, size).map_err(|error| {
        Error::writing(match error {
            ImageError::IoError(error) => error,
            other => io::Error::other(other),
        })
    })?;
    writer.flush().map_err(Error::writing)
}

pub(super) fn jpeg(writer: &mut impl Write, pixels: &[u8], size: Size) -> ImageResult<()> {
    whole(
        JpegEncoder::new_with_quality(writer, JPEG_QUALITY),
        pixels,
        size,
    )
}

pub(super) fn bmp(mut writer: &mut impl Write, pixels: &[u8], size: Size) -> ImageResult<()> {
    whole(BmpEncoder::new(&mut writer), pixels, size)
}

pub(super) fn qoi(writer: &mut impl Write, pixels: &[u8], size: Size) -> ImageResult<()> {
    whole(QoiEncoder::new(writer), pixels, size)
}

pub(super) fn webp(writer: &mut impl Write, pixels: &[u8], size: Size) -> ImageResult<()> {
    whole(WebPEncoder::new_lossless(writer), pixels, size)
}

/// TIFF goes back to write where its tables stand; a pipe cannot, so that the file is made in
/// memory.
pub(super) fn tiff(writer: &mut impl Write, pixels: &[u8], size: Size) -> ImageResult<()> {
    let mut file = Cursor::new(Vec::new());
    whole(TiffEncoder::new(&mut file), pixels, size)?;
    Ok(writer.write_all(file.get_ref())?)
}

fn whole(encoder: impl ImageEncoder, pixels: &[u8], size: Size) -> ImageResult<()> {
    encoder.write_image(pixels, size.width(), size.height(), ExtendedColorType::Rgb8)
}
