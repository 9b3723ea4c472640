//! The page of each code, in Markdown: its meaning, a scene that fails, and the fix.

use crate::diagnostic::Code;

/// Returns the address of a code's page in the manual of this version.
pub fn page_url(code: Code) -> String {
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
    code.page()
}
