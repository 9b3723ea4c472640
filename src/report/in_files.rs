//! Faults of tables and meshes, reported in their own files.

use std::io;

use crate::{
    diagnostic::{Diagnostic, InFile, plain::own},
    report::{
        file::{FileReport, UsedBy},
        reporter::Report,
        summary::Summary,
    },
    text::lines::Position,
};

/// A reporter that places the faults of a file that a scene names in that file.
pub(super) struct InFiles<'w>(pub(super) Box<dyn Report + 'w>);

/// The largest number of lines between two faults that are reported together.
const FARTHEST: usize = 1000;

impl Report for InFiles<'_> {
    fn file(&mut self, report: &FileReport<'_>) -> io::Result<()> {
        let is_here = |fault: &Diagnostic| fault.in_file.is_none();
        if report.diagnostics.iter().all(is_here) {
            return self.0.file(report);
        }
        let here = report.diagnostics.iter();
        let here: Vec<_> = here.filter(|fault| is_here(fault)).cloned().collect();
        self.0.file(&FileReport {
            diagnostics: &here,
            ..*report
        })?;
        let lines = report.lines();
        let elsewhere = report.diagnostics.iter();
        let elsewhere = elsewhere.filter_map(|fault| Some((fault, fault.in_file.as_deref()?)));
        let mut elsewhere: Vec<_> = elsewhere.collect();
        // Faults of one use of a file, in the order of its lines.
        elsewhere.sort_by_key(|(fault, place)| (fault.range.start, place.line));
        let are_together = |one: &(&Diagnostic, &InFile), other: &(&Diagnostic, &InFile)| {
            one.0.range == other.0.range
                && one.1.file == other.1.file
                && other.1.line - one.1.line <= FARTHEST
        };
        for together in elsewhere.chunk_by(are_together) {
            let Some((first, place)) = together.first() else {
                continue;
            };
            // The text of an option is not that of the file that it is for.
            let Position { line, column } = match report.option {
                Some(_) => Position { line: 1, column: 1 },
                None => lines.position(first.range.start),
            };
            let (text, faults) = text_of(together);
            self.0.file(&FileReport {
                file: &place.file,
                text: &text,
                lines_before: place.line - 1,
                diagnostics: &faults,
                used_by: Some(UsedBy {
                    file: report.file,
                    line,
                    column,
                }),
                ..FileReport::default()
            })?;
        }
        Ok(())
    }

    fn finish(self: Box<Self>, summary: &Summary) -> io::Result<()> {
        self.0.finish(summary)
    }
}

/// Returns the lines of a file from the first fault to the last, of which only those with faults have
/// a text, and the faults in them.
fn text_of(together: &[(&Diagnostic, &InFile)]) -> (String, Vec<Diagnostic>) {
    let mut text = String::new();
    let (mut start, mut last) = (0, None);
    let mut faults = Vec::new();
    for (fault, place) in together {
        if last != Some(place.line) {
            let ends = last.map_or(0, |last| place.line - last);
            text.extend(std::iter::repeat_n('\n', ends));
            start = text.len();
            text.push_str(&place.text);
            last = Some(place.line);
        }
        faults.push(Diagnostic {
            range: place.range.start + start..place.range.end + start,
            ..own(fault, place)
        });
    }
    (text, faults)
}
