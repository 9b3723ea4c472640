//! The text with its tree, and the faults that were found in it.

use std::{
    borrow::Cow,
    cell::RefCell,
    collections::{HashMap, HashSet},
    fmt,
    ops::Range,
};

use crate::{
    diagnostic::{Code, Diagnostic, path::Trail},
    scene::problem::{Tally, syntax_fault},
    text::{
        nearest::quote,
        syntax::{NodeId, NodeKind, Syntax, Tree, name, string},
    },
};

/// The parts of a recovered model that differ from the text.
#[derive(Default)]
pub(crate) struct Repairs {
    /// The replaced values.
    pub(crate) replaced: HashSet<NodeId>,
    /// Misspelt fields: key and value by the struct and the intended name.
    pub(crate) renamed: HashMap<(NodeId, &'static str), (NodeId, NodeId)>,
}

/// The stand-in for a number: a NaN that no text produces, so that checks neither report nor count it.
pub(crate) const NO_NUMBER: f64 = f64::from_bits(f64::NAN.to_bits() | 1);

pub(super) struct Notes {
    pub(super) diagnostics: Vec<Diagnostic>,
    pub(super) tally: Tally,
    pub(super) repairs: Repairs,
    /// The nearest known name of each name looked up, by the list of known names: a misspelt name
    /// may occur a thousand times in a file.
    pub(super) nearest: HashMap<(usize, String), Option<&'static str>>,
}

/// The text with its tree, and the collected faults.
#[derive(Clone, Copy)]
pub(super) struct Text<'a> {
    pub(super) text: &'a str,
    pub(super) tree: &'a Tree,
    pub(super) notes: &'a RefCell<Notes>,
}

impl<'a> Text<'a> {
    pub(super) fn slice(self, range: Range<usize>) -> &'a str {
        self.text.get(range).unwrap_or("")
    }

    pub(super) fn source(self, id: NodeId) -> &'a str {
        self.slice(self.tree.node(id).range())
    }

    /// Counts a fault if no more of its kind are kept. Returns true if it was counted.
    pub(super) fn is_counted(self, code: Code) -> bool {
        self.notes.borrow_mut().tally.only_counts(code)
    }

    /// The name that was probably meant.
    pub(super) fn nearest(
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

    pub(super) fn note(self, diagnostic: Diagnostic) {
        let mut notes = self.notes.borrow_mut();
        if notes.tally.keeps(diagnostic.code) {
            notes.diagnostics.push(diagnostic);
        }
    }

    /// Reports a value that does not fit and is replaced by a stand-in.
    pub(super) fn replace(self, id: NodeId, diagnostic: Diagnostic) {
        self.note(diagnostic);
        self.notes.borrow_mut().repairs.replaced.insert(id);
    }

    /// Reports a value that is not read as one, and that a stand-in replaces.
    pub(super) fn broken(self, id: NodeId, path: &Trail<'_>) {
        let range = self.tree.node(id).range();
        let faults = self.tree.faults();
        let first = faults.partition_point(|fault| fault.range.start < range.start);
        if let Some(fault) = faults.get(first) {
            self.replace(id, syntax_fault(fault).with_path(path));
        }
    }

    pub(super) fn wrong_type(
        self,
        id: NodeId,
        path: &Trail<'_>,
        expected: impl fmt::Display,
    ) -> Diagnostic {
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

/// Returns the name in a key or a string, without quotes and RON's `r#`.
pub(crate) fn name_of<'t>(text: &'t str, tree: &Tree, key: NodeId) -> Cow<'t, str> {
    let node = tree.node(key);
    let source = text.get(node.range()).unwrap_or_default();
    match node.kind() {
        NodeKind::String => string(source, tree.syntax()).unwrap_or_default(),
        _ => name(source).into(),
    }
}

/// A variant as it is written.
pub(crate) struct VariantText<'t> {
    pub(crate) name: Cow<'t, str>,
    /// The place of the name.
    pub(crate) place: Range<usize>,
    /// The value with its content, if it has any: in RON the whole value.
    pub(crate) body: Option<NodeId>,
}

impl<'t> VariantText<'t> {
    /// Returns the variant in a node, if it is written as one.
    pub(crate) fn of(text: &'t str, tree: &Tree, id: NodeId) -> Option<Self> {
        let node = tree.node(id);
        let (place, body) = match (tree.syntax(), node.kind()) {
            (Syntax::Ron, NodeKind::Name) | (Syntax::Json, NodeKind::String) => {
                (node.range(), None)
            }
            (Syntax::Ron, NodeKind::Struct | NodeKind::Tuple | NodeKind::Unit) => {
                (node.name()?, Some(id))
            }
            (Syntax::Json, NodeKind::Map) => {
                let mut fields = tree.fields(id);
                let (key, body) = fields.next().filter(|_| fields.next().is_none())?;
                (tree.node(key).range(), Some(body))
            }
            _ => return None,
        };
        let source = text.get(place.clone()).unwrap_or_default();
        let name = match tree.syntax() {
            Syntax::Ron => name(source).into(),
            Syntax::Json => string(source, Syntax::Json).unwrap_or_default(),
        };
        Some(Self { name, place, body })
    }
}
