//! The channels of an EXR file other than its colors.

use std::io::Cursor;

use exr::prelude::{FlatSamples, MetaData, ReadChannels, ReadLayers, read};

use crate::{
    compare::{
        layers::Layer,
        limit::{self, PictureOptions, broken},
    },
    data::table::layout::Scalar,
    diagnostic::error::Error,
    parallel::{Cancel, reader::UntilCancelled},
};

const COLORS: [&str; 4] = ["R", "G", "B", "A"];

/// Returns the layers, and true if there are colors as well.
pub(super) fn layers(
    file: &[u8],
    options: &PictureOptions,
    cancel: Option<&Cancel>,
) -> Result<(Vec<Layer>, bool), Error> {
    let broken = |error| broken("exr", error);
    let reader = || UntilCancelled::new(Cursor::new(file), cancel);
    let about = MetaData::read_from_buffered(reader(), false).map_err(broken)?;
    for header in &about.headers {
        // The decoder allocates memory for these before it reports them.
        for window in [
            header.layer_size,
            header.shared_attributes.display_window.size,
        ] {
            options.size(side(window.width()), side(window.height()))?;
        }
    }
    let names = |header: &exr::meta::header::Header| -> Vec<String> {
        let all = header.channels.list.iter();
        all.map(|channel| channel.name.to_string()).collect()
    };
    let parts: Vec<Vec<String>> = about.headers.iter().map(names).collect();
    let has = |names: &Vec<String>| {
        COLORS[..3]
            .iter()
            .all(|color| names.iter().any(|name| name == color))
    };
    let colors = parts.iter().position(has);
    let is_color = |part: usize, name: &str| colors == Some(part) && COLORS.contains(&name);
    let mut all = parts.iter().enumerate();
    if all.all(|(part, names)| names.iter().all(|name| is_color(part, name))) {
        return Ok((Vec::new(), colors.is_some()));
    }
    let numbers = about.headers.iter().map(|header| {
        let size = header.layer_size;
        size.width() as u64 * size.height() as u64 * header.channels.list.len() as u64
    });
    options.check_numbers(numbers.sum())?;
    let image = read()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels()
        .all_layers()
        .all_attributes()
        .non_parallel()
        .from_buffered(reader())
        .map_err(broken)?;
    let mut layers = Vec::new();
    for (part, layer) in image.layer_data.into_iter().enumerate() {
        let size = options.size(side(layer.size.width()), side(layer.size.height()))?;
        let before = match (&layer.attributes.layer_name, parts.len()) {
            (Some(name), 2..) => format!("{name}."),
            _ => String::new(),
        };
        for channel in layer.channel_data.list {
            let name = channel.name.to_string();
            if is_color(part, &name) {
                continue;
            }
            let (kind, bytes) = bytes(&channel.sample_data);
            if bytes.len() as u64 != size.pixels() * kind.size() as u64 {
                let why = format!("the channel `{name}` does not have a number for each pixel");
                return Err(limit::broken("exr", why));
            }
            layers.push(Layer {
                name: before.clone() + &name,
                size,
                count: 1,
                kind,
                bytes,
            });
        }
    }
    Ok((layers, colors.is_some()))
}

fn side(side: usize) -> u32 {
    u32::try_from(side).unwrap_or(u32::MAX)
}

fn bytes(samples: &FlatSamples) -> (Scalar, Vec<u8>) {
    match samples {
        FlatSamples::F16(all) => (Scalar::F16, joined(all, |one| one.to_le_bytes())),
        FlatSamples::F32(all) => (Scalar::F32, joined(all, |one| one.to_le_bytes())),
        FlatSamples::U32(all) => (Scalar::U32, joined(all, |one| one.to_le_bytes())),
    }
}

fn joined<T: Copy, const N: usize>(all: &[T], bytes: impl Fn(T) -> [u8; N]) -> Vec<u8> {
    all.iter().flat_map(|one| bytes(*one)).collect()
}
