//! The edits of the lines in which two texts differ.

use std::ops::Range;

use strahl::text::Edit;

use super::line_diff::{LineDiff, starts};

/// Returns the edits that turn one text into another: one for each run of lines that differ, so that
/// the cursor of an editor stays where it is.
pub(super) fn changed_lines(old: &str, new: &str) -> Vec<Edit> {
    edits(&LineDiff::new(old, new))
}

/// Returns those edits that touch a range of the old text, each with as few lines as possible.
pub(super) fn changed_lines_near(old: &str, new: &str, range: &Range<usize>) -> Vec<Edit> {
    edits(&LineDiff::near(old, new, range.clone()))
}

fn edits(diff: &LineDiff) -> Vec<Edit> {
    let starts: Vec<_> = starts(&diff.old).collect();
    let edits = diff.changes.iter().map(|change| Edit {
        range: starts[change.old.start]..starts[change.old.end],
        text: diff.new[change.new.clone()].concat(),
    });
    edits.collect()
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
    fn a_range_has_as_few_lines_as_possible() {
        let (old, new) = ("a:1,\nb:[2,\n3]\n\nc\n", "a: 1,\nb: [2, 3],\n\n  c,\n");
        let found = |edits: Vec<Edit>| -> Vec<_> {
            let edits = edits.into_iter();
            edits.map(|edit| (edit.range, edit.text)).collect()
        };
        let first = (0..14, "a: 1,\nb: [2, 3],\n".to_owned());
        let last = (15..17, "  c,\n".to_owned());
        assert_eq!(found(changed_lines(old, new)), [first, last.clone()]);
        let middle = (5..14, "b: [2, 3],\n".to_owned());
        assert_eq!(found(changed_lines_near(old, new, &(7..8))), [middle]);
        assert_eq!(found(changed_lines_near(old, new, &(16..16))), [last]);
        // The comma of an item is never there twice.
        let (old, new) = ("a\n\n// b\n, c\nd\n", "a,\n\n// b\nc,\nd,\n");
        let item = (0..12, "a,\n\n// b\nc,\n".to_owned());
        assert_eq!(found(changed_lines_near(old, new, &(0..1))), [item]);
    }

    /// Applies edits, which have equal lines between them.
    fn applied(old: &str, edits: &[Edit]) -> String {
        assert!(edits.is_sorted_by(|one, next| one.range.end < next.range.start));
        let mut text = old.to_owned();
        for edit in edits.iter().rev() {
            text.replace_range(edit.range.clone(), &edit.text);
        }
        text
    }

    #[test]
    fn the_edits_lead_from_one_text_to_the_other() {
        let mut texts = vec![String::new()];
        for text in 0..40 {
            for line in ["a\n", " a,\r\n", "\n"] {
                texts.push(format!("{}{line}", texts[text]));
            }
        }
        let ends = texts
            .iter()
            .map(|text| text.trim_end_matches('\n').to_owned());
        texts.extend(ends.collect::<Vec<_>>());
        for old in &texts {
            for new in &texts {
                let edits = changed_lines(old, new);
                assert_eq!(applied(old, &edits), *new, "{old:?}");
                let range = old.len() / 3..old.len() / 2;
                for edit in changed_lines_near(old, new, &range) {
                    assert!(edit.range.start <= range.end && range.start <= edit.range.end);
                    let is_part = |whole: &Edit| {
                        let (whole, part) = (&whole.range, &edit.range);
                        whole.start <= part.start && part.end <= whole.end
                    };
                    assert!(edits.iter().any(is_part), "{old:?} {new:?} {range:?}");
                }
                assert_eq!(changed_lines_near(old, new, &(0..old.len())), edits);
            }
        }
    }
}
