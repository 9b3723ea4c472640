//! Comma-separated values: a header with the names of the columns, unless the scene names them, then
//! one sphere or cylinder per record. Columns may also be separated by tabs or blanks.

mod blocks;
mod commas;
mod opening;
mod plain;

use std::io::{Cursor, Read};

use csv::{ByteRecord, ReaderBuilder, StringRecord, Trim};

use crate::{
    data::{
        bytes::{LONGEST_LINE, check_lines, read_bytes},
        fault::{At, Blamed, Fault, LinePart, ReadError, Wrong},
        table::{
            Table,
            csv::{
                blocks::Blocks,
                commas::Commas,
                opening::{Opening, Separator, usual_name},
            },
            kind::RowKind,
            layout::{RADIUS, VALUE},
            request::Request,
            row_cells::RowCells,
            rows::{Rows, unread},
            select::{Known, Selection, coordinates, other_kind},
        },
    },
    parallel::Pool,
    text::nearest::{list, nearest, quote},
    tracer::color::Color,
};

/// The columns of a record.
struct Header {
    names: Vec<String>,
    selection: Selection,
}

/// Size of the start of a file that contains the header, except for the longest ones.
const HEAD: usize = if cfg!(test) { 16 } else { 1 << 16 };

pub(super) fn read(
    mut reader: impl Read + Send,
    length: usize,
    request: &Request,
    pool: impl FnOnce(usize) -> Pool,
) -> Result<Table, ReadError> {
    let (mut text, (names, opening, body)) = read_opening(&mut reader, length, request)?;
    let header = Header::new(names, request)?;
    let Opening {
        separators: [_, separator],
        is_mac,
        ..
    } = opening;
    let left = length - text.len();
    let records = text.split_off(body.min(text.len()));
    let before = match is_mac {
        true => text.iter().filter(|byte| **byte == b'\r').count(),
        false => line_ends(&text),
    };
    let mut rows = Rows::default();
    let blocks: Blocks<Box<dyn Read + Send + '_>> = if separator == Separator::Comma && !is_mac {
        Blocks::new(Box::new(reader), left, records)
    } else {
        let left = left + records.len();
        let reader = Cursor::new(records).chain(reader);
        let reader = Commas::new(reader, separator, is_mac);
        Blocks::new(Box::new(reader), left, Vec::new())
    };
    let rest = plain::read(blocks, before, &header, request, &mut rows, &pool(length))?;
    // Each of these rows has one line.
    let mut lines = before + rows.rows;
    if !rest.is_empty() {
        read_rest(&rest, lines, &header, request, &mut rows)?;
        lines += line_ends(&rest) - usize::from(rest.ends_with(b"\n"));
    }
    // Without blank lines and cells of several lines, the row determines the line.
    rows.first_line = (lines == before + rows.rows).then_some(before as u64 + 1);
    let Selection { names, .. } = header.selection.clone();
    Ok(rows.into_table(header.selection.has(), names, &request.defaults))
}

/// Reads the cells of a row, with the names of their columns.
pub(super) fn row_cells(
    mut reader: impl Read,
    length: usize,
    request: &Request,
    row: usize,
) -> Result<RowCells, ReadError> {
    let (mut text, (names, opening, body)) = read_opening(&mut reader, length, request)?;
    let records = Cursor::new(text.split_off(body.min(text.len()))).chain(reader);
    let [_, separator] = opening.separators;
    let records = Commas::new(records, separator, opening.is_mac);
    // As in `read_rest`, the end of a line comes first.
    let mut reader = reader_of(b"\n".chain(records), false);
    let mut record = ByteRecord::new();
    for _ in 0..=row {
        reader.read_byte_record(&mut record).map_err(refused)?;
    }
    let cells = record.iter().map(String::from_utf8_lossy);
    Ok(RowCells::new(names.len(), names.iter().zip(cells)))
}

/// Reads the start of a text up to its first records, and some of these.
fn read_opening(
    reader: &mut impl Read,
    length: usize,
    request: &Request,
) -> Result<(Vec<u8>, FoundColumns), ReadError> {
    let mut text = read_bytes(&mut *reader, length.min(HEAD))?;
    loop {
        if let Some(found) = opening_of(&text, text.len() == length, request)? {
            return Ok((text, found));
        }
        // A line that does not end is refused before the rest of the file is read.
        let piece = text.len().max(LONGEST_LINE).min(length - text.len());
        text.append(&mut read_bytes(&mut *reader, piece)?);
        check_lines(&text, 0)?;
    }
}

fn line_ends(text: &[u8]) -> usize {
    text.iter().filter(|byte| **byte == b'\n').count()
}

/// The names of the columns of a text, what precedes its records, and their start.
type FoundColumns = (Vec<String>, Opening, usize);

/// Returns what is at the start of a text; `None` if more of the text is needed.
fn opening_of(
    text: &[u8],
    is_all: bool,
    request: &Request,
) -> Result<Option<FoundColumns>, ReadError> {
    let Some(opening) = Opening::of(text, is_all, request.columns.is_some()) else {
        return Ok(None);
    };
    let Opening {
        start,
        header,
        records,
        ..
    } = opening;
    if let Some(names) = request.columns {
        let names = names.iter().map(|name| name.clone().into()).collect();
        return Ok(Some((names, opening, records)));
    }
    let head = text.get(start..).unwrap_or_default();
    let line = text.get(start..header.unwrap_or(start)).unwrap_or_default();
    let (names, body) = match opening.separators {
        [Separator::Comma, _] => {
            let mut reader = reader_of(head, true);
            let names: &StringRecord = reader.headers().map_err(refused)?;
            let names: Vec<_> = names.iter().map(str::to_owned).collect();
            let end = usize::try_from(reader.position().byte()).unwrap_or(head.len());
            // Quotes may hold ends of lines.
            if end > line.len() + 2 && start + end >= text.len() && !is_all {
                return Ok(None);
            }
            let has_quotes = line.contains(&b'"');
            (
                names,
                if has_quotes {
                    after_line_end(text, start + end)
                } else {
                    records
                },
            )
        }
        [separator, _] => {
            let line = str::from_utf8(line).map_err(|_| Fault::new(NOT_TEXT))?;
            let names = opening::names(line, separator);
            let rows = text.get(records..).unwrap_or_default();
            opening.check_commas(names.len(), rows)?;
            (names, records)
        }
    };
    Ok(Some((usual(names, request), opening, body)))
}

/// Returns an offset behind the second of the two bytes of a line end, if it is between them.
fn after_line_end(text: &[u8], at: usize) -> usize {
    let (head, rest) = text.split_at_checked(at).unwrap_or((text, &[]));
    at + usize::from(head.ends_with(b"\r") && rest.starts_with(b"\n"))
}

/// Replaces names of columns by the usual ones, if that gives no name twice.
fn usual(names: Vec<String>, request: &Request) -> Vec<String> {
    let known = Known::of_csv(request.kind()).all();
    let usual_name = |name: &str| usual_name(name).filter(|usual| known.contains(usual));
    let found: Vec<_> = names.iter().map(|name| usual_name(name)).collect();
    let is_one = |usual: &str| found.iter().filter(|other| **other == Some(usual)).count() == 1;
    let names = names.iter().zip(&found);
    let names = names.map(|(name, usual)| match usual {
        Some(usual) if is_one(usual) => (*usual).to_owned(),
        _ => name.clone(),
    });
    names.collect()
}

/// Creates the reader of a text that starts with a header or with records.
fn reader_of<R: Read>(text: R, has_headers: bool) -> csv::Reader<R> {
    ReaderBuilder::new()
        .has_headers(has_headers)
        .flexible(true)
        .trim(Trim::All)
        .from_reader(text)
}

/// Reads the records of the rest of a text, after `lines` lines. It starts with the end of the
/// previous line, which is skipped: the reader would skip a byte order mark at the start of a text,
/// but one in a record is a fault.
fn read_rest(
    rest: &[u8],
    lines: usize,
    header: &Header,
    request: &Request,
    rows: &mut Rows,
) -> Result<(), ReadError> {
    let mut reader = reader_of(rest, false);
    let mut record = ByteRecord::new();
    let mut numbers = Vec::with_capacity(VALUE + 1);
    while reader.read_byte_record(&mut record).map_err(refused)? {
        numbers.clear();
        CsvRecord {
            header,
            rest,
            lines,
            record: &record,
            row: rows.rows,
        }
        .numbers(request, &mut numbers, rows);
        rows.push(&numbers, None)?;
    }
    Ok(())
}

const NOT_TEXT: &str = "the header is not UTF-8";

/// Since records may have any length, only the disk fails, or a header that is not text.
fn refused(error: csv::Error) -> ReadError {
    match error.into_kind() {
        csv::ErrorKind::Io(error) => ReadError::Io(error),
        _ => Fault::new(NOT_TEXT).into(),
    }
}

impl Header {
    fn new(names: Vec<String>, request: &Request) -> Result<Self, Fault> {
        let all: Vec<&str> = names.iter().map(String::as_str).collect();
        let known = Known::of_csv(request.kind());
        let selection = Selection::new(&all, &known, request).map_err(|fault| {
            let is_complete = coordinates(&known.columns).all(|name| all.contains(&name));
            match request.columns {
                Some(_) => fault.at(Blamed::Columns),
                None if is_complete || other_kind(&all, request.kind()).is_some() => fault,
                None => without_names(&all, &known, fault),
            }
        })?;
        Ok(Self { names, selection })
    }

    /// The number of numbers in a row.
    fn numbers(&self) -> usize {
        self.selection.places.iter().flatten().count()
    }

    fn name(&self, column: usize) -> &str {
        self.names.get(column).map_or("", String::as_str)
    }
}

/// Explains why a file without coordinates seems to have other columns.
fn without_names(names: &[&str], columns: &Known, missing: Fault) -> Fault {
    let known = columns.all();
    let Some(name) = names
        .iter()
        .find(|name| !known.contains(name) && !name.is_empty())
    else {
        return missing.help(format!(
            "the first line names the columns: {}",
            list(&known)
        ));
    };
    let expected = list(&known);
    let message = format!("unknown column {}, expected one of {expected}", quote(name));
    let fault = Fault::new(message);
    if names.len() == 1 && name.contains([';', '\t', '|']) {
        return fault
            .help("columns are separated by commas, tabs or blanks, and decimals by points");
    }
    if name.parse::<f64>().is_ok() {
        let coordinates: Vec<_> = coordinates(&columns.columns).collect();
        let first = coordinates.join(",");
        return fault.help(format!(
            "the first line names the columns, such as `{first},radius`; or name them in the scene, \
             such as `columns: {coordinates:?}`"
        ));
    }
    match nearest(name, &known) {
        Some(name) => fault.help(format!("did you mean `{name}`?")),
        None => missing.help(format!("the first line names the columns: {expected}")),
    }
}

/// A record below its header.
struct CsvRecord<'a> {
    header: &'a Header,
    rest: &'a [u8],
    lines: usize,
    record: &'a ByteRecord,
    row: usize,
}

impl CsvRecord<'_> {
    /// Ends, radius, color and value, as far as there are columns for them.
    fn numbers(&self, request: &Request, numbers: &mut Vec<f64>, rows: &mut Rows) {
        let defaults = &request.defaults;
        let (expected, found) = (self.header.names.len(), self.record.len());
        if expected != found {
            rows.note(Wrong::Length, "", || {
                let at = At::row(self.row, Some(self.line()));
                at.fault(format!("{found} columns, expected {expected}"))
            });
            numbers.extend((0..self.header.numbers()).map(unread));
            return;
        }
        let Selection { places, is_hex, .. } = self.header.selection;
        let [.., radius, r, g, b, value] = places;
        for (column, at) in places.into_iter().take(RADIUS).enumerate() {
            numbers.extend(at.map(|at| self.coordinate(column, at, rows)));
        }
        if let Some(at) = radius {
            numbers.push(match (self.text(at), defaults.radius) {
                ([], Some(radius)) => {
                    rows.empty.radius.push(self.row);
                    radius
                }
                ([], None) => self.empty(at, Some(ONE_FOR_ALL), rows),
                _ => self.number(at, rows),
            });
        }
        if let [Some(r), Some(g), Some(b)] = [r, g, b] {
            let is_empty = [r, g, b].iter().all(|at| self.text(*at).is_empty());
            numbers.extend(match defaults.color {
                Some(color) if is_empty => {
                    rows.empty.color.push(self.row);
                    color
                }
                None if is_empty && is_hex => [self.empty(r, Some(ONE_FOR_ALL), rows); 3],
                _ if is_hex => self.hex(r, rows),
                _ => [r, g, b].map(|at| self.number(at, rows)),
            });
        }
        if let Some(at) = value {
            let same = places
                .iter()
                .take(VALUE)
                .flatten()
                .position(|place| *place == at);
            let is_optional = request.kind() != RowKind::Copy;
            numbers.push(match same.and_then(|place| numbers.get(place)) {
                Some(number) => *number,
                None if is_optional && self.text(at).is_empty() => f64::NAN,
                // Unlike the substitute, this is not a value.
                None if request.value.is_some() => self.read(at).unwrap_or_else(|| {
                    self.not_a_number(at, rows);
                    f64::NAN
                }),
                None => self.number(at, rows),
            });
        }
    }

    fn text(&self, at: usize) -> &[u8] {
        self.record.get(at).unwrap_or_default()
    }

    /// Returns the line of the record's start; the reader counts blank lines before a record as
    /// part of it.
    fn line(&self) -> u64 {
        let start = self.record.position().map_or(0, csv::Position::byte);
        let start = usize::try_from(start).unwrap_or_default();
        let (before, behind) = self.rest.split_at_checked(start).unwrap_or_default();
        let blank = behind
            .iter()
            .take_while(|byte| matches!(byte, b'\r' | b'\n'));
        let blank = blank.filter(|byte| **byte == b'\n').count();
        (self.lines + line_ends(before) + blank) as u64
    }

    /// Returns the place of a cell.
    fn cell(&self, at: usize, column: &str) -> At {
        let of = self.header.names.len();
        At::cell(self.row, Some(self.line()), column).part(LinePart::Cell { at, of })
    }

    fn empty(&self, at: usize, help: Option<&str>, rows: &mut Rows) -> f64 {
        let column = self.header.name(at);
        rows.note(Wrong::Empty, column, || {
            let fault = self.cell(at, column).fault("the cell is empty");
            match help {
                Some(help) => fault.help(help),
                None => fault,
            }
        })
    }

    /// Returns the number of a cell, if it is one.
    fn read(&self, at: usize) -> Option<f64> {
        str::from_utf8(self.text(at)).ok()?.parse().ok()
    }

    /// Returns a coordinate; if it cannot be read, one that no other column has.
    fn coordinate(&self, column: usize, at: usize, rows: &mut Rows) -> f64 {
        let number = self.read(at);
        number.unwrap_or_else(|| {
            self.number(at, rows);
            unread(column)
        })
    }

    fn number(&self, at: usize, rows: &mut Rows) -> f64 {
        self.read(at).unwrap_or_else(|| {
            if self.text(at).is_empty() {
                return self.empty(at, None, rows);
            }
            self.not_a_number(at, rows)
        })
    }

    fn not_a_number(&self, at: usize, rows: &mut Rows) -> f64 {
        let column = self.header.name(at);
        rows.note(Wrong::Number, column, || {
            let text = quote(&String::from_utf8_lossy(self.text(at)));
            let cell = self.cell(at, column);
            cell.fault(format!("{text} is not a number"))
        })
    }

    fn hex(&self, at: usize, rows: &mut Rows) -> [f64; 3] {
        let text = String::from_utf8_lossy(self.text(at));
        hex(&text).unwrap_or_else(|| {
            let unread = rows.note(Wrong::Color, "color", || {
                let (cell, text) = (self.cell(at, "color"), quote(&text));
                cell.fault(format!(
                    "{text} is not a color, expected `#rrggbb` or `#rgb`"
                ))
            });
            [unread; 3]
        })
    }
}

/// The channels of a color such as `#ff8000`.
fn hex(text: &str) -> Option<[f64; 3]> {
    let bytes = Color::parse_hex(text)?;
    Some(bytes.map(|byte| f64::from(byte) / 255.0))
}

/// The help for an empty cell.
const ONE_FOR_ALL: &str = "fill it, or give one in the scene for all rows that have none";
