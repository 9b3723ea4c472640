//! The bytes of a file, read piece by piece: a piece can be checked while it is in the cache.

use std::io::{self, Read};

use crate::scene::table::{Fault, ReadError};

/// How much is read at once: little enough for the cache of a core. In tests, a piece of an array
/// of numpy with seven columns ends within the last row of a block.
const PIECE: usize = if cfg!(test) { 318 } else { 1 << 18 };

/// The longest line of a text.
const LONGEST_LINE: usize = 1 << 20;

/// Refuses a text with a line beyond all reason: its cells would take many times its length. So many
/// lines come before it.
pub(super) fn check_lines(text: &[u8], before: usize) -> Result<(), Fault> {
    // A longer line covers one of these pieces from end to end.
    let mut pieces = text.chunks(LONGEST_LINE / 2);
    if pieces.all(|piece| piece.contains(&b'\n')) {
        return Ok(());
    }
    let mut lines = (before + 1..).zip(text.split(|byte| *byte == b'\n'));
    lines
        .find(|(_, line)| line.len() > LONGEST_LINE)
        .map_or(Ok(()), |(line, _)| {
            let message = format!("line {line} is longer than 1 MiB");
            Err(Fault::new(message).help("a row of a table is one line"))
        })
}

/// A file that is being read, whose length is known.
pub(super) struct Reading<R> {
    reader: R,
    bytes: Vec<u8>,
    length: usize,
}

impl<R: Read> Reading<R> {
    pub(super) fn new(reader: R, length: usize) -> io::Result<Self> {
        let mut bytes = Vec::new();
        bytes.try_reserve_exact(length)?;
        Ok(Self {
            reader,
            bytes,
            length,
        })
    }

    /// The bytes that have been read.
    pub(super) fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// Reads the next piece; `false` at the end.
    pub(super) fn more(&mut self) -> Result<bool, ReadError> {
        let piece = PIECE.min(self.length - self.bytes.len());
        let read = self
            .reader
            .by_ref()
            .take(piece as u64)
            .read_to_end(&mut self.bytes)?;
        if read < piece {
            return Err(shorter().into());
        }
        Ok(piece > 0)
    }

    /// The whole file, once the rest is read.
    pub(super) fn finish(mut self) -> Result<Vec<u8>, ReadError> {
        while self.more()? {}
        Ok(self.bytes)
    }
}

/// Reads exactly `length` bytes, which the file is known to have.
pub(super) fn read_bytes(reader: impl Read, length: usize) -> Result<Vec<u8>, ReadError> {
    Reading::new(reader, length)?.finish()
}

/// The fault of a file that ends before its length.
pub(super) fn shorter() -> Fault {
    Fault::new("the file became shorter while it was read")
}
