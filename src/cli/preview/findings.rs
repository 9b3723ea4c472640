//! Diagnostics as pages get them.

use serde::Serialize;
use strahl::{
    Document,
    diagnostic::{Diagnostic, Fix},
    report::limit,
    text::Lines,
};

use super::places::{Place, PlacedEdit, Span};

/// The most diagnostics that a page gets.
const MOST: usize = 200;

#[derive(Serialize)]
pub(super) struct Finding {
    code: &'static str,
    severity: &'static str,
    message: String,
    help: Option<String>,
    path: String,
    #[serde(flatten)]
    span: Span,
    labels: Vec<PlacedLabel>,
    fix: Option<PlacedFix>,
    /// The place in the table or the mesh that is at fault.
    in_file: Option<PlaceInFile>,
}

#[derive(Serialize)]
struct PlaceInFile {
    file: String,
    #[serde(flatten)]
    place: Place,
    message: String,
}

#[derive(Serialize)]
struct PlacedLabel {
    message: String,
    #[serde(flatten)]
    span: Span,
}

#[derive(Serialize)]
struct PlacedFix {
    is_safe: bool,
    edits: Vec<PlacedEdit>,
}

impl Finding {
    /// Returns the first diagnostics of a document; errors are kept before warnings.
    pub(super) fn all(document: &Document) -> Vec<Self> {
        if document.diagnostics().is_empty() {
            // The lines of a long text need not be counted.
            return Vec::new();
        }
        let lines = document.lines();
        let (shown, _) = limit(document.diagnostics(), MOST);
        shown.iter().map(|fault| Self::new(&lines, fault)).collect()
    }

    fn new(lines: &Lines, fault: &Diagnostic) -> Self {
        let fix = |fix: &Fix| PlacedFix {
            is_safe: fix.is_safe,
            edits: fix
                .edits
                .iter()
                .map(|edit| PlacedEdit::new(lines, edit))
                .collect(),
        };
        let labels = fault.labels.iter().map(|label| PlacedLabel {
            message: label.message.clone(),
            span: Span::new(lines, &label.range),
        });
        Self {
            code: fault.code.name(),
            severity: fault.severity.name(),
            message: fault.message.clone(),
            help: fault.help.clone(),
            path: fault.path.to_string(),
            span: Span::new(lines, &fault.range),
            labels: labels.collect(),
            fix: fault.fix.as_ref().map(fix),
            in_file: fault.in_file.as_ref().map(|in_file| {
                let lines = Lines::after(in_file.line - 1, &in_file.text);
                PlaceInFile {
                    file: in_file.file.clone(),
                    place: Place::new(&lines, in_file.range.start),
                    message: in_file.message.clone(),
                }
            }),
        }
    }
}
