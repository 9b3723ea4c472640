//! `ron` and `serde_json` with the rules of the format around them: the reference for the tree.
//!
//! Within a tuple, neither reports how a value begins, nor that a bare name is followed by
//! something; so they accept more in the keys of an animation than the format.

use ron::{error::SpannedResult, extensions::Extensions};
use serde::de::DeserializeOwned;

use super::strict::Strict;
use crate::{
    diagnostic::Diagnostic,
    parallel::Pool,
    scene::{format::scene::Model, problem::syntax_fault, read, recover},
    text::syntax::{Syntax, parse},
};

/// Reads the model of a text like a scene file.
pub(crate) fn model(text: &str, syntax: Syntax) -> Result<Model, Diagnostic> {
    let body = text.strip_prefix('\u{feff}').unwrap_or(text);
    match read::model(body, syntax, &Pool::Calling) {
        Some(model) => Ok(model),
        None => from_tree(text, syntax),
    }
}

/// Reads the model of a text from the tree, or returns the first fault.
pub(super) fn from_tree(text: &str, syntax: Syntax) -> Result<Model, Diagnostic> {
    let tree = parse(text, syntax);
    if let Some(fault) = tree.faults().first() {
        return Err(syntax_fault(fault));
    }
    let recovered = recover::recover::<Model>(text, &tree, 9);
    match recovered.diagnostics.into_iter().next() {
        Some(fault) => Err(fault),
        None => Ok(recovered.model.expect("a text without a fault is read")),
    }
}

/// Reads a text with `ron` or `serde_json`.
pub(super) fn lenient<T: DeserializeOwned>(body: &str, syntax: Syntax) -> Result<T, String> {
    match syntax {
        Syntax::Ron => ron(body).map_err(|error| error.to_string()),
        Syntax::Json => json(body).map_err(|error| error.to_string()),
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
