//! Settings of single values from outside of a scene: `PATH=VALUE`.
//!
//! A setting changes the model in memory: its path leads through the things of the format to a slot,
//! and its value is read there by the code that reads files. So settings allow exactly what a file does,
//! and report faults in the same words.

mod apply;
mod fill;
mod lookup;
mod parse;
mod value;

use std::ops::Range;

pub(crate) use apply::{Applied, path_fault};
pub use lookup::FieldLookup;
pub(crate) use lookup::look_up;
pub use parse::SettingError;

use crate::{scene::path::PathPart, text::syntax::Syntax};

/// A value that replaces one of a scene, or adds to it.
///
/// It is written `PATH=VALUE`. The path is that of a diagnostic, such as `camera.fov`,
/// `geometries[3].color` or `cameras["front"].eye[2]`; the key of a map may also follow a dot, and
/// a geometry with a name is found by it: `geometries["ball"].radius`. The value is written as in
/// the scene, but a text needs no quotes; `null` or `None` removes a field.
///
/// # Examples
///
/// ```
/// use strahl::{Document, ReadOptions, Scene, Syntax};
///
/// let text = "(camera: Orthographic(eye: (0, 0, 9), gaze: (0, 0, -1), scale: 2), geometries: [])";
/// let options = ReadOptions::new().syntax(Syntax::Ron).set("camera.scale=6".parse()?);
/// let document = Document::from_reader("mine.ron", text.as_bytes(), &options)?;
/// assert!(!document.has_errors());
/// # let strahl::Camera::Orthographic(camera) = *Scene::try_from(document)?.camera() else { panic!() };
/// # assert_eq!(camera.scale(), 6.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Setting {
    text: String,
    steps: Vec<PathPart>,
    /// The start of the value.
    value: usize,
    /// The syntax of the value; that of the scene if it is not known.
    syntax: Option<Syntax>,
}

impl Setting {
    /// Returns the whole setting as written: `PATH=VALUE`.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Reads the value in this syntax, whatever the syntax of the scene.
    #[must_use]
    pub fn in_syntax(self, syntax: Syntax) -> Self {
        Self {
            syntax: Some(syntax),
            ..self
        }
    }

    /// Returns the path as written.
    pub fn path(&self) -> &str {
        self.text[..self.value].trim_end_matches('=').trim()
    }

    /// The place of a text without quotes, if the value may be one: a color or the name of a file,
    /// for example. A value of a known syntax is written as there.
    fn bare(&self) -> Option<Range<usize>> {
        let text = self.value().trim();
        let start = self.value + self.value().find(text)?;
        let is_bare = !text.starts_with(['"', '(', '[', '{']) && !text.is_empty();
        (self.syntax.is_none() && is_bare).then(|| start..start + text.len())
    }

    fn value(&self) -> &str {
        &self.text[self.value..]
    }
}
