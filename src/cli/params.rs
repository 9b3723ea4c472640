//! `--params`: a table that sets values of a scene, with one picture per row.

mod place;

use std::{
    collections::HashSet,
    path::{Path, PathBuf},
};

use csv::{ReaderBuilder, StringRecord, Trim};
use serde::{
    Deserialize, Deserializer,
    de::{Error as _, MapAccess, Visitor},
};
use serde_json::Value;
use strahl::{
    Error, Syntax,
    diagnostic::open_file,
    scene::{Setting, SettingError},
};

use self::place::Line;
pub(super) use self::place::{TableFaults, Told};
use super::{bounded, failure::Failure};

/// The maximum size of a table, in MiB.
const LONGEST: u64 = 256;

/// A table of values, read completely.
pub(super) struct Params {
    path: PathBuf,
    /// The whole text of the file.
    text: String,
    format: Format,
    /// The line with the names of the columns; empty if the rows of the table repeat them.
    header: Line,
    /// The column names, each once.
    columns: Vec<String>,
    rows: Vec<ParamsRow>,
}

struct ParamsRow {
    line: Line,
    /// A cell for each column; `None` keeps the value of the scene.
    cells: Vec<Option<Cell>>,
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Format {
    Csv,
    Json,
}

impl Format {
    /// Returns the format for the file extension.
    fn of_path(path: &Path) -> Result<Self, Failure> {
        let ending = path.extension().unwrap_or_default().to_ascii_lowercase();
        match ending.to_str() {
            Some("csv") => Ok(Self::Csv),
            Some("jsonl" | "ndjson") => Ok(Self::Json),
            _ => Err(Failure::refused(
                path,
                "unknown file extension, expected .csv or .jsonl",
            )),
        }
    }
}

enum Cell {
    /// A CSV cell: a value as in the scene, or a text without quotes.
    Text(String),
    Json(Value),
}

/// The roles of a table's columns for a scene.
pub(super) struct Columns {
    /// True for each column that is a path into the scene.
    are_paths: Vec<bool>,
    /// The columns that are neither names nor paths that lead somewhere.
    pub(super) unused: Vec<TableFaults>,
    /// The values that all rows set as well.
    pub(super) for_all: Vec<Setting>,
}

impl Params {
    /// Reads a table; its extension, `.csv` or `.jsonl`, determines the format.
    pub(super) fn read(path: &Path) -> Result<Self, Failure> {
        let format = Format::of_path(path)?;
        let bytes = open_file(path).and_then(|file| bounded::read(file, LONGEST));
        let bytes = bytes.map_err(|error| Error::reading_failed(path, error))?;
        let (header, columns, rows) = match format {
            Format::Csv => csv_rows(path, &bytes)?,
            Format::Json => json_rows(path, &bytes)?,
        };
        let wrong = |what| TableFaults::wrong(path, &Line::default(), "", what);
        let text = String::from_utf8(bytes).map_err(|_| wrong("the table is not UTF-8"))?;
        if rows.is_empty() {
            return Err(wrong("there are no rows below the column names"));
        }
        Ok(Self {
            path: path.to_owned(),
            text,
            format,
            header,
            columns,
            rows,
        })
    }

    pub(super) fn len(&self) -> usize {
        self.rows.len()
    }

    /// Returns the column names.
    pub(super) fn columns(&self) -> impl Iterator<Item = &str> {
        self.columns.iter().map(String::as_str)
    }

    /// Returns the first value that a column sets.
    fn first(&self, at: usize) -> Option<Setting> {
        let mut rows = 0..self.rows.len();
        rows.find_map(|row| self.setting(row, at)?.ok())
    }

    /// Returns the values that a row sets in a scene.
    pub(super) fn settings(&self, row: usize, columns: &Columns) -> Result<Vec<Setting>, Failure> {
        let paths = columns
            .are_paths
            .iter()
            .enumerate()
            .filter(|(_, is_path)| **is_path);
        let settings = paths.filter_map(|(at, _)| self.setting(row, at));
        settings
            .chain(columns.for_all.iter().cloned().map(Ok))
            .collect()
    }

    fn setting(&self, row: usize, at: usize) -> Option<Result<Setting, Failure>> {
        let (row, column) = (self.rows.get(row)?, self.columns.get(at)?);
        let parsed = |value: &str| format!("{column}={value}").parse();
        let setting: Result<Setting, SettingError> = match row.cells.get(at)?.as_ref()? {
            Cell::Text(text) => parsed(text),
            Cell::Json(value) => {
                let setting = parsed(&value.to_string());
                setting.map(|setting| setting.in_syntax(Syntax::Json))
            }
        };
        let wrong = |error: SettingError| self.wrong(&row.line, column, &error.to_string());
        Some(setting.map_err(wrong))
    }

    /// Returns the value of a row in a column, as a part of a file name. Without such a column,
    /// `id` is the row number, from 0.
    pub(super) fn name(&self, row: usize, column: &str) -> Option<Result<String, Failure>> {
        let Some(at) = self.columns.iter().position(|name| name == column) else {
            return (column == "id").then(|| Ok(row.to_string()));
        };
        let row = self.rows.get(row)?;
        let text = match row.cells.get(at)? {
            Some(Cell::Text(text)) => text.clone(),
            Some(Cell::Json(Value::String(text))) => text.clone(),
            Some(Cell::Json(value @ (Value::Number(_) | Value::Bool(_)))) => value.to_string(),
            _ => String::new(),
        };
        let is_part = !text.is_empty()
            && !text.starts_with('.')
            && !text.contains(|letter: char| letter.is_control() || "/\\:".contains(letter));
        Some(if is_part {
            Ok(text)
        } else {
            let what = match &*text {
                "" => "the cell is empty, but its value is part of a file name".to_owned(),
                text => format!("{text:?} cannot be part of a file name"),
            };
            Err(self.wrong(&row.line, column, &what))
        })
    }

    /// Returns the name of a row in messages.
    pub(super) fn row(&self, row: usize) -> String {
        let line = self.rows.get(row).map_or(0, |row| row.line.number);
        format!("{}:{line}", self.path.display())
    }
}

type Rows = (Line, Vec<String>, Vec<ParamsRow>);

fn csv_rows(path: &Path, bytes: &[u8]) -> Result<Rows, Failure> {
    let mut reader = ReaderBuilder::new()
        .trim(Trim::All)
        .flexible(true)
        .from_reader(bytes);
    let wrong =
        |line: &Line, what: &str| TableFaults::wrong(path, line, line.of_bytes(bytes), what);
    let refused = |error: csv::Error| {
        let start = error.position().map_or(0, csv::Position::byte) as usize;
        let number = error.position().map_or(0, csv::Position::line) as usize;
        wrong(&Line::of(bytes, start..start, number), &error.to_string())
    };
    let columns: Vec<String> = reader
        .headers()
        .map_err(refused)?
        .iter()
        .map(str::to_owned)
        .collect();
    let header = Line::of(bytes, 0..at(&reader), 1);
    let mut known = HashSet::new();
    for (index, column) in columns.iter().enumerate() {
        if column.is_empty() {
            let what = format!("column {} has no name", index + 1);
            return Err(wrong(&header, &what));
        }
        if !known.insert(column) {
            let what = format!("column {column}: there are two columns with this name");
            return Err(wrong(&header, &what));
        }
    }
    let mut rows = Vec::new();
    let mut record = StringRecord::new();
    loop {
        let start = at(&reader);
        if !reader.read_record(&mut record).map_err(refused)? {
            break;
        }
        let number = record.position().map_or(0, csv::Position::line);
        let line = Line::of(bytes, start..at(&reader), number as usize);
        if record.len() != columns.len() {
            let (found, expected) = (record.len(), columns.len());
            let what = format!("{found} cells, but the table has {expected} columns");
            return Err(wrong(&line, &what));
        }
        let cells = record.iter();
        let cells = cells.map(|cell| (!cell.is_empty()).then(|| Cell::Text(cell.to_owned())));
        rows.push(ParamsRow {
            line,
            cells: cells.collect(),
        });
    }
    Ok((header, columns, rows))
}

/// Returns the byte position of a reader.
fn at<R: std::io::Read>(reader: &csv::Reader<R>) -> usize {
    reader.position().byte() as usize
}

fn json_rows(path: &Path, bytes: &[u8]) -> Result<Rows, Failure> {
    let mut columns: Vec<String> = Vec::new();
    let mut rows: Vec<ParamsRow> = Vec::new();
    let mut start = 0;
    for (number, text) in (1..).zip(bytes.split_inclusive(|byte| *byte == b'\n')) {
        let line = Line::of(bytes, start..start + text.len(), number);
        start += text.len();
        if text.trim_ascii().is_empty() {
            continue;
        }
        let Fields(fields) = serde_json::from_slice(text).map_err(|error| {
            // The line is parsed as a text of its own, so its line number is always 1.
            let message = error.to_string();
            let message = message
                .split(" at line 1 column")
                .next()
                .unwrap_or_default();
            let text = line.of_bytes(bytes);
            let at = error.column().saturating_sub(1).min(text.len());
            TableFaults::wrong_at(path, &line, text, at..text.len(), message)
        })?;
        let mut cells: Vec<Option<Cell>> = Vec::new();
        for (name, value) in fields {
            let at = columns.iter().position(|column| *column == name);
            let at = at.unwrap_or_else(|| {
                columns.push(name);
                columns.len() - 1
            });
            if cells.len() <= at {
                cells.resize_with(at + 1, || None);
            }
            if let Some(cell) = cells.get_mut(at) {
                *cell = Some(Cell::Json(value));
            }
        }
        rows.push(ParamsRow { line, cells });
    }
    for row in &mut rows {
        row.cells.resize_with(columns.len(), || None);
    }
    Ok((Line::default(), columns, rows))
}

/// The fields of an object in order, each name once.
struct Fields(Vec<(String, Value)>);

impl<'de> Deserialize<'de> for Fields {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct FieldsVisitor;

        impl<'de> Visitor<'de> for FieldsVisitor {
            type Value = Fields;

            fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.write_str("an object with a value for each column")
            }

            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Fields, A::Error> {
                let mut fields: Vec<(String, Value)> = Vec::new();
                while let Some((name, value)) = map.next_entry::<String, Value>()? {
                    if fields.iter().any(|(known, _)| *known == name) {
                        return Err(A::Error::custom(format_args!("`{name}` is given twice")));
                    }
                    fields.push((name, value));
                }
                Ok(Fields(fields))
            }
        }

        deserializer.deserialize_map(FieldsVisitor)
    }
}
