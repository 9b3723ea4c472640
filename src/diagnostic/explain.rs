//! The page of each code, in Markdown: its meaning, a scene that fails, and the fix.

use crate::diagnostic::Code;

/// Returns the address of a code's page in the manual of this version.
pub(crate) fn page_url(code: Code) -> String {
    const MANUAL: &str = concat!(
        env!("CARGO_PKG_REPOSITORY"),
        "/blob/v",
        env!("CARGO_PKG_VERSION"),
        "/docs/diagnostics.md"
    );
    format!("{MANUAL}#{code}")
}

/// Returns the page of a code, in Markdown: a heading, a sentence on the meaning of the code,
/// details, an example that fails, and the fix.
///
/// # Examples
///
/// ```
/// let page = strahl::diagnostic::describe(strahl::diagnostic::Code::OutOfRange);
/// assert!(page.starts_with("# out-of-range\n"));
/// ```
pub const fn describe(code: Code) -> &'static str {
    match code {
        Code::Syntax => include_str!("explain/syntax.md"),
        Code::Unreadable => include_str!("explain/unreadable.md"),
        Code::UnknownField => include_str!("explain/unknown-field.md"),
        Code::UnknownVariant => include_str!("explain/unknown-variant.md"),
        Code::DuplicateField => include_str!("explain/duplicate-field.md"),
        Code::MissingField => include_str!("explain/missing-field.md"),
        Code::WrongType => include_str!("explain/wrong-type.md"),
        Code::UnsupportedVersion => include_str!("explain/unsupported-version.md"),
        Code::NotFinite => include_str!("explain/not-finite.md"),
        Code::OutOfRange => include_str!("explain/out-of-range.md"),
        Code::ZeroVector => include_str!("explain/zero-vector.md"),
        Code::ParallelVectors => include_str!("explain/parallel-vectors.md"),
        Code::GazeOrLookAt => include_str!("explain/gaze-or-look-at.md"),
        Code::InvalidColor => include_str!("explain/invalid-color.md"),
        Code::InvalidName => include_str!("explain/invalid-name.md"),
        Code::DuplicateName => include_str!("explain/duplicate-name.md"),
        Code::UnknownName => include_str!("explain/unknown-name.md"),
        Code::UnknownPath => include_str!("explain/unknown-path.md"),
        Code::UnsortedKeys => include_str!("explain/unsorted-keys.md"),
        Code::FileNotFound => include_str!("explain/file-not-found.md"),
        Code::OutsideFolder => include_str!("explain/outside-folder.md"),
        Code::InvalidTable => include_str!("explain/invalid-table.md"),
        Code::ColorClamped => include_str!("explain/color-clamped.md"),
        Code::UnusedDefault => include_str!("explain/unused-default.md"),
        Code::UnusedColumn => include_str!("explain/unused-column.md"),
        Code::EmptyScene => include_str!("explain/empty-scene.md"),
        Code::NothingVisible => include_str!("explain/nothing-visible.md"),
        Code::EyeInside => include_str!("explain/eye-inside.md"),
        Code::EyeOnPlane => include_str!("explain/eye-on-plane.md"),
        Code::DuplicateGeometry => include_str!("explain/duplicate-geometry.md"),
        Code::NeverVisible => include_str!("explain/never-visible.md"),
    }
}
