//! Values without the names of their fields, as in `Ambient(0.2)`: the types of the fields tell which
//! are meant.

use std::sync::OnceLock;

use schemars::generate::SchemaSettings;
use serde_json::Value as Json;

use crate::{
    diagnostic::{Diagnostic, Fix},
    scene::{format::scene::Model, problem::syntax_fault, recover::name_of},
    text::{
        edit::Edit,
        nearest::quote,
        syntax::{Fault, Kind, NodeId, Syntax, Tree, string},
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
        let value = value.trim_matches('`');
        match syntax {
            Syntax::Ron => format!("{name}: {value}"),
            Syntax::Json => format!("\"{name}\": {value}"),
        }
    });
    let shown: Vec<_> = shown.collect();
    let shown = shown.join(", ");
    diagnostic.help = Some(match (syntax, variant) {
        (_, None) => format!("write `{shown}`"),
        (Syntax::Ron, Some(variant)) => format!("write `{variant}({shown})`"),
        (Syntax::Json, Some(variant)) => format!("write `{{\"{variant}\": {{{shown}}}}}`"),
    });
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
    let schema = schema();
    let definitions = schema["$defs"].as_object()?.values();
    let variants = definitions.flat_map(|one| one["oneOf"].as_array().into_iter().flatten());
    let mut structs = variants.filter_map(|one| one["properties"].get(variant));
    let fields = structs.find(|fields| {
        let has = |field: &&str| fields["properties"].get(field).is_some();
        known.is_none_or(|known| known.iter().all(has))
    })?;
    let required = fields["required"].as_array();
    let mut required: Vec<_> = required
        .into_iter()
        .flatten()
        .filter_map(Json::as_str)
        .collect();
    let mut others: Vec<_> = fields["properties"].as_object()?.keys().collect();
    others.retain(|field| !required.contains(&field.as_str()));
    let fits = |field: &str, value| admits(schema, &fields["properties"][field], text, tree, value);
    let mut names = Vec::new();
    for value in values {
        if let Some(at) = required.iter().position(|field| fits(field, *value)) {
            names.push(required.remove(at));
            continue;
        }
        let mut fitting = others
            .iter()
            .enumerate()
            .filter(|(_, field)| fits(field, *value));
        let (Some((at, _)), None) = (fitting.next(), fitting.next()) else {
            return None;
        };
        names.push(others.remove(at));
    }
    (!names.is_empty()).then_some(names)
}

/// Returns true if a variant has all of the fields, and these are all that it requires.
pub(super) fn fits(variant: &str, given: &[impl AsRef<str>]) -> bool {
    let definitions = schema()["$defs"].as_object().into_iter().flatten();
    let variants = definitions.flat_map(|(_, one)| one["oneOf"].as_array().into_iter().flatten());
    let mut structs = variants.filter_map(|one| one["properties"].get(variant));
    structs.any(|fields| {
        let has = |field: &str| !fields["properties"][field].is_null();
        let required = fields["required"].as_array().into_iter().flatten();
        let is_given = |field: &Json| given.iter().any(|one| field.as_str() == Some(one.as_ref()));
        given.iter().all(|field| has(field.as_ref())) && required.clone().all(is_given)
    })
}

/// The schema of the types.
fn schema() -> &'static Json {
    static SCHEMA: OnceLock<Json> = OnceLock::new();
    SCHEMA.get_or_init(|| {
        let generator = SchemaSettings::draft2020_12().into_generator();
        generator.into_root_schema_for::<Model>().to_value()
    })
}

/// Returns true if a value has a type of the schema.
fn admits(schema: &Json, node: &Json, text: &str, tree: &Tree, value: NodeId) -> bool {
    let admit = |node: &Json| admits(schema, node, text, tree, value);
    if let Some(name) = node["$ref"].as_str() {
        let name = name.rsplit('/').next().unwrap_or_default();
        return admit(&schema["$defs"][name]);
    }
    let mut choices = ["anyOf", "oneOf"]
        .into_iter()
        .filter_map(|key| node[key].as_array());
    if let Some(choices) = choices.next() {
        return choices.iter().any(admit);
    }
    let is = |name: &str| match &node["type"] {
        Json::String(one) => one == name,
        Json::Array(all) => all.iter().any(|one| one == name),
        _ => false,
    };
    let (of_value, syntax) = (tree.node(value), tree.syntax());
    match of_value.kind() {
        Kind::Number => is("number") || is("integer"),
        Kind::Bool(_) => is("boolean"),
        Kind::String => {
            let source = text.get(of_value.range()).unwrap_or_default();
            let is_color = string(source, syntax).is_some_and(|text| text.starts_with('#'));
            is("string") && is_color != node["pattern"].is_null()
        }
        Kind::Tuple | Kind::List if of_value.name().is_none() && is("array") => {
            let length = tree.children(value).count() as u64;
            let is_tuple = !node["maxItems"].is_null();
            let has_length = !is_tuple || node["maxItems"].as_u64() == Some(length);
            let is_written_so =
                syntax == Syntax::Json || is_tuple == (of_value.kind() == Kind::Tuple);
            let item = |item| admits(schema, &node["items"], text, tree, item);
            has_length && is_written_so && tree.children(value).next().is_none_or(item)
        }
        // A variant is an object with its name as the key.
        Kind::Tuple | Kind::Struct | Kind::Unit => {
            let name = of_value.name().and_then(|name| text.get(name));
            name.is_some_and(|name| !node["properties"][name].is_null())
        }
        Kind::Map => {
            let key = tree
                .fields(value)
                .next()
                .map(|(key, _)| name_of(text, tree, key));
            key.is_some_and(|key| !node["properties"][&*key].is_null())
        }
        _ => false,
    }
}
