//! Completion of files.

use std::{ops::Range, path::PathBuf};

use super::{complete::item, spot::Finder};
use crate::{
    scene::{
        assist::completion::{Completion, CompletionKind},
        format::{
            scene::Model,
            thing::{Thing, Type},
        },
        locate::{Typed, content, parts},
        options::ReadOptions,
    },
    text::syntax::{NodeId, NodeKind},
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
    let mut strings = Vec::new();
    if let Some(root) = tree.root() {
        strings.extend(finder.field(root, "$schema"));
        add_files(finder, (root, Some(Model::of_type())), &mut strings);
    }
    let files = options.tables();
    let strings = strings
        .into_iter()
        .filter(|id| tree.node(*id).kind() == NodeKind::String);
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

/// Adds the values that name files, in the order of the text.
fn add_files(finder: &Finder, value: Typed, found: &mut Vec<NodeId>) {
    let inside = content(finder.text, finder.tree, value);
    match inside.1 {
        Some(Type::File(_)) => found.push(inside.0),
        Some(Type::Object(..) | Type::OneOf(_) | Type::List(..)) => {
            let parts = parts(finder.text, finder.tree, inside);
            parts.for_each(|(_, part)| add_files(finder, part, found));
        }
        _ => {}
    }
}
