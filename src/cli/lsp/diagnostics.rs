//! Diagnostics: pushed with every text, or sent when the client asks.

use std::hash::{DefaultHasher, Hash, Hasher};

use lsp_types::{
    CodeDescription, Diagnostic, DiagnosticRelatedInformation, DiagnosticSeverity, DiagnosticTag,
    Location, NumberOrString, Uri,
};
use serde_json::{Value, json};
use strahl::{
    Document,
    diagnostic::{Code, Severity, page_url},
    report::limit,
};

use super::{
    actions,
    client::Client,
    document::{Latest, OpenDocument, Waiting, Wish},
    outbox::Outbox,
    requests,
    text::Places,
    work::{Pace, Work},
};

/// Returns the diagnostics of a document as the client gets them; errors are kept before warnings.
pub(super) fn all(
    document: &Document,
    places: &Places,
    (uri, client): (&Uri, &Client),
    most: usize,
) -> Vec<Diagnostic> {
    let (kept, _) = limit(document.diagnostics(), most);
    kept.iter()
        .map(|fault| one(fault, places, uri, client))
        .collect()
}

pub(super) fn one(
    fault: &strahl::Diagnostic,
    places: &Places,
    uri: &Uri,
    client: &Client,
) -> Diagnostic {
    let related = fault
        .labels
        .iter()
        .map(|label| DiagnosticRelatedInformation {
            location: Location {
                uri: uri.clone(),
                range: places.range(&label.range),
            },
            message: label.message.clone(),
        });
    let related: Vec<_> = related.collect();
    let is_unused = matches!(fault.code, Code::NoEffect | Code::UnusedDefault);
    let message = match &fault.help {
        Some(help) => format!("{}\n{help}", fault.message),
        None => fault.message.clone(),
    };
    Diagnostic {
        range: places.range(&fault.range),
        severity: Some(match fault.severity {
            Severity::Error => DiagnosticSeverity::ERROR,
            Severity::Warning => DiagnosticSeverity::WARNING,
        }),
        code: Some(NumberOrString::String(fault.code.name().to_owned())),
        code_description: page_url(fault.code)
            .parse()
            .ok()
            .map(|href| CodeDescription { href }),
        source: Some("strahl".to_owned()),
        message,
        related_information: (client.related_information && !related.is_empty()).then_some(related),
        tags: (client.tags && is_unused).then(|| vec![DiagnosticTag::UNNECESSARY]),
        data: None,
    }
}

/// Returns the diagnostics of the newest text.
fn of_document(document: &OpenDocument, latest: &Latest, client: &Client) -> Vec<Diagnostic> {
    if !latest.is_scene {
        return Vec::new();
    }
    let places = document.text.places(client.columns);
    let most = document.settings.most;
    all(
        latest.checked.document(),
        &places,
        (&document.uri, client),
        most,
    )
}

/// Sends the diagnostics of the newest text.
pub(super) fn push(document: &mut OpenDocument, client: &Client, outbox: &Outbox) {
    let Some(latest) = document.latest() else {
        return;
    };
    // Nothing is sent about a file that is not a scene and never was.
    if !latest.is_scene && !document.has_published {
        return;
    }
    let diagnostics = of_document(document, latest, client);
    publish(outbox, &document.uri, Some(document.version), diagnostics);
    document.has_published = true;
}

pub(super) fn publish(
    outbox: &Outbox,
    uri: &Uri,
    version: Option<i32>,
    diagnostics: Vec<Diagnostic>,
) {
    let mut params = json!({"uri": uri, "diagnostics": diagnostics});
    if let Some(version) = version {
        params["version"] = version.into();
    }
    outbox.notify("textDocument/publishDiagnostics", params);
}

/// Answers a request that needs the diagnostics of the newest text.
pub(super) fn answer(document: &OpenDocument, waiting: Waiting, client: &Client, work: &Work) {
    let Waiting { id, wish } = waiting;
    match wish {
        Wish::Diagnostics(known) => {
            let latest = document.latest();
            let items = latest.map(|latest| of_document(document, latest, client));
            let report = report(items.unwrap_or_default(), known.as_deref());
            work.answer(id, Pace::Quick, |_| Ok(report));
        }
        Wish::Actions(params) => {
            let latest = document.latest().filter(|latest| latest.is_scene).cloned();
            let snapshot = document.snapshot(client.columns);
            let client = client.clone();
            work.answer(id, Pace::Slow, move |_| {
                let actions = latest.map(|latest| {
                    actions::all(&snapshot, &client, latest.checked.document(), &params)
                });
                requests::value(actions)
            });
        }
    }
}

/// Returns the report of some diagnostics; that nothing is new, if the client knows them.
pub(super) fn report(items: Vec<Diagnostic>, known: Option<&str>) -> Value {
    let items = json!(items);
    let mut hasher = DefaultHasher::new();
    items.to_string().hash(&mut hasher);
    let id = format!("{:016x}", hasher.finish());
    match known == Some(&*id) {
        true => json!({"kind": "unchanged", "resultId": id}),
        false => json!({"kind": "full", "resultId": id, "items": items}),
    }
}
