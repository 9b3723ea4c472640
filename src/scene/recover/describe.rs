//! Description of a value in a message.

use crate::{
    scene::recover::Text,
    text::{
        nearest::quote,
        syntax::{NodeId, NodeKind, Syntax},
    },
};

/// Describes a value, such as "the number `5`" or "a list of 2".
pub(super) fn describe(document: Text<'_>, id: NodeId) -> String {
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
