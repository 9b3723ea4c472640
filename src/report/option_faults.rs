//! Faults of options, reported where a tool can show them: its file name must be that of a file.

use std::io;

use crate::{
    diagnostic::Diagnostic,
    report::{file::FileReport, reporter::Report, summary::Summary},
    text::lines::Position,
};

/// A reporter that places the faults of an option at the start of the file that the option is for.
pub(super) struct OfOptions<'w>(pub(super) Box<dyn Report + 'w>);

impl Report for OfOptions<'_> {
    fn file(&mut self, report: &FileReport<'_>) -> io::Result<()> {
        let Some(option) = report.option else {
            return self.0.file(report);
        };
        let lines = report.lines();
        let faults = report.diagnostics.iter().map(|fault| {
            let Position { line, column } = lines.position(fault.range.start);
            Diagnostic {
                range: 0..0,
                message: format!("{option}:{line}:{column}: {}", fault.message),
                labels: Vec::new(),
                ..fault.clone()
            }
        });
        let faults: Vec<_> = faults.collect();
        self.0.file(&FileReport {
            text: "",
            option: None,
            diagnostics: &faults,
            ..*report
        })
    }

    fn finish(self: Box<Self>, summary: &Summary) -> io::Result<()> {
        self.0.finish(summary)
    }
}
