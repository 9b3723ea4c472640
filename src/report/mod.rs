//! Diagnostics of scenes, written for people and for tools: one file per format.
//!
//! A reporter writes the diagnostics of each file as they arrive and keeps none, so that a run over
//! thousands of files needs no more memory than its largest file. The one exception is bounded: see
//! [`OutputFormat::Github`].

mod excerpt;
mod github;
mod human;
mod in_files;
mod json;
mod junit;
mod option_faults;
mod sarif;
mod short;
mod summary;

use std::{
    fmt,
    io::{self, Write},
    path::Path,
    time::Duration,
};

pub use crate::diagnostic::Suppressed;
use in_files::InFiles;
pub use junit::{JunitFailure, JunitWriter, escaped};
use option_faults::OfOptions;
pub use summary::{Summary, limit};

use serde::Serialize;

use crate::{
    diagnostic::{Code, Diagnostic, named::named},
    text::{lines::Lines, sanitize::sanitize},
};

/// Returns the URI of a file, relative if its path is.
///
/// # Examples
///
/// ```
/// assert_eq!(strahl::report::file_uri("scenes/a b.ron"), "scenes/a%20b.ron");
/// ```
pub fn file_uri(path: &str) -> String {
    sarif::uri::of_bytes(path.as_bytes(), cfg!(windows))
}

named! {
    /// An output format for diagnostics.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
    pub enum OutputFormat {
        /// The affected lines, with the places underlined.
        #[default]
        Human = "human",
        /// One line per diagnostic: `FILE:LINE:COL: SEVERITY[CODE]: MESSAGE`.
        Short = "short",
        /// One JSON object for the whole run.
        Json = "json",
        /// One JSON object per diagnostic, each on its own line.
        Jsonl = "jsonl",
        /// SARIF 2.1.0, for code scanning services and editors.
        Sarif = "sarif",
        /// Workflow commands that GitHub Actions shows next to the lines. Errors come first, so
        /// warnings wait for the end: up to a mebibyte of them is kept, the rest is only counted.
        Github = "github",
        /// JUnit XML, for services that show test results: one test per file.
        Junit = "junit",
    }
}

/// The style of [`OutputFormat::Human`]; the other formats look the same everywhere.
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
    fn lines(&self) -> Lines<'a> {
        let text = if self.diagnostics.is_empty() {
            ""
        } else {
            self.text
        };
        Lines::after(self.lines_before, text)
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

/// Creates the reporter for a format. It writes to `out` in many small pieces, so `out` should be
/// buffered.
///
/// `describe` supplies the text about each code for [`OutputFormat::Sarif`].
pub fn reporter<'w>(
    format: OutputFormat,
    style: Style,
    describe: Describe,
    out: impl Write + 'w,
) -> Box<dyn Report + 'w> {
    let for_tools: Box<dyn Report + 'w> = match format {
        OutputFormat::Human => return Box::new(InFiles(Box::new(human::Human::new(out, style)))),
        OutputFormat::Short => Box::new(short::Short(out)),
        OutputFormat::Json => Box::new(json::Json::new(out)),
        OutputFormat::Jsonl => Box::new(json::Jsonl(out)),
        OutputFormat::Sarif => Box::new(sarif::Sarif::new(out, describe)),
        OutputFormat::Github => Box::new(github::Github::new(out)),
        OutputFormat::Junit => Box::new(junit::Junit::new(out)),
    };
    Box::new(InFiles(Box::new(OfOptions(for_tools))))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_format_is_found_by_its_name() {
        for format in OutputFormat::ALL {
            assert_eq!(format.name().parse(), Ok(*format));
        }
        assert!("xml".parse::<OutputFormat>().is_err());
    }
}
