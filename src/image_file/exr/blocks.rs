//! Compression of the rows of a block.

use std::borrow::Cow;

use crate::image_file::{
    Compression,
    deflate::zlib,
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

/// Returns a block, compressed if that makes it shorter; a reader detects this by the length.
pub(super) fn compressed(block: &[u8], method: Method, compression: Compression) -> Cow<'_, [u8]> {
    let compressed = match method {
        Method::None => return block.into(),
        Method::Rle => run_lengths(&differences(block)),
        Method::Zips | Method::Zip => zlib(&differences(block), compression),
    };
    if compressed.len() < block.len() {
        compressed.into()
    } else {
        block.into()
    }
}

/// Returns the even bytes, then the odd ones, each as its difference from the byte before it, plus
/// 128.
fn differences(block: &[u8]) -> Vec<u8> {
    let (first, second) = (block.iter().step_by(2), block.iter().skip(1).step_by(2));
    let mut before = 128;
    let bytes = first.chain(second).map(|byte| {
        let difference = byte.wrapping_sub(before).wrapping_add(128);
        before = *byte;
        difference
    });
    bytes.collect()
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
        assert_eq!(differences(&[10, 1, 13, 0, 11]), [10, 131, 126, 118, 127]);
        assert!(differences(&[]).is_empty());
    }

    #[test]
    fn a_block_that_would_grow_is_not_compressed() {
        let block = [1, 200, 7, 90];
        for method in [Method::None, Method::Rle, Method::Zips, Method::Zip] {
            assert_eq!(*compressed(&block, method, Compression::Fast), block);
        }
        let flat = [0; 1000];
        for method in [Method::Rle, Method::Zips, Method::Zip] {
            assert!(compressed(&flat, method, Compression::Fast).len() < 40);
        }
    }
}
