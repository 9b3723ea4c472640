//! The lines in which two texts differ.

use std::time::Duration;

use similar::{DiffOp, TextDiff};
use strahl::text::Edit;

/// The time after which the shortest list of edits is no longer looked for.
const LONGEST: Duration = Duration::from_millis(500);

/// Returns the edits that turn one text into another: only lines that differ, so that the cursor
/// of an editor stays where it is.
pub(super) fn changed_lines(old: &str, new: &str) -> Vec<Edit> {
    let diff = TextDiff::configure().timeout(LONGEST).diff_lines(old, new);
    let starts = |lines: &[&str]| -> Vec<usize> {
        let ends = lines.iter().scan(0, |at, line| {
            *at += line.len();
            Some(*at)
        });
        std::iter::once(0).chain(ends).collect()
    };
    let old_starts = starts(&diff.iter_old_slices().collect::<Vec<_>>());
    let new_starts = starts(&diff.iter_new_slices().collect::<Vec<_>>());
    let differs = |op: &&DiffOp| !matches!(op, DiffOp::Equal { .. });
    let edit = |op: &DiffOp| {
        let (from, to) = (op.old_range(), op.new_range());
        Some(Edit {
            range: *old_starts.get(from.start)?..*old_starts.get(from.end)?,
            text: new
                .get(*new_starts.get(to.start)?..*new_starts.get(to.end)?)?
                .to_owned(),
        })
    };
    diff.ops().iter().filter(differs).filter_map(edit).collect()
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
}
