//! Settings of single values from outside of a scene: `PATH=VALUE`.
//!
//! A setting changes the model in memory: its path leads through the things of the format to a slot,
//! and its value is read there by the code that reads files. So settings allow exactly what a file does,
//! and report faults in the same words.

mod apply;
mod fill;
mod lookup;

pub(crate) use apply::{Applied, path_fault};
pub use lookup::FieldLookup;
pub(crate) use lookup::look_up;

use std::{error::Error, fmt, ops::Range, str::FromStr};

use crate::{
    diagnostic::{Code, Diagnostic},
    scene::{
        path::{PathPart, parts_before},
        problem::syntax_fault,
    },
    text::syntax::{self, Syntax},
};

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

/// The value of a setting and its range in the setting.
struct Value {
    range: Range<usize>,
    text: String,
    /// True if a field is removed.
    removes: bool,
}

impl Value {
    /// Returns the value of a setting as a text without quotes, if it may be one.
    fn bare(setting: &Setting) -> Option<Self> {
        let range = setting.bare()?;
        let text = setting.text.get(range.clone())?;
        Some(Self {
            text: serde_json::Value::from(text).to_string(),
            range,
            removes: false,
        })
    }

    /// Reads the value of a setting.
    fn of(setting: &Setting, syntax: Syntax) -> Result<Self, Vec<Diagnostic>> {
        let start = setting.value;
        if setting.value().trim().is_empty() {
            let message = "expected a value after `=`";
            return Err(vec![Diagnostic::new(Code::Syntax, start..start, message)]);
        }
        // A removal may be written as in either syntax.
        let trimmed = setting.value().trim();
        if ["null", "None"].contains(&trimmed) {
            let start = start + setting.value().find(trimmed).unwrap_or_default();
            return Ok(Self {
                range: start..start + trimmed.len(),
                text: match syntax {
                    Syntax::Ron => "None".to_owned(),
                    Syntax::Json => "null".to_owned(),
                },
                removes: true,
            });
        }
        let tree = syntax::parse(setting.value(), syntax);
        if let [_, ..] = tree.faults() {
            let faults = tree.faults().iter().map(|fault| {
                let range = fault.range.start + start..fault.range.end + start;
                let labels = Vec::new();
                let fault = syntax_fault(fault);
                Diagnostic {
                    range,
                    labels,
                    ..fault
                }
            });
            return Err(faults.collect());
        }
        let range = tree.root().map_or(0..0, |root| tree.node(root).range());
        let text = setting.value().get(range.clone()).unwrap_or("");
        Ok(Self {
            range: range.start + start..range.end + start,
            text: text.to_owned(),
            removes: false,
        })
    }
}

/// A text that is not `PATH=VALUE`.
#[derive(Clone, PartialEq, Eq)]
pub struct SettingError {
    expected: &'static str,
}

impl fmt::Display for SettingError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "expected {}; a setting is written PATH=VALUE, such as camera.fov=60 or \
             geometries[3].radius=0.5",
            self.expected
        )
    }
}

/// Same as `Display`, because a `main` that returns an error prints it with `Debug`.
impl fmt::Debug for SettingError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(self, f)
    }
}

impl Error for SettingError {}

impl FromStr for Setting {
    type Err = SettingError;

    fn from_str(text: &str) -> Result<Self, SettingError> {
        let read = parts_before(text).and_then(|(steps, rest)| {
            let value = rest.strip_prefix('=').ok_or("`=` after the path")?;
            Ok((steps, text.len() - value.len()))
        });
        let (steps, value) = read.map_err(|expected| SettingError { expected })?;
        Ok(Self {
            text: text.to_owned(),
            steps,
            value,
            syntax: None,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnostic::path::Step;

    fn read(text: &str) -> String {
        let setting: Setting = text.parse().unwrap();
        for part in &setting.steps {
            let shown = &text[part.range.clone()];
            match part.name() {
                Some(name) => assert!(shown.contains(name) || shown.contains('\\')),
                None => assert_eq!(part.step, Step::Index(shown.parse().unwrap())),
            }
        }
        let steps = setting.steps.iter().map(|part| match part.name() {
            Some(name) => format!("<{name}>"),
            None => format!("<#{}>", &text[part.range.clone()]),
        });
        let steps: String = steps.collect();
        format!("{steps}{}|{}", setting.value(), setting.path())
    }

    #[test]
    fn paths_are_those_of_diagnostics() {
        for (text, expected) in [
            ("camera.fov=60", "<camera><fov>60|camera.fov"),
            ("background=", "<background>|background"),
            (
                "geometries[3].color = \"#0=f\"",
                "<geometries><#3><color> \"#0=f\"|geometries[3].color",
            ),
            ("a[1][2]=x", "<a><#1><#2>x|a[1][2]"),
            (
                "cameras[\"a.b=[c]\"].fov=1",
                "<cameras><a.b=[c]><fov>1|cameras[\"a.b=[c]\"].fov",
            ),
            (
                r#"g["a \"b\" \\"].x=1"#,
                r#"<g><a "b" \><x>1|g["a \"b\" \\"].x"#,
            ),
            (
                "cameras.front 2.fov=1",
                "<cameras><front 2><fov>1|cameras.front 2.fov",
            ),
            ("é . ü = 1", "<é><ü> 1|é . ü"),
        ] {
            assert_eq!(read(text), expected);
        }
    }

    #[test]
    fn wrong_paths_are_rejected() {
        for text in [
            "",
            "=",
            "camera",
            "camera.=1",
            ".fov=1",
            "a[]=1",
            "a[-1]=1",
            "a[99999999999999999999999]=1",
            "a[1=1",
            "a[b]=1",
            "a[\"b]=1",
            "a[\"b\"=1",
            "a[1]b=1",
            "a[\"\\q\"]=1",
            "[0]=1",
        ] {
            assert!(text.parse::<Setting>().is_err(), "{text}");
        }
    }
}
