//! Formatting of a text, a part of it, and the line of the cursor.

use std::ops::Range;

use lsp_types::{
    DocumentFormattingParams, DocumentOnTypeFormattingParams, DocumentRangeFormattingParams,
    TextEdit,
};
use strahl::text::Edit;

use super::{
    super::changed_lines::{changed_lines, changed_lines_near},
    document::Snapshot,
    work::Result,
};

/// Returns the edits that format a text, or those near a range; `None` if it has syntax faults.
fn edits(snapshot: &Snapshot, near: Option<Range<usize>>) -> Option<Vec<TextEdit>> {
    let source = snapshot.text.source();
    let (text, formatted) = (source.text(), source.format()?);
    let edits = match near {
        None => changed_lines(text, &formatted),
        Some(range) => changed_lines_near(text, &formatted, &range),
    };
    Some(placed(snapshot, edits))
}

fn placed(snapshot: &Snapshot, edits: impl IntoIterator<Item = Edit>) -> Vec<TextEdit> {
    let places = snapshot.places();
    edits.into_iter().map(|edit| places.edit(edit)).collect()
}

pub(super) fn whole(
    snapshot: &Snapshot,
    _params: DocumentFormattingParams,
) -> Result<Option<Vec<TextEdit>>> {
    Ok(edits(snapshot, None))
}

pub(super) fn range(
    snapshot: &Snapshot,
    params: DocumentRangeFormattingParams,
) -> Result<Option<Vec<TextEdit>>> {
    let range = snapshot.places().offsets(params.range);
    Ok(edits(snapshot, Some(range)))
}

pub(super) fn on_type(
    snapshot: &Snapshot,
    params: DocumentOnTypeFormattingParams,
) -> Result<Option<Vec<TextEdit>>> {
    let places = snapshot.places();
    let mut start = params.text_document_position.position;
    start.character = 0;
    let line = places.offset(start);
    let cursor = places.offset(params.text_document_position.position);
    let text = snapshot.text.as_str();
    let edit = indent(text, line, cursor, &params.ch).and_then(|old| {
        let width = snapshot.text.around(line).indentation(line)?;
        let edit = Edit {
            range: old,
            text: " ".repeat(width),
        };
        (text.get(edit.range.clone()) != Some(&*edit.text)).then_some(edit)
    });
    Ok(Some(placed(snapshot, edit)))
}

/// Returns the range of the blanks that begin a line, if what was typed may change them: a line
/// break, or a bracket that is the first in its line.
fn indent(text: &str, line: usize, cursor: usize, typed: &str) -> Option<Range<usize>> {
    let rest = text.get(line..)?;
    let blank = rest.len() - rest.trim_start_matches([' ', '\t']).len();
    let first = line + blank;
    let is_first = typed == "\n" || first + typed.len() == cursor;
    is_first.then_some(line..first)
}
