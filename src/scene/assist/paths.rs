//! Completion of the paths of tracks.

use std::{collections::HashMap, fmt::Write as _};

use super::{complete::item, names::written, spot::Finder};
use crate::{
    scene::{
        assist::completion::{Completion, CompletionKind},
        format::{field::Field, scene::Model, thing::Type},
        locate::{body, content},
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
        first_cut,
        found: Vec::new(),
        defaults: Vec::new(),
    };
    if let Some(root) = finder.tree.root() {
        all.add_fields("", Model::FIELDS, root);
    }
    let tree = finder.tree;
    let syntax = tree.syntax();
    let items = all.found.into_iter().chain(all.defaults).map(|path| {
        let quoted = written(&path, syntax);
        let insert = if has_colon { quoted } else { quoted + ": " };
        Completion {
            detail: "value of the scene".to_owned(),
            ..item(&path, insert, CompletionKind::Name, "")
        }
    });
    items.collect()
}

struct Paths<'f, 'a> {
    finder: &'f Finder<'a>,
    first_cut: usize,
    found: Vec<String>,
    /// Those of fields that are not given.
    defaults: Vec<String>,
}

impl Paths<'_, '_> {
    /// Adds the fields of an object that can change: those that are given, and those with a default.
    fn add_fields(&mut self, path: &str, fields: &'static [Field], object: NodeId) {
        let tree = self.finder.tree;
        let given: HashMap<_, _> = tree
            .fields(object)
            .map(|(key, value)| (self.finder.name(key), value))
            .collect();
        // Nothing in a matrix can change, and nothing in the animation itself.
        let is_matrix = given.contains_key("matrix");
        for field in fields
            .iter()
            .filter(|field| !is_matrix && field.name != "animation")
        {
            let path = match path {
                "" => field.name.to_owned(),
                path => format!("{path}.{}", field.name),
            };
            let value = given.get(field.name);
            match value {
                Some(value) if !field.kind.changes() => self.add(&path, (field.of_type)(), *value),
                Some(_) => self.found.push(path),
                None if field.has_start && field.kind.changes() => self.defaults.push(path),
                None => {}
            }
        }
    }

    /// Adds what can change in a thing.
    fn add(&mut self, path: &str, of_type: Type, thing: NodeId) {
        let (text, tree) = (self.finder.text, self.finder.tree);
        let (thing, of_type) = content(text, tree, (thing, Some(of_type)));
        let Some(of_type) = of_type else { return };
        match of_type {
            Type::Object(object, _) => self.add_fields(path, object.fields, thing),
            Type::Map(of_type, _) => {
                for (key, value) in tree.fields(thing).take(MOST) {
                    self.add(&step(path, &self.finder.name(key)), of_type(), value);
                }
            }
            Type::List(of_type, _) => {
                let root = path.split(['.', '[']).next().unwrap_or_default();
                for (index, item) in tree.children(thing).enumerate().take(MOST) {
                    let is_counted =
                        path != Model::LONG || tree.node(item).range().start < self.first_cut;
                    let path = match self.name_of(item) {
                        Some(given) => step(root, &given),
                        None if is_counted => format!("{path}[{index}]"),
                        None => continue,
                    };
                    self.add(&path, of_type(), item);
                }
            }
            _ => {}
        }
    }

    /// Returns the name of an element of a list.
    fn name_of(&self, thing: NodeId) -> Option<String> {
        let fields = body(self.finder.tree, thing).unwrap_or(thing);
        let value = self.finder.field(fields, "name")?;
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
