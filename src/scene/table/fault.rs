//! What is wrong with a table, and which field of the scene is at fault.

use std::io;

use crate::{
    diagnostic::{Code, Severity, path::Path},
    text::nearest::{list, quote},
};

/// The reason why a table cannot be read.
#[derive(Debug)]
pub(crate) enum ReadError {
    /// An error of the disk.
    Io(io::Error),
    /// A fault in the file.
    Invalid(Fault),
}

/// A fault of a table: one line, lower case, without a full stop.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Fault {
    pub(crate) message: String,
    pub(crate) help: Option<String>,
    /// The field of the scene that is at fault.
    pub(crate) blamed: Blamed,
}

/// A field of a geometry that names a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Blamed {
    File,
    Columns,
    Array,
    /// The column whose values determine the colors.
    Value,
}

impl Blamed {
    /// Returns the path of the field, given that of the geometry.
    pub(crate) fn path_in(self, variant: &Path) -> Path {
        match self {
            Self::File => variant.field("file"),
            Self::Columns => variant.field("columns"),
            Self::Array => variant.field("array"),
            Self::Value => variant.field("color_by").field("column"),
        }
    }
}

impl Fault {
    pub(crate) fn new(message: impl Into<String>) -> Self {
        Self {
            message: message.into(),
            help: None,
            blamed: Blamed::File,
        }
    }

    pub(super) const fn at(mut self, blamed: Blamed) -> Self {
        self.blamed = blamed;
        self
    }

    /// Blames the choice of a column whose values are not numbers; `others` are those to choose from.
    pub(crate) fn blame_value(self, others: &[&str]) -> Self {
        let help = format!("choose another column: {}", list(others));
        self.help(help).at(Blamed::Value)
    }

    pub(crate) fn help(mut self, help: impl Into<String>) -> Self {
        self.help = Some(help.into());
        self
    }
}

/// A fault in a row of a text, found before its numbers are checked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Wrong {
    Length,
    Empty,
    Number,
    Color,
    Element,
    /// A kind of atom that is not an element, which is drawn all the same.
    Kind,
    /// A line that resembles a record.
    Record,
    End,
}

impl Wrong {
    const fn code(self) -> Code {
        match self {
            Self::Kind => Code::UnknownElement,
            Self::Length
            | Self::Empty
            | Self::Number
            | Self::Color
            | Self::Element
            | Self::Record
            | Self::End => Code::InvalidTable,
        }
    }

    /// The largest number of rows that are listed for such a fault in a column. A warning names one.
    pub(super) const fn most_listed(self) -> usize {
        match self.code().severity() {
            Severity::Error => MOST_LISTED,
            Severity::Warning => 1,
        }
    }
}

/// The largest number of rows that are listed for a fault in a column.
pub(super) const MOST_LISTED: usize = 100;

/// Rows that have the same fault in the same column.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct BadRows {
    pub(super) wrong: Wrong,
    pub(super) column: String,
    /// The first row, followed by its fault.
    pub(crate) row: usize,
    /// The number of such rows that are listed before.
    pub(super) before: usize,
    pub(crate) fault: Fault,
    /// The number of rows, this one included: of those that are not listed on their own.
    pub(crate) count: usize,
}

impl BadRows {
    pub(crate) const fn code(&self) -> Code {
        self.wrong.code()
    }

    /// Returns true if the table must not be used.
    pub(crate) const fn is_error(&self) -> bool {
        matches!(self.code().severity(), Severity::Error)
    }
}

impl From<io::Error> for ReadError {
    fn from(error: io::Error) -> Self {
        Self::Io(error)
    }
}

impl From<Fault> for ReadError {
    fn from(fault: Fault) -> Self {
        Self::Invalid(fault)
    }
}

/// Formats the place of a row for the start of a message. Rows count from 0, as every index does;
/// lines of a text from 1, as in editors.
pub(crate) fn row(row: usize, line: Option<u64>) -> String {
    let line = line.map_or_else(String::new, |line| format!(" (line {line})"));
    format!("row {row}{line}")
}

/// The same for a cell.
pub(crate) fn cell(index: usize, line: Option<u64>, column: &str) -> String {
    format!("{}, column {}", row(index, line), quote(column))
}
