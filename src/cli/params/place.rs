//! Places in a table of values, and the faults there.

use std::{collections::HashSet, ops::Range, path::Path};

use strahl::{
    Diagnostic, Document,
    diagnostic::{Code, Severity},
    report::{FileReport, Suppressed},
    scene::{FieldLookup, Setting},
};

use super::{Columns, Format, Params, ParamsRow};
use crate::cli::failure::Failure;

/// The column that numbers the rows.
const ID: &str = "id";

/// The field in which many tables name their pictures.
const NAME: &str = "name";

/// A line of a table, or several if a quoted cell spans them.
#[derive(Clone, Default)]
pub(super) struct Line {
    /// The line number, from 1.
    pub(super) number: usize,
    /// The byte range of the line.
    range: Range<usize>,
}

impl Line {
    /// Creates a line from the bytes after the end of the previous line, whose number is one less
    /// than `number`.
    pub(super) fn of(bytes: &[u8], range: Range<usize>, number: usize) -> Self {
        let piece = bytes.get(range.clone()).unwrap_or_default();
        let is_end = |byte: &u8| matches!(byte, b'\n' | b'\r');
        // Empty lines are not rows.
        let empty = piece.iter().take_while(|byte| is_end(byte)).count();
        let ends = piece.iter().take(empty).filter(|byte| **byte == b'\n');
        let behind = piece.iter().rev().take_while(|byte| is_end(byte)).count();
        let start = range.start + empty;
        Self {
            number: number + ends.count(),
            range: start..(range.end - behind.min(piece.len())).max(start),
        }
    }

    /// Returns the text of the line, given the bytes of the table; empty if it is not UTF-8.
    pub(super) fn of_bytes<'b>(&self, bytes: &'b [u8]) -> &'b str {
        let line = bytes.get(self.range.clone()).unwrap_or_default();
        str::from_utf8(line).unwrap_or_default()
    }
}

/// The faults of rows that have been told: each once at its place, and at most some of them.
pub(crate) struct Told {
    table: String,
    known: HashSet<String>,
    most: usize,
    /// The numbers of those that were too many.
    more: Suppressed,
}

impl Told {
    pub(crate) fn new(params: &Params, most: usize) -> Self {
        Self {
            table: params.path.display().to_string(),
            known: HashSet::new(),
            most,
            more: Suppressed::default(),
        }
    }

    /// Returns true for a fault that is to be told: the first of several at one place. Counts
    /// those that are too many.
    pub(crate) fn is_new(&mut self, file: &str, line: usize, fault: &Diagnostic) -> bool {
        let (start, message) = (fault.range.start, &fault.message);
        let key = format!("{file}:{line}:{start}: {message}");
        if self.known.contains(&key) {
            return false;
        }
        let is_new = self.known.len() < self.most;
        if is_new {
            self.known.insert(key);
        } else {
            match fault.severity {
                Severity::Error => self.more.errors += 1,
                Severity::Warning => self.more.warnings += 1,
            }
        }
        is_new
    }

    /// Returns the report of the faults that were not told.
    pub(crate) fn rest(&self) -> Option<FileReport<'_>> {
        (!self.more.is_empty()).then(|| FileReport {
            file: &self.table,
            suppressed: self.more,
            ..FileReport::default()
        })
    }
}

/// The faults in a line of a table.
#[derive(Clone, Debug)]
pub(crate) struct TableFaults {
    file: String,
    text: String,
    line: usize,
    diagnostics: Vec<Diagnostic>,
}

impl TableFaults {
    /// Returns the failure for a table that cannot be used at all, at a line with this text. A line
    /// without a number means no particular one.
    pub(super) fn wrong(path: &Path, line: &Line, text: &str, what: &str) -> Failure {
        Self::wrong_at(path, line, text, 0..text.len(), what)
    }

    /// Returns the same failure at a range of the line.
    pub(super) fn wrong_at(
        path: &Path,
        line: &Line,
        text: &str,
        range: Range<usize>,
        what: &str,
    ) -> Failure {
        Failure::Table(Box::new(Self {
            file: path.display().to_string(),
            text: text.to_owned(),
            line: line.number,
            diagnostics: vec![Diagnostic::new(Code::InvalidTable, range, what)],
        }))
    }

    /// Removes the faults that have been told.
    pub(crate) fn keep_new(&mut self, told: &mut Told) {
        let Self { file, line, .. } = self;
        self.diagnostics
            .retain(|fault| told.is_new(file, *line, fault));
    }

    /// Returns the messages on one line.
    pub(crate) fn message(&self) -> String {
        let all = self.diagnostics.iter().map(|fault| &*fault.message);
        let (file, all) = (&self.file, all.collect::<Vec<_>>().join("; "));
        let starts = self.diagnostics.iter().map(|fault| fault.range.start);
        match (self.line, starts.min().unwrap_or_default()) {
            (0, _) => format!("{file}: {all}"),
            (line, 0) => format!("{file}:{line}: {all}"),
            (line, start) => format!("{file}:{line}:{}: {all}", start + 1),
        }
    }

    /// Returns the faults as a report.
    pub(crate) fn report(&self) -> FileReport<'_> {
        FileReport {
            file: &self.file,
            text: &self.text,
            lines_before: self.line.saturating_sub(1),
            diagnostics: &self.diagnostics,
            ..FileReport::default()
        }
    }
}

impl Params {
    /// Returns the roles of the columns for a scene; `names` are the placeholders of a pattern, if
    /// there is one.
    ///
    /// A word that is not a field of the scene itself is a name, unless it resembles a field and no
    /// placeholder has this name. A name without a placeholder is unused.
    pub(crate) fn columns_of(&self, document: &Document, names: Option<&[&str]>) -> Columns {
        let mut columns = Columns {
            are_paths: Vec::new(),
            unused: Vec::new(),
            for_all: Vec::new(),
        };
        for (index, column) in self.columns.iter().enumerate() {
            let has_place = names.is_some_and(|names| names.contains(&&**column));
            let found = if column.contains(['.', '[']) {
                FieldLookup::Found
            } else {
                document.look_up(column)
            };
            let (is_path, meant) = match found {
                FieldLookup::Found => (true, None),
                FieldLookup::Misspelt(_) => (!has_place, None),
                FieldLookup::Inside(path) => (false, Some(path)),
                _ => (false, None),
            };
            let fault = match is_path {
                true => self.path_fault(index, document),
                false => None,
            };
            columns.are_paths.push(is_path && fault.is_none());
            if let Some(fault) = fault {
                let (line, range) = self.head(index, column);
                columns.add(self.faults_of(line, vec![of_column(column, &range, &fault)]));
                continue;
            }
            // Without a pattern, any word may be meant as a name.
            let may_be_name = match names {
                Some(_) => has_place,
                None => meant.is_none() || column == NAME,
            };
            if is_path || may_be_name || column == ID {
                continue;
            }
            if let Some(severity) = document.severity(Code::UnusedColumn) {
                let (line, range) = self.head(index, column);
                let fault = Diagnostic {
                    severity,
                    ..unused(column, range, meant)
                };
                columns.add(self.faults_of(line, vec![fault]));
            }
        }
        columns
    }

    /// Returns the fault of a path that leads nowhere, whatever the row: unless another column
    /// replaces what it leads through.
    fn path_fault(&self, index: usize, document: &Document) -> Option<Diagnostic> {
        let column = self.columns.get(index)?;
        let leads_through = |other: &String| {
            let rest = column.strip_prefix(&**other);
            rest.is_some_and(|rest| rest.starts_with(['.', '[']))
        };
        if self.columns.iter().any(leads_through) {
            return None;
        }
        document.path_fault(&self.first(index)?)
    }

    /// Returns the place of a column name: in the header, or in the first row that has the column.
    fn head(&self, index: usize, column: &str) -> (&Line, Range<usize>) {
        let has_it = |row: &&ParamsRow| row.cells.get(index).is_some_and(Option::is_some);
        let line = match self.format {
            Format::Csv => &self.header,
            Format::Json => self
                .rows
                .iter()
                .find(has_it)
                .map_or(&self.header, |row| &row.line),
        };
        (line, self.place(line, index, column))
    }

    /// Returns the faults of a value that a row sets, at its place in the table.
    pub(crate) fn faults(
        &self,
        row: usize,
        setting: &Setting,
        faults: &[Diagnostic],
    ) -> TableFaults {
        let mut columns = self.columns.iter();
        let index = columns.position(|column| column == setting.path());
        let line = self.rows.get(row).map_or(&self.header, |row| &row.line);
        let column = setting.path();
        let range = self.place(line, index.unwrap_or_default(), column);
        let faults = faults.iter();
        let faults = faults.map(|fault| of_column(column, &range, fault));
        self.faults_of(line, faults.collect())
    }

    /// Returns the failure for a cell that no scene can use.
    pub(super) fn wrong(&self, line: &Line, column: &str, what: &str) -> Failure {
        let what = format!("column {column}: {what}");
        TableFaults::wrong(&self.path, line, self.text_of(line), &what)
    }

    fn faults_of(&self, line: &Line, diagnostics: Vec<Diagnostic>) -> TableFaults {
        TableFaults {
            file: self.path.display().to_string(),
            text: self.text_of(line).to_owned(),
            line: line.number,
            diagnostics,
        }
    }

    fn text_of(&self, line: &Line) -> &str {
        self.text.get(line.range.clone()).unwrap_or_default()
    }

    /// Returns the byte range of a cell in its line.
    fn place(&self, line: &Line, index: usize, column: &str) -> Range<usize> {
        let text = self.text_of(line);
        match self.format {
            Format::Csv => cell(text, index),
            Format::Json => {
                let key = serde_json::Value::from(column).to_string();
                text.find(&key)
                    .map_or(0..text.len(), |at| at..at + key.len())
            }
        }
    }
}

impl Columns {
    /// Returns true if an unused column is reported as an error.
    pub(crate) fn has_errors(&self) -> bool {
        let mut faults = self.unused.iter().flat_map(|unused| &unused.diagnostics);
        faults.any(|fault| fault.severity == Severity::Error)
    }

    /// Adds an unused column to the others of its line.
    fn add(&mut self, mut unused: TableFaults) {
        match self.unused.last_mut() {
            Some(last) if last.line == unused.line => {
                last.diagnostics.append(&mut unused.diagnostics);
            }
            _ => self.unused.push(unused),
        }
    }
}

/// Returns the fault of a setting at its place in the table.
fn of_column(column: &str, range: &Range<usize>, fault: &Diagnostic) -> Diagnostic {
    Diagnostic {
        range: range.clone(),
        message: format!("column `{column}`: {}", fault.message),
        labels: Vec::new(),
        ..fault.clone()
    }
}

fn unused(column: &str, range: Range<usize>, meant: Option<String>) -> Diagnostic {
    let message = format!(
        "column `{column}` is not used: it is neither a path into the scene nor a placeholder in a name"
    );
    Diagnostic::new(Code::UnusedColumn, range, message).with_help(match meant {
        Some(path) => format!("did you mean `{path}`?"),
        None => format!("put {{{column}}} into the names of the pictures to use it"),
    })
}

/// Returns the byte range of a cell in a CSV line, without surrounding space.
fn cell(line: &str, index: usize) -> Range<usize> {
    let mut is_quoted = false;
    let commas = line.bytes().enumerate().filter(|(_, byte)| {
        is_quoted ^= *byte == b'"';
        *byte == b',' && !is_quoted
    });
    let commas: Vec<usize> = commas.map(|(at, _)| at).collect();
    // The first line may start with a byte order mark.
    let first = line.len() - line.trim_start_matches('\u{feff}').len();
    let start = match index.checked_sub(1) {
        None => first,
        Some(before) => commas.get(before).map_or(line.len(), |comma| comma + 1),
    };
    let end = commas.get(index).copied().unwrap_or(line.len()).max(start);
    let cell = line.get(start..end).unwrap_or_default();
    let start = start + (cell.len() - cell.trim_start().len());
    start..start + cell.trim().len()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_are_found_in_their_lines() {
        let line = "\u{feff}id, \"a,b\" ,,70";
        let found = |index| &line[cell(line, index)];
        assert_eq!([0, 1, 2, 3, 4].map(found), ["id", "\"a,b\"", "", "70", ""]);
    }
}
