//! One line per diagnostic, for `grep`, editors and eyes.

use std::io::{self, Write};

use crate::{
    diagnostic::plain::line,
    report::{file::FileReport, reporter::Report, summary::Summary},
    text::{lines::LineRange, sanitize::sanitize},
};

pub(super) struct Short<W>(pub(super) W);

impl<W: Write> Report for Short<W> {
    fn file(&mut self, report: &FileReport<'_>) -> io::Result<()> {
        let lines = report.lines();
        for diagnostic in report.diagnostics {
            let place = LineRange::new(&lines, &diagnostic.range);
            let line = line(report.file, place, diagnostic);
            match report.used_by {
                Some(used_by) => writeln!(self.0, "{line} ({used_by})")?,
                None => writeln!(self.0, "{line}")?,
            }
        }
        if !report.suppressed.is_empty() {
            // Written without line and column, so that no tool takes it for a diagnostic.
            writeln!(self.0, "{}: {}", sanitize(report.file), report.suppressed)?;
        }
        Ok(())
    }

    fn finish(mut self: Box<Self>, _summary: &Summary) -> io::Result<()> {
        self.0.flush()
    }
}
