//! How the rows of a block are compressed.

use std::borrow::Cow;

use crate::image_file::{
    Compression,
    deflate::zlib,
    runs::{Run, runs},
};

/// How the blocks of a file are compressed, by the number that the format gives it.
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

    /// How many rows a block has.
    pub(super) const fn lines(self) -> usize {
        match self {
            Self::None | Self::Rle | Self::Zips => 1,
            Self::Zip => 16,
        }
    }
}

/// A block, compressed if it becomes shorter: a reader knows that by its length.
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

/// First every other byte, then those between; of each the difference to the one before, and 128
/// more.
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

/// One byte less than the length and the byte that is repeated, or the negative length and the
/// bytes.
fn run_lengths(bytes: &[u8]) -> Vec<u8> {
    let mut lengths = Vec::new();
    for run in runs(bytes, 3) {
        match run {
            Run::Equal(count, byte) => lengths.extend([count - 1, byte]),
            Run::Unequal(bytes) => {
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
    fn bytes_are_parted_and_subtracted() {
        assert_eq!(differences(&[10, 1, 13, 0, 11]), [10, 131, 126, 118, 127]);
        assert!(differences(&[]).is_empty());
    }

    #[test]
    fn a_block_that_would_grow_stays_as_it_is() {
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
