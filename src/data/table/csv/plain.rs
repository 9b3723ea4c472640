//! Records in common form: one per line, without quotes. They are read in blocks on all threads.
//!
//! The first record in another form, or with a fault, ends this: the `csv` crate reads from there
//! on, and its result counts.

use std::{
    io::{self, Read},
    iter,
    sync::atomic::{AtomicBool, Ordering},
};

use crate::{
    data::{
        bytes::{LONGEST_LINE, check_lines},
        fault::ReadError,
        table::{
            csv::{
                Header,
                blocks::{Blocks, Spare},
                hex, line_ends,
            },
            kind::RowKind,
            layout::{COLORS, RADIUS, Scalar, VALUE},
            request::{Defaults, Request},
            rows::{Empty, Rows},
        },
    },
    parallel::Pool,
    text::syntax::Decimal,
};

/// Maximum number of blocks per thread that wait to be joined.
const BLOCKS_PER_THREAD: usize = 4;
/// The maximum number of numbers in a row: ends, radius, color and value.
const MOST: usize = VALUE + 1;

/// The contents of a column.
#[derive(Clone, Copy)]
enum Cell {
    /// A number, by its place in the row.
    Number(usize),
    /// A color, by the place of its first channel.
    Hex(usize),
    /// A column that is not read.
    Skipped,
}

/// The columns in the order of the file, and the places of their numbers in a row.
struct Columns<'a> {
    cells: Vec<Cell>,
    /// The place of the radius.
    radius: Option<usize>,
    /// The place of the color.
    color: Option<usize>,
    /// The place of the value.
    value: Option<usize>,
    /// The place of the number that is the value as well, if its column has one.
    copied: Option<usize>,
    /// The length of a row.
    numbers: usize,
    defaults: &'a Defaults,
}

/// The rows of a block.
#[derive(Default)]
struct BlockRows {
    bytes: Vec<u8>,
    rows: usize,
    empty: Empty,
    /// The end of the last row in the block.
    end: usize,
}

/// Reads records up to the first unknown one, and returns the text from the line end before that
/// one on; empty if all are known. `before` is the number of lines before the first record.
pub(super) fn read(
    mut blocks: Blocks<impl Read + Send>,
    before: usize,
    header: &Header,
    request: &Request,
    rows: &mut Rows,
    pool: &Pool,
) -> Result<Vec<u8>, ReadError> {
    let columns = Columns::of(header, &request.defaults);
    let (spare_blocks, spare_parts) = (Spare::default(), Spare::<BlockRows>::default());
    let mut has_failed = false;
    let blocks = iter::from_fn(|| {
        let block = (!has_failed).then(|| blocks.next(&spare_blocks))?;
        has_failed = block.is_err();
        (!matches!(&block, Ok(block) if block.is_empty())).then_some(block)
    });
    let is_known = AtomicBool::new(true);
    let make = |block: Result<Vec<u8>, ReadError>| {
        let (block, mut part) = (block?, spare_parts.take());
        part.clear();
        if is_known.load(Ordering::Relaxed) {
            columns.read(&block, &mut part);
        }
        Ok::<_, ReadError>((block, part))
    };
    let mut rest = Vec::new();
    let ahead = pool.threads() * BLOCKS_PER_THREAD;
    pool.in_order(blocks, ahead, make, |made| {
        let (block, part) = made?;
        if block.len() > LONGEST_LINE {
            // Each of the rows has one line, and the rest starts with the end of the last one.
            let lines = before + rows.rows + line_ends(&rest).saturating_sub(1);
            check_lines(&block, lines)?;
        }
        let mut unknown = block.as_slice();
        if rest.is_empty() {
            rows.append(&part.bytes, part.rows, &part.empty)?;
            unknown = block.get(part.end..).unwrap_or_default();
            if !unknown.is_empty() {
                is_known.store(false, Ordering::Relaxed);
                rest.push(b'\n');
            }
        }
        rest.try_reserve(unknown.len()).map_err(io::Error::from)?;
        rest.extend_from_slice(unknown);
        spare_blocks.put(block);
        spare_parts.put(part);
        Ok::<_, ReadError>(())
    })?;
    Ok(rest)
}

impl BlockRows {
    fn clear(&mut self) {
        self.bytes.clear();
        self.empty.radius.clear();
        self.empty.color.clear();
        (self.rows, self.end) = (0, 0);
    }
}

impl<'a> Columns<'a> {
    fn of(header: &Header, defaults: &'a Defaults) -> Self {
        let places = header.selection.places;
        let place = |column: usize| {
            let before = places.iter().take(column).flatten().count();
            places[column].map(|_| before)
        };
        let numbers = header.numbers();
        let (color, value) = (place(COLORS.start), place(VALUE));
        let mut copied = None;
        let mut cells = vec![Cell::Skipped; header.names.len()];
        for (number, column) in places.into_iter().flatten().enumerate() {
            let Some(cell) = cells.get_mut(column) else {
                continue;
            };
            *cell = match (*cell, color) {
                (Cell::Number(other), _) if value == Some(number) => {
                    copied = Some(other);
                    Cell::Number(other)
                }
                (_, Some(color)) if header.selection.is_hex && number >= color => Cell::Hex(color),
                _ => Cell::Number(number),
            };
        }
        Self {
            cells,
            radius: place(RADIUS),
            color,
            value,
            copied,
            numbers,
            defaults,
        }
    }

    /// Reads the rows of a block up to the first unknown one.
    fn read(&self, block: &[u8], part: &mut BlockRows) {
        let Ok(text) = str::from_utf8(block) else {
            return;
        };
        while part.end < text.len() {
            let mut row = [0.0; MOST];
            let Some((end, empty)) = self.row(text, part.end, &mut row) else {
                break;
            };
            if empty != 0 && self.fill(empty, &mut row, part).is_none() {
                break;
            }
            if let (Some(value), Some(copied)) = (self.value, self.copied) {
                row[value] = row[copied];
            }
            let mut bytes = [0; MOST * Scalar::F64.size()];
            for (bytes, number) in bytes.as_chunks_mut().0.iter_mut().zip(row) {
                *bytes = number.to_le_bytes();
            }
            let length = self.numbers * Scalar::F64.size();
            part.bytes
                .extend_from_slice(bytes.get(..length).unwrap_or_default());
            part.rows += 1;
            part.end = end;
        }
    }

    /// Reads the numbers of the row at a place. Returns the start of the next row, and a bit for
    /// each empty number.
    #[inline(always)]
    fn row(&self, text: &str, mut at: usize, row: &mut [f64; MOST]) -> Option<(usize, u16)> {
        let bytes = text.as_bytes();
        let mut empty = 0;
        for (index, cell) in self.cells.iter().enumerate() {
            if index > 0 {
                if bytes.get(at) != Some(&b',') {
                    return None;
                }
                at += 1;
            }
            at = match *cell {
                Cell::Number(place) => {
                    let (number, end) = number(text, at)?;
                    match number {
                        Some(number) => *row.get_mut(place)? = number,
                        None => empty |= 1 << place,
                    }
                    end
                }
                Cell::Skipped => cell_at(text, at)?.1,
                Cell::Hex(place) => {
                    let (cell, end) = cell_at(text, at)?;
                    if cell.is_empty() {
                        empty |= 0b111 << place;
                    } else {
                        let channels = hex(cell)?;
                        row.get_mut(place..place + 3)?.copy_from_slice(&channels);
                    }
                    end
                }
            };
        }
        match bytes.get(at..)? {
            [] => Some((at, empty)),
            [b'\n', ..] => Some((at + 1, empty)),
            [b'\r', b'\n', ..] => Some((at + 2, empty)),
            _ => None,
        }
    }

    /// Fills the empty places of a row with the defaults.
    #[cold]
    fn fill(&self, empty: u16, row: &mut [f64; MOST], part: &mut BlockRows) -> Option<()> {
        let mut left = empty;
        if let Some(value) = self.value
            && left & 1 << value != 0
            && self.defaults.kind != RowKind::Copy
        {
            *row.get_mut(value)? = f64::NAN;
            left &= !(1 << value);
        }
        if let Some(radius) = self.radius
            && left & 1 << radius != 0
        {
            *row.get_mut(radius)? = self.defaults.radius?;
            left &= !(1 << radius);
            part.empty.radius.push(part.rows);
        }
        if let Some(place) = self.color
            && left == 0b111 << place
        {
            row.get_mut(place..place + 3)?
                .copy_from_slice(&self.defaults.color?);
            left = 0;
            part.empty.color.push(part.rows);
        }
        (left == 0).then_some(())
    }
}

/// Returns the number of the cell at a place, if it is not empty, and the end of the cell.
#[inline(always)]
fn number(text: &str, at: usize) -> Option<(Option<f64>, usize)> {
    if let Some(decimal) = Decimal::scan(text, at)
        && matches!(
            text.as_bytes().get(decimal.end),
            Some(b',' | b'\n' | b'\r') | None
        )
        && let Some(number) = decimal.float(text)
    {
        return Some((Some(number), decimal.end));
    }
    unusual_number(text, at)
}

/// Same as `number`, for numbers with spaces around them, infinite numbers, and spellings that
/// scenes do not allow.
#[cold]
fn unusual_number(text: &str, at: usize) -> Option<(Option<f64>, usize)> {
    let (cell, end) = cell_at(text, at)?;
    if cell.is_empty() {
        return Some((None, end));
    }
    Some((Some(cell.parse().ok()?), end))
}

/// Returns the text of the cell at a place, without the spaces around it, and its end.
fn cell_at(text: &str, at: usize) -> Option<(&str, usize)> {
    let rest = text.get(at..)?;
    let length = rest
        .bytes()
        .position(|byte| matches!(byte, b',' | b'\n' | b'\r' | b'"'))
        .unwrap_or(rest.len());
    let cell = rest.get(..length)?;
    (rest.as_bytes().get(length) != Some(&b'"')).then_some((cell.trim_ascii(), at + length))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn output_of_programs_is_read_to_the_end() {
        for (columns, record) in [
            ("x,y,z,radius,r,g,b", "1,-2.5,3e-7,0.1,0,1,0.5"),
            ("x,y,z,radius,r,g,b", " 1, +2, 3., .1, 0, 1, 1e999"),
            ("color,z,y,x,radius", "#ff8000,1,2,3,4"),
            ("x,y,z,radius,color", "1,2,3,,"),
            ("x,y,z,r,g,b", "1,2,3,,,"),
            ("energy,x,name,y,z", ",1, carbon atom ,2,3"),
        ] {
            for line_end in ["\n", "\r\n"] {
                let request = Request {
                    defaults: Defaults {
                        radius: Some(1.0),
                        color: Some([0.0; 3]),
                        ..Defaults::default()
                    },
                    value: columns.contains("energy").then_some("energy"),
                    ..Request::default()
                };
                let names = columns.split(',').map(str::to_owned).collect();
                let header = Header::new(names, &request).unwrap();
                let text = format!("{record}{line_end}").repeat(20);
                let mut rows = Rows::default();
                let blocks = Blocks::new(text.as_bytes(), text.len(), Vec::new());
                let rest = read(blocks, 0, &header, &request, &mut rows, &Pool::Calling);
                assert_eq!((rest.unwrap(), rows.rows), (Vec::new(), 20), "{text:?}");
            }
        }
    }
}
