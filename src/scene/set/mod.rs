//! Single values of a scene that are set from outside: `PATH=VALUE`.
//!
//! A setting changes the model in memory. The geometry that it concerns, or all of the scene but
//! its geometries, is written as text, the value takes its place in that text, and the text is read
//! again: by those who read files, so that nothing is allowed here that a file may not say, and
//! nothing is said otherwise about what is wrong.

mod apply;
mod lookup;
mod parse;
mod patch;

use std::ops::Range;

pub(crate) use apply::Applied;
pub use lookup::FieldLookup;
pub(crate) use lookup::look_up;
pub use parse::SettingError;

use crate::scene::path::Part;

/// A value that is set instead of that of a scene, or beside what the scene has.
///
/// It is written `PATH=VALUE`. The path is that of a diagnostic, such as `camera.fov`,
/// `geometries[3].color` or `cameras["front"].eye[2]`; the key of a map may stand behind a dot as
/// well, and a geometry that has a name is found by it: `geometries["ball"].radius`. The value is
/// written as in the scene, `null` or `None` removes a field.
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
    steps: Vec<Part>,
    /// Where the value begins.
    value: usize,
}

impl Setting {
    /// All of it, as it was written: `PATH=VALUE`.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// The path, as it was written.
    pub fn path(&self) -> &str {
        self.text[..self.value].trim_end_matches('=').trim()
    }

    /// The place of a color without quotes, if the value is one.
    fn bare_color(&self) -> Option<Range<usize>> {
        let color = self.value().trim();
        let start = self.value + self.value().find(color)?;
        color.starts_with('#').then(|| start..start + color.len())
    }

    fn value(&self) -> &str {
        &self.text[self.value..]
    }
}
