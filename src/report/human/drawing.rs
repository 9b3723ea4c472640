//! The few lines around a place, ready to be drawn.

use std::{borrow::Cow, ops::Range};

use crate::{
    report::excerpt::{Tail, fit, has_no_width, width},
    text::lines::Lines,
};

/// The maximum distance in lines within a drawing. A place farther away is shown separately; of a
/// longer range, only the first line.
const NEAR: usize = 50;

/// An offset as a line number, from 1, and the number of bytes before it in that line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct LineOffset {
    pub(super) line: usize,
    pub(super) at: usize,
}

impl LineOffset {
    fn new(text: &str, lines: &Lines<'_>, offset: usize) -> Self {
        let mut offset = offset.min(text.len());
        while !text.is_char_boundary(offset) {
            offset -= 1;
        }
        let line = lines.position(offset).line;
        let before = text.get(..offset).unwrap_or("");
        // The first line starts after a byte order mark.
        let bom = if text.starts_with('\u{feff}') { 3 } else { 0 };
        let start = before.rfind('\n').map_or(bom, |at| at + 1);
        let at = offset.saturating_sub(start).min(lines.text(line).len());
        Self { line, at }
    }
}

/// A range to underline.
#[derive(Clone, Debug)]
pub(super) struct Mark<'a> {
    pub(super) from: LineOffset,
    pub(super) to: LineOffset,
    /// The text next to the mark; the first mark of a drawing has none.
    pub(super) label: Option<Cow<'a, str>>,
}

impl<'a> Mark<'a> {
    pub(super) fn new(
        text: &str,
        lines: &Lines<'_>,
        range: &Range<usize>,
        label: Option<Cow<'a, str>>,
    ) -> Self {
        let from = LineOffset::new(text, lines, range.start);
        let mut to = if range.end > range.start {
            LineOffset::new(text, lines, range.end)
        } else {
            from
        };
        if to.line - from.line > NEAR {
            to = end_of(lines, from.line);
        } else if to.at == 0 && to.line > from.line {
            // The range ends with a line break and does not reach into the next line.
            to = end_of(lines, to.line - 1);
        }
        Self { from, to, label }
    }

    /// Returns true if both fit into one drawing.
    pub(super) fn is_near(&self, other: &Self) -> bool {
        let first = self.from.line.min(other.from.line);
        let last = self.to.line.max(other.to.line);
        last - first <= NEAR
    }

    fn is_on(&self, line: usize) -> bool {
        self.from.line == line || self.to.line == line
    }
}

fn end_of(lines: &Lines<'_>, line: usize) -> LineOffset {
    let at = lines.text(line).len();
    LineOffset { line, at }
}

/// Lines cut to the width, with their marks.
pub(super) struct Drawing<'a> {
    /// The lines, each with its line break.
    pub(super) source: String,
    /// The number of the first line.
    pub(super) first: usize,
    /// The marks, the most important one first.
    pub(super) marks: Vec<Mark<'a>>,
    /// The range of each mark in `source`; never empty.
    pub(super) spans: Vec<Range<usize>>,
    /// True if a line of the first mark is cut.
    pub(super) cut: bool,
    last: usize,
}

/// All marks but one, and the one that has no room; `None` if the first mark has none.
type WithoutRoom<'a> = (Vec<Mark<'a>>, Option<Mark<'a>>);

impl<'a> Drawing<'a> {
    /// Creates a drawing of the marks.
    ///
    /// # Errors
    ///
    /// Returns the marks if there is not enough room for all of them.
    pub(super) fn new(
        lines: &Lines<'_>,
        mut marks: Vec<Mark<'a>>,
        columns: usize,
    ) -> Result<Self, WithoutRoom<'a>> {
        let first = marks.iter().map(|mark| mark.from.line).min().unwrap_or(1);
        let last = marks.iter().map(|mark| mark.to.line).max().unwrap_or(first);
        let mut drawing = Self {
            source: String::new(),
            first,
            spans: vec![0..0; marks.len()],
            cut: false,
            last,
            marks: Vec::new(),
        };
        // To the left of the lines are their numbers, ` | `, and a bar for each mark that spans
        // lines.
        let spanning = marks
            .iter()
            .filter(|mark| mark.from.line < mark.to.line)
            .count();
        let bars = if spanning == 0 { 0 } else { spanning + 1 };
        let room = columns.saturating_sub(drawing.digits() + 3 + bars);
        for line in first..=last {
            if !drawing.push(lines.text(line), line, &marks, room) {
                let index = marks.iter().rposition(|mark| mark.is_on(line));
                let without_room = index
                    .filter(|index| *index > 0)
                    .map(|index| marks.remove(index));
                return Err((marks, without_room));
            }
        }
        drawing.marks = marks;
        Ok(drawing)
    }

    /// Adds a line; returns false if its marks have no room.
    fn push(&mut self, text: &str, line: usize, marks: &[Mark<'_>], room: usize) -> bool {
        let mut points = Vec::new();
        let mut tails: Vec<Tail> = Vec::new();
        for mark in marks {
            if mark.from.line == line {
                // A mark that continues below has its first column drawn even if the line ends.
                tails.extend((mark.to.line > line).then_some((points.len(), 1)));
                points.push(mark.from.at);
            }
            if mark.to.line == line {
                let label = mark.label.as_ref().map_or(0, |label| width(label) + 1);
                // A mark without width is drawn under the next character, up to two columns.
                let marked = text
                    .get(mark.from.at..mark.to.at)
                    .filter(|_| mark.from.line == line);
                let itself = if marked.is_some_and(has_no_width) {
                    2
                } else {
                    0
                };
                tails.push((points.len(), itself + label));
                points.push(mark.to.at);
            }
        }
        let Some(excerpt) = fit(text, &points, &tails, room) else {
            return false;
        };
        self.cut |= excerpt.cut && marks.first().is_some_and(|mark| mark.is_on(line));
        let start = self.source.len();
        let mut shown = excerpt.points.iter().map(|at| start + at);
        self.source.push_str(&excerpt.text);
        let mut beyond = false;
        for (mark, span) in marks.iter().zip(&mut self.spans) {
            if mark.from.line == line {
                span.start = shown.next().unwrap_or(start);
            }
            if mark.to.line == line {
                span.end = shown.next().unwrap_or(start);
                // An empty span is drawn as a mark under the next character. An explicit range
                // keeps the crate from taking the start of a line for the end of the one before.
                if span.end <= span.start || span.end == start {
                    let next = self
                        .source
                        .get(span.end..)
                        .and_then(|rest| rest.chars().next());
                    beyond |= next.is_none();
                    span.end += next.map_or(1, char::len_utf8);
                }
            }
        }
        if beyond {
            self.source.push(' ');
        }
        // The last line needs it too: without a line break the crate would not see an empty one.
        self.source.push('\n');
        true
    }

    /// Returns the width of the line-number column.
    pub(super) fn digits(&self) -> usize {
        self.last.max(1).ilog10() as usize + 1
    }
}
