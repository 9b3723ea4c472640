//! A file and its diagnostics.

use std::{fmt, path::Path, time::Duration};

use serde::Serialize;

use crate::{
    diagnostic::{Diagnostic, Suppressed},
    text::{lines::Lines, sanitize::sanitize},
};

/// A file and its diagnostics.
#[derive(Clone, Copy, Debug, Default)]
pub struct FileReport<'a> {
    /// The file name as given; `<stdin>` for standard input.
    pub file: &'a str,
    /// The path of the file, if its name is not text: URIs hold its bytes.
    pub path: Option<&'a Path>,
    /// The text that the ranges of the diagnostics refer to; empty if it could not be read.
    pub text: &'a str,
    /// The number of lines before the text, if the text is a part of the file.
    pub lines_before: usize,
    /// The option that contains the text, such as `--set camera.fov`, if the text belongs to an
    /// option for this file and not to the file. People see the option, tools the start of the
    /// file.
    pub option: Option<&'a str>,
    /// The diagnostics, in the order to write them.
    pub diagnostics: &'a [Diagnostic],
    /// The numbers of diagnostics not listed in `diagnostics`.
    pub suppressed: Suppressed,
    /// The time for reading and checking the file.
    pub time: Duration,
    /// The place that names the file, if the report is about a file that a scene names.
    pub used_by: Option<UsedBy<'a>>,
}

/// A place that names a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct UsedBy<'a> {
    /// The name of the scene or the part.
    pub file: &'a str,
    /// The line, from 1.
    pub line: usize,
    /// The column in Unicode scalar values, from 1.
    pub column: usize,
}

impl fmt::Display for UsedBy<'_> {
    /// Writes `used by scene.ron:3:20`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { file, line, column } = self;
        write!(f, "used by {}:{line}:{column}", sanitize(file))
    }
}

impl<'a> FileReport<'a> {
    /// Returns the lines of the diagnostics. A file without any is not searched, however large.
    pub(super) fn lines(&self) -> Lines<'a> {
        let text = if self.diagnostics.is_empty() {
            ""
        } else {
            self.text
        };
        Lines::after(self.lines_before, text)
    }
}
