//! Completion of files.

use std::{ops::Range, path::PathBuf};

use super::{
    Completion, CompletionKind,
    complete::{FILE, item},
    spot::Finder,
};
use crate::{
    scene::{
        format::{geometry::inside::FIELD_NAMES, scene::Model},
        locate::{body, items},
        options::ReadOptions,
    },
    text::syntax::NodeKind,
};

/// The number of files that are offered.
const MOST: usize = 1000;

/// Returns the tables or parts, and the folders with more of them, that a scene may name; `typed` is
/// the path so far, and `endings` are those of their names.
pub(super) fn files(typed: &str, endings: &[&str], options: &ReadOptions) -> Vec<Completion> {
    let Some(files) = options.tables() else {
        return Vec::new();
    };
    let folder = typed.rfind('/').map_or("", |end| &typed[..=end]);
    let mut listed = files.list(folder);
    listed.retain(|(name, is_folder)| {
        let ending = name.rsplit_once('.').map_or("", |(_, ending)| ending);
        let is_known = endings
            .iter()
            .any(|known| known.eq_ignore_ascii_case(ending));
        !name.starts_with('.') && (*is_folder || is_known)
    });
    listed.sort_by(|one, other| (one.1, &one.0).cmp(&(other.1, &other.0)));
    let items = listed.into_iter().take(MOST).map(|(name, is_folder)| {
        let slash = if is_folder { "/" } else { "" };
        let label = format!("{folder}{name}{slash}");
        let kind = match is_folder {
            true => CompletionKind::Folder,
            false => CompletionKind::File,
        };
        item(&label, format!("{label:?}"), kind, "")
    });
    items.collect()
}

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
    let field = |owner, name: &str| finder.field(owner, name);
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
