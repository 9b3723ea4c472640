//! What is wrong with a table or a mesh, where, and which field of the scene is at fault.

use std::{fmt::Display, io, ops::Range};

use crate::{
    diagnostic::{Code, Severity},
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
    /// The place in the file, if the file is a text.
    pub(crate) spot: Option<Spot>,
}

/// A place in a text.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Spot {
    /// The number of the line, from 1.
    pub(crate) line: u64,
    pub(crate) part: LinePart,
}

/// A part of a line. One that is not found, or found twice, is all of the line.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum LinePart {
    All,
    /// Bytes of the line, end exclusive.
    Bytes(Range<usize>),
    /// One of this many cells.
    Cell {
        at: usize,
        of: usize,
    },
    Word(String),
    Number(f64),
}

/// The place of a fault: in words, and in the text if the file is one.
pub(crate) struct At {
    words: String,
    spot: Option<Spot>,
}

impl At {
    /// Creates a place in a line of a text.
    pub(crate) fn new(words: impl Into<String>, line: impl Into<Option<u64>>) -> Self {
        let part = LinePart::All;
        Self {
            words: words.into(),
            spot: line.into().map(|line| Spot { line, part }),
        }
    }

    /// Creates the place of a line that is not a row.
    pub(crate) fn line(line: u64) -> Self {
        Self::new(format!("line {line}"), line)
    }

    /// Creates the place of a row. Rows count from 0, as every index does; lines of a text from 1, as in
    /// editors.
    pub(crate) fn row(row: impl Display, line: Option<u64>) -> Self {
        let in_text = line.map_or_else(String::new, |line| format!(" (line {line})"));
        Self::new(format!("row {row}{in_text}"), line)
    }

    /// Creates the place of a cell.
    pub(crate) fn cell(row: usize, line: Option<u64>, column: &str) -> Self {
        Self::row(row, line).in_column(column)
    }

    /// Names the column.
    pub(crate) fn in_column(mut self, column: &str) -> Self {
        self.words += &format!(", column {}", quote(column));
        self
    }

    /// Narrows the place down to a part of the line.
    pub(crate) fn part(mut self, part: LinePart) -> Self {
        if let Some(spot) = &mut self.spot {
            spot.part = part;
        }
        self
    }

    /// Narrows the place down to a word, if it is in the line only once.
    pub(crate) fn word(self, word: impl Into<String>) -> Self {
        self.part(LinePart::Word(word.into()))
    }

    /// Creates a fault at this place.
    pub(crate) fn fault(self, what: impl Display) -> Fault {
        Fault {
            spot: self.spot,
            ..Fault::new(format!("{}: {what}", self.words))
        }
    }
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

impl Fault {
    pub(crate) fn new(message: impl Into<String>) -> Self {
        Self {
            message: message.into(),
            help: None,
            blamed: Blamed::File,
            spot: None,
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

    /// The largest number of rows that are listed for such a fault in a column.
    pub(super) const fn most_listed(self) -> usize {
        most_listed(self.is_error())
    }

    const fn is_error(self) -> bool {
        matches!(self.code().severity(), Severity::Error)
    }
}

/// Returns the largest number of places that are listed for a fault. A warning does not stop the work,
/// so it must not fill the terminal.
pub(crate) const fn most_listed(is_error: bool) -> usize {
    match is_error {
        true => 100,
        false => 10,
    }
}

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
        self.wrong.is_error()
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
