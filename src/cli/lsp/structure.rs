//! Symbols, folds and links.

use lsp_types::{
    DocumentLink, DocumentLinkParams, DocumentSymbol, DocumentSymbolParams, DocumentSymbolResponse,
    FoldingRange, FoldingRangeKind, FoldingRangeParams, Location, SymbolInformation,
};
use strahl::scene::{Symbol, SymbolKind};

use super::{document::Snapshot, text::Places, uri, work::Result};

pub(super) fn symbols(
    snapshot: &Snapshot,
    _params: DocumentSymbolParams,
) -> Result<Option<DocumentSymbolResponse>> {
    let places = snapshot.places();
    let symbols = snapshot.text.source().symbols();
    if snapshot.client.nested_symbols {
        let nested = symbols.into_iter().map(|symbol| nested(symbol, &places));
        return Ok(Some(DocumentSymbolResponse::Nested(nested.collect())));
    }
    let mut all = Vec::new();
    flatten(symbols, None, snapshot, &places, &mut all);
    Ok(Some(DocumentSymbolResponse::Flat(all)))
}

/// Returns a kind that every client knows.
const fn kind(kind: SymbolKind) -> lsp_types::SymbolKind {
    match kind {
        SymbolKind::Camera => lsp_types::SymbolKind::INTERFACE,
        SymbolKind::Light => lsp_types::SymbolKind::VARIABLE,
        SymbolKind::Material => lsp_types::SymbolKind::CONSTANT,
        SymbolKind::Geometry => lsp_types::SymbolKind::CLASS,
        SymbolKind::Track => lsp_types::SymbolKind::FUNCTION,
        SymbolKind::List => lsp_types::SymbolKind::NAMESPACE,
        SymbolKind::Field => lsp_types::SymbolKind::FIELD,
    }
}

#[allow(deprecated, reason = "the field has no default")]
fn nested(symbol: Symbol, places: &Places) -> DocumentSymbol {
    let range = places.range(&symbol.range);
    let selection_range = places.range(&symbol.selection);
    let children = symbol
        .children
        .into_iter()
        .map(|child| nested(child, places));
    DocumentSymbol {
        name: symbol.name,
        detail: Some(symbol.detail).filter(|detail| !detail.is_empty()),
        kind: kind(symbol.kind),
        tags: None,
        deprecated: None,
        range,
        selection_range,
        children: Some(children.collect::<Vec<_>>()).filter(|children| !children.is_empty()),
    }
}

#[allow(deprecated, reason = "the field has no default")]
fn flatten(
    symbols: Vec<Symbol>,
    parent: Option<&str>,
    snapshot: &Snapshot,
    places: &Places,
    all: &mut Vec<SymbolInformation>,
) {
    for symbol in symbols {
        all.push(SymbolInformation {
            name: symbol.name.clone(),
            kind: kind(symbol.kind),
            tags: None,
            deprecated: None,
            location: Location::new(snapshot.uri.clone(), places.range(&symbol.range)),
            container_name: parent.map(str::to_owned),
        });
        flatten(symbol.children, Some(&symbol.name), snapshot, places, all);
    }
}

pub(super) fn folds(
    snapshot: &Snapshot,
    _params: FoldingRangeParams,
) -> Result<Option<Vec<FoldingRange>>> {
    let places = snapshot.places();
    let source = snapshot.text.source();
    let mut folds = source.folds();
    // The largest are the most useful ones.
    folds.sort_by_key(|fold| std::cmp::Reverse(fold.range.len()));
    folds.truncate(snapshot.client.folds);
    folds.sort_by_key(|fold| fold.range.start);
    let folds = folds.into_iter().filter_map(|fold| {
        let start = places.position(fold.range.start);
        let mut end = places.position(fold.range.end);
        if !fold.is_comment {
            // The bracket that closes it stays visible, if it is the first in its line.
            let text = source.text().get(fold.range).unwrap_or_default();
            let line = text.rsplit(['\n', '\r']).next().unwrap_or_default();
            end.line -= u32::from(line.trim().len() <= 1 && end.line > start.line);
        }
        (end.line > start.line).then(|| FoldingRange {
            start_line: start.line,
            end_line: end.line,
            kind: fold.is_comment.then_some(FoldingRangeKind::Comment),
            ..FoldingRange::default()
        })
    });
    Ok(Some(folds.collect()))
}

pub(super) fn links(
    snapshot: &Snapshot,
    _params: DocumentLinkParams,
) -> Result<Option<Vec<DocumentLink>>> {
    let places = snapshot.places();
    let links = snapshot.text.source().links(&snapshot.settings.options);
    let links = links.into_iter().filter_map(|link| {
        Some(DocumentLink {
            range: places.range(&link.range),
            target: Some(uri::of_path(&link.path?)?),
            tooltip: None,
            data: None,
        })
    });
    Ok(Some(links.collect()))
}
