//! A cursor over the text of a scene: white space, brackets, names, plain strings and plain
//! numbers, in either syntax.

use std::fmt;

use serde::de;

use super::source::Source;

use crate::{
    parallel::Pool,
    scene::format::geometry::GeometryModel,
    text::syntax::{Decimal, block_comment, line_comment},
};

/// An item that does not fit; for this reader one that it does not know, not necessarily wrong.
#[derive(Debug)]
pub(crate) struct Misfit;

impl fmt::Display for Misfit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("the value does not fit")
    }
}

impl std::error::Error for Misfit {}

impl de::Error for Misfit {
    fn custom<T: fmt::Display>(_message: T) -> Self {
        Self
    }
}

pub(crate) type Result<T> = std::result::Result<T, Misfit>;

/// An opening and a closing bracket.
pub(super) type Brackets = (u8, u8);

/// True for ASCII letters, digits and `_`.
const IS_OF_A_WORD: [bool; 256] = {
    let mut table = [false; 256];
    let mut byte = 0;
    while byte < 256 {
        table[byte] = (byte as u8).is_ascii_alphanumeric() || byte as u8 == b'_';
        byte += 1;
    }
    table
};
/// True for bytes that end a string or are invalid in a JSON string.
const ENDS_A_STRING: [bool; 256] = {
    let mut table = [false; 256];
    let mut byte = 0;
    while byte < 256 {
        table[byte] = matches!(byte as u8, b'"' | b'\\' | 0..b' ');
        byte += 1;
    }
    table
};

/// A text in RON, or else in JSON, and the current place.
pub(super) struct Reader<'t, const RON: bool> {
    pub(super) text: &'t str,
    pub(super) at: usize,
    /// The last key.
    pub(super) key: &'t str,
    /// The number of enums around the current place.
    pub(super) depth: u32,
    /// The geometries of a scene, if they are read separately.
    pub(super) apart: Option<Vec<GeometryModel>>,
    /// The threads that read a long list; `None` for the calling thread.
    pub(super) pool: Option<&'t Pool>,
    /// The source of the rest of a long list that only starts in the text.
    pub(super) source: Option<&'t Source<'t>>,
}

impl<'t, const RON: bool> Reader<'t, RON> {
    /// The brackets around the fields of a struct.
    pub(super) const STRUCT: Brackets = if RON { (b'(', b')') } else { (b'{', b'}') };
    /// The brackets around the entries of a map, whose keys are strings.
    pub(super) const MAP: Brackets = (b'{', b'}');
    /// The brackets around the values of a tuple.
    pub(super) const TUPLE: Brackets = if RON { (b'(', b')') } else { (b'[', b']') };
    /// The brackets around the values of a list.
    pub(super) const LIST: Brackets = (b'[', b']');

    /// Creates a reader at a place of a text.
    pub(super) fn new(text: &'t str, at: usize) -> Self {
        Self {
            text,
            at,
            key: "",
            depth: 0,
            apart: None,
            pool: None,
            source: None,
        }
    }

    /// Creates a reader of a file. The caller must check [`Source::is_read`] at the end.
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

    /// Skips white space and comments. Anything else is left for the caller.
    #[inline(always)]
    pub(super) fn skip_blank(&mut self) {
        // Almost always there is one blank or none.
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
            // At the end of a block, the comment may go on in the next one.
            b'/' => Some(line_comment(bytes, self.at)).filter(|end| *end < bytes.len()),
            b'*' => block_comment(bytes, self.at),
            _ => None,
        }
    }

    /// Skips white space and consumes a byte if it comes next; returns true if it did.
    #[inline(always)]
    pub(super) fn take(&mut self, byte: u8) -> bool {
        let found = self.sees(byte);
        self.at += usize::from(found);
        found
    }

    #[inline(always)]
    pub(super) fn expect(&mut self, byte: u8) -> Result<()> {
        if self.take(byte) { Ok(()) } else { Err(Misfit) }
    }

    /// Skips white space and returns true if a byte comes next.
    #[inline(always)]
    pub(super) fn sees(&mut self, byte: u8) -> bool {
        if self.peek() != byte {
            self.skip_blank();
        }
        self.peek() == byte
    }

    /// Reads a word of ASCII letters, digits and `_`; empty if there is none.
    #[inline]
    pub(super) fn word(&mut self) -> &'t str {
        self.skip_blank();
        let start = self.at;
        while IS_OF_A_WORD[usize::from(self.peek())] {
            self.at += 1;
        }
        self.text.get(start..self.at).unwrap_or("")
    }

    /// Consumes a word if it comes next; returns true if it did.
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
        // RON strings may contain control characters and span several lines.
        if RON && self.peek() != b'"' {
            let rest = self.text.as_bytes().get(self.at..).unwrap_or_default();
            let ends = |byte: &u8| matches!(byte, b'"' | b'\\');
            self.at += rest.iter().position(ends).ok_or(Misfit)?;
        }
        if self.peek() != b'"' {
            return Err(Misfit);
        }
        self.at += 1;
        self.text.get(start..self.at - 1).ok_or(Misfit)
    }

    /// Reads a number. Inlined, because returning it through memory would stall.
    #[inline(always)]
    pub(super) fn number(&mut self) -> Result<Decimal> {
        self.skip_blank();
        let number = Decimal::scan(self.text, self.at).ok_or(Misfit)?;
        self.at = number.end;
        Ok(number)
    }
}
