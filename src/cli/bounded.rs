//! Texts that a command reads besides scenes, such as lists of paths, up to a sensible size.

use std::io::{self, Read};

/// The maximum length of a line.
const LONGEST_LINE: usize = 1 << 20;

/// A reader that fails after a number of bytes, or at a line that is too long, so that an endless
/// device or pipe does not fill the memory.
pub(super) struct Bounded<R> {
    reader: R,
    most: u64,
    left: u64,
    /// Number of bytes read of the current line.
    line: usize,
}

impl<R: Read> Bounded<R> {
    /// Creates a reader of at most this many MiB.
    pub(super) fn mebibytes(reader: R, most: u64) -> Self {
        Self {
            reader,
            most,
            left: most << 20,
            line: 0,
        }
    }
}

impl<R: Read> Read for Bounded<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        // Limited, so that a longer line cannot go unnoticed within one read.
        let room = buffer.len().min(LONGEST_LINE);
        let count = match buffer.get_mut(..room) {
            Some(buffer) => self.reader.read(buffer)?,
            None => 0,
        };
        let read = buffer.get(..count).unwrap_or_default();
        let first = read.iter().position(|byte| *byte == b'\n');
        if self.line + first.unwrap_or(count) > LONGEST_LINE {
            return Err(too_long("has a line longer than 1 MiB".to_owned()));
        }
        self.line = match read.iter().rposition(|byte| *byte == b'\n') {
            Some(last) => count - last - 1,
            None => self.line + count,
        };
        self.left = self.left.checked_sub(count as u64).ok_or_else(|| {
            let most = self.most;
            too_long(format!("is longer than {most} MiB; split it"))
        })?;
        Ok(count)
    }
}

fn too_long(message: String) -> io::Error {
    io::Error::new(io::ErrorKind::FileTooLarge, message)
}
