//! The parts of a scene.

use std::ops::Range;

use super::spot::Finder;
use crate::{
    diagnostic::named::named,
    scene::{
        format::{
            geometry::inside::FIELD_NAMES,
            scene::Model,
            thing::{Thing, Type},
        },
        locate::{body, items},
        recover::text::VariantText,
    },
    text::syntax::NodeId,
};

/// The number of elements up to which all are listed. Of longer lists, only those with a name are.
const MOST: usize = 5000;
/// The longest value that is shown.
const LONGEST: usize = 40;

named! {
    /// The kind of a part of a scene.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum SymbolKind {
        /// A camera.
        Camera = "camera",
        /// A light.
        Light = "light",
        /// A material.
        Material = "material",
        /// A geometry.
        Geometry = "geometry",
        /// The track of an animation.
        Track = "track",
        /// A field of the scene with parts.
        List = "list",
        /// Any other field.
        Field = "field",
    }
}

/// A part of a scene.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Symbol {
    /// The name.
    pub name: String,
    /// The variant, a short value, or a number of elements.
    pub detail: String,
    /// The kind.
    pub kind: SymbolKind,
    /// The range of the whole part.
    pub range: Range<usize>,
    /// The range of its name.
    pub selection: Range<usize>,
    /// The parts of the part.
    pub children: Vec<Symbol>,
}

pub(super) fn symbols(finder: &Finder) -> Vec<Symbol> {
    let root = finder.tree.root();
    root.map_or_else(Vec::new, |root| fields(finder, root, Model::of_type()))
}

/// Returns the fields of an object with their parts.
fn fields(finder: &Finder, owner: NodeId, of_type: Type) -> Vec<Symbol> {
    let symbols = finder.tree.fields(owner).map(|(key, value)| {
        let name = finder.name(key);
        let of_type = of_type.value(&name);
        let kind = of_type.and_then(|of_type| SymbolKind::of_name(&of_type.noun()));
        let (kind, children) = match (of_type, kind) {
            (Some(Type::Map(..)), Some(kind)) => (SymbolKind::List, entries(finder, value, kind)),
            (Some(Type::List(..)), Some(kind)) => (SymbolKind::List, elements(finder, value, kind)),
            (_, Some(kind)) => (kind, Vec::new()),
            (Some(Type::Tracks), _) => {
                (SymbolKind::List, entries(finder, value, SymbolKind::Track))
            }
            (Some(of_type), _) if name == "animation" => {
                (SymbolKind::List, fields(finder, value, of_type))
            }
            _ => (SymbolKind::Field, Vec::new()),
        };
        Symbol {
            children,
            ..field(finder, (key, value), kind)
        }
    });
    symbols.collect()
}

/// Returns a field without its parts.
fn field(finder: &Finder, (key, value): (NodeId, NodeId), kind: SymbolKind) -> Symbol {
    let (key_range, range) = (
        finder.tree.node(key).range(),
        finder.tree.node(value).range(),
    );
    Symbol {
        name: label(&finder.name(key)),
        detail: detail(finder, value),
        kind,
        range: key_range.start..range.end.max(key_range.end),
        selection: key_range,
        children: Vec::new(),
    }
}

/// Editors require a name.
fn label(name: &str) -> String {
    match name.trim().is_empty() {
        true => format!("{name:?}"),
        false => name.to_owned(),
    }
}

fn entries(finder: &Finder, map: NodeId, kind: SymbolKind) -> Vec<Symbol> {
    let entries = finder.tree.fields(map).take(MOST);
    entries.map(|entry| field(finder, entry, kind)).collect()
}

fn elements(finder: &Finder, list: NodeId, kind: SymbolKind) -> Vec<Symbol> {
    let tree = finder.tree;
    let items = items(tree, list);
    let is_long = items.len() > MOST;
    let elements = items.into_iter().enumerate().filter_map(|(index, item)| {
        let given = finder.field(body(tree, item).unwrap_or(item), "name");
        if is_long && given.is_none() {
            return None;
        }
        let range = tree.node(item).range();
        let (variant, selection) = variant(finder, item);
        let (name, selection) = match given {
            Some(value) => (label(&finder.name(value)), tree.node(value).range()),
            None => (format!("[{index}]"), selection),
        };
        let selection = match range.start <= selection.start && selection.end <= range.end {
            true => selection,
            false => range.clone(),
        };
        Some(Symbol {
            name,
            detail: variant,
            kind,
            range,
            selection,
            children: inside(finder, item, kind),
        })
    });
    elements.take(MOST).collect()
}

/// Returns the geometries inside of another.
fn inside(finder: &Finder, item: NodeId, kind: SymbolKind) -> Vec<Symbol> {
    let tree = finder.tree;
    let fields = tree.fields(body(tree, item).unwrap_or(item));
    let fields = fields.filter(|(key, _)| FIELD_NAMES.contains(&&*finder.name(*key)));
    let fields = fields.filter(|_| kind == SymbolKind::Geometry);
    let symbols = fields.flat_map(|(_, value)| elements(finder, value, kind));
    symbols.collect()
}

/// Returns the name of a variant and its range.
fn variant(finder: &Finder, value: NodeId) -> (String, Range<usize>) {
    let tree = finder.tree;
    match VariantText::of(finder.text, tree, value) {
        Some(VariantText {
            name,
            place,
            body: Some(_),
        }) => (name.into_owned(), place),
        _ => (String::new(), tree.node(value).range()),
    }
}

fn detail(finder: &Finder, value: NodeId) -> String {
    let tree = finder.tree;
    let range = tree.node(value).range();
    if body(tree, value).is_some() || tree.node(value).name().is_some() {
        return variant(finder, value).0;
    }
    let text = finder.text.get(range).unwrap_or_default();
    match text.len() <= LONGEST && !text.contains('\n') {
        true => text.to_owned(),
        false => tree.children(value).next().map_or_else(String::new, |_| {
            let count = match tree.fields(value).next() {
                Some(_) => tree.fields(value).count(),
                None => tree.children(value).count(),
            };
            count.to_string()
        }),
    }
}
