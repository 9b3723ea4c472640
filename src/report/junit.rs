//! JUnit's XML: a file is a test, an error in it a failure.
//!
//! A suite must say at its start how many tests of it failed. A suite of its own for each file
//! keeps to that without holding anything back.

use std::io::{self, Write};

use super::{FileReport, Report, Summary};
use crate::{diagnostic::Severity, plain::paragraph, visible::visible};

pub(super) struct Junit<W> {
    out: W,
    open: bool,
}

impl<W: Write> Junit<W> {
    pub(super) const fn new(out: W) -> Self {
        Self { out, open: false }
    }

    fn open(&mut self) -> io::Result<()> {
        if !self.open {
            self.open = true;
            self.out
                .write_all(b"<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n")?;
            self.out
                .write_all(b"<testsuites name=\"strahl validate\">\n")?;
        }
        Ok(())
    }
}

impl<W: Write> Report for Junit<W> {
    fn file(&mut self, report: &FileReport<'_>) -> io::Result<()> {
        self.open()?;
        let lines = report.lines();
        let of = |severity| {
            report
                .diagnostics
                .iter()
                .filter(move |one| one.severity == severity)
        };

        let failed = of(Severity::Error).next().is_some() || report.suppressed.errors > 0;
        let failures = u8::from(failed);
        let file = escaped(report.file);
        let time = format!("{:.6}", report.time.as_secs_f64());
        writeln!(
            self.out,
            "  <testsuite name=\"{file}\" tests=\"1\" failures=\"{failures}\" errors=\"0\" \
             time=\"{time}\">\n    \
             <testcase name=\"{file}\" classname=\"strahl\" time=\"{time}\">",
        )?;
        for diagnostic in of(Severity::Error) {
            writeln!(
                self.out,
                "      <failure message=\"{}\" type=\"{}\">{}</failure>",
                escaped(&diagnostic.message),
                diagnostic.code,
                escaped_lines(&paragraph(report.file, &lines, diagnostic)),
            )?;
        }
        let not_listed = report.suppressed.to_string();
        if report.suppressed.errors > 0 {
            // A failure, so that a file does not pass because none of its errors is listed.
            writeln!(
                self.out,
                "      <failure message=\"{not_listed}\" type=\"max-diagnostics\"/>",
            )?;
        }
        let mut said: Vec<_> = of(Severity::Warning)
            .map(|diagnostic| paragraph(report.file, &lines, diagnostic))
            .collect();
        if report.suppressed.errors == 0 && report.suppressed.warnings > 0 {
            said.push(not_listed);
        }
        if !said.is_empty() {
            let said = escaped_lines(&said.join("\n"));
            writeln!(self.out, "      <system-out>{said}</system-out>")?;
        }
        self.out.write_all(b"    </testcase>\n  </testsuite>\n")
    }

    fn finish(mut self: Box<Self>, _summary: &Summary) -> io::Result<()> {
        self.open()?;
        self.out.write_all(b"</testsuites>\n")?;
        self.out.flush()
    }
}

/// A text on one line as an attribute can hold it. XML 1.0 has no way at all to write most
/// control characters, so they show as their pictures.
fn escaped(text: &str) -> String {
    escaped_lines(&visible(text))
}

/// The same for text whose parts are visible already and that has lines.
fn escaped_lines(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
        .replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        diagnostic::{Code, Diagnostic},
        report::Suppressed,
    };

    #[test]
    fn only_what_xml_can_hold() {
        let diagnostic = Diagnostic::new(Code::Syntax, 0..0, "<&\"'> ]]> \u{1b}\u{0}\u{ffff}");
        let mut out = Vec::new();
        let mut junit = Box::new(Junit::new(&mut out));
        let report = FileReport {
            file: "<stdin>",
            text: "",
            diagnostics: &[diagnostic],
            suppressed: Suppressed::default(),
            time: std::time::Duration::ZERO,
        };
        junit.file(&report).unwrap();
        junit.finish(&Summary::default()).unwrap();
        let text = String::from_utf8(out).unwrap();
        assert!(
            text.contains("message=\"&lt;&amp;&quot;'&gt; ]]&gt; ␛␀\u{fffd}\" type=\"syntax\""),
            "{text}"
        );
        assert!(
            text.contains("<testsuite name=\"&lt;stdin&gt;\" "),
            "{text}"
        );
    }

    #[test]
    fn errors_that_are_not_listed_fail_too() {
        let mut out = Vec::new();
        let mut junit = Box::new(Junit::new(&mut out));
        let report = FileReport {
            file: "a.ron",
            text: "",
            diagnostics: &[],
            suppressed: Suppressed {
                errors: 2,
                warnings: 0,
            },
            time: std::time::Duration::from_micros(1500),
        };
        junit.file(&report).unwrap();
        junit.finish(&Summary::default()).unwrap();
        let text = String::from_utf8(out).unwrap();
        assert!(text.contains("failures=\"1\""), "{text}");
        assert!(text.contains("… and 2 more errors in this file"), "{text}");
    }
}
