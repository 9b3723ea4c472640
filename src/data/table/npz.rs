//! Numpy arrays with names, in a zip file, as `numpy.savez` and `numpy.savez_compressed` write them.
//!
//! One array has rows of columns, as in an .npy file. Arrays of one dimension are columns with the
//! names of the arrays.

use std::io::{self, Cursor, Read};

use zip::{ZipArchive, result::ZipError};

use crate::{
    data::{
        bytes::{Bytes, read_bytes},
        fault::{Blamed, Fault, ReadError},
        npy::Header,
        table::{
            Table,
            check::Check,
            layout::{Column, Layout},
            npy::{self, Array, Cell},
            request::Request,
            row_cells::{MOST_CELLS, RowCells},
            select::{columns, coordinates},
        },
    },
    text::{
        members,
        nearest::{list, nearest, quote},
    },
};

type Archive<'a> = ZipArchive<Cursor<&'a [u8]>>;

/// The number of bytes that arrays may have when unpacked, however small the file is. Tests use less.
const LEAST: u64 = if cfg!(test) { 1 << 14 } else { 1 << 27 };
/// The number of such bytes for each byte of the file. Columns of one number are packed to a
/// thousandth, but not whole tables.
const MOST_RATIO: u64 = 128;

/// A named array and its index in the archive.
struct Entry<'a> {
    index: usize,
    name: &'a str,
    array: Array,
}

pub(super) fn read(
    reader: impl Read,
    length: usize,
    request: &Request,
) -> Result<Table, ReadError> {
    let file = read_bytes(reader, length)?;
    let (mut archive, headers) = members_of(&file)?;
    let (mut entries, rows) = entries(&headers, request)?;
    // Arrays of another length are data of another kind, unless they are meant to be read.
    let columns = columns(request.kind());
    let is_meant = |name: &str| columns.contains(&Some(name)) || request.value == Some(name);
    entries.retain(|entry| entry.array.rows == rows || is_meant(entry.name));
    let most = LEAST.saturating_add(MOST_RATIO.saturating_mul(length as u64));
    load(&mut archive, (rows, most), &entries, request)
}

/// Reads the cells of a row, with the names of their columns.
pub(super) fn row_cells(
    reader: impl Read,
    length: usize,
    request: &Request,
    row: usize,
) -> Result<RowCells, ReadError> {
    let file = read_bytes(reader, length)?;
    let (mut archive, headers) = members_of(&file)?;
    let (mut entries, rows) = entries(&headers, request)?;
    entries.retain(|entry| entry.array.rows == rows);
    let count = entries.iter().map(|entry| entry.array.cells.len()).sum();
    let mut cells = Vec::new();
    for Entry { index, name, array } in &entries {
        if cells.len() >= MOST_CELLS {
            break;
        }
        let (_, _, mut elements) = open(&mut archive, *index, name)?;
        let texts = array.texts(row, &mut elements, |elements, count| {
            // An array that the scene does not need may unpack to anything.
            match count > LEAST {
                true => Err(io::ErrorKind::FileTooLarge.into()),
                false => io::copy(&mut elements.take(count), &mut io::sink()).map(drop),
            }
        })?;
        cells.extend(array.cells.iter().map(|cell| &*cell.name).zip(texts));
    }
    Ok(RowCells::new(count, cells.into_iter()))
}

/// The index of an array in the archive, its name and its header.
type Member = (usize, String, Header);

/// Opens an archive and reads the headers of its arrays.
fn members_of(file: &[u8]) -> Result<(Archive<'_>, Vec<Member>), ReadError> {
    let mut archive = ZipArchive::new(Cursor::new(file)).map_err(|error| {
        let fault = Fault::new(format!("not a zip file of arrays: {error}"));
        fault.help("`numpy.savez` writes one")
    })?;
    if let Some(name) = members::repeated(file, archive.central_directory_start()) {
        let fault = Fault::new(format!("several arrays have the name {}", quote(&name)));
        return Err(fault.help("write the file again, each array once").into());
    }
    let mut headers = Vec::new();
    for index in 0..archive.len() {
        let name = archive.name_for_index(index).and_then(Result::ok);
        let name = name.and_then(|name| Some(name.strip_suffix(".npy")?.to_owned()));
        if let Some(name) = name {
            let (header, _, _) = open(&mut archive, index, &name)?;
            headers.push((index, name, header));
        }
    }
    Ok((archive, headers))
}

/// Returns the arrays that have rows or are columns, and the number of rows.
fn entries<'a>(headers: &'a [Member], request: &Request) -> Result<(Vec<Entry<'a>>, usize), Fault> {
    let main = main(headers, request)?;
    if main.is_none() {
        request.refuse_columns("the arrays have names")?;
    }
    let mut entries = Vec::new();
    for (place, (index, name, header)) in headers.iter().enumerate() {
        let array = match main == Some(place) {
            true => Some(
                header
                    .rows_of_columns(request)
                    .map_err(|fault| fault.of(name))?,
            ),
            false => header.column(name),
        };
        let index = *index;
        entries.extend(array.map(|array| Entry { index, name, array }));
    }
    let main = main.and_then(|place| headers.get(place));
    let rows = rows(&entries, main, request)?;
    Ok((entries, rows))
}

/// Returns the place of the array with rows of columns.
fn main(headers: &[Member], request: &Request) -> Result<Option<usize>, Fault> {
    let mut candidates = headers
        .iter()
        .enumerate()
        .filter(|(_, (_, _, header))| header.has_columns());
    if let Some(wanted) = request.array {
        let names: Vec<_> = candidates.map(|(_, (_, name, _))| name.as_str()).collect();
        let found = headers
            .iter()
            .position(|(_, name, header)| name == wanted && header.has_columns());
        return found.map(Some).ok_or_else(|| {
            let message = match names.as_slice() {
                [] => "no array of the file has rows of columns".to_owned(),
                names => {
                    let (wanted, names) = (quote(wanted), list(names));
                    format!("no array {wanted} with rows of columns, expected one of {names}")
                }
            };
            let fault = Fault::new(message).at(Blamed::Array);
            match nearest(wanted, &names) {
                Some(name) => fault.help(format!("did you mean `{name}`?")),
                None => fault,
            }
        });
    }
    let first = candidates.next();
    let Some((_, (_, other, _))) = candidates.next() else {
        return Ok(first.map(|(place, _)| place));
    };
    let name = first.map_or("", |(_, (_, name, _))| name);
    let message = format!(
        "several arrays have rows of columns, such as {} and {}",
        quote(name),
        quote(other)
    );
    Err(Fault::new(message).help(format!("choose one: `array: {name:?}`")))
}

/// Returns the number of rows: that of the array with columns, or that of the first coordinate.
fn rows(entries: &[Entry], main: Option<&Member>, request: &Request) -> Result<usize, Fault> {
    let columns = columns(request.kind());
    let coordinates: Vec<_> = coordinates(&columns).collect();
    let first = coordinates.first().copied().unwrap_or_default();
    let name = main.map_or(first, |(_, name, _)| name);
    let found = entries.iter().find(|entry| entry.name == name);
    found.map(|entry| entry.array.rows).ok_or_else(|| {
        let message =
            format!("the file has neither an array with rows of columns nor an array `{first}`");
        let given: Vec<_> = coordinates
            .iter()
            .map(|name| format!("{name}={name}"))
            .collect();
        let given = given.join(", ");
        Fault::new(message).help(format!("`numpy.savez(file, {given})` writes columns"))
    })
}

/// Reads the elements of the arrays that have chosen columns.
fn load(
    archive: &mut Archive,
    (rows, most): (usize, u64),
    entries: &[Entry],
    request: &Request,
) -> Result<Table, ReadError> {
    let cells = entries.iter().flat_map(|entry| &entry.array.cells);
    let cells: Vec<Cell> = cells.cloned().collect();
    let (mut chosen, names) = npy::choose(&cells, request)?;
    let mut bytes = Vec::new();
    let mut before = 0;
    for entry in entries {
        let cells = before..before + entry.array.cells.len();
        before = cells.end;
        let columns = chosen.iter_mut().flatten();
        let columns = columns.filter(|(place, _)| cells.contains(place));
        let mut columns: Vec<_> = columns.map(|(_, column)| column).collect();
        if columns.is_empty() {
            continue;
        }
        if entry.array.rows != rows {
            let (name, found) = (quote(entry.name), entry.array.rows);
            let message = format!("the array {name} has {found} numbers, expected {rows}");
            return Err(Fault::new(message)
                .help("columns have equal lengths")
                .into());
        }
        for column in &mut columns {
            if let Column::Stored { start, .. } = column {
                *start += bytes.len();
            }
        }
        append(archive, entry, most, &mut bytes)?;
    }
    let columns = chosen.map(|chosen| chosen.map(|(_, column)| column));
    let layout = Layout::new(rows, columns, &request.defaults);
    Ok(Table::new(Bytes::Rows(bytes), Check::new(layout), names))
}

/// Opens an array and reads its header. Returns the length of its elements, as the archive states
/// it, and a reader of them.
fn open<'a>(
    archive: &'a mut Archive,
    index: usize,
    name: &str,
) -> Result<(Header, u64, impl Read + 'a), ReadError> {
    let mut file = archive.by_index(index).map_err(|error| match error {
        ZipError::Io(error) => broken(name, error),
        error => ReadError::from(Fault::new(error.to_string()).of(name)),
    })?;
    let length = file.size();
    let (header, start) = Header::read(&mut file, length).map_err(|error| match error {
        ReadError::Io(error) => broken(name, error),
        ReadError::Invalid(fault) => fault.of(name).into(),
    })?;
    Ok((header, length.saturating_sub(start), file))
}

/// Appends the elements of an array, up to `most` bytes in all. Memory grows as they are unpacked,
/// whatever the archive states.
fn append(
    archive: &mut Archive,
    entry: &Entry,
    most: u64,
    bytes: &mut Vec<u8>,
) -> Result<(), ReadError> {
    let Entry { index, name, array } = entry;
    let (_, length, mut elements) = open(archive, *index, name)?;
    array.check_length(length).map_err(|fault| fault.of(name))?;
    let before = bytes.len();
    if length.saturating_add(before as u64) > most {
        let message = format!("unpacked, the arrays have more than {most} bytes");
        let fault = Fault::new(message).of(name);
        return Err(fault.help("`numpy.savez` writes them as they are").into());
    }
    // The archive has a checksum, which is compared at the end of the elements.
    let mut elements = elements.by_ref().take(length.saturating_add(1));
    elements
        .read_to_end(bytes)
        .map_err(|error| broken(name, error))?;
    let found = (bytes.len() - before) as u64;
    array.check_length(found).map_err(|fault| fault.of(name))?;
    Ok(())
}

/// Returns the error of an array that cannot be unpacked. The file is in memory, so the disk is not
/// at fault.
fn broken(name: &str, error: io::Error) -> ReadError {
    match error.kind() {
        io::ErrorKind::OutOfMemory => ReadError::Io(error),
        _ => Fault::new(format!("cannot be unpacked: {error}"))
            .of(name)
            .into(),
    }
}

impl Fault {
    /// Adds the name of the array.
    fn of(self, name: &str) -> Self {
        Self {
            message: format!("array {}: {}", quote(name), self.message),
            ..self
        }
    }
}
