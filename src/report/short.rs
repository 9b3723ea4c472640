//! One line per finding, for `grep`, editors and eyes.

use std::{
    fmt::Write as _,
    io::{self, Write},
};

use super::{FileReport, Report, Summary, place::Place};
use crate::visible::visible;
use crate::{diagnostic::Diagnostic, lines::Lines};

pub(super) struct Short<W> {
    out: W,
}

impl<W: Write> Short<W> {
    pub(super) const fn new(out: W) -> Self {
        Self { out }
    }
}

impl<W: Write> Report for Short<W> {
    fn file(&mut self, report: &FileReport<'_>) -> io::Result<()> {
        let lines = report.lines();
        for diagnostic in report.diagnostics {
            let place = Place::new(&lines, &diagnostic.range);
            writeln!(self.out, "{}", line(report.file, place, diagnostic))?;
        }
        if !report.suppressed.is_empty() {
            // Without line and column, so that no tool takes it for a finding.
            writeln!(self.out, "{}: {}", visible(report.file), report.suppressed)?;
        }
        Ok(())
    }

    fn finish(mut self: Box<Self>, _summary: &Summary) -> io::Result<()> {
        self.out.flush()
    }
}

/// `FILE:LINE:COL: SEVERITY[CODE]: MESSAGE`
pub(super) fn line(file: &str, place: Place, diagnostic: &Diagnostic) -> String {
    format!(
        "{}:{}:{}: {}[{}]: {}",
        visible(file),
        place.start.line,
        place.start.column,
        diagnostic.severity,
        diagnostic.code,
        visible(&diagnostic.message),
    )
}

/// That line, then a line for every label, then the help: all that a plain text can say.
pub(super) fn paragraph(file: &str, lines: &Lines<'_>, diagnostic: &Diagnostic) -> String {
    let mut text = line(file, Place::new(lines, &diagnostic.range), diagnostic);
    for label in &diagnostic.labels {
        let at = lines.position(label.range.start);
        // Writing to a string cannot fail.
        let _ = write!(
            text,
            "\nnote: {}:{}: {}",
            at.line,
            at.column,
            visible(&label.message)
        );
    }
    if let Some(help) = &diagnostic.help {
        let _ = write!(text, "\nhelp: {}", visible(help));
    }
    text
}
