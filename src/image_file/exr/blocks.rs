//! Compression of the rows of a block.

use std::borrow::Cow;

use crate::image_file::{
    Compression, deflate, exr,
    runs::{ByteRun, runs},
};

/// The compression method of the blocks, by its number in the format.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Method {
    None = 0,
    Rle = 1,
    Zips = 2,
    Zip = 3,
}

impl Method {
    pub(super) const fn of(compression: Compression) -> Self {
        match compression {
            Compression::None => Self::None,
            Compression::Rle => Self::Rle,
            Compression::Zips => Self::Zips,
            Compression::Zip | Compression::Fast | Compression::Small => Self::Zip,
        }
    }

    /// Returns the number of rows in a block.
    pub(super) const fn lines(self) -> usize {
        match self {
            Self::None | Self::Rle | Self::Zips => 1,
            Self::Zip => 16,
        }
    }
}

/// Returns a block, compressed if that makes it shorter; a reader detects this by the length. The
/// memory is kept for further blocks.
pub(super) fn compressed<'a>(
    block: &'a [u8],
    method: Method,
    compression: Compression,
    memory: &mut Vec<u8>,
) -> Cow<'a, [u8]> {
    let compressed = match (method, compression) {
        (Method::None, _) => return block.into(),
        (Method::Rle, _) => run_lengths(differences(block, memory)),
        (_, Compression::Fast) => exr::deflate::zlib(differences(block, memory)),
        _ => deflate::zlib(differences(block, memory), compression),
    };
    if compressed.len() < block.len() {
        compressed.into()
    } else {
        block.into()
    }
}

/// Returns the even bytes, then the odd ones, each as its difference from the byte before it, plus
/// 128. Each number has an even number of bytes.
fn differences<'a>(block: &[u8], differences: &'a mut Vec<u8>) -> &'a [u8] {
    differences.clear();
    let pairs = block.as_chunks().0;
    let difference = |byte: u8, before: u8| byte.wrapping_sub(before).wrapping_add(128);
    let mut before = 128;
    for shift in [0, 8] {
        // Halves of 16-bit numbers, of which the compiler takes many at a time.
        let byte = |pair: &[u8; 2]| (u16::from_le_bytes(*pair) >> shift) as u8;
        let first = pairs.first().map(byte);
        differences.extend(first.map(|first| difference(first, before)));
        let neighbors = pairs.iter().zip(pairs.iter().skip(1));
        differences.extend(neighbors.map(|(before, pair)| difference(byte(pair), byte(before))));
        before = pairs.last().map_or(before, byte);
    }
    differences
}

/// Encodes runs: the length minus one and the repeated byte, or the negative length and the bytes.
fn run_lengths(bytes: &[u8]) -> Vec<u8> {
    let mut lengths = Vec::new();
    for run in runs(bytes, 3) {
        match run {
            ByteRun::Equal(count, byte) => lengths.extend([count - 1, byte]),
            ByteRun::Unequal(bytes) => {
                lengths.push((bytes.len() as u8).wrapping_neg());
                lengths.extend(bytes);
            }
        }
    }
    lengths
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_are_separated_and_subtracted() {
        let memory = &mut Vec::new();
        let bytes = [10, 1, 13, 0, 11, 7];
        assert_eq!(differences(&bytes, memory), [10, 131, 126, 118, 127, 135]);
        assert!(differences(&[], memory).is_empty());
    }

    #[test]
    fn a_block_that_would_grow_is_not_compressed() {
        let memory = &mut Vec::new();
        for block in [&[][..], &[1, 200], &[1, 200, 7, 90]] {
            for method in [Method::None, Method::Rle, Method::Zips, Method::Zip] {
                let found = compressed(block, method, Compression::Fast, memory);
                assert_eq!(*found, *block);
            }
        }
        let flat = [0; 1000];
        for method in [Method::Rle, Method::Zips, Method::Zip] {
            assert!(compressed(&flat, method, Compression::Zip, memory).len() < 40);
            assert!(compressed(&flat, method, Compression::Fast, memory).len() < 180);
        }
    }
}
