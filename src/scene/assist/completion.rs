//! What fits at a place of a scene, and what something there means.

use std::ops::Range;

use crate::{diagnostic::named::named, tracer::color::Color};

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
