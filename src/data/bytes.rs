//! Reads a file into fresh memory in pieces: each can be checked while it is in the cache.

use std::{
    io::{self, Read},
    ops::Deref,
};

use memmap2::{MmapMut, MmapOptions};

use crate::data::fault::{At, Fault, ReadError};

/// Number of bytes read at once, small enough for the cache of a core. In tests, a piece of a numpy
/// array with seven columns ends within the last row of a block.
const PIECE: usize = if cfg!(test) { 318 } else { 1 << 18 };

/// The longest line of a text.
pub(crate) const LONGEST_LINE: usize = 1 << 20;

/// The start of some texts, which is not a part of their first line.
pub(crate) const BYTE_ORDER_MARK: &[u8] = "\u{feff}".as_bytes();

/// The bytes that a table is decoded from.
pub(super) enum Bytes {
    /// A file, or a part of it.
    File(MmapMut),
    /// Rows decoded from a file.
    Rows(Vec<u8>),
}

impl Deref for Bytes {
    type Target = [u8];

    fn deref(&self) -> &[u8] {
        match self {
            Self::File(bytes) => bytes,
            Self::Rows(bytes) => bytes,
        }
    }
}

/// Rejects a text with an extremely long line: its cells would take many times its length. `before`
/// is the number of lines before the text.
pub(super) fn check_lines(text: &[u8], before: usize) -> Result<(), Fault> {
    // A longer line fully covers one of these pieces.
    let mut pieces = text.chunks(LONGEST_LINE / 2);
    if pieces.all(|piece| piece.contains(&b'\n')) {
        return Ok(());
    }
    let mut lines = (before + 1..).zip(text.split(|byte| *byte == b'\n'));
    lines
        .find(|(_, line)| line.len() > LONGEST_LINE)
        .map_or(Ok(()), |(line, _)| {
            Err(longer(line as u64).help("a row of a table is one line"))
        })
}

/// The fault of a line longer than the longest.
pub(crate) fn longer(line: u64) -> Fault {
    At::line(line).fault("longer than 1 MiB")
}

/// A clone is made to be written to, so it holds rows.
impl Clone for Bytes {
    fn clone(&self) -> Self {
        Self::Rows(self.to_vec())
    }
}

/// A file that is being read, with a known length.
pub(super) struct Reading<R> {
    reader: R,
    bytes: MmapMut,
    /// Number of bytes read so far.
    read: usize,
}

impl<R: Read> Reading<R> {
    pub(super) fn new(reader: R, length: usize) -> io::Result<Self> {
        Ok(Self {
            reader,
            bytes: MmapOptions::new().len(length).map_anon()?,
            read: 0,
        })
    }

    /// Returns the bytes read so far.
    pub(super) fn bytes(&self) -> &[u8] {
        self.bytes.get(..self.read).unwrap_or_default()
    }

    /// Reads the next piece; returns false at the end.
    pub(super) fn more(&mut self) -> Result<bool, ReadError> {
        let end = self.bytes.len().min(self.read + PIECE);
        let piece = self.read..end;
        if piece.is_empty() {
            return Ok(false);
        }
        // Faster than mapping each page on first touch; Linux before 5.14 does not support it.
        #[cfg(target_os = "linux")]
        let _ = self
            .bytes
            .advise_range(memmap2::Advice::PopulateWrite, self.read, piece.len());
        let bytes = self.bytes.get_mut(piece).unwrap_or_default();
        self.reader
            .read_exact(bytes)
            .map_err(|error| match error.kind() {
                io::ErrorKind::UnexpectedEof => shorter().into(),
                _ => ReadError::Io(error),
            })?;
        self.read = end;
        Ok(true)
    }

    /// Reads the rest and returns all bytes.
    pub(super) fn finish(mut self) -> Result<Bytes, ReadError> {
        while self.more()? {}
        Ok(Bytes::File(self.bytes))
    }
}

/// Reads exactly `length` bytes, which the file is known to have.
pub(super) fn read_bytes(reader: impl Read, length: usize) -> Result<Vec<u8>, ReadError> {
    let mut bytes = Vec::new();
    bytes.try_reserve_exact(length).map_err(io::Error::from)?;
    reader.take(length as u64).read_to_end(&mut bytes)?;
    if bytes.len() < length {
        return Err(shorter().into());
    }
    Ok(bytes)
}

/// The fault of a file that no address reaches to the end of.
pub(super) fn too_large() -> Fault {
    Fault::new("the file is too large")
}

pub(crate) fn shorter() -> Fault {
    Fault::new("the file became shorter while it was read")
}
