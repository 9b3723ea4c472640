//! The requests that the server answers, each with the function that does.

use lsp_server::{ErrorCode, Request, ResponseError};
use lsp_types::{
    Uri,
    request::{
        CodeActionRequest, ColorPresentationRequest, Completion, DocumentColor,
        DocumentDiagnosticRequest, DocumentHighlightRequest, DocumentLinkRequest,
        DocumentSymbolRequest, FoldingRangeRequest, Formatting, GotoDefinition, HoverRequest,
        OnTypeFormatting, PrepareRenameRequest, RangeFormatting, References, Rename,
        Request as Method, WorkspaceDiagnosticRequest,
    },
};
use serde::Serialize;

use super::{
    assist,
    client::Client,
    colors, diagnostics,
    document::{Snapshot, Waiting, Wish},
    format, names,
    outbox::refused,
    server::Server,
    structure,
    work::{Answer, Pace},
};

/// The result of an answer.
pub(super) type Result<T> = std::result::Result<T, ResponseError>;

/// Answers a request, or has it answered.
pub(super) fn dispatch(server: &mut Server, request: Request) {
    use Pace::{Quick, Slow};

    let at = |place: &lsp_types::TextDocumentPositionParams| place.text_document.uri.clone();
    match &*request.method {
        Completion::METHOD => answer::<Completion>(
            server,
            request,
            Quick,
            |params| at(&params.text_document_position),
            assist::complete,
        ),
        HoverRequest::METHOD => answer::<HoverRequest>(
            server,
            request,
            Quick,
            |params| at(&params.text_document_position_params),
            assist::hover,
        ),
        OnTypeFormatting::METHOD => answer::<OnTypeFormatting>(
            server,
            request,
            Quick,
            |params| at(&params.text_document_position),
            format::on_type,
        ),
        GotoDefinition::METHOD => answer::<GotoDefinition>(
            server,
            request,
            Slow,
            |params| at(&params.text_document_position_params),
            names::definition,
        ),
        References::METHOD => answer::<References>(
            server,
            request,
            Slow,
            |params| at(&params.text_document_position),
            names::references,
        ),
        DocumentHighlightRequest::METHOD => answer::<DocumentHighlightRequest>(
            server,
            request,
            Slow,
            |params| at(&params.text_document_position_params),
            names::highlights,
        ),
        PrepareRenameRequest::METHOD => {
            answer::<PrepareRenameRequest>(server, request, Slow, at, names::prepare);
        }
        Rename::METHOD => answer::<Rename>(
            server,
            request,
            Slow,
            |params| at(&params.text_document_position),
            names::rename,
        ),
        DocumentSymbolRequest::METHOD => answer::<DocumentSymbolRequest>(
            server,
            request,
            Slow,
            |params| params.text_document.uri.clone(),
            structure::symbols,
        ),
        FoldingRangeRequest::METHOD => answer::<FoldingRangeRequest>(
            server,
            request,
            Slow,
            |params| params.text_document.uri.clone(),
            structure::folds,
        ),
        DocumentLinkRequest::METHOD => answer::<DocumentLinkRequest>(
            server,
            request,
            Slow,
            |params| params.text_document.uri.clone(),
            structure::links,
        ),
        DocumentColor::METHOD => answer::<DocumentColor>(
            server,
            request,
            Slow,
            |params| params.text_document.uri.clone(),
            colors::all,
        ),
        ColorPresentationRequest::METHOD => answer::<ColorPresentationRequest>(
            server,
            request,
            Quick,
            |params| params.text_document.uri.clone(),
            colors::presentations,
        ),
        Formatting::METHOD => answer::<Formatting>(
            server,
            request,
            Slow,
            |params| params.text_document.uri.clone(),
            format::whole,
        ),
        RangeFormatting::METHOD => answer::<RangeFormatting>(
            server,
            request,
            Slow,
            |params| params.text_document.uri.clone(),
            format::range,
        ),
        CodeActionRequest::METHOD => wait::<CodeActionRequest>(server, request, |params| {
            let uri = params.text_document.uri.clone();
            (uri, Wish::Actions(params.into()))
        }),
        DocumentDiagnosticRequest::METHOD => {
            wait::<DocumentDiagnosticRequest>(server, request, |params| {
                let known = params.previous_result_id;
                (params.text_document.uri, Wish::Diagnostics(known))
            });
        }
        WorkspaceDiagnosticRequest::METHOD => {
            if let Some(params) = parse::<WorkspaceDiagnosticRequest>(server, &request) {
                server.work.expect(request.id.clone());
                super::workspace::answer(server, request.id, params);
            }
        }
        method => {
            let error = refused(
                ErrorCode::MethodNotFound,
                format!("unknown method `{method}`"),
            );
            server.outbox.respond(request.id, Err(error));
        }
    }
}

/// Returns the parameters of a request, or refuses it.
fn parse<M: Method>(server: &Server, request: &Request) -> Option<M::Params> {
    match serde_json::from_value(request.params.clone()) {
        Ok(params) => Some(params),
        Err(error) => {
            let error = refused(ErrorCode::InvalidParams, error.to_string());
            server.outbox.respond(request.id.clone(), Err(error));
            None
        }
    }
}

/// Answers a request about a document on another thread, from its text at this moment.
fn answer<M: Method>(
    server: &Server,
    request: Request,
    pace: Pace,
    document: impl Fn(&M::Params) -> Uri,
    find: fn(&Snapshot, &Client, M::Params) -> Result<M::Result>,
) where
    M::Params: Send + 'static,
    M::Result: Default,
{
    let Some(params) = parse::<M>(server, &request) else {
        return;
    };
    let uri = document(&params);
    let Some(snapshot) = server.snapshot(&uri) else {
        server.outbox.respond(request.id, Err(not_open(&uri)));
        return;
    };
    let is_scene_file = is_scene_file(server, &uri);
    let client = server.client.clone();
    server.work.expect(request.id.clone());
    server.work.answer(request.id, pace, move |_| {
        // Other files get nothing.
        match is_scene_file && snapshot.text.may_be_scene() {
            true => value(find(&snapshot, &client, params)?),
            false => value(M::Result::default()),
        }
    });
}

fn is_scene_file(server: &Server, uri: &Uri) -> bool {
    let document = server.documents.get(uri.as_str());
    document.is_some_and(|document| document.is_scene_file)
}

/// Answers a request as soon as the diagnostics of the newest text are known.
fn wait<M: Method>(server: &mut Server, request: Request, wish: impl Fn(M::Params) -> (Uri, Wish)) {
    let Some(params) = parse::<M>(server, &request) else {
        return;
    };
    let (uri, wish) = wish(params);
    let Some(document) = server.documents.get_mut(uri.as_str()) else {
        server.outbox.respond(request.id, Err(not_open(&uri)));
        return;
    };
    server.work.expect(request.id.clone());
    let waiting = Waiting {
        id: request.id,
        wish,
    };
    if diagnostics::can_answer(document, &waiting, &server.client) {
        diagnostics::answer(document, waiting, &server.client, &server.work);
    } else {
        document.waiting.push(waiting);
        document.hurry();
    }
}

fn not_open(uri: &Uri) -> ResponseError {
    let message = format!("`{}` is not open", uri.as_str());
    refused(ErrorCode::InvalidParams, message)
}

/// Returns a result as JSON.
pub(super) fn value(result: impl Serialize) -> Answer {
    let value = serde_json::to_value(result);
    value.map_err(|error| refused(ErrorCode::InternalError, error.to_string()))
}
