//! Completion of the paths of tracks.

use std::{collections::HashSet, fmt::Write as _};

use super::{Completion, CompletionKind, names::written, schema_type::key, spot::Finder};
use crate::{
    scene::{
        format::{animation::changing, geometry::nesting::FIELD_NAMES, scene::Model},
        locate::{body, items},
    },
    text::syntax::NodeId,
};

/// The number of elements of a list that are offered.
pub(super) const MOST: usize = 200;

/// Returns the paths of the values in the scene that a track can change. From `first_cut` on, the
/// indices of geometries are not known.
pub(super) fn paths(finder: &Finder, has_colon: bool, first_cut: usize) -> Vec<Completion> {
    let mut all = Paths {
        finder,
        changing: changing().map(|field| field.name).collect(),
        found: Vec::new(),
    };
    let tree = finder.tree;
    let fields = tree.root().into_iter().flat_map(|root| tree.fields(root));
    for (field, value) in fields {
        let name = finder.name(field);
        match &*name {
            "camera" | "image" | "outlines" => all.add(&name, value),
            "cameras" | "materials" => {
                for (entry, value) in tree.fields(value) {
                    all.add(&step(&name, &finder.name(entry)), value);
                }
            }
            "lights" | Model::LONG => {
                let is_whole = &*name != Model::LONG;
                let items = tree
                    .children(value)
                    .enumerate()
                    .filter_map(|(index, item)| {
                        let named = all.name_of(item).map(|given| step(&name, &given));
                        let is_counted = is_whole || tree.node(item).range().start < first_cut;
                        let path = named.or_else(|| is_counted.then(|| format!("{name}[{index}]")));
                        Some((path?, item))
                    });
                let items: Vec<_> = items.take(MOST).collect();
                for (path, item) in items {
                    all.add_element(&path, item);
                }
            }
            name if all.changing.contains(name) => all.found.push(name.to_owned()),
            _ => {}
        }
    }
    let syntax = tree.syntax();
    let items = all.found.into_iter().map(|path| {
        let quoted = written(&path, syntax);
        let colon = key("", syntax).trim_start_matches('"').to_owned();
        Completion {
            label: path,
            insert: if has_colon { quoted } else { quoted + &colon },
            kind: CompletionKind::Name,
            detail: "value of the scene".to_owned(),
            docs: String::new(),
        }
    });
    items.collect()
}

struct Paths<'f, 'a> {
    finder: &'f Finder<'a>,
    /// The names of the fields that can change.
    changing: HashSet<&'static str>,
    found: Vec<String>,
}

impl Paths<'_, '_> {
    /// Adds the fields of a thing that can change, and those of its material.
    fn add(&mut self, path: &str, thing: NodeId) {
        let tree = self.finder.tree;
        for (field, value) in tree.fields(body(tree, thing).unwrap_or(thing)) {
            let name = self.finder.name(field);
            if name == "material" {
                self.add(&format!("{path}.material"), value);
            } else if self.changing.contains(&*name) {
                self.found.push(format!("{path}.{name}"));
            }
        }
    }

    /// Adds the fields of a light or a geometry, and those of the geometries inside of it.
    fn add_element(&mut self, path: &str, thing: NodeId) {
        self.add(path, thing);
        let tree = self.finder.tree;
        for (field, value) in tree.fields(body(tree, thing).unwrap_or(thing)) {
            let name = self.finder.name(field);
            if !FIELD_NAMES.contains(&&*name) {
                continue;
            }
            for (index, item) in items(tree, value).into_iter().enumerate().take(MOST) {
                let path = match self.name_of(item) {
                    Some(given) => step(Model::LONG, &given),
                    None if item == value => format!("{path}.{name}"),
                    None => format!("{path}.{name}[{index}]"),
                };
                self.add_element(&path, item);
            }
        }
    }

    fn name_of(&self, thing: NodeId) -> Option<String> {
        let tree = self.finder.tree;
        let mut fields = tree.fields(body(tree, thing).unwrap_or(thing));
        let (_, value) = fields.find(|(field, _)| self.finder.name(*field) == "name")?;
        Some(self.finder.name(value).into_owned())
    }
}

/// Returns the path of a named element.
fn step(path: &str, name: &str) -> String {
    let mut path = path.to_owned();
    let is_plain = |letter: char| letter.is_alphanumeric() || matches!(letter, '_' | '-');
    // Writing to a string cannot fail.
    let _ = match !name.is_empty() && name.chars().all(is_plain) {
        true => write!(path, ".{name}"),
        false => write!(path, "[{name:?}]"),
    };
    path
}
