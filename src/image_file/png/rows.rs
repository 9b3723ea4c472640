//! The pixels of a PNG file: rows that are filtered, compressed and split into chunks.

use std::{
    cell::Cell,
    io::{self, Write},
};

use miniz_oxide::deflate::core::{CompressorOxide, TDEFLFlush, compress_to_output};
use png::{Writer, chunk::IDAT};

use crate::{
    diagnostic::error::Error,
    image_file::{Compression, deflate, png::error::error},
};

/// Number of compressed bytes in a chunk of the file.
const CHUNK: usize = 1 << 16;

/// The filter type, which is the first byte of a row (PNG Specification, Third Edition, section
/// 9.2).
const NO_FILTER: u8 = 0;
const UP: u8 = 2;

/// The failure that has not been reported yet.
pub(super) type Failure = Cell<Option<Error>>;

/// A compressor for rows as they arrive.
pub(super) struct Rows<'a> {
    compressor: Compressor<'a>,
    /// Number of bytes in a row.
    width: usize,
    failure: &'a Failure,
}

/// The compressor and the filter of the rows, chosen by `cargo bench --bench encode`.
///
/// `fdeflate` also runs the same code on every processor.
enum Compressor<'a> {
    /// `fdeflate` finds only runs of zeros. Without a filter a file is larger than its pixels; with
    /// it, a flat picture is all zeros, as each row has the one above subtracted.
    Up {
        deflate: fdeflate::Compressor<Chunks<'a>>,
        above: Vec<u8>,
        filtered: Vec<u8>,
    },
    /// This compressor finds the rows above by itself, and does it better: a filter leaves a trace
    /// at each edge.
    Unfiltered {
        deflate: Box<CompressorOxide>,
        chunks: Chunks<'a>,
    },
}

impl<'a> Rows<'a> {
    /// Creates a compressor for rows of `width` bytes.
    pub(super) fn new(
        writer: Writer<&'a mut dyn Write>,
        width: usize,
        compression: Compression,
        failure: &'a Failure,
    ) -> Result<Self, Error> {
        let chunks = Chunks {
            writer,
            bytes: Vec::with_capacity(CHUNK),
            works: true,
            failure,
        };
        let compressor = match compression {
            Compression::Small => Compressor::Unfiltered {
                deflate: deflate::stream(compression),
                chunks,
            },
            _ => Compressor::Up {
                deflate: fdeflate::Compressor::new(chunks).map_err(Error::writing)?,
                above: vec![0; width],
                filtered: vec![0; width],
            },
        };
        Ok(Self {
            compressor,
            width,
            failure,
        })
    }

    /// Compresses whole rows.
    pub(super) fn write(&mut self, bytes: &[u8]) -> Result<(), Error> {
        let rows = bytes.chunks_exact(self.width);
        match &mut self.compressor {
            Compressor::Up {
                deflate,
                above: last,
                filtered,
            } => {
                let mut above = &last[..];
                for row in rows {
                    for ((filtered, byte), above) in filtered.iter_mut().zip(row).zip(above) {
                        *filtered = byte.wrapping_sub(*above);
                    }
                    deflate.write_data(&[UP]).map_err(Error::writing)?;
                    deflate.write_data(filtered).map_err(Error::writing)?;
                    above = row;
                }
                *last = above.to_vec();
            }
            Compressor::Unfiltered { deflate, chunks } => {
                for row in rows {
                    chunks.compress(deflate, &[NO_FILTER], TDEFLFlush::None);
                    chunks.compress(deflate, row, TDEFLFlush::None);
                }
            }
        }
        self.failure.take().map_or(Ok(()), Err)
    }

    /// Writes the remaining bytes and the end of the file.
    pub(super) fn finish(self) -> Result<(), Error> {
        let mut chunks = match self.compressor {
            Compressor::Up { deflate, .. } => deflate.finish().map_err(Error::writing)?,
            Compressor::Unfiltered {
                mut deflate,
                mut chunks,
            } => {
                chunks.compress(&mut deflate, &[], TDEFLFlush::Finish);
                chunks
            }
        };
        chunks.end();
        self.failure.take().map_or(Ok(()), Err)?;
        chunks.writer.finish().map_err(error)
    }
}

/// A writer that splits compressed bytes into chunks. It accepts everything and keeps its first
/// failure for later: `fdeflate` panics if its last bytes cannot be written.
struct Chunks<'a> {
    writer: Writer<&'a mut dyn Write>,
    bytes: Vec<u8>,
    works: bool,
    failure: &'a Failure,
}

impl Chunks<'_> {
    /// Compresses bytes and appends the output.
    fn compress(&mut self, deflate: &mut CompressorOxide, bytes: &[u8], flush: TDEFLFlush) {
        compress_to_output(deflate, bytes, flush, |bytes| {
            self.take(bytes);
            true
        });
    }

    /// Appends bytes. `fdeflate` passes eight at a time.
    #[inline]
    fn take(&mut self, bytes: &[u8]) {
        if bytes.len() < CHUNK - self.bytes.len() {
            self.bytes.extend_from_slice(bytes);
        } else {
            self.fill(bytes);
        }
    }

    /// Appends bytes that fill the chunk.
    #[cold]
    fn fill(&mut self, mut bytes: &[u8]) {
        while let Some((now, later)) = bytes.split_at_checked(CHUNK - self.bytes.len()) {
            self.bytes.extend_from_slice(now);
            self.end();
            bytes = later;
        }
        self.bytes.extend_from_slice(bytes);
    }

    /// Writes the current chunk.
    fn end(&mut self) {
        if self.works
            && !self.bytes.is_empty()
            && let Err(failure) = self.writer.write_chunk(IDAT, &self.bytes)
        {
            self.works = false;
            self.failure.set(Some(error(failure)));
        }
        self.bytes.clear();
    }
}

impl Write for Chunks<'_> {
    #[inline]
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.take(bytes);
        Ok(bytes.len())
    }

    #[inline]
    fn write_all(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.take(bytes);
        Ok(())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}
