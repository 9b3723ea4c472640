//! Which thing each pixel shows, as compositors read it: Cryptomatte 1.2.0.
//!
//! Jonah Friedman and Andrew C. Jones, "Fully automatic ID mattes with support for motion blur and
//! transparency", SIGGRAPH 2015, and the specification that came with it. A thing has a name, its
//! hash is a float, and a channel holds that; the next one tells how much of the pixel it covers.

use std::fmt::Write;

use crate::image_file::pixel::{Channel, Sample};

/// The channels that hold the two largest things of a pixel, then the next two, and so on. Of each
/// four, red is the thing that covers most, as [`id`] has it, green how much of the pixel that is,
/// blue and alpha are the same of the next thing.
pub(crate) fn channels(layer: &str, pairs: usize) -> Vec<Channel> {
    let levels = (0..pairs).flat_map(|pair| {
        ["r", "g", "b", "a"].map(|part| Channel {
            name: format!("{layer}{pair:02}.{part}"),
            sample: Sample::F32,
        })
    });
    levels.collect()
}

/// The metadata of a layer: what it is, and which names its things have.
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

/// The number of a name in a channel.
pub(crate) fn id(name: &str) -> f32 {
    f32::from_bits(bits(name))
}

/// The hash of a name, made an ordinary float: an exponent of all zeros or all ones has its lowest
/// bit turned.
fn bits(name: &str) -> u32 {
    let hash = hash(name);
    match hash >> 23 & 255 {
        0 | 255 => hash ^ 1 << 23,
        _ => hash,
    }
}

/// An object of JSON: from each name to its number in hexadecimal digits.
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

/// `MurmurHash3_x86_32` of Austin Appleby, with the seed 0.
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
        // By mmh3 5.3.1 of Python.
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
    fn only_hashes_that_are_no_ordinary_floats_are_changed() {
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
    fn a_layer_says_what_it_is() {
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
