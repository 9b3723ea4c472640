//! PNG, row by row as the bands arrive.

use std::io::{self, Write};

use png::{BitDepth, ColorType, Compression, Encoder, EncodingError, Filter, SrgbRenderingIntent};

use crate::{error::Error, film::Size, image_file::Sink};

/// How much compressed data one chunk of the file holds.
const CHUNK: usize = 1 << 16;

pub(super) fn encode(
    writer: impl Write,
    size: Size,
    draw: impl FnOnce(Sink) -> Result<(), Error>,
) -> Result<(), Error> {
    let mut encoder = Encoder::new(writer, size.width(), size.height());
    encoder.set_color(ColorType::Rgb);
    encoder.set_depth(BitDepth::Eight);
    encoder.set_source_srgb(SrgbRenderingIntent::Perceptual);
    // The fast compressor finds little in rows that are not filtered, and a flat picture is
    // nothing but zeros once each row has the one above it taken off.
    encoder.set_compression(Compression::Fast);
    encoder.set_filter(Filter::Up);
    let mut writer = encoder.write_header().map_err(error)?;
    let mut rows = writer.stream_writer_with_size(CHUNK).map_err(error)?;
    draw(&mut |bytes| rows.write_all(bytes).map_err(Error::writing))?;
    rows.finish().map_err(error)?;
    writer.finish().map_err(error)
}

fn error(error: EncodingError) -> Error {
    Error::writing(match error {
        EncodingError::IoError(error) => error,
        other => io::Error::other(other),
    })
}
