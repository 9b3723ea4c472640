//! `OpenEXR`: scan lines in one part, written block by block as bands arrive.
//!
//! The layout follows "OpenEXR File Layout" of the Academy Software Foundation. The `exr` crate
//! writes the attributes in a different order each time, so it is only used for testing.

mod blocks;
mod deflate;
mod header;

use std::io::SeekFrom;

use crate::{
    diagnostic::error::Error,
    film::size::Size,
    image_file::{
        Compression, Content, Form, Format, ImageFormat,
        exr::blocks::Method,
        format::cannot_hold_pixel,
        output::{Draw, Output},
        pixel::{Channel, Pixel},
    },
};

impl ImageFormat {
    /// `OpenEXR`, lossless: the named channels of one picture.
    pub const EXR: Self = Self(&Format {
        endings: &["exr"],
        content: Content::Channels,
        holds: |pixel| layout(pixel).is_some(),
        exceeded: |size, pixel| {
            let row = u64::from(size.width()) * pixel.bytes() as u64;
            let fits = row * Method::Zip.lines() as u64 <= i32::MAX as u64;
            (!fits).then(|| "less than 2 GiB in 16 rows".to_owned())
        },
        compressions: Compression::ALL,
        has_metadata: true,
        decoder: Some(image::ImageFormat::OpenExr),
        encode,
        ..Format::PLAIN
    });
}

/// Returns the channels, if the format supports the type of each.
fn layout(pixel: Pixel<'_>) -> Option<&[Channel]> {
    match pixel {
        Pixel::Channels(all) => {
            let known = |channel: &Channel| header::kind(channel.sample).is_some();
            all.iter().all(known).then_some(all)
        }
        _ => None,
    }
}

fn encode(output: Output, form: Form, draw: Draw) -> Result<(), Error> {
    let Form {
        size,
        pixel,
        encoding,
    } = form;
    let channels = layout(pixel).ok_or_else(|| cannot_hold_pixel(ImageFormat::EXR, pixel))?;
    let parts = parts(channels, size);
    let sorted: Vec<&Channel> = parts.iter().map(|part| part.channel).collect();
    let method = Method::of(encoding.compression);
    let header = header::header(size, &sorted, method, encoding);
    let row = size.width() as usize * pixel.bytes();
    let lines = method.lines();
    let count = (size.height() as usize).div_ceil(lines);
    output.going_back(|file| {
        file.write_all(&header).map_err(Error::writing)?;
        // The table of block offsets comes before the blocks; it is filled in at the end.
        let mut places = Vec::with_capacity(count);
        let mut place = (header.len() + 8 * count) as u64;
        file.seek(SeekFrom::Start(place)).map_err(Error::writing)?;
        let mut memory = Vec::new();
        let mut write = |block: &[u8]| {
            let data = blocks::compressed(block, method, encoding.compression, &mut memory);
            let line = (places.len() * lines) as i32;
            places.push(place);
            place += 8 + data.len() as u64;
            file.write_all(&line.to_le_bytes())?;
            file.write_all(&(data.len() as i32).to_le_bytes())?;
            file.write_all(&data)
        };
        let mut block = Vec::new();
        draw(&mut |rows| {
            for row in rows.chunks(row) {
                for part in &parts {
                    let numbers = &row[part.begin..part.end];
                    block.extend_from_slice(&part.channel.sample.little_endian(numbers));
                }
                if block.len() == lines * row.len() {
                    write(&block).map_err(Error::writing)?;
                    block.clear();
                }
            }
            Ok(())
        })?;
        if !block.is_empty() {
            write(&block).map_err(Error::writing)?;
        }
        let table: Vec<u8> = places
            .iter()
            .flat_map(|place| place.to_le_bytes())
            .collect();
        let found = file.seek(SeekFrom::Start(header.len() as u64));
        found
            .and_then(|_| file.write_all(&table))
            .map_err(Error::writing)
    })
}

/// A channel and the range of its numbers in a row.
struct ChannelBytes<'a> {
    channel: &'a Channel,
    begin: usize,
    end: usize,
}

/// Returns the channels in the order of the format: by the bytes of their names.
fn parts(channels: &[Channel], size: Size) -> Vec<ChannelBytes<'_>> {
    let mut end = 0;
    let parts = channels.iter().map(|channel| {
        let begin = end;
        end += size.width() as usize * channel.sample.bytes();
        ChannelBytes {
            channel,
            begin,
            end,
        }
    });
    let mut parts: Vec<_> = parts.collect();
    parts.sort_by(|a, b| a.channel.name.cmp(&b.channel.name));
    parts
}
