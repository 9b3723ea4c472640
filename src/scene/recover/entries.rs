//! The keys and values of a map whose keys are strings.

use std::{borrow::Cow, collections::HashMap};

use serde::de::{MapAccess, value::MapDeserializer};

use crate::{
    diagnostic::path::Trail,
    scene::recover::{
        Text,
        access::duplicate,
        reader::{Fault, Reader, Value},
    },
    text::{
        nearest::quote,
        syntax::{NodeId, NodeKind, string},
    },
};

/// What a map holds, or nothing for a stand-in; of a key that is given twice the first.
pub(super) fn entries<'de, 'p>(
    document: Text<'p>,
    path: &'p Trail<'p>,
    owner: Option<NodeId>,
) -> impl MapAccess<'de, Error = Fault> {
    let mut first_of: HashMap<Cow<'_, str>, NodeId> = HashMap::new();
    let mut entries = Vec::new();
    for (key, value) in owner.into_iter().flat_map(|id| document.tree.fields(id)) {
        let Some(name) = name(document, path, key) else {
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
                let path = path.key(&name);
                let value = Value::Node(value);
                let reader = Reader {
                    document,
                    value,
                    path,
                };
                entries.push((name, reader));
            }
        }
    }
    MapDeserializer::new(entries.into_iter())
}

/// Returns the name in a key, if it is a string; reports all other keys.
fn name<'a>(document: Text<'a>, path: &Trail<'_>, key: NodeId) -> Option<Cow<'a, str>> {
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
