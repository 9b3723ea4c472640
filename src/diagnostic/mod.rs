//! The faults of a scene as plain data, and of files that are not opened: nothing here prints.

pub(crate) mod error;
pub(crate) mod explain;
pub(crate) mod levels;
pub(crate) mod named;
pub(crate) mod path;
pub(crate) mod plain;
pub(crate) mod reading;
pub(crate) mod setters;

use std::ops::Range;

pub use explain::{describe, page_url};
pub use levels::Levels;
pub use named::UnknownName;
pub use path::{Path, Step};
pub use reading::{folder_of, is_at, is_named_pipe, open_file, read_file, read_text};

use named::named;
use setters::setters;

use crate::text::{
    edit::Edit,
    nearest::{nearest, quote},
};

named! {
    /// The severity of a [`Diagnostic`].
    #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
    pub enum Severity {
        /// The scene cannot be rendered.
        Error = "error",
        /// The scene can be rendered, but probably not as intended.
        Warning = "warning",
    }
}

macro_rules! codes {
    ($($(#[doc = $doc:literal])* $variant:ident = $name:literal, $severity:ident;)*) => {
        named! {
            /// The kind of a fault. A code is stable: its meaning never changes.
            #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
            #[non_exhaustive]
            pub enum Code {
                $($(#[doc = $doc])* $variant = $name,)*
            }
        }

        impl Code {
            /// Returns the default severity of the code.
            pub const fn severity(self) -> Severity {
                match self {
                    $(Self::$variant => Severity::$severity,)*
                }
            }

            /// Returns the page of the code, in Markdown.
            const fn page(self) -> &'static str {
                match self {
                    $(Self::$variant => include_str!(concat!("explain/", $name, ".md")),)*
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
    /// A required field that is missing.
    MissingField = "missing-field", Error;
    /// A value of the wrong type or length.
    WrongType = "wrong-type", Error;
    /// A format version that this program does not support.
    UnsupportedVersion = "unsupported-version", Error;
    /// A number that is NaN, infinite, or too large for an f64.
    NotFinite = "not-finite", Error;
    /// A number out of range.
    OutOfRange = "out-of-range", Error;
    /// A direction whose squared length is 0 or not finite.
    ZeroVector = "zero-vector", Error;
    /// `up` is parallel to the line of sight.
    ParallelVectors = "parallel-vectors", Error;
    /// A camera that cannot frame the geometries.
    CannotFit = "cannot-fit", Error;
    /// Both or neither of `gaze` and `look_at`.
    GazeOrLookAt = "gaze-or-look-at", Error;
    /// Both or neither of two fields of which one is required.
    OneOf = "one-of", Error;
    /// A string that is not a color.
    InvalidColor = "invalid-color", Error;
    /// A name that is empty, or that is used in a file name and not valid there.
    InvalidName = "invalid-name", Error;
    /// A name shared by two geometries.
    DuplicateName = "duplicate-name", Error;
    /// A name in an option that does not occur in the scene.
    UnknownName = "unknown-name", Error;
    /// A path in an option or an animation that does not lead to a value of the scene.
    UnknownPath = "unknown-path", Error;
    /// Keys of a track whose times are not ascending.
    UnsortedKeys = "unsorted-keys", Error;
    /// A file named by the scene that cannot be read.
    FileNotFound = "file-not-found", Error;
    /// A file named by the scene that lies outside of its folder.
    OutsideFolder = "outside-folder", Error;
    /// A table with invalid content.
    InvalidTable = "invalid-table", Error;
    /// A mesh file with invalid content.
    InvalidMesh = "invalid-mesh", Error;
    /// A picture with invalid content.
    InvalidImage = "invalid-image", Error;
    /// A mesh without coordinates for its texture.
    MissingUv = "missing-uv", Error;
    /// A part with errors, or one that is not a scene file.
    InvalidPart = "invalid-part", Error;
    /// A part that contains the file that names it.
    PartRing = "part-ring", Error;
    /// A color channel outside of 0 to 1.
    ColorClamped = "color-clamped", Warning;
    /// An atom whose kind is not a chemical element.
    UnknownElement = "unknown-element", Warning;
    /// An angle of view that is likely in radians.
    FovInRadians = "fov-in-radians", Warning;
    /// A radius or a color for all rows of a table, although every row has its own.
    UnusedDefault = "unused-default", Warning;
    /// A column of a table of values that sets nothing and occurs in no name.
    UnusedColumn = "unused-column", Warning;
    /// A mesh file that leaves open what it means, or that was not read to its end.
    OddMesh = "odd-mesh", Warning;
    /// A scene without geometries.
    EmptyScene = "empty-scene", Warning;
    /// A field that changes nothing in this scene.
    NoEffect = "no-effect", Warning;
    /// A lit scene without a light that shines.
    Unlit = "unlit", Warning;
    /// A light that is too weak for its distance from all geometries.
    DimLight = "dim-light", Warning;
    /// A light inside an opaque sphere.
    LightInside = "light-inside", Warning;
    /// Solid glass that no light gets through, where light follows paths.
    LostCaustic = "lost-caustic", Warning;
    /// A geometry that shines but that no path of light aims at.
    NotAimed = "not-aimed", Warning;
    /// A camera that certainly sees none of the geometries.
    NothingVisible = "nothing-visible", Warning;
    /// The eye of a perspective camera lies inside a sphere.
    EyeInside = "eye-inside", Warning;
    /// The eye of a perspective camera lies exactly on a plane.
    EyeOnPlane = "eye-on-plane", Warning;
    /// Two geometries of the same kind with equal numbers.
    DuplicateGeometry = "duplicate-geometry", Warning;
    /// Two solids of glass that overlap.
    OverlappingGlass = "overlapping-glass", Warning;
    /// A geometry that is certainly outside of the view.
    NeverVisible = "never-visible", Warning;
}

impl Code {
    /// The codes whose default severity is [`Severity::Warning`].
    // They are the last ones.
    pub const WARNINGS: &'static [Self] = Self::ALL.split_at(Self::ColorClamped as usize).1;

    /// Returns true if the code is reported by default.
    pub const fn on_by_default(self) -> bool {
        !matches!(self, Self::NeverVisible)
    }

    /// Returns true if a fault of this kind depends on other parts of the list of geometries than
    /// the value that it is about.
    pub const fn depends_on_others(self) -> bool {
        matches!(
            self,
            Self::CannotFit
                | Self::DuplicateName
                | Self::UnknownPath
                | Self::EmptyScene
                | Self::Unlit
                | Self::DimLight
                | Self::LightInside
                | Self::NothingVisible
                | Self::EyeInside
                | Self::DuplicateGeometry
                | Self::OverlappingGlass
                | Self::NeverVisible
        )
    }
}

/// A secondary place of a fault, with its relation to the fault.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Label {
    /// Byte offsets in the text, end exclusive.
    pub range: Range<usize>,
    /// One line, lower case, without a full stop.
    pub message: String,
}

/// The fix of a fault, as edits of the text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fix {
    /// The edits, to be applied together; no two of the ranges touch.
    pub edits: Vec<Edit>,
    /// True if the author certainly meant this. Only safe fixes are applied without being
    /// requested.
    pub is_safe: bool,
}

impl Fix {
    /// Creates a fix that the author certainly meant.
    pub(crate) fn safe(edits: impl Into<Vec<Edit>>) -> Self {
        let (edits, is_safe) = (edits.into(), true);
        Self { edits, is_safe }
    }

    /// Creates a fix that the author may have meant.
    pub(crate) fn unsure(edits: impl Into<Vec<Edit>>) -> Self {
        let (edits, is_safe) = (edits.into(), false);
        Self { edits, is_safe }
    }
}

/// A fault of a scene and its place.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Diagnostic {
    /// The kind of the fault.
    pub code: Code,
    /// The severity of the fault.
    pub severity: Severity,
    /// Byte offsets in the text, end exclusive; `0..0` for the file as a whole.
    pub range: Range<usize>,
    /// One line, lower case, without a full stop; the value is in backticks.
    pub message: String,
    /// The fix in words, if known.
    pub help: Option<String>,
    /// The fix as edits, if possible.
    pub fix: Option<Fix>,
    /// The field concerned, such as `geometries[3].radius`; empty for the root and for syntax
    /// errors.
    pub path: Path,
    /// The other places of the fault.
    pub labels: Vec<Label>,
    /// The place of the fault in a file that the scene names, such as a table.
    pub in_file: Option<Box<InFile>>,
}

/// A place in a file that a scene names: in a table or a mesh that is a text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct InFile {
    /// The path of the file from the current folder.
    pub file: String,
    /// The number of the line, from 1.
    pub line: usize,
    /// The text of the line.
    pub text: String,
    /// Byte offsets in the line, end exclusive.
    pub range: Range<usize>,
    /// The message without the name of the file.
    pub message: String,
}

impl Diagnostic {
    /// Creates a fault with the default severity of its code, without help, fix, path or labels.
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
            in_file: None,
        }
    }

    /// Adds the known name that is probably meant, if there is one, as the help.
    pub(crate) fn meaning(self, name: &str, known: &[&str]) -> Self {
        match nearest(name, known) {
            Some(meant) => self.with_help(format!("did you mean {}?", quote(meant))),
            None => self,
        }
    }

    setters! {
        /// Adds the fix in words.
        with_help(help: impl Into<String>) => help = Some(help.into());

        /// Adds the fix as edits.
        with_fix(fix: impl Into<Option<Fix>>) => fix = fix.into();

        /// Sets the path of the field concerned.
        with_path(path: impl Into<Path>) => path = path.into();
    }

    /// Returns the same fault in another text, where each range is as given by `place`.
    #[must_use]
    pub fn moved(mut self, place: impl Fn(&Range<usize>) -> Range<usize>) -> Self {
        self.range = place(&self.range);
        for label in &mut self.labels {
            label.range = place(&label.range);
        }
        for edit in self.fix.iter_mut().flat_map(|fix| &mut fix.edits) {
            edit.range = place(&edit.range);
        }
        self
    }

    /// Adds a secondary place.
    #[must_use]
    pub fn with_label(mut self, range: Range<usize>, message: impl Into<String>) -> Self {
        self.labels.push(Label {
            range,
            message: message.into(),
        });
        self
    }
}

/// Number of diagnostics of a file that are not listed: those beyond the number requested or kept.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Suppressed {
    /// Number of errors that are not listed.
    pub errors: usize,
    /// Number of warnings that are not listed.
    pub warnings: usize,
}

impl Suppressed {
    /// Adds a number of diagnostics of a severity.
    pub(crate) const fn count(&mut self, severity: Severity, count: usize) {
        match severity {
            Severity::Error => self.errors += count,
            Severity::Warning => self.warnings += count,
        }
    }

    /// Returns true if all diagnostics are listed.
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

    #[test]
    fn the_warnings_are_all_codes_of_that_severity() {
        let is_warning = |code: &Code| code.severity() == Severity::Warning;
        let warnings = Code::ALL.iter().copied().filter(is_warning);
        assert_eq!(warnings.collect::<Vec<_>>(), Code::WARNINGS);
    }
}
