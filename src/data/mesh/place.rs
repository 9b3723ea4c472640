//! Places in a mesh file.

use std::fmt;

use crate::data::fault::{At, Fault};

/// A line or a byte of a file, and the row of an element that is there.
#[derive(Clone, Copy, Debug)]
pub(super) struct FilePlace {
    row: Option<(&'static str, usize)>,
    is_line: bool,
    number: u64,
}

impl FilePlace {
    pub(super) const fn line(number: u64) -> Self {
        Self {
            row: None,
            is_line: true,
            number,
        }
    }

    pub(super) const fn byte(number: u64) -> Self {
        Self {
            is_line: false,
            ..Self::line(number)
        }
    }

    /// Names the row of an element that is at the place.
    pub(super) const fn row(mut self, element: &'static str, row: usize) -> Self {
        self.row = Some((element, row));
        self
    }

    /// Returns the line, if the file is a text.
    pub(super) fn text_line(self) -> Option<u64> {
        self.is_line.then_some(self.number)
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

impl fmt::Display for FilePlace {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (spot, number) = (if self.is_line { "line" } else { "byte" }, self.number);
        match self.row {
            Some((element, row)) => write!(f, "{element} {row} ({spot} {number})"),
            None => write!(f, "{spot} {number}"),
        }
    }
}
