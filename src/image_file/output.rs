//! Output of the bytes of a file: from front to back, or with seeking.

use std::{
    borrow::Cow,
    io::{self, BufWriter, Seek, Write},
};

use crate::diagnostic::error::Error;

const BUFFER: usize = 1 << 18;

/// An output for the bytes of a file, at its beginning.
pub(crate) enum Output<'a> {
    /// Sequential output, such as a pipe.
    Stream(&'a mut dyn Write),
    /// A file with seeking.
    File(&'a mut dyn WriteSeek),
}

/// A writer that can seek.
pub(crate) trait WriteSeek: Write + Seek {}

impl<T: Write + Seek> WriteSeek for T {}

impl Output<'_> {
    /// Writes a header and then each band of rows, as the bytes that `encode` returns.
    pub(crate) fn write_rows(
        mut self,
        header: &[u8],
        draw: Draw,
        encode: impl Fn(&[u8]) -> Cow<'_, [u8]>,
    ) -> Result<(), Error> {
        self.write_all(header).map_err(Error::writing)?;
        draw(&mut |rows| self.write_all(&encode(rows)).map_err(Error::writing))?;
        self.flush().map_err(Error::writing)
    }

    /// Calls `write` with a seekable output. For a stream this is an unnamed temporary file, which
    /// is then copied to the stream: memory might not have room for it.
    pub(crate) fn going_back(
        self,
        write: impl FnOnce(&mut dyn WriteSeek) -> Result<(), Error>,
    ) -> Result<(), Error> {
        match self {
            Self::File(file) => {
                write(file)?;
                file.flush().map_err(Error::writing)
            }
            Self::Stream(stream) => {
                let file = tempfile::tempfile().map_err(Error::writing)?;
                let mut buffered = BufWriter::with_capacity(BUFFER, file);
                write(&mut buffered)?;
                let copied = buffered.into_inner().map_err(|error| error.into_error());
                let copied = copied.and_then(|mut file| {
                    file.rewind()?;
                    io::copy(&mut file, stream)?;
                    stream.flush()
                });
                copied.map_err(Error::writing)
            }
        }
    }
}

impl Write for Output<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match self {
            Self::Stream(stream) => stream.write(bytes),
            Self::File(file) => file.write(bytes),
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        match self {
            Self::Stream(stream) => stream.flush(),
            Self::File(file) => file.flush(),
        }
    }
}

/// A function that takes a picture in whole rows of bytes.
pub(crate) type Sink<'a> = &'a mut dyn FnMut(&[u8]) -> Result<(), Error>;

/// A function that passes a picture to a sink, in whole rows from the top, with numbers in native
/// byte order.
pub(crate) type Draw<'a> = &'a mut dyn FnMut(Sink) -> Result<(), Error>;

#[cfg(test)]
mod tests {
    use std::io::{Cursor, SeekFrom};

    use super::*;

    #[test]
    fn a_stream_gets_overwritten_bytes() {
        let write = |file: &mut dyn WriteSeek| {
            let written = file.write_all(b"xbc").and_then(|()| {
                file.seek(SeekFrom::Start(0))?;
                file.write_all(b"a")
            });
            written.map_err(Error::writing)
        };
        let (mut stream, mut file) = (Vec::new(), Cursor::new(Vec::new()));
        Output::Stream(&mut stream).going_back(write).unwrap();
        Output::File(&mut file).going_back(write).unwrap();
        assert_eq!((&*stream, &**file.get_ref()), (&b"abc"[..], &b"abc"[..]));
    }
}
