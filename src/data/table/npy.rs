//! The columns of a numpy array: those of an array with two dimensions, or the fields of a structured
//! array.

use std::io::{self, Read, Seek};

use crate::{
    data::{
        bytes::{Reading, read_bytes},
        fault::{Blamed, Fault, ReadError},
        npy::{Descr, Header, not_numbers, remedy, scalar, size_of},
        table::{
            Table,
            layout::{COLORS, Column, Columns, Layout, RADIUS, Scalar, VALUE},
            request::Request,
            row_cells::{MOST_CELLS, RowCells},
            select::Names,
            select::{Known, Selection, columns, coordinates},
        },
    },
    text::nearest::quote,
};

/// The number of bytes of a text that are read as a cell.
const LONGEST_TEXT: usize = 256;

pub(super) fn read(
    mut reader: impl Read,
    length: u64,
    request: &Request,
) -> Result<Table, ReadError> {
    let (header, start) = Header::read(&mut reader, length)?;
    let array = header.rows_of_columns(request)?;
    let behind = array.bytes_behind(length.saturating_sub(start))?;
    let (chosen, names) = choose(&array.cells, request)?;
    let columns = chosen.map(|chosen| chosen.map(|(_, column)| column));
    let layout = Layout::new(array.rows, columns, &request.defaults);
    let table = Table::read_file(Reading::new(reader, array.bytes)?, layout, names)?;
    let behind = (behind > 0).then(|| {
        let message = format!("bytes after the last row are not read: {behind}");
        Fault::new(message).help("a file holds one array; `numpy.savez` writes several")
    });
    Ok(Table { behind, ..table })
}

/// Reads the cells of a row, with the names of their columns.
pub(super) fn row_cells(
    mut reader: impl Read + Seek,
    length: u64,
    request: &Request,
    row: usize,
) -> Result<RowCells, ReadError> {
    let (header, _) = Header::read(&mut reader, length)?;
    let array = header.rows_of_columns(request)?;
    let texts = array.texts(row, &mut reader, |reader, count| {
        let count = i64::try_from(count).map_err(io::Error::other)?;
        reader.seek_relative(count)
    });
    let texts = texts?;
    let names = array.cells.iter().map(|cell| &cell.name);
    Ok(RowCells::new(array.cells.len(), names.zip(texts)))
}

/// An array as columns.
pub(super) struct Array {
    pub(super) rows: usize,
    pub(super) cells: Vec<Cell>,
    /// The size of all elements.
    pub(super) bytes: usize,
    /// The size of a row.
    row: usize,
}

/// A column of an array.
#[derive(Clone)]
pub(super) struct Cell {
    pub(super) name: String,
    descr: String,
    /// The offset of its first number.
    start: usize,
    /// The distance from one number to the next.
    step: usize,
}

impl Header {
    /// Returns true if the array has rows of columns: two dimensions, or one with fields.
    pub(super) fn has_columns(&self) -> bool {
        match self.descr {
            Descr::Bare(_) => self.shape.len() == 2,
            Descr::Fields(..) => self.shape.len() == 1,
        }
    }

    /// Returns the array as the single column `name`, if it has one dimension and no fields.
    pub(super) fn column(&self, name: &str) -> Option<Array> {
        let (Descr::Bare(descr), &[rows]) = (&self.descr, self.shape.as_slice()) else {
            return None;
        };
        let size = size_of(descr)?;
        Some(Array {
            rows,
            cells: vec![Cell {
                name: name.to_owned(),
                descr: descr.clone(),
                start: 0,
                step: size,
            }],
            bytes: rows.checked_mul(size)?,
            row: size,
        })
    }

    /// Returns the columns of the array.
    pub(super) fn rows_of_columns(&self, request: &Request) -> Result<Array, Fault> {
        let shape: Vec<_> = self.shape.iter().map(usize::to_string).collect();
        let shape = shape.join(", ");
        let cut_off = |rows: usize, size: usize| {
            Fault::new(format!(
                "the file is cut off: {rows} rows of {size} bytes do not fit"
            ))
        };
        match &self.descr {
            Descr::Fields(fields, size) => {
                let size = *size;
                request.refuse_columns("the fields of the array have names")?;
                let &[rows] = self.shape.as_slice() else {
                    let message = format!("the shape is ({shape}), expected (N,) with fields");
                    return Err(Fault::new(message).help("save `array.ravel()`"));
                };
                let cells = fields.iter().map(|(name, descr, start)| Cell {
                    name: name.clone(),
                    descr: descr.clone(),
                    start: *start,
                    step: size,
                });
                Ok(Array {
                    rows,
                    cells: cells.collect(),
                    bytes: rows.checked_mul(size).ok_or_else(|| cut_off(rows, size))?,
                    row: size,
                })
            }
            Descr::Bare(descr) => {
                if request.columns.is_none() {
                    check_usual(descr)?;
                }
                let (rows, names) = names(&self.shape, &shape, request)?;
                let count = names.len();
                let (scalar, _) = scalar(descr).ok_or_else(|| not_numbers("array", descr))?;
                let size = scalar.size();
                let bytes = rows
                    .checked_mul(count)
                    .and_then(|all| all.checked_mul(size));
                let cell = |(index, name)| Cell {
                    name,
                    descr: descr.clone(),
                    start: size
                        * if self.fortran_order {
                            index * rows
                        } else {
                            index
                        },
                    step: size * if self.fortran_order { 1 } else { count },
                };
                let bytes = bytes.ok_or_else(|| cut_off(rows, size * count))?;
                Ok(Array {
                    rows,
                    cells: names.into_iter().enumerate().map(cell).collect(),
                    bytes,
                    row: size * count,
                })
            }
        }
    }
}

impl Array {
    /// Reads the first cells of a row as text; `skip` skips bytes of the elements.
    pub(super) fn texts<R: Read>(
        &self,
        row: usize,
        reader: &mut R,
        mut skip: impl FnMut(&mut R, u64) -> io::Result<()>,
    ) -> Result<Vec<String>, ReadError> {
        let mut texts = Vec::new();
        let mut at = 0;
        // The cells of a row are in the order of their places.
        for cell in self.cells.iter().take(MOST_CELLS) {
            let start = cell.start.saturating_add(row.saturating_mul(cell.step));
            let count = start.saturating_sub(at) as u64;
            skip(reader, count)?;
            let size = size_of(&cell.descr).unwrap_or_default().min(LONGEST_TEXT);
            texts.push(text_of(&cell.descr, &read_bytes(&mut *reader, size)?));
            at = start + size;
        }
        Ok(texts)
    }

    /// Returns how many of `found` bytes are behind the elements.
    pub(super) fn bytes_behind(&self, found: u64) -> Result<u64, Fault> {
        let needed = self.bytes as u64;
        if needed > found {
            let Self { rows, row, .. } = self;
            return Err(Fault::new(format!(
                "the file is cut off: {rows} rows of {row} bytes, found {found} bytes"
            )));
        }
        Ok(found - needed)
    }

    /// Checks that the elements take exactly `found` bytes.
    pub(super) fn check_length(&self, found: u64) -> Result<(), Fault> {
        match self.bytes_behind(found)? {
            0 => Ok(()),
            behind => Err(Fault::new(format!("bytes after the last row: {behind}"))),
        }
    }
}

/// Returns the number of rows and the names of the columns of an array without fields.
fn names(shape: &[usize], shown: &str, request: &Request) -> Result<(usize, Vec<String>), Fault> {
    if let Some(names) = request.columns {
        let &[rows, count] = shape else {
            let message = format!("the shape is ({shown}), expected (N, {})", names.len());
            return Err(Fault::new(message).help(stack(request)));
        };
        if count != names.len() {
            let message = format!(
                "the array has {count} columns, but `columns` has {} names",
                names.len()
            );
            let fault = Fault::new(message).at(Blamed::Columns);
            return Err(fault.help("name each column; `_` is a name for one to skip"));
        }
        return Ok((rows, names.iter().map(|name| name.to_string()).collect()));
    }
    let columns = columns(request.kind());
    let coordinates: Vec<_> = coordinates(&columns).collect();
    let bare = coordinates.len();
    let [with_radius, with_color, with_both] = [1, 3, 4].map(|more| bare + more);
    let all = [bare, with_radius, with_color, with_both];
    let usual = match columns[COLORS.start] {
        Some(_) => &all[..],
        None => &all[..2],
    };
    let is_usual = |count: usize| usual.contains(&count);
    let (rows, count) = match shape {
        &[rows, count] if is_usual(count) => (rows, count),
        _ => {
            let expected = match columns[COLORS.start] {
                Some(_) => format!(
                    "(N, {bare}), (N, {with_radius}) with radius, (N, {with_color}) with r, g, b, or \
                     (N, {with_both}) with both"
                ),
                None => format!("(N, {bare}), or (N, {with_radius}) with scale"),
            };
            let fault = Fault::new(format!("the shape is ({shown}), expected {expected}"));
            return Err(match shape {
                [count, _] if is_usual(*count) => {
                    let kind = request.kind().name();
                    fault.help(format!("a row is a {kind}: save `array.T`"))
                }
                [_, count] if *count > bare => {
                    let names = format!("{coordinates:?}");
                    let names = names.trim_end_matches(']');
                    fault.help(format!(
                        "name the columns in the scene, such as `columns: {names}, …]`, with `_` for \
                         one to skip"
                    ))
                }
                _ => fault.help(stack(request)),
            });
        }
    };
    let is_there = |index: usize| match index {
        RADIUS => count == with_radius || count == with_both,
        _ if COLORS.contains(&index) => count >= with_color,
        _ => true,
    };
    let names = columns.into_iter().enumerate();
    let names = names.filter(|(index, _)| is_there(*index));
    let names = names.filter_map(|(_, name)| name);
    Ok((rows, names.map(str::to_owned).collect()))
}

/// Returns the help for creating an array from columns.
fn stack(request: &Request) -> String {
    let columns = columns(request.kind());
    let names: Vec<_> = columns.into_iter().flatten().collect();
    let names = names.join(", ");
    format!("`numpy.column_stack(({names}))` makes an array of columns")
}

/// A column that is read, after its index among the cells.
type Chosen = Option<(usize, Column)>;

/// Chooses the columns that are read.
pub(super) fn choose(cells: &[Cell], request: &Request) -> Result<(Columns<Chosen>, Names), Fault> {
    let names: Vec<_> = cells.iter().map(|cell| cell.name.as_str()).collect();
    let known = Known::of_array(request.kind());
    let selection = Selection::new(&names, &known, request).map_err(|fault| {
        let is_named = request.columns.is_some();
        fault.at(match is_named {
            true => Blamed::Columns,
            false => Blamed::File,
        })
    })?;
    let mut chosen = [None; _];
    for (at, (chosen, place)) in chosen.iter_mut().zip(selection.places).enumerate() {
        let cell = place.and_then(|place| Some((place, cells.get(place)?)));
        if let Some((place, cell)) = cell {
            let column = cell.column(COLORS.contains(&at));
            let column = column.map_err(|fault| match at {
                VALUE if request.value.is_some() => fault.blame_value(&names_of_numbers(cells)),
                _ => fault,
            })?;
            *chosen = Some((place, column));
        }
    }
    Ok((chosen, selection.names))
}

fn names_of_numbers(cells: &[Cell]) -> Vec<&str> {
    let cells = cells.iter().filter(|cell| scalar(&cell.descr).is_some());
    cells.map(|cell| cell.name.as_str()).collect()
}

impl Cell {
    fn column(&self, is_channel: bool) -> Result<Column, Fault> {
        let Self { name, descr, .. } = self;
        let what = format!("column {}", quote(name));
        let (scalar, endian) = scalar(descr).ok_or_else(|| not_numbers(&what, descr))?;
        let divisor = match scalar {
            Scalar::U8 if is_channel => 255.0,
            Scalar::F16 | Scalar::F32 | Scalar::F64 => 1.0,
            _ if is_channel => {
                let descr = quote(descr);
                let fault = Fault::new(format!(
                    "the type of the {what} is {descr}, which does not determine its range"
                ));
                return Err(fault.help("channels are `u1`, 0 to 255, or floats, 0 to 1"));
            }
            _ => 1.0,
        };
        Ok(Column::Stored {
            scalar,
            endian,
            start: self.start,
            step: self.step,
            divisor,
        })
    }
}

/// Rejects arrays of anything but floats: integers may be colors of any range.
fn check_usual(descr: &str) -> Result<(), Fault> {
    match scalar(descr) {
        Some((Scalar::F32 | Scalar::F64, _)) => Ok(()),
        _ => {
            let fault = Fault::new(format!(
                "the type is {}, expected `<f4`, `<f8`, `>f4` or `>f8`",
                quote(descr)
            ));
            Err(fault.help(remedy(descr).unwrap_or("save `array.astype(\"f8\")`")))
        }
    }
}

/// Returns an element as text; of one that is neither a number nor text, its type.
fn text_of(descr: &str, bytes: &[u8]) -> String {
    if let Some((scalar, endian)) = scalar(descr) {
        return scalar.text(bytes, endian).unwrap_or_default();
    }
    let text: String = match descr.as_bytes() {
        [_, b'S', ..] => bytes.iter().map(|byte| char::from(*byte)).collect(),
        [order, b'U', ..] => {
            let letters = bytes.as_chunks().0.iter().map(|bytes| match order {
                b'>' => u32::from_be_bytes(*bytes),
                _ => u32::from_le_bytes(*bytes),
            });
            letters
                .map(|letter| char::from_u32(letter).unwrap_or(char::REPLACEMENT_CHARACTER))
                .collect()
        }
        _ => return format!("({descr})"),
    };
    text.trim_end_matches('\0').to_owned()
}
