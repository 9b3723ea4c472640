//! The bytes of a file in fresh memory, read piece by piece: what has come can be looked at while
//! it is still in the cache.

use std::{
    io::{self, Read},
    ops::Deref,
};

use memmap2::{MmapMut, MmapOptions};

use crate::scene::table::{Fault, ReadError};

/// How much is read at once: little enough for the cache of a core. In tests, a piece of an array
/// of numpy with seven columns ends within the last row of a block.
const PIECE: usize = if cfg!(test) { 318 } else { 1 << 18 };

/// The longest line of a text.
const LONGEST_LINE: usize = 1 << 20;

/// What a table is decoded from.
pub(super) enum Bytes {
    /// A file, or a part of it.
    File(MmapMut),
    /// Rows that have been made of a file.
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

/// A copy is made to be written to.
impl Clone for Bytes {
    fn clone(&self) -> Self {
        Self::Rows(self.to_vec())
    }
}

/// A file that is being read, whose length is known.
pub(super) struct Reading<R> {
    reader: R,
    bytes: MmapMut,
    /// How many have come.
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

    /// Those that have come.
    pub(super) fn bytes(&self) -> &[u8] {
        self.bytes.get(..self.read).unwrap_or_default()
    }

    /// Reads the next piece; `false` at the end.
    pub(super) fn more(&mut self) -> Result<bool, ReadError> {
        let end = self.bytes.len().min(self.read + PIECE);
        let piece = self.read..end;
        if piece.is_empty() {
            return Ok(false);
        }
        // Sooner than one page after another, when it is first touched; Linux before 5.14 cannot.
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

    /// All of them, once the rest is read.
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

pub(super) fn shorter() -> Fault {
    Fault::new("the file became shorter while it was read")
}
