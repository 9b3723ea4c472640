//! A reader that fails once it is cancelled.

use std::io::{self, Read, Seek, SeekFrom};

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
}

impl<R: Seek> Seek for UntilCancelled<R> {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.reader.seek(to)
    }
}

impl<R: Read> Read for UntilCancelled<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        if let Some(cancel) = &self.cancel {
            cancel.check().map_err(io::Error::other)?;
        }
        self.reader.read(buffer)
    }
}
