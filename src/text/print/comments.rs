//! The comments of a text, in the order in which the printer needs them.

use std::ops::Range;

use crate::text::syntax::{Comment, Tree};

/// An iterator that yields each comment once.
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

    /// Returns the next comment if it starts before `end`.
    pub(super) fn next_before(&mut self, end: usize) -> Option<&'a Comment> {
        let (first, rest) = self.rest.split_first()?;
        (first.range().start < end).then(|| {
            self.rest = rest;
            first
        })
    }

    /// Returns the next comments that trail the item before `end`: those on the same line as
    /// `from`. A comment in front of an item at `end` on that line belongs to that item, unless a
    /// comma follows the comment.
    pub(super) fn trailing(&mut self, from: usize, end: usize) -> &'a [Comment] {
        let (mut count, mut before_comma) = (0, 0);
        let mut last = from;
        let mut starts = self.rest.iter().map(|comment| comment.range());
        let line_ends = loop {
            let next = starts.next().filter(|range| range.start < end);
            let gap = last..next.as_ref().map_or(end, |range| range.start);
            if self.has(gap.clone(), '\n') {
                break true;
            }
            if self.has(gap, ',') {
                before_comma = count;
            }
            let Some(next) = next else { break false };
            last = next.end;
            count += 1;
        };
        if !line_ends && self.is_item(end) {
            count = before_comma;
        }
        let (trailing, rest) = self.rest.split_at_checked(count).unwrap_or_default();
        self.rest = rest;
        trailing
    }

    /// Skips the comments that start before `end`.
    pub(super) fn skip_before(&mut self, end: usize) {
        while self.next_before(end).is_some() {}
    }

    fn has(&self, range: Range<usize>, sought: char) -> bool {
        self.text
            .get(range)
            .is_some_and(|text| text.contains(sought))
    }

    /// Returns true if an item starts at `at`, not a closing bracket or the end of the text.
    fn is_item(&self, at: usize) -> bool {
        let next = self.text.get(at..).and_then(|rest| rest.bytes().next());
        !matches!(next, None | Some(b')' | b']' | b'}'))
    }
}
