//! The reader of each format.

use std::io::{Read, Seek};

use crate::{
    data::{
        bytes::too_large,
        fault::{Fault, ReadError},
        table::{
            Table, atoms, csv, format::Format, npy, npz, ply, request::Request, row_cells::RowCells,
        },
    },
    parallel::Pool,
};

/// The number of bytes that are read to find a row. Rows of an .npy file need no search.
const MOST_BYTES: u64 = 1 << 28;

impl Table {
    /// Reads a table of `length` bytes. No more memory is allocated before the file is known to be
    /// that large. `pool` returns the threads that read a text of a given length.
    pub(crate) fn read(
        reader: impl Read + Send,
        length: u64,
        format: Format,
        request: &Request,
        pool: impl FnOnce(usize) -> Pool,
    ) -> Result<Self, ReadError> {
        if length == 0 {
            return Err(Fault::new("the file is empty").into());
        }
        if format != Format::Npz {
            request.refuse_array()?;
        }
        let size = usize::try_from(length).map_err(|_| too_large());
        let table = match format {
            Format::Csv => csv::read(reader, size?, request, pool),
            Format::Npy => npy::read(reader, length, request),
            Format::Npz => npz::read(reader, size?, request),
            Format::Ply => ply::read(reader, size?, request),
            Format::Xyz => atoms::read_xyz(reader, size?, request),
            Format::Pdb => atoms::read_pdb(reader, size?, request),
        }?;
        let table = table.without_missing(&request.defaults)?;
        Ok(Self { format, ..table })
    }
}

impl RowCells {
    /// Reads the cells of a row of a file, which counts from 0.
    pub(crate) fn read(
        reader: impl Read + Seek,
        length: u64,
        format: Format,
        request: &Request,
        row: usize,
    ) -> Result<Self, ReadError> {
        if format == Format::Npy {
            return npy::row_cells(reader, length, request, row);
        }
        if format != Format::Csv && length > MOST_BYTES {
            return Err(too_large().into());
        }
        let length = usize::try_from(length).map_err(|_| too_large())?;
        let reader = reader.take(MOST_BYTES);
        match format {
            Format::Csv | Format::Npy => csv::row_cells(reader, length, request, row),
            Format::Npz => npz::row_cells(reader, length, request, row),
            Format::Ply => ply::row_cells(reader, length, row),
            Format::Xyz => atoms::xyz_row_cells(reader, length, row),
            Format::Pdb => atoms::pdb_row_cells(reader, length, row),
        }
    }
}
