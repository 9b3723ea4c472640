//! Collection of all faults in a text that is not a valid scene, in one run.
//!
//! The serde types of the model are deserialised from the syntax tree. Everything that does not fit
//! is noted and repaired on the way, so that serde never sees an error: an unknown field is dropped
//! or taken for the one it resembles, and a missing value or one of the wrong type is replaced by a
//! stand-in. The types remain the only definition of the format: serde passes the names of fields
//! and variants.
//!
//! Four conventions of the model make this possible. An optional field is an `Option`. Two types are
//! read by `deserialize_any`: the color, which is a string or three numbers, and the scale, which is one
//! or three numbers and tells itself by what it expects. A tuple holds numbers, except for the matrix,
//! which tells itself in the same way. And the only tuple struct, the key of a track, has two or three
//! elements.

mod access;
mod elsewhere;
pub(crate) mod fix;
mod foreign;
pub(crate) mod nameless;
mod reader;
pub(crate) mod text;
mod variant;

use std::{cell::RefCell, collections::HashMap};

use serde::Deserialize;

use crate::{
    diagnostic::{
        Code, Diagnostic,
        path::{Step, Trail},
    },
    scene::{
        problem::Tally,
        recover::{
            reader::{Reader, Value},
            text::{Notes, Repairs, Text},
        },
    },
    text::syntax::Tree,
};

/// A model with stand-ins for everything that does not fit, and the faults.
pub(crate) struct Recovered<T> {
    pub(crate) model: Option<T>,
    pub(crate) diagnostics: Vec<Diagnostic>,
    pub(crate) tally: Tally,
    pub(crate) repairs: Repairs,
}

/// Reads a model, or a part of one, from a tree whose syntax faults are those of values. At most `most` faults of
/// each kind are kept.
pub(crate) fn recover<'de, T: Deserialize<'de>>(
    text: &str,
    tree: &Tree,
    most: usize,
) -> Recovered<T> {
    recover_at(text, tree, most, &[])
}

/// Reads what is at the end of these steps in a model.
pub(crate) fn recover_at<'de, T: Deserialize<'de>>(
    text: &str,
    tree: &Tree,
    most: usize,
    steps: &[Step],
) -> Recovered<T> {
    let notes = RefCell::new(Notes {
        diagnostics: Vec::new(),
        tally: Tally::new(most),
        repairs: Repairs::default(),
        nearest: HashMap::new(),
    });
    let model = tree.root().and_then(|root| {
        let document = Text {
            text,
            tree,
            notes: &notes,
        };
        let read = |path: Trail<'_>| T::deserialize(Reader::new(document, Value::Node(root), path));
        with_trail(steps, Trail::Root, read)
            .map_err(|fault| {
                let range = tree.node(root).range();
                document.note(Diagnostic::new(Code::WrongType, range, fault.to_string()));
            })
            .ok()
    });
    let Notes {
        diagnostics,
        tally,
        repairs,
        ..
    } = notes.into_inner();
    Recovered {
        model,
        diagnostics,
        tally,
        repairs,
    }
}

/// Calls `read` with the trail of the steps behind another one.
fn with_trail<R>(steps: &[Step], trail: Trail<'_>, read: impl FnOnce(Trail<'_>) -> R) -> R {
    match steps {
        [] => read(trail),
        [first, rest @ ..] => with_trail(rest, Trail::Inside(&trail, first.clone()), read),
    }
}
