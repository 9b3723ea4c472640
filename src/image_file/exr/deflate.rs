//! A fast zlib stream (RFC 1950 and 1951) for the differences in a block.
//!
//! Repetitions are searched two bytes back and nowhere else: half of the bytes of a 32-bit number
//! follow each other in a block, so equal numbers repeat there. `miniz_oxide` searches everywhere,
//! which takes several times as long and finds little else. `fdeflate` finds only runs of zeros,
//! and its fixed codes expect them, but equal bytes have the difference 128 here.

use std::array;

/// A part of the stream ends when it has this many symbols. The last sequence adds at most 4,066 more, the
/// last bytes 7, and the end one: fewer than 2¹⁵, so that no code needs more than 15 bits.
const MOST: usize = 1 << 14;
/// The most bytes that a sequence repeats.
const FARTHEST: usize = 1 << 20;
/// The longest repetition that has a symbol.
const LONGEST: usize = 258;
/// The number of symbols: bytes, the end of a part, and lengths.
const SYMBOLS: usize = 286;
const END: usize = 256;

/// Compresses all bytes at once, of which there is at least one.
pub(super) fn zlib(bytes: &[u8]) -> Vec<u8> {
    let mut out = Bits {
        bytes: vec![0x78, 0x01],
        ..Bits::default()
    };
    let (mut sequences, mut at) = (Vec::new(), 0);
    while at < bytes.len() {
        let end = search(bytes, at, &mut sequences);
        out.put(u64::from(end == bytes.len()), 1);
        write(&bytes[at..end], &sequences, &mut out);
        at = end;
    }
    let mut checksum = simd_adler32::Adler32::new();
    checksum.write(bytes);
    let mut out = out.finish();
    out.extend(checksum.finish().to_be_bytes());
    out
}

/// Bytes as they are, and the number of bytes behind them that repeat those two places before.
struct Sequence {
    plain: usize,
    repeated: usize,
}

/// Finds the sequences of the next part, and returns its end.
fn search(bytes: &[u8], start: usize, sequences: &mut Vec<Sequence>) -> usize {
    let word = |at: usize| u64::from_le_bytes(array::from_fn(|byte| bytes[at + byte]));
    let change = |at: usize| word(at) ^ word(at - 2);
    sequences.clear();
    let (mut begin, mut at, mut symbols) = (start, start.max(2), 0);
    while at + 8 <= bytes.len() && symbols + (at - begin) < MOST {
        let here = change(at);
        if here != 0 {
            // A repetition may begin behind the last byte that differs.
            at += 8 - here.leading_zeros() as usize / 8;
            continue;
        }
        let (mut end, most) = (at + 8, bytes.len().min(at + FARTHEST));
        while end + 64 <= most && bytes[end..end + 64] == bytes[end - 2..end + 62] {
            end += 64;
        }
        while end + 8 <= most && change(end) == 0 {
            end += 8;
        }
        let (plain, repeated) = (at - begin, end - at);
        sequences.push(Sequence { plain, repeated });
        symbols += plain + repeated / LONGEST + 2;
        (begin, at) = (end, end);
    }
    let is_last = at + 8 > bytes.len();
    let end = if is_last { bytes.len() } else { at };
    let (plain, repeated) = (end - begin, 0);
    sequences.push(Sequence { plain, repeated });
    end
}

/// What symbols stand for.
enum Coded<'a> {
    Plain(&'a [u8]),
    Repeated(usize),
}

/// Passes on the bytes and the repetitions of a part.
#[inline(always)]
fn each(mut bytes: &[u8], sequences: &[Sequence], mut take: impl FnMut(Coded)) {
    for sequence in sequences {
        let (plain, rest) = bytes.split_at(sequence.plain);
        let (repeated, rest) = rest.split_at(sequence.repeated);
        bytes = rest;
        take(Coded::Plain(plain));
        for repeated in repeated.chunks(LONGEST) {
            take(match repeated.len() {
                ..3 => Coded::Plain(repeated),
                length => Coded::Repeated(length),
            });
        }
    }
}

/// Writes a part: its codes, and its sequences in them.
fn write(bytes: &[u8], sequences: &[Sequence], out: &mut Bits) {
    let mut counts = [[0; SYMBOLS]; 4];
    counts[0][END] = 1;
    each(bytes, sequences, |piece| match piece {
        // Equal bytes may follow each other, and a single counter would wait for itself.
        Coded::Plain(bytes) => bytes.iter().enumerate().for_each(|(place, byte)| {
            counts[place % 4][usize::from(*byte)] += 1;
        }),
        Coded::Repeated(length) => counts[0][symbol(length).0] += 1,
    });
    let counts = array::from_fn(|symbol| counts.iter().map(|counts| counts[symbol]).sum());
    let lengths = lengths(&counts);
    // The part has codes of its own: for all symbols, and for the distances 1 and 2. Of the 19
    // symbols for lengths of codes, 0 to 15 have four bits and the others are unused.
    for (bits, count) in [(2, 2), (286 - 257, 5), (2 - 1, 5), (19 - 4, 4), (0, 3 * 3)] {
        out.put(bits, count);
    }
    (0..16).for_each(|_| out.put(4, 3));
    for length in lengths.iter().chain(&[1, 1]) {
        out.put(u64::from(length.reverse_bits() >> 28), 4);
    }
    let codes = codes(&lengths);
    each(bytes, sequences, |piece| match piece {
        Coded::Plain(bytes) => {
            // Four codes have at most 60 bits.
            for four in bytes.chunks(4) {
                let (mut bits, mut count) = (0, 0);
                for byte in four {
                    let (code, length) = codes[usize::from(*byte)];
                    bits |= code << count;
                    count += length;
                }
                out.put(bits, count);
            }
        }
        Coded::Repeated(length) => {
            let (symbol, extra, width) = symbol(length);
            let (code, length) = codes[symbol];
            // The distance 2 is the bit 1.
            out.put(
                code | extra << length | 1 << (length + width),
                length + width + 1,
            );
        }
    });
    let (code, length) = codes[END];
    out.put(code, length);
}

/// Returns the symbol of the length of a repetition, and the bits that follow it (RFC 1951, section
/// 3.2.5).
fn symbol(length: usize) -> (usize, u64, u32) {
    match length - 3 {
        rest @ ..8 => (257 + rest, 0, 0),
        255 => (285, 0, 0),
        rest => {
            let width = rest.ilog2() - 2;
            let extra = rest & ((1 << width) - 1);
            (
                257 + 4 * width as usize + (rest >> width),
                extra as u64,
                width,
            )
        }
    }
}

/// Returns the lengths of the codes of symbols that occur this often: the logarithm of their rarity,
/// rounded up (Shannon, "A Mathematical Theory of Communication", 1948, section 9). What is left then
/// shortens some of them, as all codes together must be complete.
///
/// At least two symbols occur, the end among them, and all together at most 2¹⁵ times. So a length is at
/// most 15, and a share `2^-length` of the codes at most `count/total`: the sum of the shares is at most 1.
/// What is left of 1 is a multiple of the smallest share, as all others are. As long as it is not 0, the
/// longest code can be shortened: with a length of 1, two symbols would leave nothing.
fn lengths(counts: &[u32; SYMBOLS]) -> [u32; SYMBOLS] {
    let total: u32 = counts.iter().sum();
    debug_assert!(total <= ALL && counts[END] < total);
    let mut lengths = counts.map(|count| match count {
        0 => 0,
        count => total.div_ceil(count).next_power_of_two().ilog2(),
    });
    let mut left = ALL - shares(&lengths);
    while left > 0 {
        for length in lengths.iter_mut().filter(|length| **length > 1) {
            let share = ALL >> *length;
            if share <= left {
                left -= share;
                *length -= 1;
            }
        }
    }
    lengths
}

/// All codes of 15 bits.
const ALL: u32 = 1 << 15;

/// Returns the number of codes of 15 bits that begin with a code of these lengths.
fn shares(lengths: &[u32; SYMBOLS]) -> u32 {
    let used = lengths.iter().filter(|length| **length > 0);
    used.map(|length| ALL >> length).sum()
}

/// Returns the codes of these lengths, the first bit lowest, and their lengths (RFC 1951, section
/// 3.2.2).
fn codes(lengths: &[u32; SYMBOLS]) -> [(u64, u32); SYMBOLS] {
    let mut codes = [(0, 0); SYMBOLS];
    let mut next = 0_u32;
    for length in 1..=15 {
        for (code, _) in codes
            .iter_mut()
            .zip(lengths)
            .filter(|(_, of)| **of == length)
        {
            *code = (u64::from(next.reverse_bits() >> (32 - length)), length);
            next += 1;
        }
        next <<= 1;
    }
    codes
}

/// Bits, the first of each byte lowest.
#[derive(Default)]
struct Bits {
    bytes: Vec<u8>,
    /// The last bits, fewer than 64.
    last: u64,
    count: u32,
}

impl Bits {
    /// Appends fewer than 64 bits.
    #[inline(always)]
    fn put(&mut self, bits: u64, count: u32) {
        self.last |= bits << self.count;
        self.count += count;
        if self.count >= 64 {
            self.bytes.extend_from_slice(&self.last.to_le_bytes());
            self.count -= 64;
            self.last = bits >> (count - self.count);
        }
    }

    fn finish(mut self) -> Vec<u8> {
        let bytes = self.count.div_ceil(8) as usize;
        self.bytes
            .extend_from_slice(&self.last.to_le_bytes()[..bytes]);
        self.bytes
    }
}

#[cfg(test)]
mod tests {
    use miniz_oxide::inflate::decompress_to_vec_zlib;

    use super::*;
    use crate::tracer::random::Rng;

    /// Returns the length of the stream of some bytes, which must inflate to them.
    fn checked(bytes: &[u8], case: usize) -> usize {
        let compressed = zlib(bytes);
        let found = decompress_to_vec_zlib(&compressed);
        assert!(found.is_ok_and(|found| found == bytes), "case {case}");
        compressed.len()
    }

    #[test]
    fn every_stream_inflates_to_its_bytes() {
        let mut random = Rng(1);
        let mut random = |below: usize| random.below(below);
        for count in 1..40 {
            for kinds in [1, 2, 256] {
                let bytes: Vec<u8> = (0..count).map(|_| random(kinds) as u8).collect();
                checked(&bytes, count);
            }
        }
        for case in 0..200 {
            // Repetitions of any length, noise, and bytes of which each is rarer than the one before.
            let mut bytes = Vec::new();
            for _ in 0..=random(30) {
                let count = [1, 2, 3, 9, 70, 258, 259, 1000, 40_000][random(9)];
                let (kind, start) = (random(3), [random(256), random(256)]);
                bytes.extend((0..count).map(|place| match kind {
                    0 => start[place % 2] as u8,
                    1 => random(256) as u8,
                    _ => (random(1 << 20) as u32).leading_zeros() as u8,
                }));
            }
            checked(&bytes, case);
        }
    }

    #[test]
    fn repetitions_of_any_length_are_short() {
        let mut random = Rng(2);
        // A part with as many symbols as possible.
        let mut bytes: Vec<u8> = (0..MOST - 1).map(|_| random.below(256) as u8).collect();
        bytes.resize(3 << 20, 7);
        let (length, most) = (checked(&bytes, 0), MOST * 9 / 8 + bytes.len() / 500);
        assert!(length < most, "{length}");
    }

    #[test]
    fn codes_are_complete_and_have_at_most_15_bits() {
        let mut random = Rng(3);
        for case in 0..2000 {
            let mut counts = [0; SYMBOLS];
            counts[END] = 1;
            let (kinds, most) = (1 + random.below(SYMBOLS - 1), 1 << random.below(15));
            for _ in 0..kinds {
                let left = ALL - counts.iter().sum::<u32>();
                let count = 1 + random.below(most) as u32;
                counts[random.below(SYMBOLS)] += count.min(left);
            }
            // All the rest is one symbol, so that the others are as rare as possible.
            if case % 2 == 0 {
                counts[0] += ALL - counts.iter().sum::<u32>();
            }
            counts[0] += u32::from(counts.iter().sum::<u32>() == counts[END]);
            let lengths = lengths(&counts);
            assert_eq!(shares(&lengths), ALL, "case {case}");
            for (length, count) in lengths.into_iter().zip(counts) {
                assert_eq!(length > 0, count > 0, "case {case}");
                assert!(length <= 15, "case {case}");
            }
        }
    }

    /// Other bytes for the same picture must be noted.
    #[test]
    fn the_bytes_are_known() {
        let byte = |place: u32| match place % 3000 {
            ..1000 => ((place * place) >> 7) as u8,
            _ => (place / 300 * (place % 2)) as u8,
        };
        let bytes: Vec<u8> = (0..40_000).map(byte).collect();
        let found = zlib(&bytes);
        assert_eq!(
            (found.len(), crc32fast::hash(&found)),
            (14_891, 2_910_419_504)
        );
    }
}
