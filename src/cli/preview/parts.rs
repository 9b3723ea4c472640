//! The parts of the scene: listing, hiding and adding them.

use axum::{
    Json,
    extract::{Query, State},
};
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value, json};
use strahl::session::{Part, PartList};

use super::{
    places::{Place, Span},
    routes::{App, apart, refuse},
    texts::{Answer, NewEdits, Version, checked},
};

/// The most parts that a page gets.
const MOST: usize = 1000;

#[derive(Serialize)]
struct PlacedPart {
    kind: &'static str,
    name: String,
    variant: String,
    level: usize,
    is_hidden: bool,
    #[serde(flatten)]
    span: Span,
}

pub(super) async fn list(
    State(App { desk, .. }): State<App>,
    Query(asked): Query<Version>,
) -> Answer {
    apart(move || {
        let checked = checked(&desk, asked.version)?;
        let document = checked.document();
        let lines = document.lines();
        let parts = checked.parts();
        let more = parts.len().saturating_sub(MOST);
        let placed = |part: Part| PlacedPart {
            kind: part.kind.name(),
            name: part.name,
            variant: part.variant,
            level: part.level,
            is_hidden: part.is_hidden,
            span: Span::new(&lines, &part.range),
        };
        let parts: Vec<_> = parts.into_iter().take(MOST).map(placed).collect();
        let samples = PartList::ALL.into_iter().map(|list| {
            let samples = list.samples(document.syntax()).iter();
            let names = samples.map(|(name, _)| Value::from(&**name)).collect();
            (list.name().to_owned(), Value::Array(names))
        });
        Ok(Json(json!({
            "parts": parts,
            "more": more,
            "can_hide": document.syntax() == strahl::Syntax::Ron,
            "samples": samples.collect::<Map<_, _>>(),
        })))
    })
    .await
}

/// A change of the parts.
#[derive(Deserialize)]
pub(super) struct Change {
    version: u64,
    /// The place of a part to hide or to show.
    hide_or_show: Option<Place>,
    /// The list that a part is added to.
    list: Option<String>,
    /// The variant of the part.
    add: Option<String>,
}

pub(super) async fn change(
    State(App { desk, .. }): State<App>,
    Json(asked): Json<Change>,
) -> Answer<NewEdits> {
    apart(move || {
        let checked = checked(&desk, asked.version)?;
        let document = checked.document();
        let list = asked
            .list
            .and_then(|name| PartList::ALL.into_iter().find(|list| list.name() == name));
        let edits = match (asked.hide_or_show, list, asked.add) {
            (Some(place), ..) => checked.hide_or_show(place.offset(&document.lines()))?,
            (None, Some(list), Some(variant)) => checked.add_part(list, &variant)?,
            _ => return Err(refuse::impossible("a part is hidden, shown or added")),
        };
        Ok(Json(NewEdits::new(document, &edits)))
    })
    .await
}
