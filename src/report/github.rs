//! Workflow commands, which GitHub Actions shows next to the changed lines.
//!
//! <https://docs.github.com/actions/reference/workflow-commands-for-github-actions>

use std::{
    fmt::Write as _,
    io::{self, Write},
};

use super::summary::{counted, with_use};
use crate::{
    diagnostic::{Diagnostic, Severity, plain::paragraph},
    report::{file::FileReport, reporter::Report, summary::Summary},
    text::{
        lines::{LineRange, Lines},
        sanitize::sanitize,
    },
};

/// Maximum number of bytes of warnings that wait for the last error. GitHub shows ten warnings per
/// step, so this is ample.
const HELD: usize = 1 << 20;

pub(super) struct Github<W> {
    out: W,
    held: String,
    not_held: usize,
}

impl<W: Write> Github<W> {
    pub(super) const fn new(out: W) -> Self {
        Self {
            out,
            held: String::new(),
            not_held: 0,
        }
    }

    fn put(&mut self, severity: Severity, command: &str) -> io::Result<()> {
        match severity {
            Severity::Error => self.out.write_all(command.as_bytes())?,
            Severity::Warning if self.held.len() + command.len() <= HELD => {
                self.held.push_str(command);
            }
            Severity::Warning => self.not_held += 1,
        }
        Ok(())
    }
}

impl<W: Write> Report for Github<W> {
    fn file(&mut self, report: &FileReport<'_>) -> io::Result<()> {
        let lines = report.lines();
        for diagnostic in report.diagnostics {
            let command = command(report, &lines, diagnostic);
            self.put(diagnostic.severity, &command)?;
        }
        if !report.suppressed.is_empty() {
            let severity = if report.suppressed.errors > 0 {
                Severity::Error
            } else {
                Severity::Warning
            };
            let file = sanitize(report.file);
            let command = format!(
                "::{severity} file={}::{}\n",
                property(&file),
                data(&format!("{file}: {}", report.suppressed)),
            );
            self.put(severity, &command)?;
        }
        Ok(())
    }

    fn finish(mut self: Box<Self>, _summary: &Summary) -> io::Result<()> {
        self.out.write_all(self.held.as_bytes())?;
        if self.not_held > 0 {
            writeln!(
                self.out,
                "::warning::… and {}",
                counted(self.not_held, "more warning")
            )?;
        }
        self.out.flush()
    }
}

fn command(report: &FileReport<'_>, lines: &Lines<'_>, diagnostic: &Diagnostic) -> String {
    let file = report.file;
    let place = LineRange::new(lines, &diagnostic.range);
    let (first, last) = (place.start.line, place.last_line());
    let mut command = format!(
        "::{} file={},line={first},endLine={last}",
        diagnostic.severity,
        property(&sanitize(file)),
    );
    // GitHub accepts columns only if both are on one line.
    if place.start.line == place.end.line {
        let (from, to) = (place.start.column, place.end.column);
        // Writing to a string cannot fail.
        let _ = write!(command, ",col={from},endColumn={to}");
    }
    // The log of a step shows only the message, so the message repeats the place.
    let message = with_use(paragraph(file, lines, diagnostic), report.used_by);
    let _ = writeln!(
        command,
        ",title={}::{}",
        property(diagnostic.code.name()),
        data(&message)
    );
    command
}

fn data(text: &str) -> String {
    text.replace('%', "%25")
        .replace('\r', "%0D")
        .replace('\n', "%0A")
}

fn property(text: &str) -> String {
    data(text).replace(':', "%3A").replace(',', "%2C")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{diagnostic::Code, report::Suppressed};

    fn written(files: &[FileReport<'_>]) -> String {
        let mut out = Vec::new();
        let mut github = Box::new(Github::new(&mut out));
        for file in files {
            github.file(file).unwrap();
        }
        github.finish(&Summary::default()).unwrap();
        String::from_utf8(out).unwrap()
    }

    #[test]
    fn special_characters_of_commands_are_escaped() {
        let diagnostic = Diagnostic::new(Code::Syntax, 0..1, "100% ::error::\nno");
        let text = written(&[FileReport {
            file: "C:\\a,b%.ron",
            text: "x",
            diagnostics: &[diagnostic],
            suppressed: Suppressed::default(),
            ..FileReport::default()
        }]);
        assert_eq!(
            text,
            "::error file=C%3A\\a%2Cb%25.ron,line=1,endLine=1,col=1,endColumn=2,title=syntax\
             ::C:\\a,b%25.ron:1:1: error[syntax]: 100%25 ::error::␊no\n"
        );
    }

    #[test]
    fn columns_only_on_one_line() {
        let diagnostic = Diagnostic::new(Code::WrongType, 0..4, "no");
        let text = written(&[FileReport {
            file: "a.ron",
            text: "a\nb\n",
            diagnostics: &[diagnostic],
            suppressed: Suppressed::default(),
            ..FileReport::default()
        }]);
        assert!(
            text.starts_with("::error file=a.ron,line=1,endLine=2,title="),
            "{text}"
        );
    }

    #[test]
    fn errors_come_first_and_the_queue_is_bounded() {
        let long = "x".repeat(1000);
        let warnings = vec![Diagnostic::new(Code::EmptyScene, 0..0, long); 3000];
        let error = [Diagnostic::new(Code::Syntax, 0..0, "last")];
        let report = |diagnostics| FileReport {
            file: "a.ron",
            text: "",
            diagnostics,
            suppressed: Suppressed::default(),
            ..FileReport::default()
        };
        let text = written(&[report(&warnings), report(&error)]);
        assert!(text.starts_with("::error "));
        assert!(text.len() < HELD + 1000);
        let shown = text.matches("::warning file=").count();
        let rest = format!("::warning::… and {} more warnings\n", 3000 - shown);
        assert!(text.ends_with(&rest), "{rest}");
    }
}
