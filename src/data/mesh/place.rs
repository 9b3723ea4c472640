//! Places in a mesh file.

use std::fmt;

use crate::data::fault::{At, Fault};

/// A line or a byte of a file, and the row of an element that is there.
#[derive(Clone, Copy, Debug)]
pub(super) struct FilePlace {
    row: Option<(&'static str, usize)>,
    spot: Spot,
}

#[derive(Clone, Copy, Debug)]
enum Spot {
    Line(u64),
    Byte(u64),
}

impl FilePlace {
    pub(super) const fn line(line: u64) -> Self {
        let (row, spot) = (None, Spot::Line(line));
        Self { row, spot }
    }

    pub(super) const fn byte(byte: u64) -> Self {
        let (row, spot) = (None, Spot::Byte(byte));
        Self { row, spot }
    }

    /// Names the row of an element that is at the place.
    pub(super) const fn row(self, element: &'static str, row: usize) -> Self {
        let (row, spot) = (Some((element, row)), self.spot);
        Self { row, spot }
    }

    /// Returns the line, if the file is a text.
    pub(super) const fn text_line(self) -> Option<u64> {
        match self.spot {
            Spot::Line(line) => Some(line),
            Spot::Byte(_) => None,
        }
    }

    /// Returns the place as that of a fault.
    pub(super) fn at(self) -> At {
        At::new(self.to_string(), self.text_line())
    }

    /// Creates a fault at this place.
    pub(super) fn fault(self, what: impl fmt::Display) -> Fault {
        self.at().fault(what)
    }
}

impl fmt::Display for Spot {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Line(line) => write!(f, "line {line}"),
            Self::Byte(byte) => write!(f, "byte {byte}"),
        }
    }
}

impl fmt::Display for FilePlace {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let spot = self.spot;
        match self.row {
            Some((element, row)) => write!(f, "{element} {row} ({spot})"),
            None => write!(f, "{spot}"),
        }
    }
}
