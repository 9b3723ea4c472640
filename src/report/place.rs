//! A byte range as people count it.

use std::ops::Range;

use crate::lines::{Lines, Position};

/// Where a range starts and ends; the end is exclusive.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Place {
    pub(super) start: Position,
    pub(super) end: Position,
}

impl Place {
    pub(super) fn new(lines: &Lines<'_>, range: &Range<usize>) -> Self {
        let start = lines.position(range.start);
        // Most ranges are short or empty, and finding a column costs the length of the line.
        let end = if range.end <= range.start {
            start
        } else {
            lines.position(range.end)
        };
        Self { start, end }
    }

    /// The last line that the range reaches into: one that ends with a line break does not
    /// reach into the next line.
    pub(super) const fn last_line(self) -> usize {
        if self.end.column == 1 && self.end.line > self.start.line {
            self.end.line - 1
        } else {
            self.end.line
        }
    }
}
