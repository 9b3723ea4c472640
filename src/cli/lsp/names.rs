//! The names of a scene: definition, references, highlights and rename.

use lsp_server::ErrorCode;
use lsp_types::{
    DocumentHighlight, DocumentHighlightKind, DocumentHighlightParams, GotoDefinitionParams,
    GotoDefinitionResponse, Location, Position, PrepareRenameResponse, ReferenceParams,
    RenameParams, TextDocumentPositionParams, WorkspaceEdit,
};
use strahl::scene::Name;

use super::{actions::workspace_edit, document::Snapshot, outbox::refused, work::Result};

/// Returns the places of the name at a position.
fn places(snapshot: &Snapshot, position: Position) -> Vec<Name> {
    let offset = snapshot.places().offset(position);
    let excerpt = snapshot.text.around(offset);
    let name = excerpt.name_at(offset);
    name.map_or_else(Vec::new, |name| excerpt.places_of(&name))
}

fn locations<'a>(snapshot: &Snapshot, names: impl Iterator<Item = &'a Name>) -> Vec<Location> {
    let places = snapshot.places();
    let location = |name: &Name| Location::new(snapshot.uri.clone(), places.range(&name.range));
    names.map(location).collect()
}

pub(super) fn definition(
    snapshot: &Snapshot,
    params: GotoDefinitionParams,
) -> Result<Option<GotoDefinitionResponse>> {
    let found = places(snapshot, params.text_document_position_params.position);
    let definitions = found.iter().filter(|name| name.definition.is_some());
    let locations = locations(snapshot, definitions);
    let is_known = !locations.is_empty();
    Ok(is_known.then_some(GotoDefinitionResponse::Array(locations)))
}

pub(super) fn references(
    snapshot: &Snapshot,
    params: ReferenceParams,
) -> Result<Option<Vec<Location>>> {
    let found = places(snapshot, params.text_document_position.position);
    let all = params.context.include_declaration;
    let wanted = found.iter().filter(|name| all || name.definition.is_none());
    Ok(Some(locations(snapshot, wanted)))
}

pub(super) fn highlights(
    snapshot: &Snapshot,
    params: DocumentHighlightParams,
) -> Result<Option<Vec<DocumentHighlight>>> {
    let found = places(snapshot, params.text_document_position_params.position);
    let places = snapshot.places();
    let highlights = found.iter().map(|name| DocumentHighlight {
        range: places.range(&name.range),
        kind: Some(match name.definition {
            Some(_) => DocumentHighlightKind::WRITE,
            None => DocumentHighlightKind::READ,
        }),
    });
    Ok(Some(highlights.collect()))
}

pub(super) fn prepare(
    snapshot: &Snapshot,
    params: TextDocumentPositionParams,
) -> Result<Option<PrepareRenameResponse>> {
    let places = snapshot.places();
    let offset = places.offset(params.position);
    let name = snapshot.text.around(offset).name_at(offset);
    Ok(
        name.map(|name| PrepareRenameResponse::RangeWithPlaceholder {
            range: places.range(&name.range),
            placeholder: name.name,
        }),
    )
}

pub(super) fn rename(snapshot: &Snapshot, params: RenameParams) -> Result<Option<WorkspaceEdit>> {
    let places = snapshot.places();
    let offset = places.offset(params.text_document_position.position);
    let excerpt = snapshot.text.around(offset);
    let Some(name) = excerpt.name_at(offset) else {
        let message = "there is no name here that could be changed everywhere";
        return Err(refused(ErrorCode::RequestFailed, message));
    };
    let edits = excerpt.rename(&name, &params.new_name);
    let edits = edits.map_err(|error| refused(ErrorCode::RequestFailed, error.to_string()))?;
    Ok(Some(workspace_edit(snapshot, edits)))
}
