//! What all writers of diagnostics share.

use std::io;

use crate::{
    diagnostic::Code,
    report::{file::FileReport, summary::Summary},
};

/// The style of [`OutputFormat::Human`](super::OutputFormat::Human); the other formats look the same everywhere.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Style {
    /// True to write ANSI colors.
    pub color: bool,
    /// The number of columns of the terminal; at least 40 are assumed.
    pub width: usize,
}

impl Default for Style {
    /// Returns the style for a file or a pipe: no color, 100 columns.
    fn default() -> Self {
        Self {
            color: false,
            width: 100,
        }
    }
}

/// A function that returns the page of a code, in Markdown. Its first paragraph explains the code
/// in one sentence, the second one adds details.
pub type Describe = fn(Code) -> &'static str;

/// A writer of diagnostics in one format.
pub trait Report {
    /// Writes the diagnostics of a file. Files without any must be passed too: some formats count
    /// them.
    ///
    /// # Errors
    ///
    /// Fails if the writer fails.
    fn file(&mut self, report: &FileReport<'_>) -> io::Result<()>;

    /// Writes the end of the report and flushes the writer.
    ///
    /// # Errors
    ///
    /// Fails if the writer fails.
    fn finish(self: Box<Self>, summary: &Summary) -> io::Result<()>;
}
