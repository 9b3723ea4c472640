//! The keys and values of a map whose keys are strings.

use std::{borrow::Cow, collections::HashMap, vec};

use serde::de::{DeserializeSeed, Error as _, MapAccess, value::StrDeserializer};

use crate::{
    diagnostic::{Code, Diagnostic, path::Trail},
    scene::mend::{
        Text, fix,
        reader::{Fault, Reader, Value},
    },
    text::{
        nearest::quote,
        syntax::{Kind, NodeId, string},
    },
};

/// What a map holds; of a key that is given twice the first.
pub(super) struct Entries<'a, 'p> {
    document: Text<'a>,
    path: &'p Trail<'p>,
    entries: vec::IntoIter<(Cow<'a, str>, NodeId)>,
    next: Option<(Cow<'a, str>, NodeId)>,
}

impl<'a, 'p> Entries<'a, 'p> {
    /// Those of a node; none for a stand-in.
    pub(super) fn of(document: Text<'a>, path: &'p Trail<'p>, owner: Option<NodeId>) -> Self {
        let mut first_of: HashMap<Cow<'a, str>, NodeId> = HashMap::new();
        let mut entries = Vec::new();
        for (key, value) in owner.into_iter().flat_map(|id| document.tree.fields(id)) {
            let Some(name) = name(document, path, key) else {
                continue;
            };
            match first_of.get(&name) {
                Some(first) => duplicate_key(document, path, &name, *first, key),
                None => {
                    first_of.insert(name.clone(), key);
                    entries.push((name, value));
                }
            }
        }
        Self {
            document,
            path,
            entries: entries.into_iter(),
            next: None,
        }
    }
}

/// What a key says, if it is a string; all else is noted.
fn name<'a>(document: Text<'a>, path: &Trail<'_>, key: NodeId) -> Option<Cow<'a, str>> {
    let source = document.source(key);
    if document.tree.node(key).kind() == Kind::String {
        return string(source, document.tree.syntax());
    }
    let mut diagnostic = document.wrong_type(key, path, "a name in quotes");
    if document.tree.node(key).kind() == Kind::Name {
        diagnostic.help = Some(format!("write `\"{source}\"`"));
    }
    document.replace(key, diagnostic);
    None
}

fn duplicate_key(document: Text<'_>, path: &Trail<'_>, name: &str, first: NodeId, later: NodeId) {
    let range = |id| document.tree.node(id).range();
    let message = format!("key {} is given twice", quote(name));
    let diagnostic = Diagnostic::new(Code::DuplicateField, range(later), message);
    document.note(
        diagnostic
            .with_path(&path.key(name))
            .with_help("remove one of the two, or give it another name")
            .with_fix(fix::without(document, first, later))
            .with_label(range(first), "the first of them"),
    );
}

impl<'de> MapAccess<'de> for Entries<'_, '_> {
    type Error = Fault;

    fn next_key_seed<K: DeserializeSeed<'de>>(
        &mut self,
        seed: K,
    ) -> Result<Option<K::Value>, Fault> {
        self.next = self.entries.next();
        let key = self.next.as_ref().map(|(key, _)| StrDeserializer::new(key));
        key.map(|key| seed.deserialize(key)).transpose()
    }

    fn next_value_seed<V: DeserializeSeed<'de>>(&mut self, seed: V) -> Result<V::Value, Fault> {
        let (key, value) = self.next.take().ok_or_else(|| Fault::custom("no value"))?;
        seed.deserialize(Reader {
            document: self.document,
            value: Value::Node(value),
            path: &self.path.key(&key),
        })
    }
}
