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
mod variant;

pub(crate) use access::name_of;

use std::{
    cell::RefCell,
    collections::{HashMap, HashSet},
    fmt,
    ops::Range,
};

use serde::Deserialize;

use crate::{
    diagnostic::{
        Code, Diagnostic,
        path::{Step, Trail},
    },
    scene::{
        problem::{Tally, syntax_fault},
        recover::reader::{Reader, Value},
    },
    text::{
        nearest::quote,
        syntax::{NodeId, NodeKind, Syntax, Tree},
    },
};

/// A model with stand-ins for everything that does not fit, and the faults.
pub(crate) struct Recovered<T> {
    pub(crate) model: Option<T>,
    pub(crate) diagnostics: Vec<Diagnostic>,
    pub(crate) tally: Tally,
    pub(crate) repairs: Repairs,
}

/// The parts of a recovered model that differ from the text.
#[derive(Default)]
pub(crate) struct Repairs {
    /// The replaced values.
    pub(crate) replaced: HashSet<NodeId>,
    /// Misspelt fields: key and value by the struct and the intended name.
    pub(crate) renamed: HashMap<(NodeId, &'static str), (NodeId, NodeId)>,
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

/// The stand-in for a number: a NaN that no text produces, so that checks neither report nor count it.
pub(crate) const NO_NUMBER: f64 = f64::from_bits(f64::NAN.to_bits() | 1);

struct Notes {
    diagnostics: Vec<Diagnostic>,
    tally: Tally,
    repairs: Repairs,
    /// The nearest known name of each name looked up, by the list of known names: a misspelt name
    /// may occur a thousand times in a file.
    nearest: HashMap<(usize, String), Option<&'static str>>,
}

/// The text with its tree, and the collected faults.
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

    /// Counts a fault if no more of its kind are kept. Returns true if it was counted.
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
        /// The maximum number of cached names.
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

    /// Reports a value that does not fit and is replaced by a stand-in.
    fn replace(self, id: NodeId, diagnostic: Diagnostic) {
        self.note(diagnostic);
        self.notes.borrow_mut().repairs.replaced.insert(id);
    }

    /// Reports a value that is not read as one, and that a stand-in replaces.
    fn broken(self, id: NodeId, path: &Trail<'_>) {
        let range = self.tree.node(id).range();
        let faults = self.tree.faults();
        let first = faults.partition_point(|fault| fault.range.start < range.start);
        if let Some(fault) = faults.get(first) {
            self.replace(id, syntax_fault(fault).with_path(path));
        }
    }

    fn wrong_type(self, id: NodeId, path: &Trail<'_>, expected: impl fmt::Display) -> Diagnostic {
        let message = format!("expected {expected}, found {}", describe(self, id));
        let range = self.tree.node(id).range();
        Diagnostic::new(Code::WrongType, range, message).with_path(path)
    }
}

/// Describes a value, such as "the number `5`" or "a list of 2".
fn describe(document: Text<'_>, id: NodeId) -> String {
    let node = document.tree.node(id);
    let source = quote(document.source(id));
    let count = || document.tree.children(id).count();
    let name = node.name().map(|range| quote(document.slice(range)));
    match (node.kind(), name) {
        (NodeKind::Null, _) => source,
        (NodeKind::Bool(_), _) => format!("the boolean {source}"),
        (NodeKind::Number, _) => format!("the number {source}"),
        (NodeKind::String, _) => format!("the string {source}"),
        (NodeKind::Char, _) => format!("the character {source}"),
        (NodeKind::Bytes, _) => format!("the bytes {source}"),
        (NodeKind::Name, _) => format!("the name {source}"),
        (NodeKind::Unit, _) => "`()`".to_owned(),
        (NodeKind::Tuple | NodeKind::Struct, Some(name)) => format!("{name} with a bracket"),
        (NodeKind::Tuple, None) => format!("a tuple of {}", count()),
        (NodeKind::List, _) => match document.tree.syntax() {
            Syntax::Ron => format!("a list of {}", count()),
            Syntax::Json => format!("an array of {}", count()),
        },
        (NodeKind::Struct, None) => "named fields".to_owned(),
        (NodeKind::Map, _) => match document.tree.syntax() {
            Syntax::Ron => "a map".to_owned(),
            Syntax::Json => match document.tree.fields(id).count() {
                1 => "an object with 1 key".to_owned(),
                count => format!("an object with {count} keys"),
            },
        },
        (NodeKind::Error, _) => "nothing".to_owned(),
    }
}
