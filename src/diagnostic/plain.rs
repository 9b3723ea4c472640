//! A fault as plain text, for a log, a terminal or a program's last message.

use std::{cell::OnceCell, fmt::Write as _};

use crate::{
    diagnostic::{Diagnostic, InFile, Severity},
    text::{
        lines::{LineRange, Lines},
        sanitize::sanitize,
    },
};

/// Returns `FILE:LINE:COL: SEVERITY[CODE]: MESSAGE`.
pub(crate) fn line(file: &str, place: LineRange, diagnostic: &Diagnostic) -> String {
    format!(
        "{}:{}:{}: {}[{}]: {}",
        sanitize(file),
        place.start.line,
        place.start.column,
        diagnostic.severity,
        diagnostic.code,
        sanitize(&diagnostic.message),
    )
}

/// Returns that line, a line for each label and the help: everything that plain text can show.
pub(crate) fn paragraph(file: &str, lines: &Lines<'_>, diagnostic: &Diagnostic) -> String {
    let mut text = line(file, LineRange::new(lines, &diagnostic.range), diagnostic);
    for label in &diagnostic.labels {
        let at = lines.position(label.range.start);
        // Writing to a string cannot fail.
        let _ = write!(
            text,
            "\nnote: {}:{}: {}",
            at.line,
            at.column,
            sanitize(&label.message)
        );
    }
    if let Some(help) = &diagnostic.help {
        let _ = write!(text, "\nhelp: {}", sanitize(help));
    }
    text
}

/// Returns a fault at its place in a file that the scene names.
pub(crate) fn own(fault: &Diagnostic, place: &InFile) -> Diagnostic {
    Diagnostic {
        range: place.range.clone(),
        message: place.message.clone(),
        fix: None,
        labels: Vec::new(),
        in_file: None,
        ..fault.clone()
    }
}

/// The largest number of listed faults.
const MOST: usize = 100;

/// A text: its name, its content and its faults.
type Text<'a> = (&'a str, &'a str, &'a [Diagnostic]);

/// Returns the line of the first fault in some texts, and a paragraph for each fault: errors come
/// before warnings.
pub(crate) fn listing(texts: &[Text<'_>]) -> (String, String) {
    let mut first = String::new();
    let mut listed = Vec::new();
    let mut more = 0;
    for severity in [Severity::Error, Severity::Warning] {
        for (name, text, faults) in texts {
            let mut faults = faults.iter().filter(|fault| fault.severity == severity);
            let lines = OnceCell::new();
            for fault in faults.by_ref().take(MOST - listed.len()) {
                let lines = lines.get_or_init(|| Lines::new(text));
                if let Some(place) = &fault.in_file {
                    let (own, at) = (own(fault, place), Lines::after(place.line - 1, &place.text));
                    if listed.is_empty() {
                        first = line(&place.file, LineRange::new(&at, &own.range), &own);
                    }
                    let used_by = lines.position(fault.range.start);
                    listed.push(format!(
                        "{}\nnote: used by {}:{}:{}",
                        paragraph(&place.file, &at, &own),
                        sanitize(name),
                        used_by.line,
                        used_by.column
                    ));
                    continue;
                }
                if listed.is_empty() {
                    first = line(name, LineRange::new(lines, &fault.range), fault);
                }
                listed.push(paragraph(name, lines, fault));
            }
            more += faults.count();
        }
    }
    if more > 0 {
        listed.push(format!("… and {more} more"));
    }
    (first, listed.join("\n"))
}
