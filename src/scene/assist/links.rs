//! The files that a scene names.

use std::{ops::Range, path::PathBuf};

use super::{complete::FILE, spot::Finder};
use crate::{
    scene::{
        format::{geometry::nesting::FIELD_NAMES, scene::Model},
        locate::{body, items},
        options::ReadOptions,
    },
    text::syntax::{NodeId, NodeKind},
};

/// A file that a scene names.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FileLink {
    /// The range of the name, without its quotes.
    pub range: Range<usize>,
    /// The name.
    pub name: String,
    /// The path of the file; `None` if it does not exist, or if the scene may not name it.
    pub path: Option<PathBuf>,
}

pub(super) fn links(finder: &Finder, options: &ReadOptions) -> Vec<FileLink> {
    let tree = finder.tree;
    let field = |owner: NodeId, name: &str| {
        let mut fields = tree.fields(owner);
        let found = fields.find(|(key, _)| finder.name(*key) == name);
        found.map(|(_, value)| value)
    };
    let root = tree.root();
    let schema = root.and_then(|root| field(root, "$schema"));
    let geometries = root.and_then(|root| field(root, Model::LONG));
    let geometries = geometries.into_iter().flat_map(|list| tree.children(list));
    let mut tables = Vec::new();
    let mut next: Vec<_> = geometries.collect();
    next.reverse();
    while let Some(item) = next.pop() {
        let fields = body(tree, item).unwrap_or(item);
        tables.extend(field(fields, FILE));
        let inside = FIELD_NAMES.iter().rev();
        for value in inside.filter_map(|name| field(fields, name)) {
            let first = next.len();
            next.extend(items(tree, value));
            next[first..].reverse();
        }
    }
    let files = options.tables();
    let strings = schema.into_iter().chain(tables);
    let strings = strings.filter(|id| tree.node(*id).kind() == NodeKind::String);
    let links = strings.map(|id| {
        let range = tree.node(id).range();
        let name = finder.name(id).into_owned();
        let path = files.as_ref().and_then(|files| files.find(&name).ok());
        FileLink {
            range: range.start + 1..(range.end - 1).max(range.start + 1),
            name,
            path,
        }
    });
    // An editor knows the links of the web itself.
    links.filter(|link| !link.name.contains("://")).collect()
}
