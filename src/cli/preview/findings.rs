//! Diagnostics as pages get them.

use serde_json::{Value, json};
use strahl::{
    Document,
    diagnostic::{Diagnostic, Fix},
    report::limit,
    text::Lines,
};

use super::places::{PagePlace, PageSpan, PlacedEdit};

/// The most diagnostics that a page gets.
const MOST: usize = 200;

/// Returns the first diagnostics of a document; errors are kept before warnings.
pub(super) fn all(document: &Document) -> Vec<Value> {
    if document.diagnostics().is_empty() {
        // The lines of a long text need not be counted.
        return Vec::new();
    }
    let lines = document.lines();
    let (shown, _) = limit(document.diagnostics(), MOST);
    shown.iter().map(|fault| one(&lines, fault)).collect()
}

fn one(lines: &Lines, fault: &Diagnostic) -> Value {
    let labels = fault.labels.iter().map(|label| {
        let PageSpan { from, to } = PageSpan::new(lines, &label.range);
        json!({"message": label.message, "from": from, "to": to})
    });
    let fix = |fix: &Fix| {
        let edits = fix.edits.iter().map(|edit| PlacedEdit::new(lines, edit));
        json!({"is_safe": fix.is_safe, "edits": edits.collect::<Vec<_>>()})
    };
    // The place in the table or the mesh that is at fault.
    let in_file = fault.in_file.as_ref().map(|in_file| {
        let lines = Lines::after(in_file.line - 1, &in_file.text);
        let PagePlace { line, column } = PagePlace::new(&lines, in_file.range.start);
        let (file, message) = (&in_file.file, &in_file.message);
        json!({"file": file, "line": line, "column": column, "message": message})
    });
    let PageSpan { from, to } = PageSpan::new(lines, &fault.range);
    json!({
        "code": fault.code.name(),
        "severity": fault.severity.name(),
        "message": fault.message,
        "help": fault.help,
        "path": fault.path.to_string(),
        "from": from,
        "to": to,
        "labels": labels.collect::<Vec<_>>(),
        "fix": fault.fix.as_ref().map(fix),
        "in_file": in_file,
    })
}
