//! JUnit XML: each file is a test, each error in it a failure.
//!
//! A suite must state its number of failures at its start. With a separate suite for each file,
//! nothing needs to be held back.

use std::{
    io::{self, Write},
    time::Duration,
};

use super::summary::with_use;
use crate::{
    diagnostic::{Severity, plain::paragraph},
    report::{file::FileReport, reporter::Report, summary::Summary},
    text::sanitize::sanitize,
};

/// A writer of JUnit XML, test by test.
///
/// # Examples
///
/// ```
/// use std::time::Duration;
/// use strahl::report::{JunitFailure, JunitWriter};
///
/// let mut junit = JunitWriter::new(Vec::new(), "strahl diff");
/// let failure = JunitFailure { message: "3 pixels differ", kind: "different", text: "" };
/// junit.test("a.png", Duration::ZERO, &[failure], "")?;
/// let text = String::from_utf8(junit.finish()?)?;
/// assert!(text.contains("<failure message=\"3 pixels differ\" type=\"different\"/>"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct JunitWriter<W> {
    out: W,
    name: &'static str,
    open: bool,
}

/// The failure of a test. The text may have several lines; apart from line breaks it is
/// [`sanitize`].
pub struct JunitFailure<'a> {
    /// The failure in one line.
    pub message: &'a str,
    /// The kind of failure, in one word.
    pub kind: &'a str,
    /// The full text, or an empty one.
    pub text: &'a str,
}

impl<W: Write> JunitWriter<W> {
    /// Creates a writer without tests; `name` is the name of the whole.
    pub const fn new(out: W, name: &'static str) -> Self {
        let open = false;
        Self { out, name, open }
    }

    fn open(&mut self) -> io::Result<()> {
        if !self.open {
            self.open = true;
            writeln!(self.out, "<?xml version=\"1.0\" encoding=\"UTF-8\"?>")?;
            writeln!(self.out, "<testsuites name=\"{}\">", self.name)?;
        }
        Ok(())
    }

    /// Writes the test of a file, with its output.
    ///
    /// # Errors
    ///
    /// Fails if the writer fails.
    pub fn test(
        &mut self,
        file: &str,
        time: Duration,
        failures: &[JunitFailure<'_>],
        said: &str,
    ) -> io::Result<()> {
        self.open()?;
        let failed = u8::from(!failures.is_empty());
        let file = escaped(file);
        let time = format!("{:.6}", time.as_secs_f64());
        writeln!(
            self.out,
            "  <testsuite name=\"{file}\" tests=\"1\" failures=\"{failed}\" errors=\"0\" \
             time=\"{time}\">\n    \
             <testcase name=\"{file}\" classname=\"strahl\" time=\"{time}\">",
        )?;
        for failure in failures {
            let (message, kind) = (escaped(failure.message), escaped(failure.kind));
            write!(
                self.out,
                "      <failure message=\"{message}\" type=\"{kind}\""
            )?;
            if failure.text.is_empty() {
                writeln!(self.out, "/>")?;
            } else {
                writeln!(self.out, ">{}</failure>", escaped_lines(failure.text))?;
            }
        }
        if !said.is_empty() {
            let said = escaped_lines(said);
            writeln!(self.out, "      <system-out>{said}</system-out>")?;
        }
        self.out.write_all(b"    </testcase>\n  </testsuite>\n")
    }

    /// Writes the end of the file.
    ///
    /// # Errors
    ///
    /// Fails if the writer fails.
    pub fn finish(mut self) -> io::Result<W> {
        self.open()?;
        self.out.write_all(b"</testsuites>\n")?;
        self.out.flush()?;
        Ok(self.out)
    }
}

pub(super) struct Junit<W>(JunitWriter<W>);

impl<W: Write> Junit<W> {
    pub(super) const fn new(out: W) -> Self {
        Self(JunitWriter::new(out, "strahl validate"))
    }
}

impl<W: Write> Report for Junit<W> {
    fn file(&mut self, report: &FileReport<'_>) -> io::Result<()> {
        let lines = report.lines();
        let of = |severity| {
            let all = report.diagnostics.iter();
            let all = all.filter(move |one| one.severity == severity);
            all.map(|one| {
                let text = with_use(paragraph(report.file, &lines, one), report.used_by);
                (one, one.code.to_string(), text)
            })
        };
        let errors: Vec<_> = of(Severity::Error).collect();
        let failures = errors.iter().map(|(error, kind, text)| JunitFailure {
            message: &error.message,
            kind,
            text,
        });
        let mut failures: Vec<_> = failures.collect();
        let not_listed = report.suppressed.to_string();
        if report.suppressed.errors > 0 {
            // Written as a failure, so that a file does not pass because none of its errors is
            // listed.
            failures.push(JunitFailure {
                message: &not_listed,
                kind: "max-diagnostics",
                text: "",
            });
        }
        let mut said: Vec<_> = of(Severity::Warning).map(|(_, _, text)| text).collect();
        if report.suppressed.errors == 0 && report.suppressed.warnings > 0 {
            said.push(not_listed.clone());
        }
        let said = said.join("\n");
        self.0.test(report.file, report.time, &failures, &said)
    }

    fn finish(self: Box<Self>, _summary: &Summary) -> io::Result<()> {
        self.0.finish().map(drop)
    }
}

/// Returns a text on one line, escaped as an attribute of XML or HTML. XML 1.0 cannot represent
/// most control characters, so their pictures are used.
pub fn escaped(text: &str) -> String {
    escaped_lines(&sanitize(text))
}

/// Escapes a text with lines whose parts are visible already.
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
    fn only_characters_that_xml_allows() {
        let diagnostic = Diagnostic::new(Code::Syntax, 0..0, "<&\"'> ]]> \u{1b}\u{0}\u{ffff}");
        let mut out = Vec::new();
        let mut junit = Box::new(Junit::new(&mut out));
        let report = FileReport {
            file: "<stdin>",
            text: "",
            diagnostics: &[diagnostic],
            suppressed: Suppressed::default(),
            ..FileReport::default()
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
            ..FileReport::default()
        };
        junit.file(&report).unwrap();
        junit.finish(&Summary::default()).unwrap();
        let text = String::from_utf8(out).unwrap();
        assert!(text.contains("failures=\"1\""), "{text}");
        assert!(text.contains("… and 2 more errors in this file"), "{text}");
    }
}
