//! Code actions: the fixes of diagnostics, and all safe ones at once.

use std::collections::HashMap;

use lsp_types::{
    CodeAction, CodeActionKind, CodeActionOrCommand, CodeActionParams, CodeActionTriggerKind,
    DocumentChanges, OneOf, OptionalVersionedTextDocumentIdentifier, TextDocumentEdit,
    WorkspaceEdit,
};
use strahl::{diagnostic::Fix, text::Edit};

use super::{
    super::changed_lines::changed_lines,
    diagnostics,
    document::{Latest, Snapshot},
};

/// The longest text that a title shows.
const LONGEST: usize = 40;
const FIX_ALL: CodeActionKind = CodeActionKind::SOURCE_FIX_ALL;

/// Returns the actions for a range of a text that was checked.
pub(super) fn all(
    snapshot: &Snapshot,
    latest: &Latest,
    params: &CodeActionParams,
) -> Vec<CodeActionOrCommand> {
    let places = snapshot.places();
    let range = places.offsets(params.range);
    let mut actions = Vec::new();
    if wants(params, &CodeActionKind::QUICKFIX) {
        let here = latest
            .diagnostics
            .iter()
            .filter(|fault| fault.range.start <= range.end && range.start <= fault.range.end);
        let fixes = here.filter_map(|fault| Some((fault, fault.fix.as_ref()?)));
        actions.extend(fixes.map(|(fault, fix)| CodeAction {
            title: title(snapshot.text.as_str(), fix, &fault.message),
            kind: Some(CodeActionKind::QUICKFIX),
            diagnostics: Some(vec![diagnostics::one(
                fault,
                &places,
                &snapshot.uri,
                &snapshot.client,
            )]),
            edit: Some(workspace_edit(snapshot, fix.edits.clone())),
            is_preferred: Some(fix.is_safe),
            ..CodeAction::default()
        }));
    }
    if is_of_file(params)
        && let Some(whole) = &latest.whole
    {
        let fixed = whole.document().findings().fixed();
        actions.extend(fixed.map(|(text, count)| {
            let edits = changed_lines(snapshot.text.as_str(), &text);
            CodeAction {
                title: match count {
                    1 => "Apply the safe fix".to_owned(),
                    count => format!("Apply all {count} safe fixes"),
                },
                kind: Some(FIX_ALL),
                edit: Some(workspace_edit(snapshot, edits)),
                ..CodeAction::default()
            }
        }));
    }
    let actions = actions.into_iter();
    actions.map(CodeActionOrCommand::CodeAction).collect()
}

fn wants(params: &CodeActionParams, kind: &CodeActionKind) -> bool {
    let only = params.context.only.as_deref();
    only.is_none_or(|only| only.iter().any(|wanted| includes(wanted, kind)))
}

/// Returns true if all fixes of the file are among the actions.
pub(super) fn is_of_file(params: &CodeActionParams) -> bool {
    let context = &params.context;
    // With every move of the cursor, all fixes would be too many.
    let is_automatic = context.trigger_kind == Some(CodeActionTriggerKind::AUTOMATIC);
    wants(params, &FIX_ALL) && (context.only.is_some() || !is_automatic)
}

/// Returns true if a kind is the wanted one, or below it; all fixes may also be asked for by name.
fn includes(wanted: &CodeActionKind, kind: &CodeActionKind) -> bool {
    let (wanted, kind) = (wanted.as_str(), kind.as_str());
    let rest = kind.strip_prefix(wanted);
    rest.is_some_and(|rest| wanted.is_empty() || rest.is_empty() || rest.starts_with('.'))
        || wanted.strip_prefix(kind) == Some(".strahl")
}

/// Returns what a fix does, in a few words.
fn title(text: &str, fix: &Fix, message: &str) -> String {
    let whole = || format!("Fix: {message}");
    let [Edit { range, text: new }] = &*fix.edits else {
        return whole();
    };
    let old = text.get(range.clone()).unwrap_or_default().trim();
    let new = new.trim();
    let is_short = |text: &str| text.len() <= LONGEST && !text.contains(['\n', '\r', '`']);
    match (old.is_empty(), new.is_empty()) {
        (true, false) if is_short(new) => format!("Insert `{new}`"),
        (false, true) if is_short(old) => format!("Remove `{old}`"),
        (false, false) if is_short(new) => format!("Replace with `{new}`"),
        _ => whole(),
    }
}

/// Returns edits of a document, for the version that they were made for if the client can tell.
#[allow(
    clippy::mutable_key_type,
    reason = "the protocol's type; nothing changes the address"
)]
pub(super) fn workspace_edit(snapshot: &Snapshot, edits: Vec<Edit>) -> WorkspaceEdit {
    let places = snapshot.places();
    let edits = edits.into_iter().map(|edit| places.edit(edit));
    if !snapshot.client.document_changes {
        return WorkspaceEdit::new(HashMap::from([(snapshot.uri.clone(), edits.collect())]));
    }
    let edit = TextDocumentEdit {
        text_document: OptionalVersionedTextDocumentIdentifier {
            uri: snapshot.uri.clone(),
            version: Some(snapshot.version),
        },
        edits: edits.map(OneOf::Left).collect(),
    };
    WorkspaceEdit {
        document_changes: Some(DocumentChanges::Edits(vec![edit])),
        ..WorkspaceEdit::default()
    }
}
