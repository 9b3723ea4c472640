//! The draft: reading, editing, saving, and help with writing it.

use std::sync::Arc;

use axum::{
    Json,
    extract::{Query, State},
    http::StatusCode,
    response::{IntoResponse, Response},
};
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};
use strahl::{
    Document,
    session::Checked,
    text::{Edit, Lines},
};

use super::{
    super::{
        changed_lines::changed_lines,
        line_diff::{LineDiff, Side},
    },
    desk::Desk,
    places::{Place, PlacedEdit, Span, shown},
    routes::{App, Refusal, apart, refuse},
};

/// An answer in JSON.
pub(super) type Answer<T = Value> = Result<Json<T>, Refusal>;

pub(super) async fn text(State(App { desk, .. }): State<App>) -> Answer {
    apart(move || {
        let draft = desk.session().draft();
        let text = shown(&draft.text);
        Ok(Json(json!({"version": draft.version, "text": text})))
    })
    .await
}

#[derive(Deserialize)]
pub(super) struct Edits {
    version: u64,
    edits: Vec<PlacedEdit>,
}

pub(super) async fn edit(State(App { desk, .. }): State<App>, Json(asked): Json<Edits>) -> Answer {
    apart(move || {
        let text = desk.session().draft().text;
        let lines = Lines::new(&text);
        let edits = asked.edits.iter().map(|edit| edit.in_text(&lines, &text));
        let edits: Vec<_> = edits.collect();
        let version = desk.session().edit(asked.version, &edits);
        let version = version.ok_or_else(refuse::outdated)?;
        desk.publish();
        Ok(Json(json!({"version": version})))
    })
    .await
}

#[derive(Deserialize)]
pub(super) struct Save {
    version: u64,
    #[serde(default)]
    overwrite: bool,
}

pub(super) async fn save(State(App { desk, .. }): State<App>, Json(asked): Json<Save>) -> Answer {
    apart(move || {
        desk.save(asked.version, asked.overwrite)?;
        Ok(Json(json!({})))
    })
    .await
}

pub(super) async fn reload(State(App { desk, .. }): State<App>) -> Answer {
    apart(move || {
        desk.reload()?;
        Ok(Json(json!({})))
    })
    .await
}

/// Returns the lines of the draft and of the file, each with where it is.
pub(super) async fn disk(State(App { desk, .. }): State<App>) -> Answer {
    apart(move || {
        let text = desk.on_disk();
        let text = text.map_err(|error| refuse::missing(error.to_string()))?;
        let (mine, disk) = (shown(&desk.session().draft().text), shown(&text));
        let diff = LineDiff::new(&mine, &disk);
        let lines = diff.lines().map(|(side, text)| {
            let of = match side {
                Side::Both => "both",
                Side::Old => "mine",
                Side::New => "disk",
            };
            json!({"of": of, "text": text})
        });
        Ok(Json(json!({"lines": lines.collect::<Vec<_>>()})))
    })
    .await
}

/// Returns the last result, if it is of this version.
pub(super) fn checked(desk: &Desk, version: u64) -> Result<Arc<Checked>, Refusal> {
    let checked = desk.session().checked();
    let checked = checked.filter(|checked| checked.version() == version);
    checked.ok_or_else(refuse::outdated)
}

#[derive(Deserialize)]
pub(super) struct Version {
    pub(super) version: u64,
}

#[derive(Serialize)]
pub(super) struct NewEdits {
    edits: Vec<PlacedEdit>,
}

impl NewEdits {
    pub(super) fn new(document: &Document, edits: &[Edit]) -> Self {
        let lines = document.lines();
        let edits = edits.iter().map(|edit| PlacedEdit::new(&lines, edit));
        Self {
            edits: edits.collect(),
        }
    }
}

pub(super) async fn format(
    State(App { desk, .. }): State<App>,
    Json(asked): Json<Version>,
) -> Answer<NewEdits> {
    apart(move || {
        let checked = checked(&desk, asked.version)?;
        let document = checked.document();
        let formatted = document.format();
        let formatted = formatted
            .ok_or_else(|| refuse::impossible("a text with syntax errors cannot be formatted"))?;
        let edits = changed_lines(document.text(), &formatted);
        Ok(Json(NewEdits::new(document, &edits)))
    })
    .await
}

#[derive(Deserialize)]
pub(super) struct At {
    version: u64,
    line: usize,
    column: usize,
}

impl At {
    fn offset(&self, document: &Document) -> usize {
        let (line, column) = (self.line, self.column);
        Place::at(line, column).offset(&document.lines())
    }
}

pub(super) async fn completions(
    State(App { desk, .. }): State<App>,
    Query(asked): Query<At>,
) -> Answer {
    apart(move || {
        let checked = checked(&desk, asked.version)?;
        let document = checked.document();
        let found = document.completions(asked.offset(document));
        let span = Span::new(&document.lines(), &found.range);
        let items = found.items.iter().map(|item| {
            json!({
                "label": item.label,
                "insert": item.insert,
                "kind": item.kind.name(),
                "detail": item.detail,
                "docs": item.docs,
            })
        });
        let items: Vec<_> = items.collect();
        Ok(Json(
            json!({"from": span.from, "to": span.to, "items": items}),
        ))
    })
    .await
}

pub(super) async fn hover(
    State(App { desk, .. }): State<App>,
    Query(asked): Query<At>,
) -> Result<Response, Refusal> {
    apart(move || {
        let checked = checked(&desk, asked.version)?;
        let document = checked.document();
        let Some(found) = document.hover(asked.offset(document)) else {
            return Ok(StatusCode::NO_CONTENT.into_response());
        };
        let span = Span::new(&document.lines(), &found.range);
        let answer = json!({
            "from": span.from,
            "to": span.to,
            "title": found.title,
            "docs": found.docs,
        });
        Ok(Json(answer).into_response())
    })
    .await
}

/// Lines of a version of the text.
#[derive(Deserialize)]
pub(super) struct VersionLines {
    version: u64,
    first: usize,
    last: usize,
}

pub(super) async fn colors(
    State(App { desk, .. }): State<App>,
    Query(asked): Query<VersionLines>,
) -> Answer<Vec<Value>> {
    apart(move || {
        let checked = checked(&desk, asked.version)?;
        let document = checked.document();
        let lines = document.lines();
        let start = |line| Place::at(line, 1).offset(&lines);
        let (first, last) = (start(asked.first), start(asked.last.saturating_add(1)));
        let colors = document.colors(first..last).into_iter().map(|place| {
            let span = Span::new(&lines, &place.range);
            let [r, g, b] = place.color.to_rgb8();
            json!({
                "from": span.from,
                "to": span.to,
                "color": format!("#{r:02x}{g:02x}{b:02x}"),
                "is_string": place.is_string,
            })
        });
        Ok(Json(colors.collect()))
    })
    .await
}
