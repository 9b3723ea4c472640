//! Converts byte offsets to the lines and columns that people and editors count.

use std::{borrow::Cow, cell::Cell, ops::Range};

/// A position in a text, in lines and columns.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Position {
    /// The line number, starting at 1.
    pub line: usize,
    /// The column, starting at 1, in Unicode scalar values by default; a tab counts as one, and so
    /// does an emoji.
    pub column: usize,
}

/// The unit of columns.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Columns {
    /// Unicode scalar values, the way people count characters.
    Characters,
    /// UTF-16 code units, as in most editors and the Language Server Protocol.
    Utf16,
    /// UTF-8 bytes.
    Bytes,
}

impl Columns {
    fn count(self, text: &str) -> usize {
        match self {
            Self::Characters => text.chars().count(),
            Self::Utf16 => text.chars().map(char::len_utf16).sum(),
            Self::Bytes => text.len(),
        }
    }

    const fn width(self, character: char) -> usize {
        match self {
            Self::Characters => 1,
            Self::Utf16 => character.len_utf16(),
            Self::Bytes => character.len_utf8(),
        }
    }
}

/// The start offsets of the lines of a text.
///
/// Lines end with LF or CRLF. A byte order mark at the start is not counted.
#[derive(Clone, Debug)]
pub struct Lines<'a> {
    text: &'a str,
    starts: Cow<'a, [usize]>,
    /// Number of lines before the text.
    before: usize,
    /// The last offset looked up and its position. A later offset on the same line is counted from
    /// here, since one line may be the whole file.
    last: Cell<(usize, Position, Columns)>,
}

impl<'a> Lines<'a> {
    /// Finds the lines of `text` in one pass.
    pub fn new(text: &'a str) -> Self {
        Self::after(0, text)
    }

    /// Like [`new`](Self::new), with `before` lines in front of the text that count in line
    /// numbers.
    pub fn after(before: usize, text: &'a str) -> Self {
        let first = if text.starts_with('\u{feff}') {
            '\u{feff}'.len_utf8()
        } else {
            0
        };
        let ends = text.bytes().enumerate().filter(|(_, byte)| *byte == b'\n');
        let starts = std::iter::once(first).chain(ends.map(|(at, _)| at + 1));
        Self::with_starts(text, Cow::Owned(starts.collect()), before)
    }

    /// The lines of a text whose starts are known.
    pub(crate) fn with_starts(text: &'a str, starts: Cow<'a, [usize]>, before: usize) -> Self {
        let first = starts.first().copied().unwrap_or_default();
        let position = Position { line: 1, column: 1 };
        Self {
            text,
            starts,
            before,
            last: Cell::new((first, position, Columns::Characters)),
        }
    }

    /// Returns the position of a byte offset; an offset inside a character or past the end is
    /// rounded down to the nearest character boundary.
    pub fn position(&self, offset: usize) -> Position {
        self.position_in(offset, Columns::Characters)
    }

    /// Returns the position of a byte offset, with the column in the given unit.
    ///
    /// # Examples
    ///
    /// ```
    /// use strahl::text::{Columns, Lines};
    ///
    /// let lines = Lines::new("a: 1,\n\"🙂\": 2");
    /// let place = lines.position_in(12, Columns::Utf16);
    /// assert_eq!((place.line, place.column), (2, 5));
    /// assert_eq!(lines.offset(place, Columns::Utf16), 12);
    /// ```
    pub fn position_in(&self, offset: usize, columns: Columns) -> Position {
        let line = self.starts.partition_point(|start| *start <= offset).max(1) - 1;
        let start = self.starts.get(line).copied().unwrap_or(0);
        let end = floor_char_boundary(self.text, offset).max(start);
        let (known, last, unit) = self.last.get();
        let is_near = last.line == line + 1 && unit == columns && (start..=end).contains(&known);
        let (from, before) = if is_near {
            (known, last.column)
        } else {
            (start, 1)
        };
        let between = self.text.get(from..end).unwrap_or_default();
        let position = Position {
            line: line + 1,
            column: before + columns.count(between),
        };
        self.last.set((end, position, columns));
        Position {
            line: position.line + self.before,
            ..position
        }
    }

    /// Returns the byte offset of a position. A column past the end of its line gives the end of
    /// the line; a line that does not exist gives the end of the text.
    pub fn offset(&self, position: Position, columns: Columns) -> usize {
        let Some(start) = self.start(position.line) else {
            return self.text.len();
        };
        let line = self.text(position.line);
        let mut before = 1;
        let behind = line.char_indices().find(|(_, character)| {
            before += columns.width(*character);
            before > position.column
        });
        start + behind.map_or(line.len(), |(at, _)| at)
    }

    /// Returns the start offset of a line.
    fn start(&self, line: usize) -> Option<usize> {
        let index = line.checked_sub(self.before + 1)?;
        self.starts.get(index).copied()
    }

    /// Returns the text of a line, counted from 1, without its line break; empty if there is no
    /// such line.
    pub fn text(&self, line: usize) -> &'a str {
        let Some(start) = self.start(line) else {
            return "";
        };
        let end = self.start(line + 1).unwrap_or(self.text.len());
        let text = self.text.get(start..end).unwrap_or("");
        let text = text.strip_suffix('\n').unwrap_or(text);
        text.strip_suffix('\r').unwrap_or(text)
    }
}

/// The start and the exclusive end of a range.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct LineRange {
    pub(crate) start: Position,
    pub(crate) end: Position,
}

impl LineRange {
    pub(crate) fn new(lines: &Lines<'_>, range: &Range<usize>) -> Self {
        let start = lines.position(range.start);
        // Most ranges are short or empty, and finding a column takes time linear in the line
        // length.
        let end = if range.end <= range.start {
            start
        } else {
            lines.position(range.end)
        };
        Self { start, end }
    }

    /// Returns the last line of the range; a range that ends with a line break does not extend to
    /// the next line.
    pub(crate) const fn last_line(self) -> usize {
        if self.end.column == 1 && self.end.line > self.start.line {
            self.end.line - 1
        } else {
            self.end.line
        }
    }
}

fn floor_char_boundary(text: &str, offset: usize) -> usize {
    let mut offset = offset.min(text.len());
    while !text.is_char_boundary(offset) {
        offset -= 1;
    }
    offset
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(text: &str, offset: usize) -> (usize, usize) {
        let position = Lines::new(text).position(offset);
        (position.line, position.column)
    }

    #[test]
    fn columns_count_characters() {
        assert_eq!(at("a\tb", 2), (1, 3));
        assert_eq!(at("日本x", 6), (1, 3));
        assert_eq!(at("🙂x", 4), (1, 2));
        assert_eq!(at("🙂x", 2), (1, 1), "inside of a character");
    }

    #[test]
    fn columns_count_in_other_units() {
        let text = "\u{feff}é🙂x\r\n日";
        let lines = Lines::new(text);
        let all = [Columns::Characters, Columns::Utf16, Columns::Bytes];
        let columns = |offset| all.map(|unit| lines.position_in(offset, unit).column);
        let x = text.find('x').unwrap();
        assert_eq!(columns(x), [3, 4, 7]);
        assert_eq!(columns(text.len()), [2, 2, 4]);
        for unit in all {
            for (offset, _) in text.char_indices().skip(1).filter(|(_, c)| *c != '\n') {
                assert_eq!(lines.offset(lines.position_in(offset, unit), unit), offset);
            }
            let at = |line, column| lines.offset(Position { line, column }, unit);
            assert_eq!(
                (at(1, 99), at(2, 99), at(3, 1)),
                (x + 1, text.len(), text.len())
            );
            assert_eq!(at(0, 1), text.len());
        }
        // Between the two units of a surrogate pair, the offset is that of the character.
        let inside = Position { line: 1, column: 3 };
        assert_eq!(
            lines.offset(inside, Columns::Utf16),
            text.find('🙂').unwrap()
        );
    }

    #[test]
    fn lines_end_with_lf_or_crlf() {
        assert_eq!(at("a\nb\r\nc", 0), (1, 1));
        assert_eq!(at("a\nb\r\nc", 2), (2, 1));
        assert_eq!(at("a\nb\r\nc", 5), (3, 1));
        assert_eq!(Lines::new("a\nb\r\nc").text(2), "b");
        assert_eq!(Lines::new("a\nb\r\nc").text(3), "c");
        assert_eq!(Lines::new("a\n").text(3), "");
    }

    #[test]
    fn a_byte_order_mark_is_not_counted() {
        assert_eq!(at("\u{feff}ab", 3), (1, 1));
        assert_eq!(at("\u{feff}ab", 4), (1, 2));
        assert_eq!(at("\u{feff}ab", 0), (1, 1));
    }

    #[test]
    fn positions_on_one_line_can_be_looked_up_in_any_order() {
        let lines = Lines::new("aé日\nb🙂c");
        let columns = |offsets: &[usize]| -> Vec<_> {
            let places = offsets.iter().map(|offset| lines.position(*offset));
            places.map(|place| (place.line, place.column)).collect()
        };
        assert_eq!(
            columns(&[1, 3, 6, 3, 0]),
            [(1, 2), (1, 3), (1, 4), (1, 3), (1, 1)]
        );
        assert_eq!(
            columns(&[8, 12, 8, 3, 13]),
            [(2, 2), (2, 3), (2, 2), (1, 3), (2, 4)]
        );
    }

    #[test]
    fn lines_before_the_text_are_counted() {
        let lines = Lines::after(6, "a\nbc");
        assert_eq!(lines.position(3), Position { line: 8, column: 2 });
        assert_eq!(lines.position(2), Position { line: 8, column: 1 });
        assert_eq!(
            (lines.text(8), lines.text(6), lines.text(9)),
            ("bc", "", "")
        );
    }

    #[test]
    fn an_offset_past_the_end_is_the_end() {
        assert_eq!(at("ab", 9), (1, 3));
        assert_eq!(at("", 0), (1, 1));
    }
}
