//! A facet of an STL file as nearly all programs write it, read at once.

use crate::data::{
    bytes::LONGEST_LINE,
    mesh::{number, stl_text::is},
};

/// A facet of three corners.
pub(super) struct Facet {
    /// The number of line ends before it.
    pub(super) start: u64,
    /// The corners, each with the number of line ends before it.
    pub(super) corners: [([f64; 3], u64); 3],
    /// The number of bytes.
    pub(super) length: usize,
    /// The number of line ends.
    pub(super) ends: u64,
}

impl Facet {
    /// The bytes that a facet has at most, but for odd ones.
    pub(super) const USUAL: usize = 512;

    /// Parses the facet behind the next line end; `None` if it is written in another way, or if it has
    /// not been read to its end.
    #[inline]
    pub(super) fn parse(bytes: &[u8], line_end: u8) -> Option<Self> {
        let mut words = Words {
            bytes: bytes.get(..LONGEST_LINE).unwrap_or(bytes),
            line_end,
            at: 0,
            ends: 0,
        };
        words.expect("facet")?;
        if words.ends == 0 {
            return None;
        }
        let start = words.ends;
        words.expect("normal")?;
        for _ in 0..3 {
            is_like_a_number(words.next()?).then_some(())?;
        }
        words.expect("outer")?;
        words.expect("loop")?;
        let mut corners = [([0.0; 3], 0); 3];
        for (corner, ends) in &mut corners {
            words.expect("vertex")?;
            *ends = words.ends;
            for coordinate in corner {
                *coordinate = number(words.next()?)?;
            }
        }
        words.expect("endloop")?;
        words.expect("endfacet")?;
        Some(Self {
            start,
            corners,
            length: words.at,
            ends: words.ends,
        })
    }
}

/// Returns true for a word that is a number, or nearly: those of normals are not read.
#[inline(always)]
pub(super) fn is_like_a_number(word: &[u8]) -> bool {
    matches!(word, [b'0'..=b'9' | b'+' | b'-' | b'.', ..]) || number(word).is_some()
}

/// The words of a text, each with white space behind it.
struct Words<'a> {
    bytes: &'a [u8],
    line_end: u8,
    /// The end of the last word.
    at: usize,
    /// The number of line ends before it.
    ends: u64,
}

impl<'a> Words<'a> {
    #[inline(always)]
    fn next(&mut self) -> Option<&'a [u8]> {
        let mut rest = self.bytes.get(self.at..)?;
        while let [first, others @ ..] = rest
            && first.is_ascii_whitespace()
        {
            self.ends += u64::from(*first == self.line_end);
            rest = others;
        }
        let start = self.bytes.len() - rest.len();
        let length = rest.iter().position(u8::is_ascii_whitespace)?;
        self.at = start + length;
        rest.get(..length)
    }

    #[inline(always)]
    fn expect(&mut self, keyword: &str) -> Option<()> {
        is(self.next()?, keyword).then_some(())
    }
}
