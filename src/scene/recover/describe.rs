//! Description of a value in a message.

use crate::{
    scene::recover::Text,
    text::{
        nearest::quote,
        syntax::{Kind, NodeId, Syntax},
    },
};

/// Describes a value, such as "the number `5`" or "a list of 2".
pub(super) fn describe(document: Text<'_>, id: NodeId) -> String {
    let node = document.tree.node(id);
    let source = quote(document.source(id));
    let count = || document.tree.children(id).count();
    let name = node.name().map(|range| quote(document.slice(range)));
    match (node.kind(), name) {
        (Kind::Null, _) => source,
        (Kind::Bool(_), _) => format!("the boolean {source}"),
        (Kind::Number, _) => format!("the number {source}"),
        (Kind::String, _) => format!("the string {source}"),
        (Kind::Char, _) => format!("the character {source}"),
        (Kind::Bytes, _) => format!("the bytes {source}"),
        (Kind::Name, _) => format!("the name {source}"),
        (Kind::Unit, _) => "`()`".to_owned(),
        (Kind::Tuple | Kind::Struct, Some(name)) => format!("{name} with a bracket"),
        (Kind::Tuple, None) => format!("a tuple of {}", count()),
        (Kind::List, _) => match document.tree.syntax() {
            Syntax::Ron => format!("a list of {}", count()),
            Syntax::Json => format!("an array of {}", count()),
        },
        (Kind::Struct, None) => "named fields".to_owned(),
        (Kind::Map, _) => match document.tree.syntax() {
            Syntax::Ron => "a map".to_owned(),
            Syntax::Json => match document.tree.fields(id).count() {
                1 => "an object with 1 key".to_owned(),
                count => format!("an object with {count} keys"),
            },
        },
        (Kind::Error, _) => "nothing".to_owned(),
    }
}
