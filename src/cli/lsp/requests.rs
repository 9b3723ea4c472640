//! The requests that the server answers, each with the function that does.

use lsp_server::{ErrorCode, Request, ResponseError};
use lsp_types::{
    DocumentDiagnosticParams,
    request::{
        CodeActionRequest, ColorPresentationRequest, Completion, DocumentColor,
        DocumentDiagnosticRequest, DocumentHighlightRequest, DocumentLinkRequest,
        DocumentSymbolRequest, FoldingRangeRequest, Formatting, GotoDefinition, HoverRequest,
        OnTypeFormatting, PrepareRenameRequest, RangeFormatting, References, Rename,
        Request as Method, WorkspaceDiagnosticRequest,
    },
};

use super::{
    assist, colors, diagnostics,
    document::{Snapshot, Waiting, Wish},
    format, names,
    outbox::refused,
    server::Server,
    structure,
    work::{Pace, Result},
};

/// The requests about one document, each with its pace and the function that finds the answer.
macro_rules! answers {
    ($server:ident, $request:ident, {$($method:ident: $pace:ident, $find:path;)*}) => {
        match &*$request.method {
            $($method::METHOD => answer::<$method>($server, $request, $pace, $find),)*
            method => {
                let message = format!("unknown method `{method}`");
                Err(refused(ErrorCode::MethodNotFound, message))
            }
        }
    };
}

/// Answers a request, or has it answered.
pub(super) fn dispatch(server: &mut Server, request: Request) {
    use Pace::{Quick, Slow};

    let id = request.id.clone();
    let done = match &*request.method {
        CodeActionRequest::METHOD => {
            wait::<CodeActionRequest>(server, request, |params| Wish::Actions(params.into()))
        }
        DocumentDiagnosticRequest::METHOD => {
            let wish =
                |params: DocumentDiagnosticParams| Wish::Diagnostics(params.previous_result_id);
            wait::<DocumentDiagnosticRequest>(server, request, wish)
        }
        WorkspaceDiagnosticRequest::METHOD => {
            parse::<WorkspaceDiagnosticRequest>(&request).map(|params| {
                server.work.expect(request.id.clone());
                super::workspace::answer(server, request.id, params);
            })
        }
        _ => answers!(server, request, {
            Completion: Quick, assist::complete;
            HoverRequest: Quick, assist::hover;
            OnTypeFormatting: Quick, format::on_type;
            GotoDefinition: Slow, names::definition;
            References: Slow, names::references;
            DocumentHighlightRequest: Slow, names::highlights;
            PrepareRenameRequest: Slow, names::prepare;
            Rename: Slow, names::rename;
            DocumentSymbolRequest: Slow, structure::symbols;
            FoldingRangeRequest: Slow, structure::folds;
            DocumentLinkRequest: Slow, structure::links;
            DocumentColor: Slow, colors::all;
            ColorPresentationRequest: Quick, colors::presentations;
            Formatting: Slow, format::whole;
            RangeFormatting: Slow, format::range;
        }),
    };
    if let Err(error) = done {
        server.outbox.respond::<()>(&id, Err(error));
    }
}

/// Returns the parameters of a request.
fn parse<M: Method>(request: &Request) -> Result<M::Params> {
    let params = serde_json::from_value(request.params.clone());
    params.map_err(|error| refused(ErrorCode::InvalidParams, error.to_string()))
}

/// Returns the address of the document that a request is about.
fn uri_of(request: &Request) -> &str {
    let uri = &request.params["textDocument"]["uri"];
    uri.as_str().unwrap_or_default()
}

/// Answers a request about a document on another thread, from its text at this moment.
fn answer<M: Method>(
    server: &Server,
    request: Request,
    pace: Pace,
    find: fn(&Snapshot, M::Params) -> Result<M::Result>,
) -> Result<()>
where
    M::Params: Send + 'static,
    M::Result: Default,
{
    let (params, uri) = (parse::<M>(&request)?, uri_of(&request));
    let document = server.documents.get(uri).ok_or_else(|| not_open(uri))?;
    let is_scene_file = document.is_scene_file;
    let snapshot = document.snapshot(&server.client);
    server.work.expect(request.id.clone());
    server.work.answer(request.id, pace, move |_| {
        // Other files get nothing.
        match is_scene_file && snapshot.text.may_be_scene() {
            true => find(&snapshot, params),
            false => Ok(M::Result::default()),
        }
    });
    Ok(())
}

/// Answers a request as soon as the diagnostics of the newest text are known.
fn wait<M: Method>(
    server: &mut Server,
    request: Request,
    wish: impl Fn(M::Params) -> Wish,
) -> Result<()> {
    let (wish, uri) = (wish(parse::<M>(&request)?), uri_of(&request));
    let document = server.documents.get_mut(uri);
    let document = document.ok_or_else(|| not_open(uri))?;
    server.work.expect(request.id.clone());
    let id = request.id;
    diagnostics::answer_or_wait(document, Waiting { id, wish }, &server.client, &server.work);
    Ok(())
}

fn not_open(uri: &str) -> ResponseError {
    refused(ErrorCode::InvalidParams, format!("`{uri}` is not open"))
}
