//! Places in a text as pages count them: lines and columns from 1, columns in UTF-16.

use std::ops::Range;

use serde::{Deserialize, Serialize};
use strahl::text::{Columns, Edit, Lines, Position};

#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(super) struct PagePlace {
    pub(super) line: usize,
    pub(super) column: usize,
}

impl PagePlace {
    pub(super) const fn at(line: usize, column: usize) -> Self {
        Self { line, column }
    }

    pub(super) fn new(lines: &Lines, offset: usize) -> Self {
        let Position { line, column } = lines.position_in(offset, Columns::Utf16);
        Self { line, column }
    }

    /// Returns the byte offset of the place.
    pub(super) fn offset(self, lines: &Lines) -> usize {
        let Self { line, column } = self;
        lines.offset(Position { line, column }, Columns::Utf16)
    }
}

/// A range of a text, end exclusive.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(super) struct PageSpan {
    pub(super) from: PagePlace,
    pub(super) to: PagePlace,
}

impl PageSpan {
    pub(super) fn new(lines: &Lines, range: &Range<usize>) -> Self {
        Self {
            from: PagePlace::new(lines, range.start),
            to: PagePlace::new(lines, range.end),
        }
    }
}

/// A range of a text and its replacement. Its lines end with LF, whatever those of the file.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct PlacedEdit {
    #[serde(flatten)]
    span: PageSpan,
    text: String,
}

impl PlacedEdit {
    pub(super) fn new(lines: &Lines, edit: &Edit) -> Self {
        Self {
            span: PageSpan::new(lines, &edit.range),
            text: shown(&edit.text),
        }
    }

    /// Returns the edit in a text, with the line ends of that text.
    pub(super) fn in_text(&self, lines: &Lines, text: &str) -> Edit {
        let PageSpan { from, to } = self.span;
        let end = to.offset(lines);
        Edit {
            range: from.offset(lines).min(end)..end,
            text: match text.contains("\r\n") {
                true => self.text.replace('\n', "\r\n"),
                false => self.text.clone(),
            },
        }
    }
}

/// Returns a text as pages show it: without a byte order mark, and with LF at the end of lines.
pub(super) fn shown(text: &str) -> String {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    text.replace("\r\n", "\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_edit_of_a_page_keeps_line_ends_and_counts_utf_16() {
        let text = "\u{feff}( // \u{1f642} a\r\n  b,\r\n)";
        assert_eq!(shown(text), "( // \u{1f642} a\n  b,\n)");
        let edit =
            r#"{"from": {"line": 1, "column": 9}, "to": {"line": 2, "column": 4}, "text": "c\nd"}"#;
        let edit: PlacedEdit = serde_json::from_str(edit).unwrap();
        let Edit { range, text: new } = edit.in_text(&Lines::new(text), text);
        assert_eq!((&text[range], &*new), ("a\r\n  b", "c\r\nd"));
    }
}
