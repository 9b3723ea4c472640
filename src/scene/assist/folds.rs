//! The parts of a text that an editor can fold.

use std::ops::Range;

use super::spot::Finder;
use crate::text::syntax::{CommentKind, NodeKind};

/// A part of a text that can be folded.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fold {
    /// The range: from a bracket to the one that closes it, or the comments.
    pub range: Range<usize>,
    /// True for comments.
    pub is_comment: bool,
}

pub(super) fn folds(finder: &Finder) -> Vec<Fold> {
    let (text, tree) = (finder.text, finder.tree);
    let has_lines = |range: &Range<usize>| {
        let text = text.get(range.clone()).unwrap_or_default();
        text.contains(['\n', '\r'])
    };
    let containers = tree.ids().map(|id| tree.node(id)).filter(|node| {
        let kinds = [
            NodeKind::Tuple,
            NodeKind::Struct,
            NodeKind::List,
            NodeKind::Map,
        ];
        kinds.contains(&node.kind()) && has_lines(&node.range())
    });
    let mut folds: Vec<_> = containers
        .map(|node| Fold {
            range: node.range(),
            is_comment: false,
        })
        .collect();
    // Line comments on neighboring lines are one fold.
    let mut comments: Vec<(Range<usize>, CommentKind)> = Vec::new();
    for comment in tree.comments() {
        let (range, kind) = (comment.range(), comment.kind);
        let is_next = |(last, of): &(Range<usize>, CommentKind)| {
            let between = text.get(last.end..range.start).unwrap_or("x");
            let is_blank = between.trim().is_empty() && between.matches('\n').count() == 1;
            *of == kind && kind == CommentKind::Line && is_blank
        };
        match comments.last_mut() {
            Some(last) if is_next(last) => last.0.end = range.end,
            _ => comments.push((range, kind)),
        }
    }
    let comments = comments.into_iter().map(|(range, _)| range);
    folds.extend(comments.filter(has_lines).map(|range| Fold {
        range,
        is_comment: true,
    }));
    folds.sort_by_key(|fold| fold.range.start);
    folds
}
