//! Comma-separated values: a header with the names of the columns, then one sphere per record.

mod blocks;
mod plain;

use std::io::Read;

use csv::{ByteRecord, ReaderBuilder, StringRecord, Trim};

use crate::{
    parallel::Pool,
    scene::{
        format::color::ColorModel,
        table::{
            Defaults, Fault, ReadError, Rows, Table, Wrong,
            bytes::{check_lines, read_bytes},
            cell,
            csv::blocks::Blocks,
            layout::Columns,
        },
    },
    text::nearest::{list, nearest, quote},
};

/// The known columns.
const COLUMNS: [&str; 8] = ["x", "y", "z", "radius", "r", "g", "b", "color"];

/// The places of the columns in a record.
struct Header {
    length: usize,
    places: Columns<Option<usize>>,
    /// If the three channels are one column with `#rrggbb` or `#rgb`.
    is_hex: bool,
}

/// Size of the start of a file that contains the header, except for the longest ones.
const HEAD: usize = if cfg!(test) { 16 } else { 1 << 16 };

pub(super) fn read(
    mut reader: impl Read + Send,
    length: u64,
    defaults: &Defaults,
    pool: impl FnOnce(usize) -> Pool,
) -> Result<Table, ReadError> {
    let length = usize::try_from(length).map_err(|_| Fault::new("the file is too large"))?;
    let mut text = read_bytes(&mut reader, length.min(HEAD))?;
    let mut found = header_of(&text);
    let is_whole = matches!(found, Ok((_, body)) if body < text.len());
    if !is_whole && text.len() < length {
        text.append(&mut read_bytes(&mut reader, length - text.len())?);
        check_lines(&text, 0)?;
        found = header_of(&text);
    }
    let (header, mut body) = found?;
    // The header ends at the first of the two bytes of a line end.
    let (head, records) = text.split_at_checked(body).unwrap_or((&text, &[]));
    body += usize::from(head.ends_with(b"\r") && records.starts_with(b"\n"));
    let left = length - text.len();
    let records = text.split_off(body.min(text.len()));
    let mut rows = Rows::new();
    let blocks = Blocks::new(reader, left, records);
    let rest = plain::read(blocks, &header, defaults, &mut rows, &pool(length))?;
    // Each of these rows has one line.
    let mut lines = line_ends(&text) + rows.rows;
    if !rest.is_empty() {
        check_lines(&rest, lines)?;
        read_rest(&rest, lines, &header, defaults, &mut rows)?;
        lines += line_ends(&rest) - usize::from(rest.ends_with(b"\n"));
    }
    // Without blank lines and cells of several lines, the row determines the line.
    rows.first_line = (lines == rows.rows + 1).then_some(2);
    Ok(rows.into_table(header.places.map(|place| place.is_some()), defaults))
}

fn line_ends(text: &[u8]) -> usize {
    text.iter().filter(|byte| **byte == b'\n').count()
}

/// Returns the header at the start of a text, and its end.
fn header_of(text: &[u8]) -> Result<(Header, usize), ReadError> {
    let mut reader = reader_of(text, true);
    let header = Header::of(reader.headers().map_err(refused)?)?;
    let end = usize::try_from(reader.position().byte()).unwrap_or(text.len());
    Ok((header, end))
}

/// Creates the reader of a text that starts with a header or with records.
fn reader_of(text: &[u8], has_headers: bool) -> csv::Reader<&[u8]> {
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
    defaults: &Defaults,
    rows: &mut Rows,
) -> Result<(), ReadError> {
    let mut reader = reader_of(rest, false);
    let mut record = ByteRecord::new();
    let mut numbers = Vec::with_capacity(7);
    while reader.read_byte_record(&mut record).map_err(refused)? {
        numbers.clear();
        Row {
            header,
            rest,
            lines,
            record: &record,
            row: rows.rows,
        }
        .numbers(defaults, &mut numbers, rows);
        rows.push(&numbers, None)?;
    }
    Ok(())
}

/// Since records may have any length, only the disk fails, or a header that is not text.
fn refused(error: csv::Error) -> ReadError {
    match error.into_kind() {
        csv::ErrorKind::Io(error) => ReadError::Io(error),
        _ => Fault::new("the header is not UTF-8").into(),
    }
}

impl Header {
    fn of(names: &StringRecord) -> Result<Self, Fault> {
        for (at, name) in names.iter().enumerate() {
            if !COLUMNS.contains(&name) {
                return Err(unknown(names, name));
            }
            if names.iter().take(at).any(|other| other == name) {
                let message = format!("the column `{name}` is given twice");
                return Err(Fault::new(message).help("remove one of the two"));
            }
        }
        let place = |name| names.iter().position(|other| other == name);
        let needed = |name| {
            place(name).ok_or_else(|| {
                let message = format!("there is no column `{name}`");
                let known = list(&COLUMNS);
                Fault::new(message).help(format!("the first line names the columns: {known}"))
            })
        };
        let (hex, channels) = (place("color"), ["r", "g", "b"].map(place));
        let [r, g, b] = match (hex, channels) {
            (None, [None, None, None] | [Some(_), Some(_), Some(_)]) => channels,
            (Some(_), [None, None, None]) => [hex; 3],
            (None, _) => {
                let message = "of the columns `r`, `g` and `b` only some are given";
                return Err(Fault::new(message).help("give all three, or none"));
            }
            (Some(_), _) => {
                let message = "the color is given twice, as `color` and as `r`, `g` and `b`";
                return Err(Fault::new(message).help("remove one of the two"));
            }
        };
        let (x, y, z) = (needed("x")?, needed("y")?, needed("z")?);
        Ok(Self {
            length: names.len(),
            places: [Some(x), Some(y), Some(z), place("radius"), r, g, b],
            is_hex: hex.is_some(),
        })
    }

    /// The number of numbers in a row.
    fn numbers(&self) -> usize {
        self.places.iter().flatten().count()
    }
}

fn unknown(names: &StringRecord, name: &str) -> Fault {
    let known = list(&COLUMNS);
    let message = format!("unknown column {}, expected one of {known}", quote(name));
    let fault = Fault::new(message);
    if names.len() == 1 && name.contains([';', '\t', '|']) {
        return fault.help("columns are separated by commas");
    }
    if name.parse::<f64>().is_ok() {
        return fault.help("the first line names the columns, such as `x,y,z,radius`");
    }
    match nearest(name, &COLUMNS) {
        Some(name) => fault.help(format!("did you mean `{name}`?")),
        None => fault.help("remove it"),
    }
}

/// A record below its header.
struct Row<'a> {
    header: &'a Header,
    rest: &'a [u8],
    lines: usize,
    record: &'a ByteRecord,
    row: usize,
}

impl Row<'_> {
    /// Center, radius and color, as far as there are columns for them.
    fn numbers(&self, defaults: &Defaults, numbers: &mut Vec<f64>, rows: &mut Rows) {
        let (expected, found) = (self.header.length, self.record.len());
        if expected != found {
            let unread = rows.note(Wrong::Length, "", || {
                let (row, line) = (self.row, self.line());
                Fault::new(format!(
                    "row {row} (line {line}): {found} columns, expected {expected}"
                ))
            });
            numbers.resize(self.header.numbers(), unread);
            return;
        }
        let [x, y, z, radius, color @ ..] = self.header.places;
        for (at, name) in [x, y, z].into_iter().flatten().zip(COLUMNS) {
            numbers.push(self.number(at, name, rows));
        }
        if let Some(at) = radius {
            numbers.push(match (self.text(at), defaults.radius) {
                ([], Some(radius)) => {
                    rows.empty.radius.push(self.row);
                    radius
                }
                ([], None) => self.empty("radius", Some(ONE_FOR_ALL), rows),
                _ => self.number(at, "radius", rows),
            });
        }
        let [Some(r), Some(g), Some(b)] = color else {
            return;
        };
        let is_empty = [r, g, b].iter().all(|at| self.text(*at).is_empty());
        numbers.extend(match defaults.color {
            Some(color) if is_empty => {
                rows.empty.color.push(self.row);
                color
            }
            None if is_empty && self.header.is_hex => {
                [self.empty("color", Some(ONE_FOR_ALL), rows); 3]
            }
            _ if self.header.is_hex => self.hex(r, rows),
            _ => [(r, "r"), (g, "g"), (b, "b")].map(|(at, name)| self.number(at, name, rows)),
        });
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

    fn cell(&self, column: &str) -> String {
        cell(self.row, Some(self.line()), column)
    }

    fn empty(&self, column: &str, help: Option<&str>, rows: &mut Rows) -> f64 {
        rows.note(Wrong::Empty, column, || Fault {
            message: format!("{}: the cell is empty", self.cell(column)),
            help: help.map(str::to_owned),
        })
    }

    fn number(&self, at: usize, column: &str, rows: &mut Rows) -> f64 {
        let text = self.text(at);
        let number = std::str::from_utf8(text)
            .ok()
            .and_then(|text| text.parse().ok());
        number.unwrap_or_else(|| {
            if text.is_empty() {
                return self.empty(column, None, rows);
            }
            rows.note(Wrong::Number, column, || {
                let text = quote(&String::from_utf8_lossy(text));
                Fault::new(format!("{}: {text} is not a number", self.cell(column)))
            })
        })
    }

    fn hex(&self, at: usize, rows: &mut Rows) -> [f64; 3] {
        let text = String::from_utf8_lossy(self.text(at));
        hex(&text).unwrap_or_else(|| {
            let unread = rows.note(Wrong::Color, "color", || {
                let (cell, text) = (self.cell("color"), quote(&text));
                Fault::new(format!(
                    "{cell}: {text} is not a color, expected `#rrggbb` or `#rgb`"
                ))
            });
            [unread; 3]
        })
    }
}

/// The channels of a color such as `#ff8000`.
fn hex(text: &str) -> Option<[f64; 3]> {
    match ColorModel::parse(text) {
        ColorModel::Hex(bytes) => Some(bytes.map(|byte| f64::from(byte) / 255.0)),
        _ => None,
    }
}

/// The help for an empty cell.
const ONE_FOR_ALL: &str = "fill it, or give one in the scene for all rows that have none";
