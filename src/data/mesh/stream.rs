//! A file of known length, read in pieces: neither its bytes nor its claims take memory beyond the
//! row that is being read.

use std::io::{self, Read};

use crate::data::{
    bytes::{BYTE_ORDER_MARK, LONGEST_LINE, longer, shorter},
    fault::{Fault, ReadError},
};

/// The number of bytes read at once, small enough for the cache of a core.
const PIECE: usize = if cfg!(test) { 64 } else { 1 << 18 };

pub(super) struct Stream<R> {
    reader: R,
    /// The number of bytes not read yet.
    left: u64,
    buffer: Vec<u8>,
    /// The start of the rest in the buffer.
    at: usize,
    /// The number of bytes before the rest.
    position: u64,
    /// The number of lines before the rest.
    lines: u64,
    /// The byte that ends a line, once it is known.
    line_end: Option<u8>,
}

impl<R: Read> Stream<R> {
    pub(super) const fn new(reader: R, length: u64) -> Self {
        Self {
            reader,
            left: length,
            buffer: Vec::new(),
            at: 0,
            position: 0,
            lines: 0,
            line_end: None,
        }
    }

    /// The bytes of the rest that have been read.
    #[inline(always)]
    pub(super) fn bytes(&self) -> &[u8] {
        self.buffer.get(self.at..).unwrap_or_default()
    }

    /// The length of the rest.
    pub(super) fn remaining(&self) -> u64 {
        self.left + self.bytes().len() as u64
    }

    /// The number of bytes before the rest.
    pub(super) const fn position(&self) -> u64 {
        self.position
    }

    /// The number of lines before the rest.
    pub(super) const fn lines(&self) -> u64 {
        self.lines
    }

    /// Reads the next piece; returns false at the end.
    pub(super) fn more(&mut self) -> Result<bool, ReadError> {
        if self.left == 0 {
            return Ok(false);
        }
        self.buffer.drain(..self.at);
        self.at = 0;
        // A row that is longer than a piece is read in pieces of its own length so far.
        let size = PIECE.max(self.buffer.len()) as u64;
        let size = size.min(self.left) as usize;
        self.buffer.try_reserve(size).map_err(io::Error::from)?;
        let mut piece = self.reader.by_ref().take(size as u64);
        if piece.read_to_end(&mut self.buffer)? < size {
            return Err(shorter().into());
        }
        self.left -= size as u64;
        Ok(true)
    }

    /// Reads until `count` bytes of the rest have been read; returns false if it is shorter.
    #[inline(always)]
    pub(super) fn have(&mut self, count: usize) -> Result<bool, ReadError> {
        while self.bytes().len() < count {
            if !self.more()? {
                return Ok(false);
            }
        }
        Ok(true)
    }

    /// Skips bytes that have been read, with this many line ends.
    #[inline(always)]
    pub(super) fn skip(&mut self, bytes: usize, lines: u64) {
        self.at += bytes;
        self.position += bytes as u64;
        self.lines += lines;
    }

    /// Skips a byte order mark at the start of a text.
    pub(super) fn skip_mark(&mut self) -> Result<(), ReadError> {
        self.have(BYTE_ORDER_MARK.len())?;
        if self.bytes().starts_with(BYTE_ORDER_MARK) {
            self.skip(BYTE_ORDER_MARK.len(), 0);
        }
        Ok(())
    }

    /// Returns the byte that ends the lines of a text: LF, or CR if the first piece has no other.
    pub(super) fn line_end(&mut self) -> Result<u8, ReadError> {
        if let Some(end) = self.line_end {
            return Ok(end);
        }
        self.have(PIECE)?;
        if self.bytes().ends_with(b"\r") {
            self.more()?;
        }
        let has_only_cr = self.bytes().contains(&b'\r') && !self.bytes().contains(&b'\n');
        let end = if has_only_cr { b'\r' } else { b'\n' };
        self.line_end = Some(end);
        Ok(end)
    }

    /// Returns the next word with the number of its line; `None` at the end of the file.
    pub(super) fn word(&mut self) -> Result<Option<(u64, &[u8])>, ReadError> {
        let line_end = self.line_end()?;
        loop {
            let blank = self.bytes().iter();
            let blank = blank.take_while(|byte| byte.is_ascii_whitespace());
            let (length, ends) = blank.fold((0, 0), |(length, ends), byte| {
                (length + 1, ends + u64::from(*byte == line_end))
            });
            self.skip(length, ends);
            if !self.bytes().is_empty() {
                break;
            }
            if !self.more()? {
                return Ok(None);
            }
        }
        let (line, mut length) = (self.lines + 1, 0);
        loop {
            let new = self.bytes().get(length..).unwrap_or_default();
            let end = new.iter().position(u8::is_ascii_whitespace);
            length += end.unwrap_or(new.len());
            if length > LONGEST_LINE {
                return Err(too_long(line).into());
            }
            if end.is_some() || !self.more()? {
                break;
            }
        }
        let word = self.at..self.at + length;
        self.skip(length, 0);
        Ok(Some((line, self.buffer.get(word).unwrap_or_default())))
    }

    /// Returns the next line with its number, without its end; `None` at the end of the file. Blank
    /// lines are skipped. `joins` gets a line, with all lines that were joined to it, and the start of
    /// the last of these; if it returns true, the last byte becomes a space, and the next line
    /// follows. The ends stay in the line.
    pub(super) fn line(
        &mut self,
        joins: impl Fn(&[u8], usize) -> bool,
    ) -> Result<Option<(u64, &[u8])>, ReadError> {
        let line_end = self.line_end()?;
        loop {
            let (length, ends) = self.line_length(line_end, &joins)?;
            let (start, number) = (self.at, self.lines + 1);
            if start == self.buffer.len() {
                return Ok(None);
            }
            if length > LONGEST_LINE {
                return Err(too_long(number).into());
            }
            let has_end = start + length < self.buffer.len();
            self.skip(length + usize::from(has_end), ends);
            let line = start..start + length;
            let is_blank = |line: &[u8]| line.trim_ascii().is_empty();
            if !self.buffer.get(line.clone()).is_none_or(is_blank) {
                return Ok(Some((number, self.buffer.get(line).unwrap_or_default())));
            }
        }
    }

    /// Reads a whole line, or the start of one that is too long. Returns its length, without its end,
    /// and the number of ends in it.
    fn line_length(
        &mut self,
        line_end: u8,
        joins: impl Fn(&[u8], usize) -> bool,
    ) -> Result<(usize, u64), ReadError> {
        let (mut last, mut searched, mut ends) = (0, 0, 0);
        loop {
            let bytes = self.bytes();
            let new = bytes.get(searched..).unwrap_or_default();
            let end = new.iter().position(|byte| *byte == line_end);
            let length = end.map_or(bytes.len(), |end| searched + end);
            if end.is_none() && length <= LONGEST_LINE && self.more()? {
                searched = length;
                continue;
            }
            ends += u64::from(end.is_some());
            let is_continued = self.join(last, length, &joins);
            if end.is_none() || !is_continued {
                return Ok((length, ends));
            }
            (last, searched) = (length + 1, length + 1);
        }
    }

    /// Makes the last byte of a line of this length a space if the next is joined to it; returns false
    /// if it is not. `last` is the start of the last line that was joined to it.
    #[inline(always)]
    fn join(&mut self, last: usize, length: usize, joins: impl Fn(&[u8], usize) -> bool) -> bool {
        let line = self.bytes().get(..length).unwrap_or_default();
        let line = line.strip_suffix(b"\r").unwrap_or(line);
        if line.len() <= last || !joins(line, last) {
            return false;
        }
        let at = self.at + line.len() - 1;
        if let Some(byte) = self.buffer.get_mut(at) {
            *byte = b' ';
        }
        true
    }
}

fn too_long(line: u64) -> Fault {
    longer(line).help("lines end with LF, CRLF or CR")
}
