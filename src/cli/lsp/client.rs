//! The capabilities of the client.

use serde_json::Value;
use strahl::text::Columns;

/// The number of folds that are sent unless the client wants fewer.
const FOLDS: usize = 5000;

/// The capabilities of the client that matter.
#[derive(Clone, Debug)]
pub(super) struct Client {
    /// The unit of columns.
    pub(super) columns: Columns,
    /// True if it asks for diagnostics.
    pub(super) pulls: bool,
    /// True if it can be told to ask for diagnostics again.
    pub(super) refreshes: bool,
    /// True if it watches files that it is told to watch.
    pub(super) watches: bool,
    pub(super) document_changes: bool,
    pub(super) related_information: bool,
    pub(super) tags: bool,
    pub(super) markdown_hover: bool,
    pub(super) markdown_completion: bool,
    pub(super) nested_symbols: bool,
    /// The largest number of folds.
    pub(super) folds: usize,
}

impl Client {
    /// Reads the capabilities that the client sent. Anything missing or odd is a capability that it
    /// does not have.
    pub(super) fn new(capabilities: &Value) -> Self {
        let at = |path: &str| capabilities.pointer(path).unwrap_or(&Value::Null);
        let has = |path: &str| at(path).as_bool().unwrap_or(false);
        let lists = |path: &str, word: &str| {
            let list = at(path).as_array();
            list.is_some_and(|list| list.iter().any(|item| item == word))
        };
        let tags = at("/textDocument/publishDiagnostics/tagSupport/valueSet").as_array();
        let folds = at("/textDocument/foldingRange/rangeLimit").as_u64();
        let folds = folds.and_then(|most| usize::try_from(most).ok());
        Self {
            columns: columns(at("/general/positionEncodings")),
            pulls: at("/textDocument/diagnostic").is_object(),
            refreshes: has("/workspace/diagnostics/refreshSupport")
                || has("/workspace/diagnostic/refreshSupport"),
            watches: has("/workspace/didChangeWatchedFiles/dynamicRegistration"),
            document_changes: has("/workspace/workspaceEdit/documentChanges"),
            related_information: has("/textDocument/publishDiagnostics/relatedInformation"),
            tags: tags.is_some_and(|tags| tags.iter().any(|tag| *tag == 1)),
            markdown_hover: lists("/textDocument/hover/contentFormat", "markdown"),
            markdown_completion: lists(
                "/textDocument/completion/completionItem/documentationFormat",
                "markdown",
            ),
            nested_symbols: has("/textDocument/documentSymbol/hierarchicalDocumentSymbolSupport"),
            folds: folds.unwrap_or(FOLDS).min(FOLDS),
        }
    }
}

/// Returns the first unit that the client offers and the program knows; UTF-16 is the default of
/// the protocol.
fn columns(offered: &Value) -> Columns {
    let offered = offered.as_array().into_iter().flatten();
    let mut known = offered.filter_map(|name| match name.as_str()? {
        "utf-8" => Some(Columns::Bytes),
        "utf-16" => Some(Columns::Utf16),
        "utf-32" => Some(Columns::Characters),
        _ => None,
    });
    known.next().unwrap_or(Columns::Utf16)
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn the_first_known_encoding_is_used() {
        let columns = |encodings: Value| {
            Client::new(&json!({"general": {"positionEncodings": encodings}})).columns
        };
        assert_eq!(columns(json!(["x", "utf-8", "utf-16"])), Columns::Bytes);
        assert_eq!(columns(json!(["utf-32"])), Columns::Characters);
        assert_eq!(columns(json!([])), Columns::Utf16);
        assert_eq!(columns(json!(3)), Columns::Utf16);
    }
}
