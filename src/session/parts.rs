//! The cameras, lights and geometries of a scene, and edits that hide one.

use std::ops::Range;

use crate::{
    diagnostic::error::Error,
    scene::{
        assist::{Symbol, SymbolKind},
        source::Source,
    },
    session::{additions::PartList, checked::Checked},
    text::{edit::Edit, syntax::Syntax},
};

/// A camera, a light or a geometry of a scene.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ScenePart {
    /// The kind: a camera, a light or a geometry.
    pub kind: SymbolKind,
    /// The name, or the index in brackets.
    pub name: String,
    /// The variant.
    pub variant: String,
    /// The number of geometries around it.
    pub level: usize,
    /// True if it is in a comment that [`Checked::hide_or_show`] wrote.
    pub is_hidden: bool,
    /// The range of the text.
    pub range: Range<usize>,
}

/// The start and the end of the comment around a hidden part.
const HIDDEN: [&str; 2] = ["/* hidden: ", " */"];

impl Checked {
    /// Returns the parts of the text, in its order, those that are hidden among them.
    pub fn parts(&self) -> Vec<ScenePart> {
        let mut parts = Vec::new();
        for symbol in self.document.source().symbols() {
            if symbol.kind == SymbolKind::Camera {
                add(&mut parts, &symbol, 0);
            } else if PartList::ALL.iter().any(|list| list.name() == symbol.name) {
                let children = symbol.children.iter();
                children.for_each(|child| add(&mut parts, child, 0));
                parts.extend(self.hidden(&symbol));
            }
        }
        parts.sort_by_key(|part| part.range.start);
        parts
    }

    /// Returns the hidden parts of a list.
    fn hidden(&self, list: &Symbol) -> Vec<ScenePart> {
        let (text, tree) = (self.document.text(), self.document.source().tree());
        let comments = tree.comments_in(list.range.clone()).iter();
        let parts = comments.filter_map(|comment| {
            let range = comment.range();
            let content = text.get(range.clone())?.strip_prefix(HIDDEN[0])?;
            let content = format!("({}: [{}])", list.name, content.strip_suffix(HIDDEN[1])?);
            let symbols = Source::new(content, Syntax::Ron).symbols();
            let symbol = symbols.first()?.children.first()?.clone();
            Some(ScenePart {
                kind: symbol.kind,
                name: symbol.name,
                variant: symbol.detail,
                level: level_at(&list.children, range.start),
                is_hidden: true,
                range,
            })
        });
        parts.collect()
    }

    /// Returns the edits that put the light or the geometry at an offset into a comment, or take it out again.
    ///
    /// # Errors
    ///
    /// A JSON text, which has no comments, and an offset where neither starts.
    pub fn hide_or_show(&self, offset: usize) -> Result<Vec<Edit>, Error> {
        let mut parts = self.parts().into_iter();
        let part = parts.find(|part| part.range.start == offset && part.kind != SymbolKind::Camera);
        let part = part.ok_or_else(|| Error::refused("a light or a geometry can be hidden"))?;
        let Range { start, end } = part.range;
        let [open, close] = HIDDEN;
        if part.is_hidden {
            return Ok(vec![
                Edit::remove(start..start + open.len()),
                Edit::remove(end - close.len()..end),
            ]);
        }
        if self.document.syntax() == Syntax::Json {
            return Err(Error::refused(
                "nothing can be hidden in JSON, which has no comments; RON has",
            ));
        }
        let end = self.comma_after(end).unwrap_or(end);
        let text = self.document.text().get(start..end).unwrap_or_default();
        if text.matches("/*").count() != text.matches("*/").count() {
            return Err(Error::refused(
                "a text with half a comment cannot be hidden in one",
            ));
        }
        Ok(vec![Edit::insert(start, open), Edit::insert(end, close)])
    }

    /// Returns the end of the comma that follows an offset, after blanks and comments.
    pub(super) fn comma_after(&self, mut at: usize) -> Option<usize> {
        let (text, tree) = (self.document.text(), self.document.source().tree());
        loop {
            let rest = text.get(at..)?;
            at += rest.len() - rest.trim_start().len();
            match tree.comments_in(at..at + 1).first() {
                Some(comment) => at = comment.range().end,
                None => return text.get(at..)?.starts_with(',').then_some(at + 1),
            }
        }
    }
}

/// Returns the number of symbols around an offset.
fn level_at(symbols: &[Symbol], at: usize) -> usize {
    let mut around = symbols.iter().filter(|symbol| symbol.range.contains(&at));
    around
        .next()
        .map_or(0, |symbol| 1 + level_at(&symbol.children, at))
}

fn add(parts: &mut Vec<ScenePart>, symbol: &Symbol, level: usize) {
    parts.push(ScenePart {
        kind: symbol.kind,
        name: symbol.name.clone(),
        variant: symbol.detail.clone(),
        level,
        is_hidden: false,
        range: symbol.range.clone(),
    });
    let children = symbol.children.iter();
    children.for_each(|child| add(parts, child, level + 1));
}

#[cfg(test)]
mod tests {
    use crate::session::tests::{TEXT, checked, edited};

    #[test]
    fn a_part_is_hidden_in_a_comment_and_shown_again() {
        let found = checked(TEXT);
        let parts = found.parts();
        let names = parts
            .iter()
            .map(|part| (&*part.name, &*part.variant, part.level));
        let expected = [
            ("camera", "Fit", 0),
            ("[0]", "Sphere", 0),
            ("[1]", "Group", 0),
            ("green", "Sphere", 1),
            ("[1]", "Sphere", 1),
        ];
        assert_eq!(names.collect::<Vec<_>>(), expected);
        for part in &parts[1..] {
            let edits = found.hide_or_show(part.range.start).unwrap();
            let hidden = edited(TEXT, &edits);
            let again = checked(&hidden);
            assert!(!again.document().has_errors(), "{hidden}");
            let parts = again.parts();
            let found: Vec<_> = parts.iter().filter(|part| part.is_hidden).collect();
            let [one] = found[..] else {
                panic!("{hidden}: {parts:?}");
            };
            assert_eq!((&one.variant, one.level), (&part.variant, part.level));
            let edits = again.hide_or_show(one.range.start).unwrap();
            assert_eq!(edited(&hidden, &edits), TEXT);
        }
        assert!(found.hide_or_show(parts[0].range.start).is_err());
        assert!(found.hide_or_show(0).is_err());
    }
}
