//! A fast reader of scenes as nearly all are written; what it does not know is left to the tree.
//!
//! It is one deserializer for both syntaxes, so that the types of the model are its grammar. What
//! it takes, the tree takes, and its values are the same bit for bit. It never tells what is wrong: a
//! text with a fault is one that it does not know. Nor does it know
//!
//! - escapes, raw strings and characters; names that are not of ASCII letters, digits and `_`,
//! - numbers other than `-1`, `2.5` and `1e-3`: `1_000`, `.5`, `0x10`, `1f64`, `inf`, …,
//! - attributes and `Some`; white space other than blanks, tabs and ends of lines.

mod de;
mod list;
mod reader;
mod source;

use std::fs::File;

use serde::Deserialize;

pub(crate) use self::list::LARGE;
use self::{reader::Reader, source::Source};
use crate::{parallel::Pool, scene::format::scene::Model, text::syntax::Syntax};

/// The scene that a text is, if all of it is known; a long list is read by all threads of a pool.
pub(crate) fn model(text: &str, syntax: Syntax, pool: &Pool) -> Option<Model> {
    match syntax {
        Syntax::Ron => whole(Reader::<true>::new(text, 0), pool),
        Syntax::Json => whole(Reader::<false>::new(text, 0), pool),
    }
}

/// The scene that a file of about so many bytes is, if all of it is known. The text is never whole
/// in memory, unless its long list is short.
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
    (reader.at == reader.text.len()).then_some(model)
}
