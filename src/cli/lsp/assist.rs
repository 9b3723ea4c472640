//! Completion and hover.

use lsp_types::{
    CompletionItem, CompletionItemKind, CompletionList, CompletionParams, CompletionResponse,
    Documentation, Hover, HoverContents, HoverParams, MarkupContent, MarkupKind, TextEdit,
};
use strahl::scene::CompletionKind;

use super::{document::Snapshot, work::Result};

pub(super) fn complete(
    snapshot: &Snapshot,
    params: CompletionParams,
) -> Result<Option<CompletionResponse>> {
    let places = snapshot.places();
    let offset = places.offset(params.text_document_position.position);
    let excerpt = snapshot.text.around(offset);
    let found = excerpt.completions(offset, &snapshot.settings.options);
    let range = places.range(&found.range);
    let is_quoted = snapshot
        .text
        .as_str()
        .get(found.range)
        .is_some_and(|word| word.starts_with('"'));
    let items = found
        .items
        .into_iter()
        .enumerate()
        .map(|(index, item)| CompletionItem {
            // An editor compares what is typed, quotes included, and sorts by name otherwise.
            filter_text: is_quoted.then(|| match item.insert.starts_with('"') {
                true => item.insert.clone(),
                false => format!("\"{}", item.label),
            }),
            sort_text: Some(format!("{index:04}")),
            kind: Some(kind(item.kind)),
            documentation: documentation(item.docs, snapshot.client.markdown_completion),
            detail: Some(item.detail).filter(|detail| !detail.is_empty()),
            label: item.label,
            text_edit: Some(TextEdit::new(range, item.insert).into()),
            ..CompletionItem::default()
        });
    Ok(Some(CompletionResponse::List(CompletionList {
        is_incomplete: false,
        items: items.collect(),
    })))
}

const fn kind(kind: CompletionKind) -> CompletionItemKind {
    match kind {
        CompletionKind::Field => CompletionItemKind::FIELD,
        CompletionKind::Variant => CompletionItemKind::CLASS,
        CompletionKind::Name => CompletionItemKind::REFERENCE,
        CompletionKind::Color => CompletionItemKind::COLOR,
        CompletionKind::File => CompletionItemKind::FILE,
        // A folder has a kind only since version 3 of the protocol, like a reference.
        CompletionKind::Folder => CompletionItemKind::FOLDER,
        CompletionKind::Value => CompletionItemKind::VALUE,
    }
}

fn documentation(docs: String, markdown: bool) -> Option<Documentation> {
    match (docs.is_empty(), markdown) {
        (true, _) => None,
        (false, false) => Some(Documentation::String(docs)),
        (false, true) => Some(Documentation::MarkupContent(MarkupContent {
            kind: MarkupKind::Markdown,
            value: docs,
        })),
    }
}

pub(super) fn hover(snapshot: &Snapshot, params: HoverParams) -> Result<Option<Hover>> {
    let places = snapshot.places();
    let offset = places.offset(params.text_document_position_params.position);
    let excerpt = snapshot.text.around(offset);
    let Some(found) = excerpt.hover(offset) else {
        return Ok(None);
    };
    let (kind, title) = match snapshot.client.markdown_hover {
        true => (MarkupKind::Markdown, format!("**{}**", found.title)),
        false => (MarkupKind::PlainText, found.title),
    };
    let value = [&*title, &*found.docs].join("\n\n").trim_end().to_owned();
    Ok(Some(Hover {
        contents: HoverContents::Markup(MarkupContent { kind, value }),
        range: Some(places.range(&found.range)),
    }))
}
