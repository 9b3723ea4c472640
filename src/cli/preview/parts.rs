//! The parts of the scene: listing, hiding and adding them.

use axum::Json;
use serde::Deserialize;
use serde_json::{Map, Value, json};
use strahl::session::{PartList, ScenePart};

use super::{
    desk::Desk,
    places::{PagePlace, PageSpan},
    refusal::refuse,
    texts::{Answer, Version, checked, new_edits},
};

/// The most parts that a page gets.
const MOST: usize = 1000;

pub(super) fn list(desk: &Desk, asked: Version) -> Answer {
    let checked = checked(desk, asked.version)?;
    let document = checked.document();
    let lines = document.lines();
    let parts = checked.parts();
    let more = parts.len().saturating_sub(MOST);
    let placed = |part: ScenePart| {
        let span = PageSpan::new(&lines, &part.range);
        json!({
            "kind": part.kind.name(),
            "name": part.name,
            "variant": part.variant,
            "level": part.level,
            "is_hidden": part.is_hidden,
            "from": span.from,
            "to": span.to,
        })
    };
    let parts: Vec<_> = parts.into_iter().take(MOST).map(placed).collect();
    let samples = PartList::ALL.iter().map(|list| {
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
}

/// A change of the parts.
#[derive(Deserialize)]
pub(super) struct Change {
    version: u64,
    /// The place of a part to hide or to show.
    hide_or_show: Option<PagePlace>,
    /// The list that a part is added to.
    list: Option<String>,
    /// The variant of the part.
    add: Option<String>,
}

pub(super) fn change(desk: &Desk, asked: Change) -> Answer {
    let checked = checked(desk, asked.version)?;
    let document = checked.document();
    let list = asked.list.as_deref().and_then(PartList::of_name);
    let edits = match (asked.hide_or_show, list, asked.add) {
        (Some(place), ..) => checked.hide_or_show(place.offset(&document.lines()))?,
        (None, Some(list), Some(variant)) => checked.add_part(list, &variant)?,
        _ => return Err(refuse::impossible("a part is hidden, shown or added")),
    };
    new_edits(document, &edits)
}
