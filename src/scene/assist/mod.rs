//! Help with writing a scene: what fits at a place, what something means, and where the colors are.
//! All of it derives from the JSON Schema and the tree of the text, which may be broken.

mod colors;
mod complete;
mod cuts;
mod excerpt;
mod files;
mod folds;
mod names;
mod paths;
mod sample;
mod source;
mod spot;
mod symbols;
#[cfg(test)]
mod tests;

use std::ops::Range;

use crate::{diagnostic::named::named, tracer::color::Color};

pub use cuts::Cuts;
pub use excerpt::{Elements, Excerpt};
pub use files::FileLink;
pub use folds::Fold;
pub use names::{Name, NameKind};
pub use symbols::{Symbol, SymbolKind};

named! {
    /// The kind of a completion.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum CompletionKind {
        /// A field of a struct.
        Field = "field",
        /// A variant, such as a shape.
        Variant = "variant",
        /// A name from the scene.
        Name = "name",
        /// A color.
        Color = "color",
        /// A file beside the scene.
        File = "file",
        /// A folder beside the scene.
        Folder = "folder",
        /// Any other value.
        Value = "value",
    }
}

/// The texts that fit at a place of a scene.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Completions {
    /// The range that a completion replaces: the word at the place, or nothing.
    pub range: Range<usize>,
    /// The completions; those most likely meant come first.
    pub items: Vec<Completion>,
}

/// A text that fits at a place of a scene.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Completion {
    /// The name, as people read it.
    pub label: String,
    /// The text that replaces the range.
    pub insert: String,
    /// The kind.
    pub kind: CompletionKind,
    /// The type in a few words, with its range and default.
    pub detail: String,
    /// The docs.
    pub docs: String,
}

/// The meaning of a name or a value in a scene.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Hover {
    /// The range of the name or value.
    pub range: Range<usize>,
    /// The name with its type.
    pub title: String,
    /// The docs.
    pub docs: String,
}

/// A color in a text.
#[derive(Clone, Debug, PartialEq)]
pub struct ColorPlace {
    /// The range of the value.
    pub range: Range<usize>,
    /// The color.
    pub color: Color,
    /// True if it is written as a string, false for three numbers.
    pub is_string: bool,
}
