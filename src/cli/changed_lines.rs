//! The edits of the lines in which two texts differ.

use std::{iter, ops::Range};

use strahl::text::Edit;

use super::line_diff::LineDiff;

/// Returns the edits that turn one text into another: only lines that differ, so that the cursor
/// of an editor stays where it is.
pub(super) fn changed_lines(old: &str, new: &str) -> Vec<Edit> {
    let diff = LineDiff::new(old, new);
    let starts: Vec<_> = starts(&diff.old).collect();
    let parts = diff.changes.iter().flat_map(|change| {
        let from = change.old.start;
        let old = &diff.old[change.old.clone()];
        let new = &diff.new[change.new.clone()];
        let parts = parts(old, new).into_iter();
        parts.map(move |(lines, text)| (from + lines.start..from + lines.end, text))
    });
    let edits = parts.filter_map(|(lines, text)| {
        let range = *starts.get(lines.start)?..*starts.get(lines.end)?;
        (old.get(range.clone())? != text).then_some(Edit { range, text })
    });
    edits.collect()
}

/// Returns the offset of each line, and the end of the last.
fn starts(lines: &[&str]) -> impl Iterator<Item = usize> {
    let ends = lines.iter().scan(0, |at, line| {
        *at += line.len();
        Some(*at)
    });
    iter::once(0).chain(ends)
}

/// Divides lines that only differ in blanks and commas, as those of a formatter do, into parts that
/// are as short as possible: the range of old lines, and their new text.
fn parts(old: &[&str], new: &[&str]) -> Vec<(Range<usize>, String)> {
    let letters = |line: &&str| {
        let is_kept = |letter: &char| !letter.is_whitespace() && *letter != ',';
        line.chars().filter(is_kept).count()
    };
    let whole = |lines: &[&str]| -> String {
        let letters = lines.iter().flat_map(|line| line.chars());
        letters
            .filter(|letter| !letter.is_whitespace() && *letter != ',')
            .collect()
    };
    if whole(old) != whole(new) {
        return vec![(0..old.len(), new.concat())];
    }
    let mut parts = Vec::new();
    let (mut from, mut to) = (0..0, 0..0);
    // The letters of the old lines that are not among the new ones yet.
    let mut ahead = 0_isize;
    while from.end < old.len() || to.end < new.len() {
        if ahead <= 0 && from.end < old.len() {
            ahead += letters(&old[from.end]) as isize;
            from.end += 1;
        } else {
            ahead -= new.get(to.end).map_or(0, letters) as isize;
            to.end += 1;
        }
        if ahead == 0 && !from.is_empty() && !to.is_empty() {
            parts.push((from.clone(), new[to.clone()].concat()));
            (from, to) = (from.end..from.end, to.end..to.end);
        }
    }
    if !from.is_empty() || !to.is_empty() {
        let end = to.end.min(new.len());
        parts.push((from, new[to.start.min(end)..end].concat()));
    }
    parts
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_lines_that_differ_are_edited() {
        let (old, new) = ("a\nb\nc\nd\n", "a\nB\nc\nd\ne\n");
        let edits = changed_lines(old, new);
        let found: Vec<_> = edits
            .iter()
            .map(|edit| (edit.range.clone(), &*edit.text))
            .collect();
        assert_eq!(found, [(2..4, "B\n"), (8..8, "e\n")]);
    }

    #[test]
    fn formatted_lines_are_edited_one_by_one() {
        let (old, new) = ("a:1,\nb:[2,\n3]\n\nc\n", "a: 1,\nb: [2, 3],\n\n  c,\n");
        let edits = changed_lines(old, new);
        let found: Vec<_> = edits
            .iter()
            .map(|edit| (&old[edit.range.clone()], &*edit.text))
            .collect();
        let expected = [
            ("a:1,\n", "a: 1,\n"),
            ("b:[2,\n3]\n", "b: [2, 3],\n"),
            ("c\n", "  c,\n"),
        ];
        assert_eq!(found, expected);
    }
}
