//! A reader that fails once it is cancelled.

use std::io::{self, BufRead, Read, Seek, SeekFrom};

use crate::parallel::Cancel;

/// A reader that fails once it is cancelled.
pub(crate) struct UntilCancelled<R> {
    reader: R,
    cancel: Option<Cancel>,
}

impl<R> UntilCancelled<R> {
    pub(crate) fn new(reader: R, cancel: Option<&Cancel>) -> Self {
        let cancel = cancel.cloned();
        Self { reader, cancel }
    }

    fn check(&self) -> io::Result<()> {
        let cancel = self.cancel.as_ref();
        let checked = cancel.map_or(Ok(()), Cancel::check);
        checked.map_err(io::Error::other)
    }
}

impl<R: Seek> Seek for UntilCancelled<R> {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.reader.seek(to)
    }
}

impl<R: Read> Read for UntilCancelled<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        self.check()?;
        self.reader.read(buffer)
    }
}

impl<R: BufRead> BufRead for UntilCancelled<R> {
    fn fill_buf(&mut self) -> io::Result<&[u8]> {
        self.check()?;
        self.reader.fill_buf()
    }

    fn consume(&mut self, count: usize) {
        self.reader.consume(count);
    }
}
