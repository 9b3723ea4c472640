//! Values without the names of their fields, as in `Ambient(0.2)`: the types of the fields tell which
//! are meant.

use std::sync::LazyLock;

use crate::{
    diagnostic::{Diagnostic, Fix},
    scene::{
        format::{
            field::{Field, FieldKind},
            scene::Model,
            thing::{Object, OneOf, Thing, Type},
        },
        problem::syntax_fault,
        recover::text::name_of,
    },
    text::{
        edit::Edit,
        nearest::quote,
        syntax::{Fault, NodeId, NodeKind, Syntax, Tree, string},
    },
};

/// Converts a syntax fault to a diagnostic, with the names of fields if it is about those.
pub(crate) fn fault(text: &str, tree: &Tree, fault: &Fault) -> Diagnostic {
    let diagnostic = syntax_fault(fault);
    let owner = fault.nameless.and_then(|first| tree.node(first).parent());
    let name = owner.and_then(|owner| text.get(tree.node(owner).name()?));
    let (Some(owner), Some(name), Some((key, _))) = (owner, name, &fault.label) else {
        return diagnostic;
    };
    let is_before = |value: &NodeId| tree.node(*value).range().end <= key.start;
    let values: Vec<_> = tree.children(owner).take_while(is_before).collect();
    match names(text, tree, name, None, &values) {
        Some(names) => with_names(diagnostic, text, tree, None, &values, &names),
        None => diagnostic,
    }
}

/// Adds to a diagnostic the names that belong to the values of a variant; with its own name if these
/// are all.
pub(super) fn with_names(
    mut diagnostic: Diagnostic,
    text: &str,
    tree: &Tree,
    variant: Option<&str>,
    values: &[NodeId],
    names: &[&str],
) -> Diagnostic {
    let range = |value: &NodeId| tree.node(*value).range();
    let source = |value: &NodeId| quote(text.get(range(value)).unwrap_or_default());
    let pairs = || names.iter().zip(values);
    let syntax = tree.syntax();
    let shown = pairs().map(|(name, value)| {
        let value = source(value);
        syntax.key(name) + value.trim_matches('`')
    });
    let shown: Vec<_> = shown.collect();
    let shown = shown.join(", ");
    let shown = variant.map_or(shown.clone(), |variant| syntax.variant(variant, &shown));
    diagnostic.help = Some(format!("write `{shown}`"));
    let edits = pairs().flat_map(|(name, value)| {
        let range = range(value);
        match syntax {
            Syntax::Ron => vec![Edit::insert(range.start, format!("{name}: "))],
            Syntax::Json => vec![
                Edit::insert(range.start, format!("{{\"{name}\": ")),
                Edit::insert(range.end, "}"),
            ],
        }
    });
    diagnostic.fix = Some(Fix::safe(edits.collect::<Vec<_>>()));
    diagnostic
}

/// Returns the fields of a variant that the values must belong to; `None` unless there is only one
/// choice. Values come in the order of the required fields. `known` are the fields of the variant, if
/// they are known.
pub(super) fn names(
    text: &str,
    tree: &Tree,
    variant: &str,
    known: Option<&[&str]>,
    values: &[NodeId],
) -> Option<Vec<&'static str>> {
    let has = |object: &Object, name: &str| object.fields.iter().any(|field| field.name == name);
    let object = objects(variant)
        .find(|object| known.is_none_or(|known| known.iter().all(|field| has(object, field))))?;
    let (mut required, mut others): (Vec<_>, Vec<_>) =
        object.fields.iter().partition(|field| field.is_required);
    let fits = |field: &Field, value| admits((field.of_type)(), text, tree, value);
    let mut names = Vec::new();
    for value in values {
        if let Some(at) = required.iter().position(|field| fits(field, *value)) {
            names.push(required.remove(at).name);
            continue;
        }
        let mut fitting = others
            .iter()
            .enumerate()
            .filter(|(_, field)| fits(field, *value));
        let (Some((at, _)), None) = (fitting.next(), fitting.next()) else {
            return None;
        };
        names.push(others.remove(at).name);
    }
    (!names.is_empty()).then_some(names)
}

/// Returns true if a variant has all of the fields, and these are all that it requires.
pub(super) fn fits(variant: &str, given: &[impl AsRef<str>]) -> bool {
    let is_given = |field: &Field| given.iter().any(|name| name.as_ref() == field.name);
    objects(variant).any(|object| {
        let known = object.fields.iter().filter(|field| is_given(field));
        let mut required = object.fields.iter().filter(|field| field.is_required);
        known.count() == given.len() && required.all(is_given)
    })
}

/// Returns the objects that a variant of the format may be: there are several of some names.
fn objects(variant: &str) -> impl Iterator<Item = &'static Object> {
    static ALL: LazyLock<Vec<&OneOf>> = LazyLock::new(|| {
        let fields = Model::of_type().all_fields().into_iter();
        let types = fields.map(|field| (field.of_type)().innermost());
        let mut all: Vec<_> = types.filter_map(Type::one_of).collect();
        all.sort_by_key(|one_of| one_of.name);
        all.dedup_by_key(|one_of| one_of.name);
        all
    });
    let variants = ALL.iter().flat_map(|one_of| one_of.variants);
    let variants = variants.filter(move |one| one.name == variant);
    variants.filter_map(|one| one.object())
}

/// Returns true for the name of an object that is one of several.
pub(super) fn is_known(variant: &str) -> bool {
    objects(variant).next().is_some()
}

/// Returns true if a value has a type.
fn admits(of_type: Type, text: &str, tree: &Tree, value: NodeId) -> bool {
    const NUMBER: Type = Type::Value(FieldKind::Number);
    let node = tree.node(value);
    match node.kind() {
        NodeKind::Number => match of_type {
            Type::Value(kind) => {
                !(kind.is_vector() || kind == FieldKind::Interval || kind == FieldKind::Color)
            }
            other => matches!(other, Type::Whole(_)),
        },
        NodeKind::Bool(_) => matches!(of_type, Type::Flag),
        NodeKind::String => {
            let source = text.get(node.range()).unwrap_or_default();
            let is_color = string(source, tree.syntax()).is_some_and(|text| text.starts_with('#'));
            match of_type {
                Type::Value(FieldKind::Color) => is_color,
                Type::Text | Type::Name | Type::NameOfGeometry => !is_color,
                Type::OneOf(one_of) => {
                    !is_color && one_of.variants.iter().any(|one| one.content.is_none())
                }
                _ => false,
            }
        }
        NodeKind::Tuple | NodeKind::List if node.name().is_none() => {
            let (item, count) = match of_type {
                Type::Value(FieldKind::Interval) => (NUMBER, Some(2)),
                Type::Value(kind) if kind.has_elements() => (NUMBER, Some(3)),
                Type::Matrix => (Type::Tuple(|| NUMBER, 4), Some(3)),
                Type::Tuple(item, count) => (item(), Some(count)),
                Type::List(item, _) => (item(), None),
                _ => return false,
            };
            let mut items = tree.children(value);
            let is_tuple = tree.syntax() == Syntax::Json
                || count.is_some() == (node.kind() == NodeKind::Tuple);
            is_tuple
                && count.is_none_or(|count| tree.children(value).count() == count)
                && items
                    .next()
                    .is_none_or(|first| admits(item, text, tree, first))
        }
        // A variant is an object with its name as the key.
        NodeKind::Tuple | NodeKind::Struct | NodeKind::Unit => {
            let name = node.name().and_then(|name| text.get(name));
            name.is_some_and(|name| of_type.value(name).is_some())
        }
        NodeKind::Map => {
            let first = tree.fields(value).next();
            first.is_some_and(|(key, _)| of_type.value(&name_of(text, tree, key)).is_some())
        }
        _ => false,
    }
}
