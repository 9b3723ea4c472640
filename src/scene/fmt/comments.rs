//! The comments of a text, in the order in which a printer comes by.

use std::ops::Range;

use crate::scene::syntax::{Comment, Tree};

/// Hands out each comment once.
pub(super) struct Comments<'a> {
    text: &'a str,
    rest: &'a [Comment],
}

impl<'a> Comments<'a> {
    pub(super) fn new(text: &'a str, tree: &'a Tree) -> Self {
        Self {
            text,
            rest: tree.comments(),
        }
    }

    /// The next comment, if it starts before `end`.
    pub(super) fn next_before(&mut self, end: usize) -> Option<&'a Comment> {
        let (first, rest) = self.rest.split_first()?;
        (first.range().start < end).then(|| {
            self.rest = rest;
            first
        })
    }

    /// The next comment, if it starts before `end` on the line on which `from` lies, and belongs
    /// to what stands there: nothing but comments follows on its line before `end`.
    pub(super) fn next_trailing(&mut self, from: usize, end: usize) -> Option<&'a Comment> {
        let first = self.rest.first()?.range();
        if first.start >= end || self.has_break(from..first.start) {
            return None;
        }
        // A block comment in front of the next item on its line belongs to that one.
        let mut last = first.end;
        for comment in &self.rest[1..] {
            let range = comment.range();
            if range.start >= end || self.has_break(last..range.start) {
                break;
            }
            last = range.end;
        }
        if self.is_item(end) && !self.has_break(last..end) && !self.has_comma(last..end) {
            return None;
        }
        self.next_before(end)
    }

    /// Whether there is any comment inside of a range.
    pub(super) fn any_in(tree: &Tree, range: Range<usize>) -> bool {
        !tree.comments_in(range).is_empty()
    }

    fn has_break(&self, range: Range<usize>) -> bool {
        self.text.get(range).is_some_and(|text| text.contains('\n'))
    }

    fn has_comma(&self, range: Range<usize>) -> bool {
        self.text.get(range).is_some_and(|text| text.contains(','))
    }

    /// Whether an item stands at `at`, not a closing bracket or the end.
    fn is_item(&self, at: usize) -> bool {
        let next = self.text.get(at..).and_then(|rest| rest.bytes().next());
        !matches!(next, None | Some(b')' | b']' | b'}'))
    }
}
