//! The number of diagnostics, in figures and in words.

use std::fmt;

use serde::Serialize;

use crate::{
    diagnostic::{Diagnostic, Severity, Suppressed},
    report::file::{FileReport, UsedBy},
};

impl fmt::Display for Suppressed {
    /// Writes `… and 37 more errors, 2 more warnings in this file`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("… and ")?;
        if self.errors > 0 {
            f.write_str(&counted(self.errors, "more error"))?;
        }
        if self.errors > 0 && self.warnings > 0 {
            f.write_str(", ")?;
        }
        if self.warnings > 0 {
            f.write_str(&counted(self.warnings, "more warning"))?;
        }
        f.write_str(" in this file")
    }
}

/// The totals of a run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Summary {
    /// Number of files that were checked.
    pub files: usize,
    /// Number of errors, listed or not.
    pub errors: usize,
    /// Number of warnings, listed or not.
    pub warnings: usize,
    /// Number of files that were skipped because they are not scenes.
    pub skipped: usize,
}

impl Summary {
    /// Adds a file and its diagnostics.
    pub fn count(&mut self, report: &FileReport<'_>) {
        self.files += 1;
        self.errors += report.suppressed.errors;
        self.warnings += report.suppressed.warnings;
        for diagnostic in report.diagnostics {
            match diagnostic.severity {
                Severity::Error => self.errors += 1,
                Severity::Warning => self.warnings += 1,
            }
        }
    }

    /// Returns the sentence for the end of a run: `3 files (1 skipped): 2 errors, 1 warning`.
    pub fn sentence(&self) -> String {
        let files = counted(self.files, "file");
        let skipped = match self.skipped {
            0 => String::new(),
            skipped => format!(" ({skipped} skipped)"),
        };
        let errors = counted(self.errors, "error");
        let warnings = counted(self.warnings, "warning");
        let found = match (self.errors, self.warnings) {
            (0, 0) => "no problems".to_owned(),
            (_, 0) => errors,
            (0, _) => warnings,
            _ => format!("{errors}, {warnings}"),
        };
        format!("{files}{skipped}: {found}")
    }
}

/// Returns a number and its noun, with an s for the plural.
pub(super) fn counted(number: usize, noun: &str) -> String {
    let plural = if number == 1 { "" } else { "s" };
    format!("{number} {noun}{plural}")
}

/// Returns the text of a fault with a note about the place that names its file, if there is one.
pub(super) fn with_use(text: String, used_by: Option<UsedBy<'_>>) -> String {
    match used_by {
        Some(used_by) => format!("{text}\nnote: {used_by}"),
        None => text,
    }
}

/// Returns the first `most` diagnostics, errors before warnings, in their order, and the number
/// left out.
pub fn limit(diagnostics: &[Diagnostic], most: usize) -> (Vec<Diagnostic>, Suppressed) {
    let count = |severity| {
        let of_it = |fault: &&Diagnostic| fault.severity == severity;
        diagnostics.iter().filter(of_it).count()
    };
    let (errors, warnings) = (count(Severity::Error), count(Severity::Warning));
    let mut errors_left = errors.min(most);
    let mut warnings_left = warnings.min(most - errors_left);
    let suppressed = Suppressed {
        errors: errors - errors_left,
        warnings: warnings - warnings_left,
    };
    let kept = diagnostics.iter().filter(|fault| {
        let left = match fault.severity {
            Severity::Error => &mut errors_left,
            Severity::Warning => &mut warnings_left,
        };
        let keep = *left > 0;
        *left -= usize::from(keep);
        keep
    });
    (kept.cloned().collect(), suppressed)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_summary_counts_errors_and_warnings() {
        let sentence = |files, errors, warnings, skipped| {
            Summary {
                files,
                errors,
                warnings,
                skipped,
            }
            .sentence()
        };
        assert_eq!(sentence(3, 2, 1, 0), "3 files: 2 errors, 1 warning");
        assert_eq!(sentence(1, 1, 0, 12), "1 file (12 skipped): 1 error");
        assert_eq!(sentence(2, 0, 2, 0), "2 files: 2 warnings");
        assert_eq!(sentence(0, 0, 0, 1), "0 files (1 skipped): no problems");
    }

    #[test]
    fn unlisted_diagnostics_are_counted() {
        let more = |errors, warnings| Suppressed { errors, warnings };
        assert_eq!(
            more(37, 2).to_string(),
            "… and 37 more errors, 2 more warnings in this file"
        );
        assert_eq!(more(1, 0).to_string(), "… and 1 more error in this file");
        assert_eq!(more(0, 3).to_string(), "… and 3 more warnings in this file");

        let mut summary = Summary::default();
        summary.count(&FileReport {
            file: "a.ron",
            text: "",
            diagnostics: &[],
            suppressed: more(37, 2),
            ..FileReport::default()
        });
        assert_eq!(
            (summary.files, summary.errors, summary.warnings),
            (1, 37, 2)
        );
    }
}
