//! From text to the model: ron and serde_json decide.

use std::ops::Range;

use ron::{error::SpannedResult, extensions::Extensions};
use serde::de::DeserializeOwned;

use crate::{
    diagnostic::{Code, Diagnostic},
    parallel::Pool,
    scene::{format::scene::Model, mend, read, strict::Strict},
    text::syntax::{self, Syntax},
};

/// The model that a text says; a large one is read by all threads of a pool.
pub(crate) fn model(text: &str, syntax: Syntax, pool: &Pool) -> Result<Model, Diagnostic> {
    // Neither of the two knows the byte order mark that some editors write.
    let start = text.len() - text.trim_start_matches('\u{feff}').len();
    let start = start.min('\u{feff}'.len_utf8());
    let body = &text[start..];
    if body.trim().is_empty() {
        let message = "the file is empty, expected a scene";
        return Err(Diagnostic::new(Code::Syntax, start..start, message));
    }
    // What the fast reader does not know, the other two decide.
    if let Some(model) = read::model(body, syntax, pool) {
        return Ok(model);
    }
    judge(body, syntax).map_err(|(range, message)| {
        let range = range.start + start..range.end + start;
        Diagnostic::new(Code::Syntax, range, first_to_lower(&message))
    })
}

/// The field in which `ron` and `serde_json` take more than the format has: within a tuple they do
/// not tell how a value begins, nor that a name alone has something behind it.
const LENIENT: &str = "animation";

/// What `ron` or `serde_json` makes of a text: of a scene, or of a part of one.
pub(crate) fn judge<T: DeserializeOwned>(
    body: &str,
    syntax: Syntax,
) -> Result<T, (Range<usize>, String)> {
    let model = lenient(body, syntax)?;
    if body.contains(LENIENT) {
        let mended = mend::mend::<T>(body, &syntax::parse(body, syntax));
        if let Some(fault) = mended.diagnostics.into_iter().next() {
            return Err((fault.range, fault.message));
        }
    }
    Ok(model)
}

fn lenient<T: DeserializeOwned>(body: &str, syntax: Syntax) -> Result<T, (Range<usize>, String)> {
    match syntax {
        Syntax::Ron => ron(body).map_err(|error| {
            let (from, to) = (error.span.start, error.span.end);
            let from = offset(body, from.line, |line| character(line, from.col));
            let to = offset(body, to.line, |line| character(line, to.col));
            (from..to.max(from), error.code.to_string())
        }),
        Syntax::Json => json(body).map_err(|error| {
            let at = offset(body, error.line(), |_| error.column().saturating_sub(1));
            let text = error.to_string();
            let place = format!(" at line {} column {}", error.line(), error.column());
            (
                at..at,
                text.strip_suffix(&place).unwrap_or(&text).to_owned(),
            )
        }),
    }
}

fn ron<T: DeserializeOwned>(text: &str) -> SpannedResult<T> {
    let extensions = Extensions::IMPLICIT_SOME | Extensions::UNWRAP_VARIANT_NEWTYPES;
    let options = ron::Options::default().with_default_extension(extensions);
    let mut deserializer = ron::Deserializer::from_str_with_options(text, &options)?;
    let model = T::deserialize(Strict::ron(&mut deserializer, text));
    model
        .and_then(|model| deserializer.end().map(|()| model))
        .map_err(|error| deserializer.span_error(error))
}

fn json<T: DeserializeOwned>(text: &str) -> serde_json::Result<T> {
    let mut deserializer = serde_json::Deserializer::from_str(text);
    let model = T::deserialize(Strict::json(&mut deserializer))?;
    deserializer.end()?;
    Ok(model)
}

/// The byte offset of a place in a line, counted from 1.
fn offset(text: &str, line: usize, within: impl Fn(&str) -> usize) -> usize {
    let lines = text.split_inclusive('\n').take(line.saturating_sub(1));
    let start = lines.map(str::len).sum::<usize>().min(text.len());
    (start + within(&text[start..])).min(text.len())
}

/// The byte offset of a character of a line, counted from 1.
fn character(line: &str, column: usize) -> usize {
    let mut characters = line.char_indices().skip(column.saturating_sub(1));
    characters.next().map_or(line.len(), |(at, _)| at)
}

fn first_to_lower(message: &str) -> String {
    let mut letters = message.chars();
    letters.next().map_or_else(String::new, |first| {
        first.to_lowercase().chain(letters).collect()
    })
}
