//! Help with writing a text that is not checked.

use std::ops::Range;

use super::{FileLink, Fold, Symbol, colors, complete, files, folds, names, spot::Finder, symbols};
use crate::{
    diagnostic::error::Error,
    scene::{
        assist::{
            completion::{ColorPlace, Completions, Hover},
            names::Name,
        },
        options::ReadOptions,
        source::Source,
    },
    text::{
        edit::Edit,
        syntax::{NodeKind, Syntax},
    },
    tracer::color::Color,
};

/// The number of spaces of one level.
const INDENT: usize = 4;

impl Source {
    fn finder(&self) -> Finder<'_> {
        Finder::new(self)
    }

    /// Returns the texts that fit at an offset. The files are those that `options` let the scene
    /// name.
    pub fn completions(&self, offset: usize, options: &ReadOptions) -> Completions {
        complete::complete(&self.finder(), offset, usize::MAX, options)
    }

    /// Returns the meaning of the name or value at an offset.
    pub fn hover(&self, offset: usize) -> Option<Hover> {
        let of_name = self.name_at(offset).and_then(|name| {
            let places = self.places_of(&name);
            names::hover(name, places, self.text(), self.syntax())
        });
        of_name.or_else(|| complete::hover(&self.finder(), offset))
    }

    /// Returns the first colors in a range of the text, at most this many, in its order.
    pub fn colors(&self, within: Range<usize>, most: usize) -> Vec<ColorPlace> {
        colors::colors(self.text(), self.tree(), &within, most)
    }

    /// Returns the ways to write a color: a string, and three numbers.
    ///
    /// # Examples
    ///
    /// ```
    /// use strahl::{Color, Syntax, scene::Source};
    ///
    /// let texts = Source::color_texts(Color::new(1.0, 0.5, 0.0), Syntax::Ron);
    /// assert_eq!(texts, ["\"#ff8000\"", "(1, 0.502, 0)"]);
    /// ```
    pub fn color_texts(color: Color, syntax: Syntax) -> [String; 2] {
        colors::texts(color, syntax)
    }

    /// Returns the parts of the scene, in the order of the text.
    pub fn symbols(&self) -> Vec<Symbol> {
        symbols::symbols(&self.finder())
    }

    /// Returns the brackets and comments that take several lines.
    pub fn folds(&self) -> Vec<Fold> {
        folds::folds(&self.finder())
    }

    /// Returns the files that the scene names.
    pub fn links(&self, options: &ReadOptions) -> Vec<FileLink> {
        files::links(&self.finder(), options)
    }

    /// Returns the name of a material, a camera, a light or a geometry that is written at an offset.
    ///
    /// # Examples
    ///
    /// ```
    /// use strahl::{Syntax, scene::Source};
    ///
    /// let text = r#"(materials: {"gold": Mirror()}, geometries: [Plane(material: Named("gold"))])"#;
    /// let source = Source::new(text, Syntax::Ron);
    /// let name = source.name_at(text.find("gold\")").unwrap()).unwrap();
    /// assert_eq!((name.kind.name(), &*name.name), ("material", "gold"));
    /// assert_eq!(source.places_of(&name).len(), 2);
    /// ```
    pub fn name_at(&self, offset: usize) -> Option<Name> {
        names::at(&self.finder(), offset)
    }

    /// Returns the places of a name, in the order of the text.
    pub fn places_of(&self, name: &Name) -> Vec<Name> {
        let finder = self.finder();
        let names = names::all(&finder);
        names.filter(|place| place.is_of(name)).collect()
    }

    /// Returns the edits that give a thing another name everywhere.
    ///
    /// # Errors
    ///
    /// Fails if the new name is not valid, or if another thing of the kind has it.
    pub fn rename(&self, name: &Name, new: &str) -> Result<Vec<Edit>, Error> {
        let names: Vec<_> = names::all(&self.finder()).collect();
        names::rename(&names, name, new, self.syntax())
    }

    /// Returns the number of spaces at the start of the line that begins at an offset, as its
    /// brackets require; `None` in a comment or a string of several lines.
    ///
    /// # Examples
    ///
    /// ```
    /// use strahl::{Syntax, scene::Source};
    ///
    /// let text = "(\n    geometries: [\n";
    /// let source = Source::new(text, Syntax::Ron);
    /// assert_eq!(source.indentation(text.len()), Some(8));
    /// ```
    pub fn indentation(&self, line: usize) -> Option<usize> {
        let (text, tree) = (self.text(), self.tree());
        let mut comments = tree.comments_in(0..line).iter().rev();
        let is_in_comment = comments.next().is_some_and(|last| last.range().end > line);
        let is_in_string = tree.node_before(line).is_some_and(|id| {
            let node = tree.node(id);
            let range = node.range();
            node.kind() == NodeKind::String && range.start < line && line < range.end
        });
        if is_in_comment || is_in_string {
            return None;
        }
        let rest = text.get(line..)?;
        let at = line + rest.len() - rest.trim_start_matches([' ', '\t']).len();
        let Some(container) = self.finder().container(at) else {
            return Some(0);
        };
        let range = tree.node(container).range();
        let open = match tree.node(container).name() {
            Some(name) => tree.bracket_after(text, name.end, range.end),
            None => range.start,
        };
        let before = text.get(..open)?;
        let start = before.rfind(['\n', '\r']).map_or(0, |end| end + 1);
        let first = before.get(start..)?;
        let width = first.len() - first.trim_start_matches([' ', '\t']).len();
        let closes = text.get(at..)?.starts_with([')', ']', '}']);
        Some(width + if closes { 0 } else { INDENT })
    }
}
