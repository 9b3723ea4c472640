//! The header in front of the pixels: attributes, each with a name, a type and a length.

use crate::{
    film::size::Size,
    image_file::{
        Encoding,
        exr::blocks::Method,
        pixel::{Channel, Sample},
    },
};

/// Red, green, blue and white of sRGB, as in Rec. 709.
const CHROMATICITIES: [f32; 8] = [0.64, 0.33, 0.3, 0.6, 0.15, 0.06, 0.3127, 0.329];
/// Longer names require a flag in the file.
const SHORT_NAME: usize = 31;
const LONG_NAMES: u32 = 0x400;

/// Returns the number of a sample type, if the format supports it.
pub(super) const fn kind(sample: Sample) -> Option<i32> {
    match sample {
        Sample::U32 => Some(0),
        Sample::F16 => Some(1),
        Sample::F32 => Some(2),
        Sample::U8 | Sample::U16 | Sample::F64 => None,
    }
}

/// Returns everything before the block table, for channels sorted by name.
pub(super) fn header(
    size: Size,
    channels: &[&Channel],
    method: Method,
    encoding: Encoding,
) -> Vec<u8> {
    let names = channels.iter().map(|channel| &channel.name);
    let mut names = names.chain(encoding.metadata.iter().map(|(name, _)| name));
    let flags = if names.any(|name| name.len() > SHORT_NAME) {
        LONG_NAMES
    } else {
        0
    };
    let mut header = vec![0x76, 0x2f, 0x31, 0x01];
    header.extend((2 | flags).to_le_bytes());
    let mut attribute = |name: &str, kind: &str, value: &[u8]| {
        for text in [name, kind] {
            header.extend(text.as_bytes());
            header.push(0);
        }
        header.extend((value.len() as i32).to_le_bytes());
        header.extend(value);
    };
    let last = [size.width() - 1, size.height() - 1].map(u32::to_le_bytes);
    let window = [&[0; 8], last.as_flattened()].concat();
    let one = 1_f32.to_le_bytes();
    attribute("channels", "chlist", &channel_list(channels));
    if encoding.colors {
        let numbers = CHROMATICITIES.map(f32::to_le_bytes);
        attribute("chromaticities", "chromaticities", numbers.as_flattened());
    }
    attribute("compression", "compression", &[method as u8]);
    attribute("dataWindow", "box2i", &window);
    attribute("displayWindow", "box2i", &window);
    attribute("lineOrder", "lineOrder", &[0]);
    attribute("pixelAspectRatio", "float", &one);
    attribute("screenWindowCenter", "v2f", &[0; 8]);
    attribute("screenWindowWidth", "float", &one);
    for (name, text) in encoding.metadata {
        attribute(name, "string", text.as_bytes());
    }
    header.push(0);
    header
}

fn channel_list(channels: &[&Channel]) -> Vec<u8> {
    let mut list = Vec::new();
    for channel in channels {
        list.extend(channel.name.as_bytes());
        list.push(0);
        list.extend(kind(channel.sample).unwrap_or_default().to_le_bytes());
        // A hint for lossy compressions and three reserved bytes, then sampling rates of 1: no
        // column and no row is left out.
        list.extend([0; 4]);
        list.extend([1, 0, 0, 0, 1, 0, 0, 0]);
    }
    list.push(0);
    list
}
