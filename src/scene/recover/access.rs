//! The fields of a struct and the elements of a sequence, with stand-ins for missing ones.

use std::{borrow::Cow, collections::HashMap, ops::Range};

use serde::de::{DeserializeSeed, MapAccess, SeqAccess, value::MapDeserializer};

use crate::{
    diagnostic::{
        Code, Diagnostic, Fix,
        path::{Step, Trail},
    },
    scene::{
        format::scene::Model,
        near::{is_same_value, near},
        read::reader::{Misfit, Result},
        recover::{
            elsewhere, fix,
            reader::{Reader, Value},
            text::{Text, name_of},
        },
    },
    text::{
        nearest::{one_of, quote},
        syntax::{Children, NodeId, NodeKind, Syntax, string},
    },
};

/// The fields of a struct with their values.
pub(super) type Fields = Vec<(&'static str, Value)>;

/// The fields of a struct, each with its path. They are in memory, so that each struct of the format is
/// compiled once.
pub(super) fn fields<'de, 'a, 'p>(
    document: Text<'a>,
    path: &'p Trail<'p>,
    fields: Fields,
) -> impl MapAccess<'de, Error = Misfit> {
    MapDeserializer::new(
        fields
            .into_iter()
            .map(move |(field, value)| (field, Reader::new(document, value, path.field(field)))),
    )
}

/// Stand-ins for all fields.
pub(super) fn stand_ins(known: &'static [&'static str]) -> Fields {
    known.iter().map(|field| (*field, Value::StandIn)).collect()
}

/// The fields that `owner` gives, a node with keys and values or an empty one, then those that it
/// lacks; `place` is where these are reported.
pub(super) fn given_fields(
    document: Text<'_>,
    path: &Trail<'_>,
    owner: NodeId,
    place: &Range<usize>,
    known: &'static [&'static str],
) -> Fields {
    let mut given: Vec<(&'static str, NodeId, Value)> = Vec::with_capacity(known.len());
    let mut unknown = Vec::new();
    for (key, value) in document.tree.fields(owner) {
        let spelt = name_of(document.text, document.tree, key);
        let Some(field) = known.iter().copied().find(|field| *field == spelt) else {
            unknown.push((key, value));
            continue;
        };
        match given.iter().find(|(other, _, _)| *other == field) {
            None => given.push((field, key, Value::Node(value))),
            Some((_, first, _)) => {
                let message = format!("field `{field}` is given twice");
                let words = (message, "remove one of the two");
                duplicate(document, &path.field(field), [*first, key], words);
            }
        }
    }
    for (key, value) in unknown {
        let spelt = name_of(document.text, document.tree, key);
        let taken = |field: &str| given.iter().any(|(other, _, _)| *other == field);
        if let Some(other) = elsewhere::field(document, owner, &spelt, known) {
            unknown_field(
                document,
                path,
                key,
                &spelt,
                known,
                true,
                (other.help, other.fix),
            );
            if let Some(field) = other.field.filter(|field| !taken(field)) {
                given.push((field, key, Value::Given));
            }
            continue;
        }
        let meant = document.nearest(&spelt, known, || near(&spelt, &writable(document, known)));
        let meant = meant.map(|field| (field, taken(field)));
        let is_meant_known = meant.is_some();
        let advice = advice(document, key, &spelt, meant);
        unknown_field(document, path, key, &spelt, known, is_meant_known, advice);
        let Some((field, false)) = meant else {
            continue;
        };
        // Reported once, as an unknown field: the field that was meant does not count as missing,
        // and its value is checked.
        let value = if is_same_value(&spelt) {
            let mut notes = document.notes.borrow_mut();
            notes.repairs.renamed.insert((owner, field), (key, value));
            Value::Node(value)
        } else {
            Value::Given
        };
        given.push((field, key, value));
    }
    let lacks = |field: &&str| given.iter().all(|(other, _, _)| other != field);
    let missing = known.iter().copied().filter(lacks).map(|field| {
        let place = place.clone();
        (field, Value::Missing { field, place })
    });
    let missing: Vec<_> = missing.collect();
    let given = given.into_iter().map(|(field, _, value)| (field, value));
    given.chain(missing).collect()
}

/// Reports a field or a key that is given a second time.
pub(super) fn duplicate(
    document: Text<'_>,
    path: &Trail<'_>,
    [first, later]: [NodeId; 2],
    (message, help): (String, &str),
) {
    if document.is_counted(Code::DuplicateField) {
        return;
    }
    let range = |id| document.tree.node(id).range();
    let diagnostic = Diagnostic::new(Code::DuplicateField, range(later), message);
    document.note(
        diagnostic
            .with_path(path)
            .with_help(help)
            .with_fix(fix::without(document, first, later))
            .with_label(range(first), "the first of them"),
    );
}

/// Returns the fields that a text can name: RON cannot write `$schema`.
fn writable(document: Text<'_>, known: &[&'static str]) -> Vec<&'static str> {
    let is_json = document.tree.syntax() == Syntax::Json;
    let can_be = |name: &&&str| is_json || !name.starts_with('$');
    known.iter().filter(can_be).copied().collect()
}

/// Reports an unknown field, with a help and a fix.
fn unknown_field(
    document: Text<'_>,
    path: &Trail<'_>,
    key: NodeId,
    spelt: &str,
    known: &[&'static str],
    is_meant_known: bool,
    (help, fix): (String, Option<Fix>),
) {
    if document.is_counted(Code::UnknownField) {
        return;
    }
    let expected = match &*writable(document, known) {
        [] => "no field".to_owned(),
        known => one_of(known, is_meant_known),
    };
    let message = format!("unknown field {}, expected {expected}", quote(spelt));
    let range = document.tree.node(key).range();
    let diagnostic = Diagnostic::new(Code::UnknownField, range, message);
    document.note(
        diagnostic
            .with_path(&Trail::Inside(path, Step::Field(spelt.to_owned().into())))
            .with_help(help)
            .with_fix(fix),
    );
}

/// Returns the help for an unknown field, and its fix. `meant` is the field that the name resembles,
/// with true if that field is given as well.
fn advice(
    document: Text<'_>,
    key: NodeId,
    spelt: &str,
    meant: Option<(&str, bool)>,
) -> (String, Option<Fix>) {
    let reads = format!(
        "strahl {} reads version {} of the format",
        env!("CARGO_PKG_VERSION"),
        Model::VERSION
    );
    let range = document.tree.node(key).range();
    match meant {
        Some((field, true)) => (format!("remove it: `{field}` is given ({reads})"), None),
        Some(("fov", false)) if !is_same_value(spelt) => {
            let help = format!("write `fov`: fov = 2α, in degrees ({reads})");
            (help, None)
        }
        Some((field, false)) if !is_same_value(spelt) => {
            let spelt = quote(spelt);
            let help = format!("write `{field}`; its value is not that of {spelt} ({reads})");
            (help, None)
        }
        Some((field, false)) => {
            let help = format!("did you mean `{field}`? ({reads})");
            (help, Some(fix::renamed(document, range, field)))
        }
        None => (format!("remove it ({reads})"), None),
    }
}

/// The elements of a sequence.
pub(super) struct Elements<'a, 'p> {
    document: Text<'a>,
    path: &'p Trail<'p>,
    /// The given elements; `None` for a stand-in.
    children: Option<Children<'a>>,
    /// True if stand-ins replace missing elements.
    endless: bool,
    index: usize,
    /// Number of replaced elements.
    replaced: usize,
}

impl<'de> SeqAccess<'de> for Elements<'_, '_> {
    type Error = Misfit;

    fn next_element_seed<T: DeserializeSeed<'de>>(&mut self, seed: T) -> Result<Option<T::Value>> {
        /// The maximum number of replaced elements: stand-ins may take far more memory than the
        /// elements themselves.
        const MOST_REPLACED: usize = 1000;
        let child = self.children.as_mut().and_then(Iterator::next);
        let value = match child {
            Some(child) if self.replaced == MOST_REPLACED => {
                self.pass_the_rest(child);
                return Ok(None);
            }
            Some(child) => Value::Node(child),
            None if self.endless => Value::StandIn,
            None => return Ok(None),
        };
        let reader = Reader::new(self.document, value, self.path.index(self.index));
        self.index += 1;
        let element = seed.deserialize(reader)?;
        let notes = self.document.notes.borrow();
        let is_replaced = child.is_some_and(|child| notes.repairs.replaced.contains(&child));
        self.replaced += usize::from(is_replaced);
        Ok(Some(element))
    }
}

impl<'a, 'p> Elements<'a, 'p> {
    pub(super) const fn new(
        document: Text<'a>,
        path: &'p Trail<'p>,
        children: Option<Children<'a>>,
        endless: bool,
    ) -> Self {
        Self {
            document,
            path,
            children,
            endless,
            index: 0,
            replaced: 0,
        }
    }

    /// Counts the rest of a list with elements of the wrong type: those of the same kind as the
    /// first.
    fn pass_the_rest(&mut self, first: NodeId) {
        let kind = |id| self.document.tree.node(id).kind();
        let rest = self.children.take().into_iter().flatten();
        let alike = rest.filter(|id| kind(*id) == kind(first)).count();
        let mut notes = self.document.notes.borrow_mut();
        notes.tally.pass(Code::WrongType, alike + 1);
    }
}

/// What a map holds, or nothing for a stand-in; of a key that is given twice the first.
pub(super) fn entries<'de, 'p>(
    document: Text<'p>,
    path: &'p Trail<'p>,
    owner: Option<NodeId>,
) -> impl MapAccess<'de, Error = Misfit> {
    let mut first_of: HashMap<Cow<'_, str>, NodeId> = HashMap::new();
    let mut entries = Vec::new();
    for (key, value) in owner.into_iter().flat_map(|id| document.tree.fields(id)) {
        let Some(name) = name_in(document, path, key) else {
            continue;
        };
        match first_of.get(&name) {
            Some(first) => {
                let message = format!("key {} is given twice", quote(&name));
                let words = (message, "remove one of the two, or give it another name");
                duplicate(document, &path.key(&name), [*first, key], words);
            }
            None => {
                first_of.insert(name.clone(), key);
                let reader = Reader::new(document, Value::Node(value), path.key(&name));
                entries.push((name, reader));
            }
        }
    }
    MapDeserializer::new(entries.into_iter())
}

/// Returns the name in a key, if it is a string; reports all other keys.
fn name_in<'a>(document: Text<'a>, path: &Trail<'_>, key: NodeId) -> Option<Cow<'a, str>> {
    let source = document.source(key);
    if document.tree.node(key).kind() == NodeKind::String {
        return string(source, document.tree.syntax());
    }
    let mut diagnostic = document.wrong_type(key, path, "a name in quotes");
    if document.tree.node(key).kind() == NodeKind::Name {
        diagnostic.help = Some(format!("write `\"{source}\"`"));
    }
    document.replace(key, diagnostic);
    None
}
