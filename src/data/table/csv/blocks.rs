//! The text of a file in blocks of whole lines, in reused memory.

use std::{
    io::{self, Read},
    mem,
    sync::{Mutex, PoisonError},
};

use crate::data::{
    bytes::{LONGEST_LINE, shorter},
    fault::ReadError,
};

/// Number of bytes read at once, small enough for the cache of a core.
const BLOCK: usize = if cfg!(test) { 64 } else { 1 << 17 };

/// The blocks of a file.
pub(super) struct Blocks<R> {
    reader: R,
    /// Number of bytes not read yet.
    left: usize,
    /// The bytes read that belong to the next block.
    bytes: Vec<u8>,
}

/// Buffers of earlier blocks, reused because fresh memory costs more than reading into it.
#[derive(Default)]
pub(super) struct Spare<T>(Mutex<Vec<T>>);

impl<T: Default> Spare<T> {
    pub(super) fn take(&self) -> T {
        let mut all = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        all.pop().unwrap_or_default()
    }

    pub(super) fn put(&self, each: T) {
        let mut all = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        all.push(each);
    }
}

impl<R: Read> Blocks<R> {
    /// Continues after `bytes`, with `left` bytes still in the file.
    pub(super) const fn new(reader: R, left: usize, bytes: Vec<u8>) -> Self {
        Self {
            reader,
            left,
            bytes,
        }
    }

    /// The next block, which is empty at the end of the file. One that does not end with a line is the
    /// last, or its last line is too long.
    pub(super) fn next(&mut self, spare: &Spare<Vec<u8>>) -> Result<Vec<u8>, ReadError> {
        let end = self.bytes.iter().rposition(|byte| *byte == b'\n');
        let line = end.map_or(0, |end| end + 1);
        while self.left > 0 && self.bytes.len() - line <= LONGEST_LINE {
            let (before, size) = (self.bytes.len(), self.left.min(BLOCK));
            self.bytes.try_reserve(size).map_err(io::Error::from)?;
            let mut piece = self.reader.by_ref().take(size as u64);
            if piece.read_to_end(&mut self.bytes)? < size {
                return Err(shorter().into());
            }
            self.left -= size;
            let new = self.bytes.get(before..).unwrap_or_default();
            if let Some(end) = new.iter().rposition(|byte| *byte == b'\n') {
                let mut next = spare.take();
                next.clear();
                next.extend_from_slice(new.get(end + 1..).unwrap_or_default());
                self.bytes.truncate(before + end + 1);
                return Ok(mem::replace(&mut self.bytes, next));
            }
        }
        Ok(mem::take(&mut self.bytes))
    }
}
