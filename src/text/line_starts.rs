//! The lines of a text that is edited.

use std::{borrow::Cow, iter, ops::Range};

use crate::text::lines::Lines;

/// The start offsets of the lines of a text that is edited, as editors count them: a line ends with
/// LF, CRLF or CR, and a byte order mark is a character.
///
/// # Examples
///
/// ```
/// use strahl::text::{LineStarts, Position};
///
/// let mut text = "a\rb\n".to_owned();
/// let mut starts = LineStarts::new(&text);
/// text.replace_range(1..1, "\n");
/// starts.replace(1..1, &text, 1);
/// assert_eq!(starts, LineStarts::new(&text));
/// assert_eq!(starts.lines(&text).position(3), Position { line: 3, column: 1 });
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LineStarts(Vec<usize>);

impl LineStarts {
    /// Finds the lines of a text in one pass.
    pub fn new(text: &str) -> Self {
        let starts = iter::once(0).chain(starts_in(text, 1..text.len() + 1));
        Self(starts.collect())
    }

    /// Follows the replacement of a range by `inserted` bytes; `text` is the text after it. Takes
    /// time linear in the number of lines and the length of the insertion.
    pub fn replace(&mut self, range: Range<usize>, text: &str, inserted: usize) {
        // A start depends on the bytes around it, so those at both ends may change as well.
        let first = self.0.partition_point(|start| *start < range.start.max(1));
        let behind = self.0.partition_point(|start| *start <= range.end);
        let end = range.start + inserted;
        for start in self.0.iter_mut().skip(behind) {
            *start = *start - range.end + end;
        }
        let new = starts_in(text, range.start.max(1)..end + 1);
        self.0.splice(first..behind.max(first), new);
    }

    /// Returns the lines of the text.
    pub fn lines<'a>(&'a self, text: &'a str) -> Lines<'a> {
        Lines::with_starts(text, Cow::Borrowed(&self.0), 0)
    }
}

/// Returns the offsets in a range at which a line starts, except the first of the text.
fn starts_in(text: &str, range: Range<usize>) -> impl Iterator<Item = usize> {
    let bytes = text.as_bytes();
    let before = range.start.saturating_sub(1)..(range.end - 1).min(bytes.len());
    let ends = bytes.get(before).unwrap_or_default().iter().enumerate();
    ends.filter_map(move |(index, byte)| {
        let at = range.start + index;
        let is_end = match byte {
            b'\n' => true,
            b'\r' => bytes.get(at) != Some(&b'\n'),
            _ => false,
        };
        is_end.then_some(at)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tracer::random::{Rng, cases};

    #[test]
    fn lines_end_with_lf_crlf_or_cr() {
        let starts = LineStarts::new("\u{feff}a\nb\r\nc\rd\r\r\n");
        assert_eq!(starts.0, [0, 5, 8, 10, 12, 14]);
        assert_eq!(LineStarts::new("").0, [0]);
    }

    #[test]
    fn edits_are_followed() {
        let mut random = Rng(21);
        let mut text = String::new();
        let mut starts = LineStarts::new(&text);
        for _ in 0..cases(5000) {
            let mut ends = [0; 2].map(|_| random.below(text.len() + 1));
            ends.sort_unstable();
            let range = ends[0]..ends[1].min(ends[0] + random.below(9));
            let new: String = (0..random.below(5))
                .map(|_| ['\r', '\n', 'a'][random.below(3)])
                .collect();
            text.replace_range(range.clone(), &new);
            starts.replace(range, &text, new.len());
            assert_eq!(starts, LineStarts::new(&text), "{text:?}");
        }
    }
}
