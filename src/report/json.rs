//! JSON: the whole run as one object, or one object per line.

use std::{
    io::{self, Write},
    ops::Range,
};

use serde::Serialize;
use serde_json::ser::Formatter;

use crate::{
    diagnostic::Diagnostic,
    report::{
        file::{FileReport, UsedBy},
        reporter::Report,
        summary::Summary,
    },
    text::{
        edit::Edit,
        lines::{LineRange, Lines},
        sanitize::shown,
        stamp::{Stamp, Stamped},
    },
};

pub(super) struct Json<W> {
    out: W,
    list: JsonList,
}

impl<W: Write> Json<W> {
    pub(super) const fn new(out: W) -> Self {
        Self {
            out,
            list: JsonList::new("    "),
        }
    }

    /// The head is written with the first file or at the end, so that a report without files has
    /// one too.
    fn open(&mut self) -> io::Result<()> {
        if self.list.is_new() {
            write!(
                self.out,
                "{{\n  {},\n  \"format\": 1,\n  \"diagnostics\": ",
                Stamp::Validate
            )?;
            self.list.open(&mut self.out)?;
        }
        Ok(())
    }
}

impl<W: Write> Report for Json<W> {
    fn file(&mut self, report: &FileReport<'_>) -> io::Result<()> {
        self.open()?;
        let lines = report.lines();
        for diagnostic in report.diagnostics {
            self.list
                .item(&mut self.out, &JsonEntry::new(report, &lines, diagnostic))?;
        }
        Ok(())
    }

    fn finish(mut self: Box<Self>, summary: &Summary) -> io::Result<()> {
        self.open()?;
        self.list.close(&mut self.out)?;
        self.out.write_all(b",\n  \"summary\": ")?;
        write_value(&mut self.out, summary)?;
        self.out.write_all(b"\n}\n")?;
        self.out.flush()
    }
}

pub(super) struct Jsonl<W>(pub(super) W);

impl<W: Write> Report for Jsonl<W> {
    fn file(&mut self, report: &FileReport<'_>) -> io::Result<()> {
        let lines = report.lines();
        for diagnostic in report.diagnostics {
            let entry = JsonEntry::new(report, &lines, diagnostic);
            write_value(&mut self.0, &Stamped::new(Stamp::Diagnostic, entry))?;
            self.0.write_all(b"\n")?;
        }
        Ok(())
    }

    fn finish(mut self: Box<Self>, _summary: &Summary) -> io::Result<()> {
        self.0.flush()
    }
}

#[derive(Serialize)]
struct JsonEntry<'a> {
    file: &'a str,
    #[serde(flatten)]
    span: JsonSpan,
    severity: &'static str,
    code: &'static str,
    message: &'a str,
    help: Option<&'a str>,
    path: String,
    labels: Vec<LabelEntry<'a>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    fix: Option<FixEntry<'a>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    used_by: Option<UsedBy<'a>>,
}

#[derive(Serialize)]
struct FixEntry<'a> {
    is_safe: bool,
    edits: Vec<EditEntry<'a>>,
}

#[derive(Serialize)]
struct EditEntry<'a> {
    #[serde(flatten)]
    span: JsonSpan,
    text: &'a str,
}

#[derive(Serialize)]
struct LabelEntry<'a> {
    #[serde(flatten)]
    span: JsonSpan,
    message: &'a str,
}

#[derive(Serialize)]
struct JsonSpan {
    line: usize,
    column: usize,
    end_line: usize,
    end_column: usize,
}

impl JsonSpan {
    fn new(lines: &Lines<'_>, range: &Range<usize>) -> Self {
        let LineRange { start, end } = LineRange::new(lines, range);
        Self {
            line: start.line,
            column: start.column,
            end_line: end.line,
            end_column: end.column,
        }
    }
}

impl<'a> JsonEntry<'a> {
    fn new(report: &FileReport<'a>, lines: &Lines<'_>, diagnostic: &'a Diagnostic) -> Self {
        let labels = diagnostic.labels.iter().map(|label| LabelEntry {
            span: JsonSpan::new(lines, &label.range),
            message: &label.message,
        });
        let edit = |edit: &'a Edit| EditEntry {
            span: JsonSpan::new(lines, &edit.range),
            text: &edit.text,
        };
        let fix = diagnostic.fix.as_ref().map(|fix| FixEntry {
            is_safe: fix.is_safe,
            edits: fix.edits.iter().map(edit).collect(),
        });
        Self {
            file: report.file,
            span: JsonSpan::new(lines, &diagnostic.range),
            severity: diagnostic.severity.name(),
            code: diagnostic.code.name(),
            message: &diagnostic.message,
            help: diagnostic.help.as_deref(),
            path: diagnostic.path.to_string(),
            labels: labels.collect(),
            fix,
            used_by: report.used_by,
        }
    }
}

/// An array written item by item, one per line.
pub(super) struct JsonList {
    indent: &'static str,
    state: State,
}

enum State {
    New,
    Empty,
    Filled,
}

impl JsonList {
    /// Creates a list; `indent` is the white space before an item. The closing bracket has two
    /// columns less.
    pub(super) const fn new(indent: &'static str) -> Self {
        Self {
            indent,
            state: State::New,
        }
    }

    pub(super) const fn is_new(&self) -> bool {
        matches!(self.state, State::New)
    }

    pub(super) fn open(&mut self, out: &mut impl Write) -> io::Result<()> {
        self.state = State::Empty;
        out.write_all(b"[")
    }

    pub(super) fn item(&mut self, out: &mut impl Write, value: &impl Serialize) -> io::Result<()> {
        let comma = if matches!(self.state, State::Filled) {
            ","
        } else {
            ""
        };
        self.state = State::Filled;
        write!(out, "{comma}\n{}", self.indent)?;
        write_value(out, value)
    }

    pub(super) fn close(&self, out: &mut impl Write) -> io::Result<()> {
        if matches!(self.state, State::Filled) {
            write!(out, "\n{}", self.indent.get(2..).unwrap_or(""))?;
        }
        out.write_all(b"]")
    }
}

/// Writes a value on one line.
pub(super) fn write_value(out: &mut impl Write, value: &impl Serialize) -> io::Result<()> {
    let mut serializer = serde_json::Serializer::with_formatter(out, Readable);
    value.serialize(&mut serializer).map_err(io::Error::from)
}

/// A one-line format with spaces after colons and commas. It escapes every character that a
/// terminal would act on; JSON itself requires this only for the old control characters.
struct Readable;

impl Formatter for Readable {
    fn begin_array_value<W: ?Sized + Write>(&mut self, out: &mut W, first: bool) -> io::Result<()> {
        out.write_all(if first { b"" } else { b", " })
    }

    fn begin_object_key<W: ?Sized + Write>(&mut self, out: &mut W, first: bool) -> io::Result<()> {
        out.write_all(if first { b"" } else { b", " })
    }

    fn begin_object_value<W: ?Sized + Write>(&mut self, out: &mut W) -> io::Result<()> {
        out.write_all(b": ")
    }

    fn write_string_fragment<W: ?Sized + Write>(
        &mut self,
        out: &mut W,
        fragment: &str,
    ) -> io::Result<()> {
        let mut rest = fragment;
        while let Some((at, unsafe_one)) = rest
            .char_indices()
            .find(|(_, character)| shown(*character) != *character)
        {
            let (before, after) = rest.split_at(at);
            out.write_all(before.as_bytes())?;
            // None of them exceeds the 16 bits of an escape.
            write!(out, "\\u{:04x}", u32::from(unsafe_one))?;
            rest = after.get(unsafe_one.len_utf8()..).unwrap_or("");
        }
        out.write_all(rest.as_bytes())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn written(value: &impl Serialize) -> String {
        let mut out = Vec::new();
        write_value(&mut out, value).unwrap();
        String::from_utf8(out).unwrap()
    }

    #[test]
    fn control_characters_in_strings_are_escaped() {
        let text = "\u{1b}[0m \u{9b}0m \u{7f} \u{202e} \u{feff} 日本 🙂 \" \\";
        let json = written(&text);
        assert_eq!(
            json,
            r#""\u001b[0m \u009b0m \u007f \u202e \ufeff 日本 🙂 \" \\""#
        );
        assert_eq!(serde_json::from_str::<String>(&json).unwrap(), text);
    }
}
