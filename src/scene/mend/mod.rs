//! Every fault of a text that is no scene, in one run.
//!
//! The serde types of the model are deserialised from the syntax tree, and what does not fit is
//! noted and repaired on the way, so that serde never sees an error: a field that is unknown is
//! left out or taken for the one it resembles, and a value that is missing or of the wrong type is
//! replaced by a stand-in. The types stay the one definition of the format: names of fields and
//! variants are those that serde passes.
//!
//! Three conventions of the model make that possible. A field that may be left out is an `Option`,
//! the one type that is read by `deserialize_any`, the color, is a string or three numbers, and the
//! one tuple struct, the key of a track, has two or three elements.

mod access;
mod entries;
pub(crate) mod fix;
mod found;
mod reader;
mod variant;

use std::{
    cell::RefCell,
    collections::{HashMap, HashSet},
    fmt,
    ops::Range,
};

use serde::Deserialize;

pub(crate) use access::name_of;

use crate::{
    diagnostic::{Code, Diagnostic, path::Trail},
    scene::{
        mend::reader::{Reader, Value},
        problem::Tally,
    },
    text::syntax::{NodeId, Tree},
};

/// A model with stand-ins in the place of everything that does not fit, and what did not.
pub(crate) struct Mended<T> {
    pub(crate) model: Option<T>,
    pub(crate) diagnostics: Vec<Diagnostic>,
    pub(crate) tally: Tally,
    pub(crate) repairs: Repairs,
}

/// What of a mended model does not stand in the text as it is.
#[derive(Default)]
pub(crate) struct Repairs {
    /// The values that have been replaced.
    pub(crate) replaced: HashSet<NodeId>,
    /// Fields whose names are misspelt: key and value by the struct and the name that was meant.
    pub(crate) renamed: HashMap<(NodeId, &'static str), (NodeId, NodeId)>,
}

/// Reads a model, or a part of one, from a tree without syntax faults.
/// Of each kind of fault so many are kept.
pub(crate) fn mend<'de, T: Deserialize<'de>>(text: &str, tree: &Tree, most: usize) -> Mended<T> {
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
        let reader = Reader {
            document,
            value: Value::Node(root),
            path: Trail::Root,
        };
        T::deserialize(reader)
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
    Mended {
        model,
        diagnostics,
        tally,
        repairs,
    }
}

struct Notes {
    diagnostics: Vec<Diagnostic>,
    tally: Tally,
    repairs: Repairs,
    /// The nearest of the known names to those that were asked for, by the list of the known ones: a
    /// misspelt name stands in a file a thousand times.
    nearest: HashMap<(usize, String), Option<&'static str>>,
}

/// The text with its tree, and where faults are noted.
#[derive(Clone, Copy)]
struct Text<'a> {
    text: &'a str,
    tree: &'a Tree,
    notes: &'a RefCell<Notes>,
}

impl<'a> Text<'a> {
    fn slice(self, range: Range<usize>) -> &'a str {
        self.text.get(range).unwrap_or("")
    }

    fn source(self, id: NodeId) -> &'a str {
        self.slice(self.tree.node(id).range())
    }

    /// Whether a fault is only counted, as there are enough of its kind: then it is.
    fn is_counted(self, code: Code) -> bool {
        self.notes.borrow_mut().tally.only_counts(code)
    }

    /// The name that was probably meant.
    fn nearest(
        self,
        spelt: &str,
        known: &'static [&'static str],
        find: impl FnOnce() -> Option<&'static str>,
    ) -> Option<&'static str> {
        /// The most names that are remembered.
        const MOST: usize = 1000;
        let key = (known.as_ptr() as usize, spelt.to_owned());
        if let Some(meant) = self.notes.borrow().nearest.get(&key) {
            return *meant;
        }
        let meant = find();
        let remembered = &mut self.notes.borrow_mut().nearest;
        if remembered.len() < MOST {
            remembered.insert(key, meant);
        }
        meant
    }

    fn note(self, diagnostic: Diagnostic) {
        let mut notes = self.notes.borrow_mut();
        if notes.tally.keeps(diagnostic.code) {
            notes.diagnostics.push(diagnostic);
        }
    }

    /// Notes that a value does not fit and that a stand-in takes its place.
    fn replace(self, id: NodeId, diagnostic: Diagnostic) {
        self.note(diagnostic);
        self.notes.borrow_mut().repairs.replaced.insert(id);
    }

    fn wrong_type(self, id: NodeId, path: &Trail<'_>, expected: impl fmt::Display) -> Diagnostic {
        let message = format!("expected {expected}, found {}", found::describe(self, id));
        let range = self.tree.node(id).range();
        Diagnostic::new(Code::WrongType, range, message).with_path(path)
    }
}
