//! Text whose columns are separated otherwise, as text with commas: byte by byte, so that its length and
//! its lines stay the same.

use std::io::{self, Read};

use super::opening::Separator;

/// The number of bytes read at once.
const PIECE: usize = 1 << 16;

/// Reads a text and replaces what separates its columns by commas.
pub(super) struct Commas<R> {
    reader: R,
    separator: Separator,
    is_mac: bool,
    is_quoted: bool,
    /// True behind the first cell of a line.
    is_in_line: bool,
    /// A blank whose next byte is not known yet.
    held: bool,
    bytes: Vec<u8>,
    /// The number of bytes that were handed out.
    at: usize,
}

impl<R: Read> Commas<R> {
    pub(super) const fn new(reader: R, separator: Separator, is_mac: bool) -> Self {
        Self {
            reader,
            separator,
            is_mac,
            is_quoted: false,
            is_in_line: false,
            held: false,
            bytes: Vec::new(),
            at: 0,
        }
    }

    fn fill(&mut self) -> io::Result<()> {
        self.bytes.clear();
        self.at = 0;
        let mut piece = self.reader.by_ref().take(PIECE as u64);
        let mut raw = Vec::with_capacity(PIECE);
        piece.read_to_end(&mut raw)?;
        self.bytes.reserve(raw.len() + 1);
        if raw.is_empty() && self.held {
            self.held = false;
            self.bytes.push(b' ');
        }
        for byte in raw {
            self.add(byte);
        }
        Ok(())
    }

    fn add(&mut self, byte: u8) {
        let byte = if byte == b'\r' && self.is_mac {
            b'\n'
        } else {
            byte
        };
        let is_space = matches!(byte, b' ' | b'\t');
        let is_blank = is_space && self.separator == Separator::Blanks && !self.is_quoted;
        let ends = matches!(byte, b'\n' | b'\r');
        if self.held {
            // The last blank before a cell separates it from the one before.
            let is_last = !is_blank && !ends && self.is_in_line;
            self.bytes.push(if is_last { b',' } else { b' ' });
        }
        self.held = is_blank;
        if is_blank {
            return;
        }
        self.is_quoted ^= byte == b'"';
        self.is_in_line = !ends;
        let is_tab = byte == b'\t' && self.separator == Separator::Tab && !self.is_quoted;
        self.bytes.push(if is_tab { b',' } else { byte });
    }
}

impl<R: Read> Read for Commas<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        while self.at == self.bytes.len() {
            self.fill()?;
            if self.bytes.is_empty() && !self.held {
                return Ok(0);
            }
        }
        let rest = self.bytes.get(self.at..).unwrap_or_default();
        let count = rest.len().min(buffer.len());
        let (from, to) = (rest.get(..count), buffer.get_mut(..count));
        if let (Some(from), Some(to)) = (from, to) {
            to.copy_from_slice(from);
        }
        self.at += count;
        Ok(count)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn length_and_lines_stay() {
        use Separator::{Blanks, Comma, Tab};
        for (text, separator, is_mac, expected) in [
            ("1 2  3\n", Blanks, false, "1,2 ,3\n"),
            (
                "  1   2 3  \r\n 4 5 6 ",
                Blanks,
                false,
                "  1  ,2,3  \r\n 4,5,6 ",
            ),
            ("\"a b\" 2\n", Blanks, false, "\"a b\",2\n"),
            ("1\t\t3\n", Tab, false, "1,,3\n"),
            ("1,2\r3,4\r", Comma, true, "1,2\n3,4\n"),
        ] {
            for size in [1, 2, 100] {
                let mut reader = Commas::new(text.as_bytes(), separator, is_mac);
                let (mut all, mut piece) = (Vec::new(), vec![0; size]);
                while let count @ 1.. = reader.read(&mut piece).unwrap() {
                    all.extend_from_slice(&piece[..count]);
                }
                assert_eq!(String::from_utf8(all).unwrap(), expected);
            }
        }
    }
}
