//! SARIF 2.1.0, for code scanning services and editors.
//!
//! <https://docs.oasis-open.org/sarif/sarif/v2.1.0/sarif-v2.1.0.html>

pub(super) mod uri;

use std::{
    io::{self, Write},
    ops::Range,
};

use serde::Serialize;

use super::{
    json::{JsonList, write_value},
    summary::counted,
};
use crate::{
    diagnostic::{Code, Diagnostic, Suppressed, explain::page_url},
    report::{
        file::{FileReport, UsedBy},
        reporter::{Describe, Report},
        summary::Summary,
    },
    text::lines::{LineRange, Lines},
};

pub(super) struct Sarif<W> {
    out: W,
    describe: Describe,
    results: JsonList,
    not_listed: Suppressed,
}

impl<W: Write> Sarif<W> {
    pub(super) fn new(out: W, describe: Describe) -> Self {
        Self {
            out,
            describe,
            results: JsonList::new("        "),
            not_listed: Suppressed::default(),
        }
    }

    fn open(&mut self) -> io::Result<()> {
        if !self.results.is_new() {
            return Ok(());
        }
        let out = &mut self.out;
        write!(
            out,
            r#"{{
  "$schema": "https://json.schemastore.org/sarif-2.1.0.json",
  "version": "2.1.0",
  "runs": [
    {{
      "tool": {{
        "driver": {{
          "name": "strahl",
          "version": "{}",
          "rules": "#,
            env!("CARGO_PKG_VERSION"),
        )?;
        let mut rules = JsonList::new("            ");
        rules.open(out)?;
        for code in Code::ALL {
            rules.item(out, &Rule::new(*code, (self.describe)(*code)))?;
        }
        rules.close(out)?;
        out.write_all(b"\n        }\n      },\n      \"columnKind\": \"unicodeCodePoints\",\n")?;
        out.write_all(b"      \"results\": ")?;
        self.results.open(out)
    }
}

impl<W: Write> Report for Sarif<W> {
    fn file(&mut self, report: &FileReport<'_>) -> io::Result<()> {
        self.open()?;
        self.not_listed.errors += report.suppressed.errors;
        self.not_listed.warnings += report.suppressed.warnings;
        let lines = report.lines();
        let bytes = report.path.map(|path| path.as_os_str().as_encoded_bytes());
        let bytes = bytes.unwrap_or(report.file.as_bytes());
        let uri = uri::of_bytes(bytes, cfg!(windows));
        let used_by = report.used_by;
        let used_by =
            used_by.map(|place| (uri::of_bytes(place.file.as_bytes(), cfg!(windows)), place));
        for diagnostic in report.diagnostics {
            let mut finding = Finding::new(&uri, &lines, diagnostic);
            let related = used_by
                .iter()
                .map(|(uri, place)| Location::used_by(uri, place));
            finding.related_locations.extend(related);
            self.results.item(&mut self.out, &finding)?;
        }
        Ok(())
    }

    fn finish(mut self: Box<Self>, _summary: &Summary) -> io::Result<()> {
        self.open()?;
        self.results.close(&mut self.out)?;
        self.out.write_all(b",\n      \"invocations\": ")?;
        let notifications = if self.not_listed.is_empty() {
            Vec::new()
        } else {
            vec![Notification::not_listed(self.not_listed)]
        };
        let invocation = Invocation {
            // The success of the program, which ran to the end, not of the scenes.
            execution_successful: true,
            tool_execution_notifications: notifications,
        };
        write_value(&mut self.out, &[invocation])?;
        self.out.write_all(b"\n    }\n  ]\n}\n")?;
        self.out.flush()
    }
}

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
struct Rule<'a> {
    id: &'a str,
    short_description: Message<'a>,
    full_description: Message<'a>,
    help: Help<'a>,
    help_uri: String,
    default_configuration: Configuration,
}

impl<'a> Rule<'a> {
    fn new(code: Code, page: &'a str) -> Self {
        let mut paragraphs = page
            .split("\n\n")
            .map(str::trim)
            .filter(|paragraph| !paragraph.is_empty() && !paragraph.starts_with('#'));
        let short = paragraphs.next().unwrap_or(code.name());
        Self {
            id: code.name(),
            short_description: Message::new(short),
            full_description: Message::new(paragraphs.next().unwrap_or(short)),
            help: Help {
                text: page,
                markdown: page,
            },
            help_uri: page_url(code),
            default_configuration: Configuration {
                enabled: code.on_by_default(),
                level: code.severity().name(),
            },
        }
    }
}

#[derive(Serialize)]
struct Help<'a> {
    text: &'a str,
    markdown: &'a str,
}

#[derive(Serialize)]
struct Configuration {
    enabled: bool,
    level: &'static str,
}

#[derive(Serialize)]
struct Message<'a> {
    text: std::borrow::Cow<'a, str>,
}

impl<'a> Message<'a> {
    fn new(text: impl Into<std::borrow::Cow<'a, str>>) -> Self {
        Self { text: text.into() }
    }
}

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
struct Finding<'a> {
    rule_id: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    rule_index: Option<usize>,
    level: &'static str,
    message: Message<'a>,
    locations: [Location<'a>; 1],
    #[serde(skip_serializing_if = "Vec::is_empty")]
    related_locations: Vec<Location<'a>>,
}

impl<'a> Finding<'a> {
    fn new(uri: &'a str, lines: &Lines<'_>, diagnostic: &'a Diagnostic) -> Self {
        let message = match &diagnostic.help {
            Some(help) => Message::new(format!("{}\nhelp: {help}", diagnostic.message)),
            None => Message::new(&*diagnostic.message),
        };
        let mut location = Location::new(uri, Region::new(lines, &diagnostic.range));
        if !diagnostic.path.steps().is_empty() {
            location.logical_locations.push(LogicalLocation {
                fully_qualified_name: diagnostic.path.to_string(),
            });
        }
        let related = diagnostic.labels.iter().map(|label| Location {
            message: Some(Message::new(&*label.message)),
            ..Location::new(uri, Region::new(lines, &label.range))
        });
        Self {
            rule_id: diagnostic.code.name(),
            rule_index: Code::ALL.iter().position(|code| *code == diagnostic.code),
            level: diagnostic.severity.name(),
            message,
            locations: [location],
            related_locations: related.collect(),
        }
    }
}

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
struct Location<'a> {
    #[serde(skip_serializing_if = "Option::is_none")]
    message: Option<Message<'a>>,
    physical_location: PhysicalLocation<'a>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    logical_locations: Vec<LogicalLocation>,
}

impl<'a> Location<'a> {
    /// Creates the place that names the file of a finding.
    fn used_by(uri: &'a str, place: &UsedBy<'_>) -> Self {
        let UsedBy { line, column, .. } = *place;
        let region = Region {
            start_line: line,
            start_column: column,
            end_line: line,
            end_column: column,
        };
        Self {
            message: Some(Message::new("used by this file")),
            ..Self::new(uri, region)
        }
    }

    const fn new(uri: &'a str, region: Region) -> Self {
        Self {
            message: None,
            physical_location: PhysicalLocation {
                artifact_location: ArtifactLocation { uri },
                region,
            },
            logical_locations: Vec::new(),
        }
    }
}

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
struct LogicalLocation {
    fully_qualified_name: String,
}

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
struct PhysicalLocation<'a> {
    artifact_location: ArtifactLocation<'a>,
    region: Region,
}

#[derive(Serialize)]
struct ArtifactLocation<'a> {
    uri: &'a str,
}

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
struct Region {
    start_line: usize,
    start_column: usize,
    end_line: usize,
    end_column: usize,
}

impl Region {
    fn new(lines: &Lines<'_>, range: &Range<usize>) -> Self {
        let LineRange { start, end } = LineRange::new(lines, range);
        Self {
            start_line: start.line,
            start_column: start.column,
            end_line: end.line,
            end_column: end.column,
        }
    }
}

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
struct Invocation {
    execution_successful: bool,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    tool_execution_notifications: Vec<Notification>,
}

#[derive(Serialize)]
struct Notification {
    level: &'static str,
    message: Message<'static>,
}

impl Notification {
    fn not_listed(count: Suppressed) -> Self {
        let errors = counted(count.errors, "error");
        let warnings = counted(count.warnings, "warning");
        Self {
            level: "warning",
            message: Message::new(format!(
                "{errors} and {warnings} are not listed, because a file has more than asked for"
            )),
        }
    }
}
