//! Values as other programs write them, with their fixes.

use std::{f64::consts::PI, ops::Range};

use crate::{
    diagnostic::Fix,
    scene::{
        format::color_names,
        near::near,
        recover::{
            fix::{self, Wants},
            nameless::fits,
            text::{Text, name_of},
        },
    },
    text::{
        edit::Edit,
        syntax::{NodeId, NodeKind, Syntax, float, string},
    },
};

/// The help for a value, and its fix if that is certain.
pub(super) type Advice = (String, Option<Fix>);

/// Returns what is meant by a value that does not have the type that is wanted.
pub(super) fn advice(document: Text<'_>, id: NodeId, wants: Wants) -> Option<Advice> {
    let source = document.source(id);
    let node = document.tree.node(id);
    let written = |help: &str, value: String| {
        let fix = Fix::safe([Edit::replace(node.range(), &*value)]);
        Some((help.replace("{}", &format!("`{value}`")), Some(fix)))
    };
    let name = node.name().map(|range| document.slice(range));
    match wants {
        Wants::Color => {
            if let Some(bytes) = color_names::of_css(source) {
                let value = format!("\"{}\"", color_names::hex(bytes));
                return written("did you mean {}?", value);
            }
            if let Some((bytes, _)) = color_names::of_function(source) {
                let hex = color_names::hex(bytes);
                return Some((format!("a color has no alpha: write `\"{hex}\"`"), None));
            }
            if let Some(value) = numbers(document, id) {
                return written("write the three numbers alone, without names: {}", value);
            }
            is_gradient(document, id).then(|| {
                let help = "a color is one value, `\"#rrggbb\"` or three numbers; gradients are not \
                            supported";
                (help.to_owned(), None)
            })
        }
        Wants::Tuple => {
            let value = numbers(document, id)?;
            written("write the values alone, without names: {}", value)
        }
        Wants::Number if matches!(source, "pi" | "PI" | "Pi") => {
            written("write {}", PI.to_string())
        }
        Wants::Number if name.is_some() => Some((
            "functions are not evaluated; write the number".to_owned(),
            None,
        )),
        _ => None,
    }
}

/// Names of three numbers in other programs.
const NAMES: [&str; 10] = [
    "color", "colour", "dvec3", "float3", "point", "rgb", "srgb", "vec", "vec3", "vector",
];

/// Returns the three numbers of a value that has a name, or names of the numbers, as a tuple.
fn numbers(document: Text<'_>, id: NodeId) -> Option<String> {
    let tree = document.tree;
    let keys = tree
        .fields(id)
        .map(|(key, _)| name_of(document.text, tree, key));
    let keys: Vec<_> = keys.collect();
    let name = tree.node(id).name().map(|range| document.slice(range));
    // `hsl(…)` are three other numbers.
    let is_known = |name: &str| NAMES.contains(&&*name.to_ascii_lowercase());
    let values: Vec<_> = match tree.node(id).kind() {
        NodeKind::Tuple if name.is_some_and(is_known) => tree.children(id).collect(),
        NodeKind::Struct | NodeKind::Map if keys == ["x", "y", "z"] || keys == ["r", "g", "b"] => {
            tree.fields(id).map(|(_, value)| value).collect()
        }
        _ => return None,
    };
    let is_number = |value: &NodeId| float(document.source(*value), tree.syntax()).is_ok();
    if values.len() != 3 || !values.iter().all(is_number) {
        return None;
    }
    let values: Vec<_> = values.iter().map(|value| document.source(*value)).collect();
    Some(tree.syntax().tuple(&values.join(", ")))
}

/// Returns true for several colors in the place of one.
fn is_gradient(document: Text<'_>, id: NodeId) -> bool {
    let tree = document.tree;
    let node = tree.node(id);
    let name = node.name().map(|range| document.slice(range));
    let is_named = name.is_some_and(|name| name.to_ascii_lowercase().contains("gradient"));
    let is_color = |value: NodeId| {
        let kind = tree.node(value).kind();
        matches!(kind, NodeKind::String | NodeKind::Tuple | NodeKind::List)
    };
    let children = match node.kind() {
        NodeKind::Struct | NodeKind::Map => tree
            .fields(id)
            .filter(|(_, value)| is_color(*value))
            .count(),
        NodeKind::Tuple | NodeKind::List => {
            tree.children(id).filter(|value| is_color(*value)).count()
        }
        _ => 0,
    };
    is_named || children > 1
}

/// Returns what is meant by a rotation without the names of its fields: angles about x, y and z are
/// one about an axis if only one of them is not 0.
pub(super) fn rotation(document: Text<'_>, id: NodeId) -> Option<Advice> {
    let (tree, syntax) = (document.tree, document.tree.syntax());
    let shown = |axis: &str, angle: &str| {
        let [of_axis, of_angle] = ["axis", "angle"].map(|name| syntax.key(name));
        let axis = syntax.tuple(axis);
        syntax.object(&format!("{of_axis}{axis}, {of_angle}{angle}"))
    };
    let children = match tree.node(id).kind() {
        NodeKind::Tuple | NodeKind::List => tree.children(id).collect(),
        NodeKind::Number => vec![id],
        _ => Vec::new(),
    };
    let angles = children
        .iter()
        .map(|child| float(document.source(*child), syntax).ok());
    let angles: Vec<_> = angles.collect::<Option<_>>()?;
    match &*angles {
        [_] => {
            let example = shown("0, 1, 0", document.source(*children.first()?));
            Some((format!("give the axis as well, such as `{example}`"), None))
        }
        [_, _, _] => {
            let mut turns = (0..3).filter(|axis| angles.get(*axis) != Some(&0.0));
            let (Some(axis), None) = (turns.next(), turns.next()) else {
                let help = "a rotation has one axis and one angle, in degrees; for several, put a \
                            group with a rotation into another one";
                return Some((help.to_owned(), None));
            };
            let unit = ["1, 0, 0", "0, 1, 0", "0, 0, 1"].get(axis)?;
            let value = shown(unit, document.source(*children.get(axis)?));
            let fix = Fix::safe([Edit::replace(tree.node(id).range(), &*value)]);
            Some((format!("write `{value}`"), Some(fix)))
        }
        _ => None,
    }
}

/// Returns what is meant by a variant whose name is the value of a field, as in `{"type": "Sphere"}`.
pub(super) fn tagged(document: Text<'_>, id: NodeId, variants: &[&'static str]) -> Option<Advice> {
    /// The keys that other formats use for this.
    const TAGS: [&str; 6] = ["type", "kind", "shape", "class", "geometry", "variant"];
    let (text, tree) = (document.text, document.tree);
    let node = tree.node(id);
    let mut fields = tree.fields(id);
    let (key, value) = fields.find(|(key, _)| TAGS.contains(&&*name_of(text, tree, *key)))?;
    let source = document.source(value);
    let spelt = match tree.node(value).kind() {
        NodeKind::String => string(source, tree.syntax())?,
        NodeKind::Name => source.into(),
        _ => return None,
    };
    let name = near(&spelt, variants)?;
    let range = node.range();
    let (open, help) = match tree.syntax() {
        Syntax::Ron => (
            range.start,
            format!("the name stands before the bracket: `{name}(…)`"),
        ),
        Syntax::Json => (
            range.start + 1,
            format!("a variant is an object with one key, its name: `{{\"{name}\": {{…}}}}`"),
        ),
    };
    let tag = tree.node(key).range().start..tree.node(value).range().end;
    let removal = fix::removal(text, tree, tag)?;
    let (before, after) = match tree.syntax() {
        Syntax::Ron => (name.to_owned(), ""),
        Syntax::Json => (format!("\"{name}\": {{"), "}"),
    };
    let close = range.end - 1;
    // The removal may touch one of the others.
    let edits = match removal.range {
        Range { start, .. } if start == open => {
            vec![
                Edit::replace(removal.range, before),
                Edit::insert(close, after),
            ]
        }
        Range { end, .. } if end == close => {
            vec![
                Edit::insert(open, before),
                Edit::replace(removal.range, after),
            ]
        }
        _ => vec![
            Edit::insert(open, before),
            removal,
            Edit::insert(close, after),
        ],
    };
    let edits = edits
        .into_iter()
        .filter(|edit| !edit.range.is_empty() || !edit.text.is_empty());
    let edits: Vec<_> = edits.collect();
    let touch = edits.windows(2).any(|pair| match pair {
        [one, other] => one.range.end >= other.range.start,
        _ => false,
    });
    Some((help, (!touch).then(|| Fix::safe(edits))))
}

/// Returns the variant whose name is missing, if the fields fit only one.
pub(super) fn unnamed(
    document: Text<'_>,
    id: NodeId,
    variants: &[&'static str],
) -> Option<&'static str> {
    let keys = document.tree.fields(id);
    let keys: Vec<_> = keys
        .map(|(key, _)| name_of(document.text, document.tree, key))
        .collect();
    let mut fitting = variants.iter().filter(|variant| fits(variant, &keys));
    match (fitting.next(), fitting.next()) {
        (Some(only), None) if !keys.is_empty() => Some(only),
        _ => None,
    }
}
