//! `--params`: a table that sets values of a scene, one picture for each row.

use std::{
    collections::HashSet,
    fs::File,
    io::{BufRead, BufReader},
    path::{Path, PathBuf},
};

use csv::{ReaderBuilder, StringRecord, Trim};
use serde::{
    Deserialize, Deserializer,
    de::{Error as _, MapAccess, Visitor},
};
use serde_json::Value;
use strahl::{Code, Document, Error, Setting, Syntax};

use super::Failure;

/// A table of values, read whole.
pub(super) struct Params {
    path: PathBuf,
    /// The names of the columns, each once.
    columns: Vec<String>,
    rows: Vec<Row>,
}

struct Row {
    /// The line of the table, from 1.
    line: u64,
    /// A cell for each of the columns; `None` leaves the value of the scene.
    cells: Vec<Option<Cell>>,
}

enum Cell {
    /// Of CSV: a value as in the scene, or a text without quotes.
    Text(String),
    Json(Value),
}

/// What the columns of a table are for a scene: which of them are paths into it.
pub(super) struct Columns(Vec<bool>);

impl Params {
    /// Reads a table; its ending, `.csv` or `.jsonl`, tells the format.
    pub(super) fn read(path: &Path) -> Result<Self, Failure> {
        let ending = path.extension().unwrap_or_default().to_ascii_lowercase();
        let file = File::open(path).map_err(|error| Error::reading_failed(path, error))?;
        let (columns, rows) = match ending.to_str() {
            Some("csv") => csv_rows(path, file)?,
            Some("jsonl" | "ndjson") => json_rows(path, BufReader::new(file))?,
            _ => {
                let message = "the ending does not tell the format, expected .csv or .jsonl";
                return Err(Failure::Usage(format!("{}: {message}", path.display())));
            }
        };
        if rows.is_empty() {
            return Err(wrong(
                path,
                None,
                "there are no rows below the names of the columns",
            ));
        }
        Ok(Self {
            path: path.to_owned(),
            columns,
            rows,
        })
    }

    pub(super) fn len(&self) -> usize {
        self.rows.len()
    }

    /// The names of the columns.
    pub(super) fn columns(&self) -> impl Iterator<Item = &str> {
        self.columns.iter().map(String::as_str)
    }

    /// Which columns set values of a scene. A word that is no field of it is a name, unless it
    /// resembles one and none of `names`, the places of a pattern, is that.
    pub(super) fn columns_of<'n>(
        &self,
        document: &Document,
        names: impl Iterator<Item = &'n str> + Clone,
    ) -> Columns {
        let is_path = |column: &String| {
            if column.contains(['.', '[']) {
                return true;
            }
            // Where it leads does not depend on the value.
            let Ok(setting) = format!("{column}=null").parse() else {
                return false;
            };
            let set = document.with([setting]);
            let mut faults = set.setting_diagnostics().flat_map(|(_, faults)| faults);
            let nowhere = faults.find(|fault| fault.code == Code::UnknownPath);
            nowhere.is_none_or(|fault| {
                let help = fault.help.as_deref().unwrap_or_default();
                help.starts_with("did you mean") && names.clone().all(|name| name != *column)
            })
        };
        Columns(self.columns.iter().map(is_path).collect())
    }

    /// What a row sets in a scene.
    pub(super) fn settings(
        &self,
        row: usize,
        columns: &Columns,
        syntax: Syntax,
    ) -> Result<Vec<Setting>, Failure> {
        let paths = columns
            .0
            .iter()
            .enumerate()
            .filter(|(_, is_path)| **is_path);
        let settings = paths.filter_map(|(at, _)| self.setting(row, at, syntax));
        settings.collect()
    }

    fn setting(&self, row: usize, at: usize, syntax: Syntax) -> Option<Result<Setting, Failure>> {
        let (row, column) = (self.rows.get(row)?, self.columns.get(at)?);
        let told = |what: &str| wrong(&self.path, Some((row.line, column)), what);
        let value = match row.cells.get(at)?.as_ref()? {
            Cell::Text(text) if text.starts_with('#') => format!("\"{text}\""),
            Cell::Text(text) => text.clone(),
            Cell::Json(value) if syntax == Syntax::Json => value.to_string(),
            Cell::Json(value) => match ron(value) {
                Some(text) => text,
                None => {
                    let what = "an object cannot be set in a scene that is RON; set its fields";
                    return Some(Err(told(what)));
                }
            },
        };
        let setting = format!("{column}={value}").parse();
        Some(setting.map_err(|error: strahl::SettingError| told(&error.to_string())))
    }

    /// What a row has in a column, as a part of the name of a file; without such a column `id` is
    /// the number of the row, from 0.
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
            let what = format!("{text:?} cannot be a part of the name of a file");
            Err(wrong(&self.path, Some((row.line, column)), &what))
        })
    }

    /// What reports call a value that a row sets.
    pub(super) fn place(&self, row: usize, setting: &Setting) -> String {
        let line = self.rows.get(row).map_or(0, |row| row.line);
        format!("{}:{line}: column {}", self.path.display(), setting.path())
    }

    /// What a message calls a row.
    pub(super) fn row(&self, row: usize) -> String {
        let line = self.rows.get(row).map_or(0, |row| row.line);
        format!("{}:{line}", self.path.display())
    }
}

fn wrong(path: &Path, place: Option<(u64, &str)>, what: &str) -> Failure {
    let path = path.display();
    Failure::Usage(match place {
        Some((line, column)) => format!("{path}:{line}: column {column}: {what}"),
        None => format!("{path}: {what}"),
    })
}

type Rows = (Vec<String>, Vec<Row>);

fn csv_rows(path: &Path, file: File) -> Result<Rows, Failure> {
    let mut reader = ReaderBuilder::new()
        .trim(Trim::All)
        .flexible(true)
        .from_reader(BufReader::new(file));
    let refused = |error: csv::Error| {
        let line = error.position().map_or(0, csv::Position::line);
        Failure::Usage(format!("{}:{line}: {error}", path.display()))
    };
    let columns: Vec<String> = reader
        .headers()
        .map_err(refused)?
        .iter()
        .map(str::to_owned)
        .collect();
    let mut known = HashSet::new();
    for (at, column) in columns.iter().enumerate() {
        if column.is_empty() {
            let what = format!("column {} has no name", at + 1);
            return Err(wrong(path, None, &what));
        }
        if !known.insert(column) {
            return Err(wrong(path, Some((1, column)), "there are two of this name"));
        }
    }
    let mut rows = Vec::new();
    let mut record = StringRecord::new();
    while reader.read_record(&mut record).map_err(refused)? {
        let line = record.position().map_or(0, csv::Position::line);
        if record.len() != columns.len() {
            let (found, expected) = (record.len(), columns.len());
            let what = format!("{found} cells, but the table has {expected} columns");
            return Err(Failure::Usage(format!("{}:{line}: {what}", path.display())));
        }
        let cells = record.iter();
        let cells = cells.map(|cell| (!cell.is_empty()).then(|| Cell::Text(cell.to_owned())));
        rows.push(Row {
            line,
            cells: cells.collect(),
        });
    }
    Ok((columns, rows))
}

fn json_rows(path: &Path, reader: impl BufRead) -> Result<Rows, Failure> {
    let mut columns: Vec<String> = Vec::new();
    let mut rows: Vec<Row> = Vec::new();
    for (line, text) in (1..).zip(reader.lines()) {
        let text = text.map_err(|error| Error::reading_failed(path, error))?;
        if text.trim().is_empty() {
            continue;
        }
        let Fields(fields) = serde_json::from_str(&text).map_err(|error| {
            // The one line is a text of its own.
            let told = error.to_string();
            let told = told.split(" at line 1 column").next().unwrap_or_default();
            let (path, column) = (path.display(), error.column());
            Failure::Usage(format!("{path}:{line}:{column}: {told}"))
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
        rows.push(Row { line, cells });
    }
    for row in &mut rows {
        row.cells.resize_with(columns.len(), || None);
    }
    Ok((columns, rows))
}

/// An object in its order, each name once.
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

/// A value of JSON as RON writes it; arrays are tuples there.
fn ron(value: &Value) -> Option<String> {
    Some(match value {
        Value::Null => "None".to_owned(),
        Value::Array(elements) => {
            let elements: Option<Vec<_>> = elements.iter().map(ron).collect();
            format!("({})", elements?.join(", "))
        }
        Value::Object(_) => return None,
        value => value.to_string(),
    })
}
