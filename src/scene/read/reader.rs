//! The text of a scene and how far it has been read: white space, brackets, names, strings and
//! numbers of the plain kind, in either syntax.

use std::fmt;

use serde::de;

use super::source::Source;

use crate::{
    parallel::Pool,
    scene::format::geometry::GeometryModel,
    text::syntax::{Decimal, block_comment, line_comment},
};

/// Something that this reader does not know, which need not be wrong.
#[derive(Debug)]
pub(super) struct Unknown;

impl fmt::Display for Unknown {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("unknown")
    }
}

impl std::error::Error for Unknown {}

impl de::Error for Unknown {
    fn custom<T: fmt::Display>(_message: T) -> Self {
        Self
    }
}

pub(super) type Result<T> = std::result::Result<T, Unknown>;

/// What opens something, and what closes it.
pub(super) type Brackets = (u8, u8);

/// Whether a byte is an ASCII letter, a digit or `_`.
const IS_OF_A_WORD: [bool; 256] = {
    let mut table = [false; 256];
    let mut byte = 0;
    while byte < 256 {
        table[byte] = (byte as u8).is_ascii_alphanumeric() || byte as u8 == b'_';
        byte += 1;
    }
    table
};
/// Whether a byte ends a string, or is none that a string of JSON has.
const ENDS_A_STRING: [bool; 256] = {
    let mut table = [false; 256];
    let mut byte = 0;
    while byte < 256 {
        table[byte] = matches!(byte as u8, b'"' | b'\\' | 0..b' ');
        byte += 1;
    }
    table
};

/// A text in RON, or else in JSON, read up to a place.
pub(super) struct Reader<'t, const RON: bool> {
    pub(super) text: &'t str,
    pub(super) at: usize,
    /// The last key.
    pub(super) key: &'t str,
    /// Where the geometries of a scene go, if they are read apart.
    pub(super) apart: Option<Vec<GeometryModel>>,
    /// Who reads a long list; `None` is the calling thread.
    pub(super) pool: Option<&'t Pool>,
    /// Where a long list goes on that only begins in the text.
    pub(super) source: Option<&'t Source<'t>>,
}

impl<'t, const RON: bool> Reader<'t, RON> {
    /// Those around the fields of a struct.
    pub(super) const STRUCT: Brackets = if RON { (b'(', b')') } else { (b'{', b'}') };
    /// Those around what a map holds, by strings.
    pub(super) const MAP: Brackets = (b'{', b'}');
    /// Those around the values of a tuple.
    pub(super) const TUPLE: Brackets = if RON { (b'(', b')') } else { (b'[', b']') };
    /// Those around the values of a list.
    pub(super) const LIST: Brackets = (b'[', b']');

    /// Reads on from a place of a text.
    pub(super) fn new(text: &'t str, at: usize) -> Self {
        Self {
            text,
            at,
            key: "",
            apart: None,
            pool: None,
            source: None,
        }
    }

    /// Reads a file, which is to be held against [`Source::is_read`] in the end.
    pub(super) fn begin(source: &'t Source<'t>) -> Self {
        let mut reader = Self::new(source.head(), 0);
        reader.source = Some(source);
        reader
    }

    /// The next byte; 0 at the end.
    #[inline]
    pub(super) fn peek(&self) -> u8 {
        self.text.as_bytes().get(self.at).copied().unwrap_or(0)
    }

    /// Skips white space and comments. What is neither stays, for others to stumble on.
    #[inline(always)]
    pub(super) fn skip_blank(&mut self) {
        // Nearly always there is one blank or none.
        self.at += usize::from(self.peek() == b' ');
        if matches!(self.peek(), 0..=b' ' | b'/') {
            self.skip_blanks();
        }
    }

    #[inline(never)]
    fn skip_blanks(&mut self) {
        loop {
            match self.peek() {
                b' ' | b'\n' | b'\r' | b'\t' => self.at += 1,
                b'/' if RON => match self.comment() {
                    Some(end) => self.at = end,
                    None => return,
                },
                _ => return,
            }
        }
    }

    #[cold]
    fn comment(&self) -> Option<usize> {
        let bytes = self.text.as_bytes();
        match bytes.get(self.at + 1)? {
            b'/' => Some(line_comment(bytes, self.at)),
            b'*' => block_comment(bytes, self.at),
            _ => None,
        }
    }

    /// Whether a byte comes next, behind white space; if so, it is taken.
    #[inline(always)]
    pub(super) fn take(&mut self, byte: u8) -> bool {
        let found = self.sees(byte);
        self.at += usize::from(found);
        found
    }

    #[inline(always)]
    pub(super) fn expect(&mut self, byte: u8) -> Result<()> {
        if self.take(byte) {
            Ok(())
        } else {
            Err(Unknown)
        }
    }

    /// Whether a byte comes next, behind white space.
    #[inline(always)]
    pub(super) fn sees(&mut self, byte: u8) -> bool {
        if self.peek() != byte {
            self.skip_blank();
        }
        self.peek() == byte
    }

    /// A word of ASCII letters, digits and `_`; empty where there is none.
    #[inline]
    pub(super) fn word(&mut self) -> &'t str {
        self.skip_blank();
        let start = self.at;
        while IS_OF_A_WORD[usize::from(self.peek())] {
            self.at += 1;
        }
        self.text.get(start..self.at).unwrap_or("")
    }

    /// Whether a word comes next; if so, it is taken.
    #[inline]
    pub(super) fn take_word(&mut self, word: &str) -> bool {
        self.skip_blank();
        let start = self.at;
        let found = self.word() == word && self.peek() < 0x80;
        if !found {
            self.at = start;
        }
        found
    }

    /// The name of a field or variant.
    #[inline]
    pub(super) fn name(&mut self) -> Result<&'t str> {
        if RON { Ok(self.word()) } else { self.string() }
    }

    /// A string without escapes.
    #[inline]
    pub(super) fn string(&mut self) -> Result<&'t str> {
        self.expect(b'"')?;
        let start = self.at;
        while !ENDS_A_STRING[usize::from(self.peek())] {
            self.at += 1;
        }
        // In RON a string may have control characters and go over several lines.
        if RON && self.peek() != b'"' {
            let rest = self.text.as_bytes().get(self.at..).unwrap_or_default();
            let ends = |byte: &u8| matches!(byte, b'"' | b'\\');
            self.at += rest.iter().position(ends).ok_or(Unknown)?;
        }
        if self.peek() != b'"' {
            return Err(Unknown);
        }
        self.at += 1;
        self.text.get(start..self.at - 1).ok_or(Unknown)
    }

    /// A number. Handed over in memory it would be waited for.
    #[inline(always)]
    pub(super) fn number(&mut self) -> Result<Decimal> {
        self.skip_blank();
        let number = Decimal::scan(self.text, self.at).ok_or(Unknown)?;
        self.at = number.end;
        Ok(number)
    }
}
