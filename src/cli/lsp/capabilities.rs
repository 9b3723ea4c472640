//! The capabilities of the server.

use serde_json::{Value, json};
use strahl::text::Columns;

use super::client::Client;

/// Characters after which an editor asks for completions.
const TRIGGERS: [&str; 8] = ["\"", "(", "{", "[", ",", ":", "/", "."];

/// Returns the answer to `initialize`: what the server can do, and its name.
pub(super) fn of(client: &Client) -> Value {
    let encoding = match client.columns {
        Columns::Bytes => "utf-8",
        Columns::Utf16 => "utf-16",
        Columns::Characters => "utf-32",
    };
    // 2 stands for edits instead of whole texts.
    let sync = json!({"openClose": true, "change": 2, "save": {}});
    let on_type = json!({"firstTriggerCharacter": "\n", "moreTriggerCharacter": [")", "]", "}"]});
    let diagnostics = json!({
        "identifier": "strahl",
        "interFileDependencies": true,
        "workspaceDiagnostics": true,
    });
    let capabilities = json!({
        "positionEncoding": encoding,
        "textDocumentSync": sync,
        "completionProvider": {"triggerCharacters": TRIGGERS},
        "hoverProvider": true,
        "definitionProvider": true,
        "referencesProvider": true,
        "documentHighlightProvider": true,
        "documentSymbolProvider": true,
        "documentFormattingProvider": true,
        "documentRangeFormattingProvider": true,
        "documentOnTypeFormattingProvider": on_type,
        "renameProvider": {"prepareProvider": true},
        "documentLinkProvider": {},
        "colorProvider": true,
        "foldingRangeProvider": true,
        "codeActionProvider": {"codeActionKinds": ["quickfix", "source.fixAll"]},
        "diagnosticProvider": diagnostics,
        "workspace": {"workspaceFolders": {"supported": true, "changeNotifications": true}},
    });
    let server = json!({"name": "strahl", "version": env!("CARGO_PKG_VERSION")});
    json!({"capabilities": capabilities, "serverInfo": server})
}
