//! Cryptomatte 1.2.0: the object that each pixel shows, in a form that compositors read.
//!
//! Jonah Friedman and Andrew C. Jones, "Fully automatic ID mattes with support for motion blur and
//! transparency", SIGGRAPH 2015, and the accompanying specification. The hash of an object's name,
//! stored as a float, is the value of one channel; the next channel holds the object's coverage of
//! the pixel.

use std::fmt::Write;

use crate::image_file::pixel::{Channel, Sample};

/// Returns the channels of a pixel's two largest objects, then those of the next two, and so on. In
/// each group of four, red is the [`id`] of the larger object and green its coverage; blue and
/// alpha are the same for the next object.
pub(crate) fn channels(layer: &str, pairs: usize) -> Vec<Channel> {
    let levels = (0..pairs).flat_map(|pair| {
        ["r", "g", "b", "a"].map(|part| Channel {
            name: format!("{layer}{pair:02}.{part}"),
            sample: Sample::F32,
        })
    });
    levels.collect()
}

/// Returns the metadata of a layer: its kind and the names of its objects.
pub(crate) fn metadata<'a>(
    layer: &str,
    names: impl IntoIterator<Item = &'a str>,
) -> [(String, String); 4] {
    let key = format!("{:08x}", hash(layer));
    let entry = |name: &str, text: String| (format!("cryptomatte/{}/{name}", &key[..7]), text);
    [
        entry("name", layer.to_owned()),
        entry("hash", "MurmurHash3_32".to_owned()),
        entry("conversion", "uint32_to_float32".to_owned()),
        entry("manifest", manifest(names)),
    ]
}

/// Returns the value of a name in a channel.
pub(crate) fn id(name: &str) -> f32 {
    f32::from_bits(bits(name))
}

/// Returns the hash of a name, changed to a normal float: if all bits of the exponent are zeros or
/// ones, its lowest bit is flipped.
fn bits(name: &str) -> u32 {
    let hash = hash(name);
    match hash >> 23 & 255 {
        0 | 255 => hash ^ 1 << 23,
        _ => hash,
    }
}

/// Returns a JSON object that maps each name to its hash in hexadecimal digits.
fn manifest<'a>(names: impl IntoIterator<Item = &'a str>) -> String {
    let mut text = "{".to_owned();
    for name in names {
        if text.len() > 1 {
            text.push(',');
        }
        // Writing to a string never fails.
        let _ = write!(
            text,
            "{}:\"{:08x}\"",
            serde_json::Value::from(name),
            bits(name)
        );
    }
    text + "}"
}

/// Returns the `MurmurHash3_x86_32` by Austin Appleby, with seed 0.
fn hash(name: &str) -> u32 {
    let mix = |word: u32| {
        let word = word.wrapping_mul(0xcc9e_2d51);
        word.rotate_left(15).wrapping_mul(0x1b87_3593)
    };
    let (words, rest) = name.as_bytes().as_chunks::<4>();
    let mut hash = words.iter().fold(0_u32, |hash, word| {
        let hash = hash ^ mix(u32::from_le_bytes(*word));
        hash.rotate_left(13)
            .wrapping_mul(5)
            .wrapping_add(0xe654_6b64)
    });
    let mut last = [0; 4];
    last[..rest.len()].copy_from_slice(rest);
    hash ^= mix(u32::from_le_bytes(last));
    hash ^= name.len() as u32;
    hash ^= hash >> 16;
    hash = hash.wrapping_mul(0x85eb_ca6b);
    hash ^= hash >> 13;
    hash = hash.wrapping_mul(0xc2b2_ae35);
    hash ^ hash >> 16
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hashes_are_those_of_the_reference() {
        // Computed with mmh3 5.3.1 for Python.
        for (name, expected) in [
            ("", 0),
            ("a", 0x3c25_69b2),
            ("ab", 0x9bbf_d75f),
            ("abc", 0xb3dd_93fa),
            ("abcd", 0x43ed_676a),
            ("hello", 0x248b_fa47),
            ("geometries[12]", 0x1695_3221),
            ("Grüße, 世界", 0xf77a_bd79),
        ] {
            assert_eq!(hash(name), expected, "{name}");
        }
    }

    #[test]
    fn only_hashes_that_are_not_ordinary_floats_are_changed() {
        assert_eq!(bits("a"), 0x3c25_69b2);
        for (name, hash, changed) in [
            ("name 368", 0x000d_cb4f, 0x008d_cb4f),
            ("name 708", 0x7fb6_69ca, 0x7f36_69ca),
        ] {
            assert_eq!((super::hash(name), bits(name)), (hash, changed), "{name}");
        }
    }

    #[test]
    fn an_id_is_an_ordinary_float() {
        for name in (0..100_000).map(|count| format!("name {count}")) {
            assert!(id(&name).is_normal(), "{name}");
        }
    }

    #[test]
    fn a_layer_declares_its_type() {
        let names = ["a", "\"quoted\" \\", "Grüße, 世界"];
        let metadata = metadata("CryptoObject", names);
        let keys = metadata.each_ref().map(|(key, _)| key.as_str());
        let expected = [
            "cryptomatte/3ae39a5/name",
            "cryptomatte/3ae39a5/hash",
            "cryptomatte/3ae39a5/conversion",
            "cryptomatte/3ae39a5/manifest",
        ];
        assert_eq!(keys, expected);
        let manifest: serde_json::Value = serde_json::from_str(&metadata[3].1).unwrap();
        let manifest = manifest.as_object().unwrap();
        assert_eq!(manifest.len(), names.len());
        for name in names {
            assert_eq!(manifest[name], format!("{:08x}", bits(name)));
        }
        assert_eq!(super::manifest([]), "{}");
    }

    #[test]
    fn channels_are_named_by_their_level() {
        let channels = channels("CryptoObject", 2);
        let names: Vec<_> = channels.iter().map(|channel| &*channel.name).collect();
        let expected = [
            "CryptoObject00.r",
            "CryptoObject00.g",
            "CryptoObject00.b",
            "CryptoObject00.a",
            "CryptoObject01.r",
            "CryptoObject01.g",
            "CryptoObject01.b",
            "CryptoObject01.a",
        ];
        assert_eq!(names, expected);
        assert!(channels.iter().all(|channel| channel.sample == Sample::F32));
    }
}
