//! The start of a text table: comments, the header, and what separates the columns.

use crate::{
    data::{bytes::BYTE_ORDER_MARK, fault::Fault},
    tracer::color::Color,
};

/// What separates the columns.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Separator {
    Comma,
    Tab,
    /// One or more blanks.
    Blanks,
}

/// The part of a text before its records.
#[derive(Debug, PartialEq)]
pub(super) struct Opening {
    /// The start of the header, or of the records if there is none.
    pub(super) start: usize,
    /// The end of the line of the header; `None` if the scene names the columns.
    pub(super) header: Option<usize>,
    /// What separates the names, and the cells of the records.
    pub(super) separators: [Separator; 2],
    /// True if lines end with CR alone.
    pub(super) is_mac: bool,
    /// The start of the records, if the header is one line.
    pub(super) records: usize,
}

/// A line with its place and the start of the next one.
#[derive(Clone, Copy)]
struct Line<'a> {
    start: usize,
    text: &'a [u8],
    next: usize,
}

impl Opening {
    /// Returns the opening of a text; `None` if more of the text is needed. `is_all` is true for a
    /// whole file, and `has_names` if the scene names the columns.
    pub(super) fn of(text: &[u8], is_all: bool, has_names: bool) -> Option<Self> {
        let mark = text.starts_with(BYTE_ORDER_MARK);
        let mut at = if mark { BYTE_ORDER_MARK.len() } else { 0 };
        let (mut given, mut first, mut second) = (None, None, None);
        let mut comments = Vec::new();
        while second.is_none() && at < text.len() {
            let line = line_at(text, at, is_all)?;
            at = line.next;
            let trimmed = line.text.trim_ascii();
            if trimmed.is_empty() {
                continue;
            }
            match (first, separator_line(trimmed), comment(trimmed, has_names)) {
                (None, Some(found), _) if given.is_none() && comments.is_empty() => {
                    given = Some(found);
                }
                (None, _, Some(_)) => comments.push(line),
                (None, _, None) => first = Some(line),
                (Some(_), ..) => second = Some(line),
            }
        }
        if second.is_none() && !is_all {
            return None;
        }
        let end = text.len();
        let nothing = Line {
            start: at.min(end),
            text: &[],
            next: end,
        };
        let is_mac = text
            .iter()
            .position(|byte| matches!(byte, b'\r' | b'\n'))
            .and_then(|at| text.get(at..at + 2))
            .is_some_and(|two| matches!(two, [b'\r', after] if *after != b'\n'));
        let opening = |start, header: Option<Line>, record: Line, records| {
            let separators = [header.unwrap_or(record), record];
            Self {
                start,
                header: header.map(|line| line.start + line.text.len()),
                separators: separators.map(|line| given.unwrap_or_else(|| separator(line.text))),
                is_mac,
                records,
            }
        };
        let Some(row) = first else {
            // Only comments, of which the last may be a header.
            return Some(match comments.last().filter(|_| !has_names) {
                Some(line) => opening(behind_mark(line), Some(*line), nothing, line.next),
                None => opening(nothing.start, None, nothing, nothing.start),
            });
        };
        let cells = words(row.text);
        let is_row = cells.iter().any(|cell| is_number(cell));
        if has_names {
            return Some(match second {
                // No cell is a number: the file has a header, which the scene replaces.
                Some(second) if !is_row && !cells.is_empty() => {
                    opening(second.start, None, second, second.start)
                }
                _ => opening(row.start, None, row, row.start),
            });
        }
        let is_header = |line: &&Line| words(line_behind_mark(line)).len() == cells.len();
        let in_comment = comments.iter().rev().find(is_header).filter(|_| is_row);
        Some(match in_comment {
            Some(line) => opening(behind_mark(line), Some(*line), row, row.start),
            None => opening(row.start, Some(row), second.unwrap_or(nothing), row.next),
        })
    }

    /// Rejects commas in rows below names that are separated otherwise, unless there are as many of them
    /// as names need.
    pub(super) fn check_commas(&self, names: usize, rows: &[u8]) -> Result<(), Fault> {
        let row = rows.split(|byte| matches!(byte, b'\n' | b'\r')).next();
        let row = row.unwrap_or_default();
        let cells = row.split(|byte| *byte == b',').count();
        if self.separators[1] != Separator::Comma || cells == names || row.is_empty() {
            return Ok(());
        }
        let fault =
            Fault::new("there are commas in the rows, but not between the names of the columns");
        Err(fault.help("write decimals with points, or commas between the names"))
    }
}

/// Returns the line at an offset, if it is complete.
fn line_at(text: &[u8], start: usize, is_all: bool) -> Option<Line<'_>> {
    let rest = text.get(start..)?;
    let end = rest.iter().position(|byte| matches!(byte, b'\n' | b'\r'));
    let (length, behind) = match end {
        Some(end) => match rest.get(end..end + 2) {
            Some(b"\r\n") => (end, 2),
            Some(_) => (end, 1),
            None if is_all || rest.get(end) == Some(&b'\n') => (end, 1),
            None => return None,
        },
        None if is_all => (rest.len(), 0),
        None => return None,
    };
    Some(Line {
        start,
        text: rest.get(..length)?,
        next: start + length + behind,
    })
}

/// Returns the separator that a line such as `sep=,` names, as Excel reads and writes it.
fn separator_line(line: &[u8]) -> Option<Separator> {
    let line = line.strip_prefix(b"\"").unwrap_or(line);
    let (key, value) = line.split_at_checked(4)?;
    if !key.eq_ignore_ascii_case(b"sep=") {
        return None;
    }
    match value.strip_suffix(b"\"").unwrap_or(value) {
        // A tab is trimmed from the end of the line.
        [] | b"\t" => Some(Separator::Tab),
        [_] => Some(Separator::Comma),
        _ => None,
    }
}

/// Returns the text of a comment: a line that begins with `#` or `//`, but not with a color.
fn comment(line: &[u8], may_be_row: bool) -> Option<&[u8]> {
    let rest = line.strip_prefix(b"#").or(line.strip_prefix(b"//"))?;
    let cell = line
        .split(|byte| matches!(byte, b',' | b'\t' | b' '))
        .next();
    let cell = str::from_utf8(cell.unwrap_or_default());
    let is_color = may_be_row && cell.is_ok_and(|cell| Color::parse_hex(cell).is_some());
    (!is_color).then(|| rest.trim_ascii_start())
}

fn line_behind_mark<'a>(line: &Line<'a>) -> &'a [u8] {
    comment(line.text.trim_ascii(), false).unwrap_or_default()
}

/// Returns the offset of the text behind the mark of a comment.
fn behind_mark(line: &Line) -> usize {
    let trimmed = line.text.trim_ascii_end();
    line.start + trimmed.len() - line_behind_mark(line).len()
}

/// Returns what separates the columns in a line.
fn separator(line: &[u8]) -> Separator {
    if line.iter().any(|byte| matches!(byte, b',' | b';' | b'|')) {
        Separator::Comma
    } else if line.trim_ascii().contains(&b'\t') {
        Separator::Tab
    } else if line.trim_ascii().contains(&b' ') {
        Separator::Blanks
    } else {
        Separator::Comma
    }
}

/// Returns the cells of a line, roughly: a unit in brackets belongs to the name before it.
fn words(line: &[u8]) -> Vec<&[u8]> {
    let all = line.split(|byte| matches!(byte, b',' | b';' | b'\t' | b' '));
    let is_cell = |word: &&[u8]| !matches!(word, [] | [b'[' | b'(', ..]);
    all.filter(is_cell).collect()
}

fn is_number(cell: &[u8]) -> bool {
    str::from_utf8(cell).is_ok_and(|cell| cell.parse::<f64>().is_ok())
}

/// Returns the names in a header whose columns are not separated by commas.
pub(super) fn names(header: &str, separator: Separator) -> Vec<String> {
    let name = |name: &str| name.trim().trim_matches('"').to_owned();
    if separator == Separator::Tab {
        return header.split('\t').map(name).collect();
    }
    let mut all: Vec<String> = Vec::new();
    for word in header.split_ascii_whitespace() {
        match all.last_mut() {
            // A unit belongs to the name before it.
            Some(last) if word.starts_with(['[', '(']) => {
                last.push(' ');
                last.push_str(word);
            }
            _ => all.push(name(word)),
        }
    }
    all
}

/// Returns the usual name of a column: of coordinates and sizes, units in brackets and capitals do not
/// count, and ParaView calls the coordinates `Points:0` to `Points:2`.
pub(super) fn usual_name(name: &str) -> Option<&'static str> {
    const SIZES: [&str; 11] = [
        "x", "y", "z", "x1", "y1", "z1", "x2", "y2", "z2", "radius", "scale",
    ];
    let bare = name.split(['[', '(']).next().unwrap_or_default().trim();
    match bare {
        "Points:0" | "Points_0" => Some("x"),
        "Points:1" | "Points_1" => Some("y"),
        "Points:2" | "Points_2" => Some("z"),
        _ => SIZES
            .into_iter()
            .find(|size| size.eq_ignore_ascii_case(bare)),
    }
}
