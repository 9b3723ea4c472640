//! Diagnostics: pushed with every text, or sent when the client asks.

use std::{
    hash::{DefaultHasher, Hash, Hasher},
    sync::Arc,
};

use lsp_types::{
    CodeDescription, Diagnostic, DiagnosticRelatedInformation, DiagnosticSeverity, DiagnosticTag,
    Location, NumberOrString, Uri,
};
use serde_json::{Value, json};
use strahl::{
    diagnostic::{Code, Severity, page_url},
    report::limit,
};

use super::{
    actions,
    client::Client,
    document::{Latest, OpenDocument, Waiting, Wish},
    outbox::Outbox,
    text::Places,
    work::{Pace, Work},
};

/// Returns the diagnostics of a text as the client gets them; errors are kept before warnings.
pub(super) fn all(
    found: &[strahl::Diagnostic],
    places: &Places,
    (uri, client): (&Uri, &Client),
    most: usize,
) -> Vec<Diagnostic> {
    let (kept, _) = limit(found, most);
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
            location: Location::new(uri.clone(), places.range(&label.range)),
            message: label.message.clone(),
        });
    // Its own file has no diagnostics: the client may not even show it as a text.
    let in_file = fault.in_file.iter().filter_map(|place| {
        let uri = super::uri::of_path(&std::path::absolute(&place.file).ok()?)?;
        let places = Places::after(place.line - 1, &place.text, client.columns);
        Some(DiagnosticRelatedInformation {
            location: Location::new(uri, places.range(&place.range)),
            message: place.message.clone(),
        })
    });
    let related: Vec<_> = related.chain(in_file).collect();
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
    all(&latest.diagnostics, &places, (&document.uri, client), most)
}

/// Tells the client the diagnostics of the newest text, unless it knows them.
pub(super) fn tell(document: &mut OpenDocument, client: &Client, outbox: &Outbox) {
    let Some(latest) = document.latest() else {
        return;
    };
    // Nothing is sent about a file that is not a scene and never was.
    if !client.pulls && !latest.is_scene && !document.has_published {
        return;
    }
    let found = of_document(document, latest, client);
    if client.pulls {
        // One that has asked before the check was finished asks again.
        if document.has_other(&found) {
            refresh(client, outbox);
        }
    } else if document.tell(&found) {
        publish(outbox, &document.uri, Some(document.version), found);
        document.has_published = true;
    }
}

/// Tells a client that asks for diagnostics to ask again.
pub(super) fn refresh(client: &Client, outbox: &Outbox) {
    if client.pulls && client.refreshes {
        outbox.request("workspace/diagnostic/refresh", Value::Null);
    }
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

/// Returns true if a request that needs the diagnostics of the newest text can be answered. Until
/// the whole text is checked, that is one whose client can be told of more, or one about a place.
fn can_answer(document: &OpenDocument, waiting: &Waiting, client: &Client) -> bool {
    match document.latest() {
        None => !document.is_scene_file,
        Some(latest) if latest.whole.is_some() => true,
        Some(_) => match &waiting.wish {
            Wish::Diagnostics(_) => client.refreshes,
            Wish::Actions(params) => !actions::is_of_file(params),
        },
    }
}

/// Answers a request that needs the diagnostics of the newest text, or lets it wait for them.
pub(super) fn answer_or_wait(
    document: &mut OpenDocument,
    waiting: Waiting,
    client: &Arc<Client>,
    work: &Work,
) {
    if !can_answer(document, &waiting, client) {
        document.waiting.push(waiting);
        document.hurry();
        return;
    }
    let Waiting { id, wish } = waiting;
    match wish {
        Wish::Diagnostics(known) => {
            let latest = document.latest();
            let items = latest.map(|latest| of_document(document, latest, client));
            let items = items.unwrap_or_default();
            document.tell(&items);
            let report = report(items, known.as_deref());
            work.answer(id, Pace::Quick, |_| Ok(report));
        }
        Wish::Actions(params) => {
            let latest = document.latest().filter(|latest| latest.is_scene).cloned();
            let snapshot = document.snapshot(client);
            work.answer(id, Pace::Slow, move |_| {
                Ok(latest.map(|latest| actions::all(&snapshot, &latest, &params)))
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
