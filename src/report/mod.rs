//! Diagnostics of scenes, written for people and for tools: one file per format.
//!
//! A reporter writes the diagnostics of each file as they arrive and keeps none, so that a run over
//! thousands of files needs no more memory than its largest file. The one exception is bounded: see
//! [`OutputFormat::Github`].

mod excerpt;
mod file;
mod github;
mod human;
mod in_files;
mod json;
mod junit;
mod option_faults;
mod reporter;
mod sarif;
mod short;
mod summary;

use std::io::Write;

pub use crate::diagnostic::Suppressed;
pub use file::{FileReport, UsedBy};
use in_files::InFiles;
pub use junit::{JunitFailure, JunitWriter, escaped};
use option_faults::OfOptions;
pub use reporter::{Describe, Report, Style};
pub use summary::{Summary, limit};

use crate::diagnostic::named::named;

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
