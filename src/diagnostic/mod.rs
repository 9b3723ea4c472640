//! What is wrong with a scene, as plain data: nothing here reads or prints.

pub(crate) mod error;
pub(crate) mod explain;
pub(crate) mod levels;
pub(crate) mod named;
pub(crate) mod path;
pub(crate) mod plain;

use std::ops::Range;

pub use explain::describe;
pub use levels::Levels;
pub use named::UnknownName;
pub use path::{Path, Step};

use named::named;

use crate::text::edit::Edit;

named! {
    /// The severity of a [`Diagnostic`].
    #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
    pub enum Severity {
        /// The scene cannot be rendered.
        Error = "error",
        /// The scene can be rendered, but is probably not as intended.
        Warning = "warning",
    }
}

macro_rules! codes {
    ($($(#[doc = $doc:literal])* $variant:ident = $name:literal, $severity:ident;)*) => {
        named! {
            /// Names a kind of fault. A code is stable: it never changes its meaning.
            #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
            #[non_exhaustive]
            pub enum Code {
                $($(#[doc = $doc])* $variant = $name,)*
            }
        }

        impl Code {
            /// The severity that the code has unless somebody says otherwise.
            pub const fn severity(self) -> Severity {
                match self {
                    $(Self::$variant => Severity::$severity,)*
                }
            }
        }
    };
}

codes! {
    /// The text is not RON or JSON, not UTF-8, nested too deep, or empty.
    Syntax = "syntax", Error;
    /// The file cannot be read.
    Unreadable = "unreadable", Error;
    /// A field that the format does not have.
    UnknownField = "unknown-field", Error;
    /// A variant that the format does not have.
    UnknownVariant = "unknown-variant", Error;
    /// A field or key that is given twice.
    DuplicateField = "duplicate-field", Error;
    /// A required field that is not given.
    MissingField = "missing-field", Error;
    /// A value of the wrong type or length.
    WrongType = "wrong-type", Error;
    /// A version of the format that this program does not read.
    UnsupportedVersion = "unsupported-version", Error;
    /// A number that is NaN, infinite, or too large for an f64.
    NotFinite = "not-finite", Error;
    /// A number outside of its range.
    OutOfRange = "out-of-range", Error;
    /// A direction whose squared length is 0 or not finite.
    ZeroVector = "zero-vector", Error;
    /// `up` is parallel to the line of sight.
    ParallelVectors = "parallel-vectors", Error;
    /// Both or neither of `gaze` and `look_at`.
    GazeOrLookAt = "gaze-or-look-at", Error;
    /// A color string that is no color.
    InvalidColor = "invalid-color", Error;
    /// A name that is empty, or that no file can have where it becomes a part of one's name.
    InvalidName = "invalid-name", Error;
    /// A name that two geometries have.
    DuplicateName = "duplicate-name", Error;
    /// A name in an option that nothing in the scene has.
    UnknownName = "unknown-name", Error;
    /// A path in an option or an animation that leads to nothing in the scene.
    UnknownPath = "unknown-path", Error;
    /// Keys of a track whose times do not ascend.
    UnsortedKeys = "unsorted-keys", Error;
    /// A file that the scene names and that cannot be read.
    FileNotFound = "file-not-found", Error;
    /// A file that the scene names and that lies outside of its folder.
    OutsideFolder = "outside-folder", Error;
    /// A table that does not hold what it should.
    InvalidTable = "invalid-table", Error;
    /// A color channel outside of 0..1.
    ColorClamped = "color-clamped", Warning;
    /// A radius or a color for all rows of a table in which every row has one.
    UnusedDefault = "unused-default", Warning;
    /// A column of a table of values that sets nothing and stands in no name.
    UnusedColumn = "unused-column", Warning;
    /// A scene without geometries.
    EmptyScene = "empty-scene", Warning;
    /// A camera that certainly sees none of the geometries.
    NothingVisible = "nothing-visible", Warning;
    /// The eye of a perspective camera lies inside a sphere.
    EyeInside = "eye-inside", Warning;
    /// The eye of a perspective camera lies exactly on a plane.
    EyeOnPlane = "eye-on-plane", Warning;
    /// Two geometries of equal kind and numbers.
    DuplicateGeometry = "duplicate-geometry", Warning;
    /// A geometry that is certainly outside of the view.
    NeverVisible = "never-visible", Warning;
}

const fn count_warnings() -> usize {
    let (mut index, mut count) = (0, 0);
    while index < Code::ALL.len() {
        count += matches!(Code::ALL[index].severity(), Severity::Warning) as usize;
        index += 1;
    }
    count
}

const WARNING_COUNT: usize = count_warnings();

const fn warnings() -> [Code; WARNING_COUNT] {
    let mut warnings = [Code::Syntax; WARNING_COUNT];
    let (mut index, mut count) = (0, 0);
    while index < Code::ALL.len() {
        if matches!(Code::ALL[index].severity(), Severity::Warning) {
            warnings[count] = Code::ALL[index];
            count += 1;
        }
        index += 1;
    }
    warnings
}

impl Code {
    /// The codes whose own severity is [`Severity::Warning`].
    pub const WARNINGS: &'static [Self] = &warnings();

    /// Whether the code is reported unless somebody says otherwise.
    pub const fn on_by_default(self) -> bool {
        !matches!(self, Self::NeverVisible)
    }
}

/// A second place that belongs to a fault, with what it has to do with it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Label {
    /// Byte offsets in the text, end exclusive.
    pub range: Range<usize>,
    /// One line, lower case, without a full stop.
    pub message: String,
}

/// The cure of a fault, as edits of the text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fix {
    /// What to change, all of it at once; no two of the ranges touch.
    pub edits: Vec<Edit>,
    /// Whether it is certain that the author meant this. Only such edits are made unasked.
    pub is_safe: bool,
}

impl Fix {
    /// Edits that the author certainly meant.
    pub(crate) fn safe(edits: impl Into<Vec<Edit>>) -> Self {
        let (edits, is_safe) = (edits.into(), true);
        Self { edits, is_safe }
    }

    /// Edits that the author may have meant.
    pub(crate) fn unsure(edits: impl Into<Vec<Edit>>) -> Self {
        let (edits, is_safe) = (edits.into(), false);
        Self { edits, is_safe }
    }
}

/// One fault of a scene, at its place.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Diagnostic {
    /// What kind of fault it is.
    pub code: Code,
    /// How bad it is.
    pub severity: Severity,
    /// Byte offsets in the text, end exclusive; `0..0` where a file as a whole is meant.
    pub range: Range<usize>,
    /// One line, lower case, without a full stop; the value stands in backticks.
    pub message: String,
    /// The cure in words, where one is known.
    pub help: Option<String>,
    /// The cure as edits, where it is one.
    pub fix: Option<Fix>,
    /// The field concerned, such as `geometries[3].radius`; empty for the root and for syntax.
    pub path: Path,
    /// Other places that belong to the fault.
    pub labels: Vec<Label>,
}

impl Diagnostic {
    /// A fault of the code's own severity, with neither help, path nor labels yet.
    pub fn new(code: Code, range: Range<usize>, message: impl Into<String>) -> Self {
        Self {
            code,
            severity: code.severity(),
            range,
            message: message.into(),
            help: None,
            fix: None,
            path: Path::ROOT,
            labels: Vec::new(),
        }
    }

    /// Adds the cure.
    #[must_use]
    pub fn with_help(mut self, help: impl Into<String>) -> Self {
        self.help = Some(help.into());
        self
    }

    /// Adds the cure as edits.
    #[must_use]
    pub fn with_fix(mut self, fix: impl Into<Option<Fix>>) -> Self {
        self.fix = fix.into();
        self
    }

    /// Names the field concerned.
    #[must_use]
    pub fn with_path(mut self, path: impl Into<Path>) -> Self {
        self.path = path.into();
        self
    }

    /// Adds a second place.
    #[must_use]
    pub fn with_label(mut self, range: Range<usize>, message: impl Into<String>) -> Self {
        self.labels.push(Label {
            range,
            message: message.into(),
        });
        self
    }
}

/// How many findings of a file are not listed, because it has more than were asked for or than are kept.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Suppressed {
    /// Errors not listed.
    pub errors: usize,
    /// Warnings not listed.
    pub warnings: usize,
}

impl Suppressed {
    /// Counts some of a severity.
    pub(crate) const fn count(&mut self, severity: Severity, count: usize) {
        match severity {
            Severity::Error => self.errors += count,
            Severity::Warning => self.warnings += count,
        }
    }

    /// Whether everything is listed.
    pub const fn is_empty(self) -> bool {
        self.errors == 0 && self.warnings == 0
    }
}

impl std::ops::Add for Suppressed {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self {
            errors: self.errors + other.errors,
            warnings: self.warnings + other.warnings,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_code_is_found_by_its_name() {
        for code in Code::ALL {
            assert_eq!(code.name().parse(), Ok(*code));
        }
        assert!("radius".parse::<Code>().is_err());
    }
}
