//! What was found in scenes, written for people and for tools: one file per format.
//!
//! A reporter writes each file's findings as they come and keeps none of them, so that a run
//! over thousands of files needs no more memory than its largest file. The one exception is
//! bounded: see [`OutputFormat::Github`].

mod excerpt;
mod github;
mod human;
mod json;
mod junit;
mod of_options;
mod sarif;
mod short;
mod summary;

use std::{
    io::{self, Write},
    time::Duration,
};

pub use crate::diagnostic::Suppressed;
pub use junit::{JunitFailure, JunitWriter, escaped};
use of_options::OfOptions;
pub use summary::{Summary, limit};

use crate::{
    diagnostic::{Code, Diagnostic, named::named},
    text::lines::Lines,
};

named! {
    /// A form in which findings are written.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
    pub enum OutputFormat {
        /// The lines concerned, with the places underlined.
        #[default]
        Human = "human",
        /// One line per finding: `FILE:LINE:COL: SEVERITY[CODE]: MESSAGE`.
        Short = "short",
        /// One JSON object for the whole run.
        Json = "json",
        /// One JSON object per finding and line.
        Jsonl = "jsonl",
        /// SARIF 2.1.0, for code scanning services and editors.
        Sarif = "sarif",
        /// Workflow commands that GitHub Actions shows beside the lines. Errors come first, so
        /// warnings wait for the end: up to a mebibyte of them, then they are only counted.
        Github = "github",
        /// JUnit's XML, for services that show test results: a test per file.
        Junit = "junit",
    }
}

/// How [`OutputFormat::Human`] looks; the other formats are the same everywhere.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Style {
    /// Whether to write ANSI colors.
    pub color: bool,
    /// The columns of the terminal; taken as at least 40.
    pub width: usize,
}

impl Default for Style {
    /// For a file or a pipe: no color, 100 columns.
    fn default() -> Self {
        Self {
            color: false,
            width: 100,
        }
    }
}

/// One file and what was found in it.
#[derive(Clone, Copy, Debug, Default)]
pub struct FileReport<'a> {
    /// The file's name as it was given; `<stdin>` for standard input.
    pub file: &'a str,
    /// The text that the ranges of the diagnostics count in; empty if it could not be read.
    pub text: &'a str,
    /// How many lines of the file stand before the text, where that is a part of it.
    pub lines_before: usize,
    /// The option that the text stands in, such as `--set camera.fov`, where it is one for this
    /// file and not a part of it: people are shown the option, and tools the start of the file.
    pub option: Option<&'a str>,
    /// The findings, in the order in which they are to be written.
    pub diagnostics: &'a [Diagnostic],
    /// How many findings there are beyond `diagnostics`.
    pub suppressed: Suppressed,
    /// The time that reading and checking the file took.
    pub time: Duration,
}

impl<'a> FileReport<'a> {
    /// The lines that the findings lie in. A file without any, however large, is not gone
    /// through.
    fn lines(&self) -> Lines<'a> {
        let text = if self.diagnostics.is_empty() {
            ""
        } else {
            self.text
        };
        Lines::after(self.lines_before, text)
    }
}

/// The page about a code, in Markdown. Its first paragraph says in one sentence what the code
/// means, the second one more about it.
pub type Describe = fn(Code) -> &'static str;

/// Writes findings in one format.
pub trait Report {
    /// Writes what was found in one file, faultless files included: some formats count them.
    ///
    /// # Errors
    ///
    /// Those of the writer.
    fn file(&mut self, report: &FileReport<'_>) -> io::Result<()>;

    /// Writes what comes after the last file, and flushes the writer.
    ///
    /// # Errors
    ///
    /// Those of the writer.
    fn finish(self: Box<Self>, summary: &Summary) -> io::Result<()>;
}

/// The reporter of a format. `out` is written to in many small pieces: give it a buffer.
///
/// `describe` supplies what [`OutputFormat::Sarif`] says about each code.
pub fn reporter<'w>(
    format: OutputFormat,
    style: Style,
    describe: Describe,
    out: impl Write + 'w,
) -> Box<dyn Report + 'w> {
    let for_tools: Box<dyn Report + 'w> = match format {
        OutputFormat::Human => return Box::new(human::Human::new(out, style)),
        OutputFormat::Short => Box::new(short::Short::new(out)),
        OutputFormat::Json => Box::new(json::Json::new(out)),
        OutputFormat::Jsonl => Box::new(json::Jsonl::new(out)),
        OutputFormat::Sarif => Box::new(sarif::Sarif::new(out, describe)),
        OutputFormat::Github => Box::new(github::Github::new(out)),
        OutputFormat::Junit => Box::new(junit::Junit::new(out)),
    };
    Box::new(OfOptions(for_tools))
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
