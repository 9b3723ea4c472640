//! Fixes as edits, for faults that the tree shows.

use std::ops::Range;

use crate::{
    diagnostic::Fix,
    scene::recover::{
        nameless::is_known,
        text::{Text, VariantText},
    },
    text::{
        edit::Edit,
        syntax::{NodeId, NodeKind, Syntax, Tree, float, string},
    },
};

/// Replaces a name by another one.
pub(super) fn renamed(document: Text<'_>, place: Range<usize>, name: &str) -> Fix {
    Fix::safe([Edit::replace(place, document.tree.syntax().word(name))])
}

/// Removes the second of two fields: a safe fix if both values are equal.
pub(super) fn without(document: Text<'_>, first: NodeId, later: NodeId) -> Option<Fix> {
    let tree = document.tree;
    let [one, other] = [first, later].map(|key| tree.value(key));
    let whole = tree.node(later).range().start..tree.node(other).range().end;
    let edits = [removal(document.text, tree, whole)?];
    let is_equal = document.source(one) == document.source(other);
    Some(if is_equal {
        Fix::safe(edits)
    } else {
        Fix::unsure(edits)
    })
}

/// Removes an item of a list or a struct with its comma, and with its line if that contains nothing
/// else; `None` if a comment would be lost.
pub(crate) fn removal(text: &str, tree: &Tree, item: Range<usize>) -> Option<Edit> {
    if !tree.comments_in(item.clone()).is_empty() {
        return None;
    }
    let before = text.get(..item.start)?;
    let behind = text.get(item.end..)?;
    let Some(rest) = behind.trim_start().strip_prefix(',') else {
        // The last item goes with the comma before it.
        let comma = before.trim_end().strip_suffix(',');
        let start = comma.map_or(item.start, str::len);
        return Some(Edit::remove(start..item.end));
    };
    let end = text.len() - rest.len();
    let blanks = |text: &str| text.len() - text.trim_start_matches([' ', '\t']).len();
    let end = end + blanks(rest);
    let indent = before.len() - before.trim_end_matches([' ', '\t']).len();
    let starts_line = before.trim_end_matches([' ', '\t']).ends_with('\n');
    let rest = text.get(end..)?;
    let line_end = rest.strip_prefix("\r\n").or(rest.strip_prefix('\n'));
    Some(match line_end {
        Some(after) if starts_line => Edit::remove(item.start - indent..text.len() - after.len()),
        _ => Edit::remove(item.start..end),
    })
}

/// Returns the fix for a value of the wrong type, if only its spelling is wrong.
pub(super) fn respelt(document: Text<'_>, id: NodeId, wants: Wants) -> Option<Fix> {
    let (tree, syntax) = (document.tree, document.tree.syntax());
    let node = tree.node(id);
    let range = node.range();
    let brackets = |open: &str, close: &str| {
        let last = range.end.checked_sub(1)?;
        Some(Fix::safe([
            Edit::replace(range.start..range.start + 1, open),
            Edit::replace(last..range.end, close),
        ]))
    };
    match (node.kind(), wants) {
        (NodeKind::Tuple, _)
            if node
                .name()
                .is_some_and(|name| document.slice(name) == "Some") =>
        {
            alone(document, id)
        }
        (NodeKind::String, Wants::Number) => {
            let inside = string(document.source(id), syntax)?;
            let number = inside.trim();
            float(number, syntax)
                .is_ok_and(f64::is_finite)
                .then(|| Fix::safe([Edit::replace(range, number)]))
        }
        (NodeKind::List, Wants::Tuple) if syntax == Syntax::Ron => brackets("(", ")"),
        (NodeKind::Tuple, Wants::List) if node.name().is_none() => brackets("[", "]"),
        _ if wants == Wants::List && is_variant(document, id) => Some(Fix::safe([
            Edit::insert(range.start, "["),
            Edit::insert(range.end, "]"),
        ])),
        _ => None,
    }
}

/// Removes what is around the only element of a node; `None` if there are others, or if a comment would
/// be lost.
pub(super) fn alone(document: Text<'_>, id: NodeId) -> Option<Fix> {
    let tree = document.tree;
    let mut children = tree.children(id);
    let (Some(only), None) = (children.next(), children.next()) else {
        return None;
    };
    let (whole, value) = (tree.node(id).range(), tree.node(only).range());
    let around = [whole.start..value.start, value.end..whole.end];
    let has_comment = |range: &Range<usize>| !tree.comments_in(range.clone()).is_empty();
    (!around.iter().any(has_comment)).then(|| Fix::safe(around.map(Edit::remove)))
}

/// Returns true if a value is a variant with content.
fn is_variant(document: Text<'_>, id: NodeId) -> bool {
    let tree = document.tree;
    let written = VariantText::of(document.text, tree, id).filter(|it| it.body.is_some());
    written.is_some_and(|it| tree.syntax() == Syntax::Ron || is_known(&it.name))
}

/// The expected type of a value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Wants {
    /// A number.
    Number,
    /// A color: a string or three numbers.
    Color,
    /// Numbers in brackets, or a key of a track.
    Tuple,
    /// A list.
    List,
    /// Anything else.
    Other,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::text::syntax::parse;

    #[test]
    fn an_item_is_removed_with_its_comma() {
        for (text, expected) in [
            ("[1, x, 2]", "[1, 2]"),
            ("[1, x]", "[1]"),
            ("[x]", "[]"),
            ("[\n  1,\n  x,\n  2,\n]", "[\n  1,\n  2,\n]"),
            ("[\n  1, // one\n  x,\n]", "[\n  1, // one\n]"),
            ("[1, x, // x\n]", "[1, // x\n]"),
        ] {
            let at = text.find('x').unwrap();
            let tree = parse(text, Syntax::Ron);
            let edit = removal(text, &tree, at..at + 1).unwrap();
            let mut found = text.to_owned();
            found.replace_range(edit.range, &edit.text);
            assert_eq!(found, expected, "{text}");
        }
        let text = "[(1, /* kept */ 2), 3]";
        assert_eq!(removal(text, &parse(text, Syntax::Ron), 1..18), None);
    }
}
