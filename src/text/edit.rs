//! Edits of a text.

use std::{collections::BTreeMap, ops::Range};

/// A range of a text and its replacement.
///
/// # Examples
///
/// ```
/// let edit = strahl::text::Edit { range: 1..4, text: "fov".to_owned() };
/// assert_eq!(edit.range.len(), edit.text.len());
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Edit {
    /// Byte offsets in the text, end exclusive; an empty range inserts.
    pub range: Range<usize>,
    /// The new text; empty to remove the range.
    pub text: String,
}

impl Edit {
    /// Replaces a range with a text.
    pub(crate) fn replace(range: Range<usize>, text: impl Into<String>) -> Self {
        let text = text.into();
        Self { range, text }
    }

    /// Inserts a text at an offset.
    pub(crate) fn insert(at: usize, text: impl Into<String>) -> Self {
        Self::replace(at..at, text)
    }

    /// Removes a range.
    pub(crate) fn remove(range: Range<usize>) -> Self {
        Self::replace(range, "")
    }
}

/// Applies groups of edits; returns the new text and the number of groups applied.
///
/// A group is applied as a whole or not at all: it is skipped if one of its edits touches an edit
/// of an earlier group.
pub(crate) fn apply<'e>(
    text: &str,
    groups: impl IntoIterator<Item = &'e [Edit]>,
) -> (String, usize) {
    let mut made: BTreeMap<usize, &Edit> = BTreeMap::new();
    let mut count = 0;
    for group in groups {
        let is_free = |edit: &Edit| {
            let before = made.range(..=edit.range.end).next_back();
            before.is_none_or(|(_, before)| before.range.end < edit.range.start)
        };
        if group.iter().all(is_free) {
            made.extend(group.iter().map(|edit| (edit.range.start, edit)));
            count += 1;
        }
    }
    let mut edited = String::with_capacity(text.len());
    let mut at = 0;
    for edit in made.into_values() {
        edited += text.get(at..edit.range.start).unwrap_or_default();
        edited += &edit.text;
        at = edit.range.end;
    }
    edited += text.get(at..).unwrap_or_default();
    (edited, count)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn touching_groups_are_left_for_later() {
        let text = "(a b c)";
        let brackets = [Edit::replace(0..1, "["), Edit::replace(6..7, "]")];
        let comma = [Edit::insert(2, ",")];
        let other = [Edit::remove(1..2)];
        let groups: [&[Edit]; 3] = [&brackets, &comma, &other];
        assert_eq!(apply(text, groups), ("[a, b c]".to_owned(), 2));
        assert_eq!(apply(text, [&other[..]]).0, "( b c)");
        assert_eq!(apply(text, []), (text.to_owned(), 0));
    }
}
