//! The draft: reading, editing, saving, and help with writing it.

use std::sync::Arc;

use axum::{
    Json,
    http::StatusCode,
    response::{IntoResponse, Response},
};
use serde::Deserialize;
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
    places::{PagePlace, PageSpan, PlacedEdit, shown},
    refusal::{Refusal, refuse},
};

/// An answer in JSON.
pub(super) type Answer = Result<Json<Value>, Refusal>;

/// A request for which its address says all.
#[derive(Deserialize)]
pub(super) struct Nothing {}

pub(super) fn text(desk: &Desk, _: Nothing) -> Answer {
    let draft = desk.session().draft();
    let text = shown(&draft.text);
    Ok(Json(json!({"version": draft.version, "text": text})))
}

#[derive(Deserialize)]
pub(super) struct Edits {
    version: u64,
    edits: Vec<PlacedEdit>,
}

pub(super) fn edit(desk: &Desk, asked: Edits) -> Answer {
    let text = desk.session().draft().text;
    let lines = Lines::new(&text);
    let edits = asked.edits.iter().map(|edit| edit.in_text(&lines, &text));
    let edits: Vec<_> = edits.collect();
    let version = desk.session().edit(asked.version, &edits);
    let version = version.ok_or_else(refuse::outdated)?;
    desk.publish();
    Ok(Json(json!({"version": version})))
}

#[derive(Deserialize)]
pub(super) struct Save {
    version: u64,
    #[serde(default)]
    overwrite: bool,
}

pub(super) fn save(desk: &Desk, asked: Save) -> Answer {
    desk.save(asked.version, asked.overwrite)?;
    Ok(Json(json!({})))
}

pub(super) fn reload(desk: &Desk, _: Nothing) -> Answer {
    desk.reload()?;
    Ok(Json(json!({})))
}

/// Returns the lines of the draft and of the file, each with where it is.
pub(super) fn disk(desk: &Desk, _: Nothing) -> Answer {
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

/// Answers with edits of a document.
pub(super) fn new_edits(document: &Document, edits: &[Edit]) -> Answer {
    let lines = document.lines();
    let edits = edits.iter().map(|edit| PlacedEdit::new(&lines, edit));
    Ok(Json(json!({"edits": edits.collect::<Vec<_>>()})))
}

pub(super) fn format(desk: &Desk, asked: Version) -> Answer {
    let checked = checked(desk, asked.version)?;
    let document = checked.document();
    let formatted = document.format();
    let formatted = formatted
        .ok_or_else(|| refuse::impossible("a text with syntax errors cannot be formatted"))?;
    let edits = changed_lines(document.text(), &formatted);
    new_edits(document, &edits)
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
        PagePlace::at(line, column).offset(&document.lines())
    }
}

pub(super) fn completions(desk: &Desk, asked: At) -> Answer {
    let checked = checked(desk, asked.version)?;
    let document = checked.document();
    let found = document.completions(asked.offset(document));
    let span = PageSpan::new(&document.lines(), &found.range);
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
}

pub(super) fn hover(desk: &Desk, asked: At) -> Result<Response, Refusal> {
    let checked = checked(desk, asked.version)?;
    let document = checked.document();
    let Some(found) = document.hover(asked.offset(document)) else {
        return Ok(StatusCode::NO_CONTENT.into_response());
    };
    let span = PageSpan::new(&document.lines(), &found.range);
    let answer = json!({
        "from": span.from,
        "to": span.to,
        "title": found.title,
        "docs": found.docs,
    });
    Ok(Json(answer).into_response())
}

/// Lines of a version of the text.
#[derive(Deserialize)]
pub(super) struct VersionLines {
    version: u64,
    first: usize,
    last: usize,
}

pub(super) fn colors(desk: &Desk, asked: VersionLines) -> Answer {
    let checked = checked(desk, asked.version)?;
    let document = checked.document();
    let lines = document.lines();
    let start = |line| PagePlace::at(line, 1).offset(&lines);
    let (first, last) = (start(asked.first), start(asked.last.saturating_add(1)));
    let colors = document.colors(first..last).into_iter().map(|place| {
        let span = PageSpan::new(&lines, &place.range);
        let [r, g, b] = place.color.to_rgb8();
        json!({
            "from": span.from,
            "to": span.to,
            "color": format!("#{r:02x}{g:02x}{b:02x}"),
            "is_string": place.is_string,
        })
    });
    Ok(Json(Value::Array(colors.collect())))
}
