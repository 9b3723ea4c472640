//! A fast reader for scenes in common spelling; the tree reads all others.
//!
//! It is one deserializer for both syntaxes, so that the types of the model are its grammar. All it
//! accepts, the tree accepts, with the same values bit for bit. It never reports faults: a text
//! with a fault is unknown to it. Also unknown are
//!
//! - escapes, raw strings and characters; names with characters other than ASCII letters, digits
//!   and `_`,
//! - numbers other than `-1`, `2.5` and `1e-3`: `1_000`, `.5`, `0x10`, `1f64`, `inf`, …,
//! - attributes and `Some`; white space other than blanks, tabs and line ends.

mod de;
mod list;
pub(crate) mod reader;
mod source;

use std::fs::File;

use serde::Deserialize;

pub(crate) use self::list::LARGE;
use self::{reader::Reader, source::Source};
use crate::{parallel::Pool, scene::format::scene::Model, text::syntax::Syntax};

/// Returns the scene in a text, if all of it is known; all threads of a pool read a long list.
pub(crate) fn model(text: &str, syntax: Syntax, pool: &Pool) -> Option<Model> {
    match syntax {
        Syntax::Ron => whole(Reader::<true>::new(text, 0), pool),
        Syntax::Json => whole(Reader::<false>::new(text, 0), pool),
    }
}

/// Returns the scene in a file of about this many bytes, if all of it is known. The text is never
/// whole in memory, unless its long list is short.
pub(crate) fn file(file: &File, length: usize, syntax: Syntax, pool: &Pool) -> Option<Model> {
    let source = Source::new(file, length).ok()?;
    let model = match syntax {
        Syntax::Ron => whole(Reader::<true>::begin(&source), pool),
        Syntax::Json => whole(Reader::<false>::begin(&source), pool),
    };
    model.filter(|_| source.is_read())
}

fn whole<'t, const RON: bool>(mut reader: Reader<'t, RON>, pool: &'t Pool) -> Option<Model> {
    reader.apart = Some(Vec::new());
    reader.pool = Some(pool);
    let mut model = Model::deserialize(&mut reader).ok()?;
    model.geometries = reader.apart.take()?;
    reader.skip_blank();
    let rest = reader.text.get(reader.at..)?;
    let is_comment = RON && rest.starts_with("//") && !rest.contains('\n');
    (rest.is_empty() || is_comment).then_some(model)
}
