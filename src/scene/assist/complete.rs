//! Completion and docs.

use std::collections::BTreeSet;

use super::{
    colors,
    files::files,
    names::{self, Name, NameKind},
    paths::paths,
    sample::{fields, sample, sample_of, words_of_field},
    spot::{Finder, Fitting, Spot},
};
use crate::{
    scene::{
        assist::completion::{Completion, CompletionKind, Completions, Hover},
        format::{
            field::FieldKind,
            scene::Model,
            thing::{Thing, Type},
        },
        options::ReadOptions,
    },
    text::syntax::{NodeKind, Syntax},
};

/// The number of names of materials or geometries that are offered.
const NAMES: usize = 1000;
/// The number of colors of the scene that are offered.
const COLORS: usize = 20;
/// Colors that are offered for a start.
const PALETTE: [&str; 9] = [
    "#ffffff", "#808080", "#000000", "#ff0000", "#ff8000", "#ffd700", "#00a000", "#0080ff",
    "#8000ff",
];
/// The number of nodes that are searched for colors.
const SEARCHED: usize = 10_000;

/// Returns what fits at an offset. From `first_cut` on, parts of the list of geometries may be left
/// out.
pub(super) fn complete(
    finder: &Finder,
    offset: usize,
    first_cut: usize,
    options: &ReadOptions,
) -> Completions {
    let (text, tree) = (finder.text, finder.tree);
    let nothing = Completions {
        range: offset..offset,
        items: Vec::new(),
    };
    if tree.root().is_none() {
        return match text.trim().is_empty() {
            true => Completions {
                items: vec![whole(tree.syntax())],
                ..nothing
            },
            false => nothing,
        };
    }
    let Some(Spot { range, word, place }) = finder.find(offset) else {
        return nothing;
    };
    let items = match &place {
        Fitting::Key {
            owner,
            given,
            has_colon,
        } => {
            let is_new = |name: &str| !given.iter().any(|other| other == name);
            keys(*owner, *has_colon, tree.syntax(), is_new)
        }
        Fitting::Path { has_colon } => paths(finder, *has_colon, first_cut),
        Fitting::Value { value, field } => match value {
            Type::File(endings) => files(word, endings, options),
            Type::NameOfGeometry => names_of(finder, NameKind::Geometry),
            Type::NameOfMaterial => names_of(finder, NameKind::Material),
            Type::Flag => {
                let field = field.as_ref().and_then(|(owner, name)| owner.field(name));
                flags(field.map_or("", |field| field.docs))
            }
            value => values(finder, *value),
        },
    };
    Completions { range, items }
}

/// Returns a whole scene, for an empty text.
fn whole(syntax: Syntax) -> Completion {
    let scene = Model::of_type();
    let fields = ["camera", "geometries"].map(|name| {
        let sample = scene.value(name).map(|value| sample(value, syntax));
        format!("    {}{},\n", syntax.key(name), sample.unwrap_or_default())
    });
    let fields = fields.concat();
    let insert = match syntax {
        Syntax::Ron => format!("(\n{fields})\n"),
        Syntax::Json => format!("{{\n{}\n}}\n", fields.trim_end().trim_end_matches(',')),
    };
    Completion {
        detail: "a camera and a list of geometries".to_owned(),
        ..item("scene", insert, CompletionKind::Value, scene.docs())
    }
}

fn keys(
    owner: Type,
    has_colon: bool,
    syntax: Syntax,
    is_new: impl Fn(&str) -> bool,
) -> Vec<Completion> {
    let written = |name: &str| match has_colon {
        true => syntax.word(name),
        false => syntax.key(name),
    };
    let fields = fields(owner).into_iter();
    let fields = fields.filter(|(_, field)| is_new(field.name));
    let fields = fields.map(|(_, field)| {
        let (name, kind) = (field.name, CompletionKind::Field);
        Completion {
            detail: words_of_field(field),
            ..item(name, written(name), kind, field.docs)
        }
    });
    let mut items: Vec<_> = fields.collect();
    // The location of the schema is written by programs.
    items.sort_by_key(|item| item.label.starts_with('$'));
    let variants = owner.variants().iter().filter_map(|variant| {
        let content = sample(owner.content(variant)?, syntax);
        let insert = match has_colon {
            true => written(variant.name),
            false => written(variant.name) + &content,
        };
        let kind = CompletionKind::Variant;
        Some(item(variant.name, insert, kind, variant.docs))
    });
    items.extend(variants);
    items
}

fn values(finder: &Finder, value: Type) -> Vec<Completion> {
    let syntax = finder.tree.syntax();
    if matches!(value, Type::Value(FieldKind::Color)) {
        let mut colors = used_colors(finder);
        let is_new = |color: &&str| !colors.iter().any(|used| used.trim_matches('"') == *color);
        let more = PALETTE.iter().copied().filter(is_new);
        let more: Vec<_> = more.map(|color| format!("\"{color}\"")).collect();
        colors.extend(more);
        let colors = colors.into_iter().map(|color| {
            let label = color.trim_matches('"').to_owned();
            item(&label, color, CompletionKind::Color, "")
        });
        return colors.collect();
    }
    let variants = value.variants();
    if !variants.is_empty() {
        let variants = variants.iter().map(|one| {
            let sample = sample_of(value, one, syntax);
            item(one.name, sample, CompletionKind::Variant, one.docs)
        });
        return variants.collect();
    }
    match value {
        Type::Object(..) => {
            let (label, kind) = (sample(value, syntax), CompletionKind::Value);
            vec![item(&label, label.clone(), kind, value.docs())]
        }
        _ => Vec::new(),
    }
}

/// Returns the values of a flag, with its docs.
fn flags(docs: &str) -> Vec<Completion> {
    let item = |value: &str| item(value, value.to_owned(), CompletionKind::Value, docs);
    ["true", "false"].map(item).into()
}

/// Returns a completion without details.
pub(super) fn item(label: &str, insert: String, kind: CompletionKind, docs: &str) -> Completion {
    Completion {
        label: label.to_owned(),
        insert,
        kind,
        detail: String::new(),
        docs: docs.to_owned(),
    }
}

/// Returns the colors of the scene that are strings, as they are written.
fn used_colors(finder: &Finder) -> Vec<String> {
    let ids = finder.tree.ids().take(SEARCHED);
    let strings = ids.filter(|id| finder.tree.node(*id).kind() == NodeKind::String);
    let colors = strings.filter_map(|id| {
        let range = finder.tree.node(id).range();
        let text = finder.text.get(range)?;
        colors::of_string(text).map(|_| text.to_owned())
    });
    let mut seen = BTreeSet::new();
    for color in colors {
        if seen.len() == COLORS {
            break;
        }
        seen.insert(color);
    }
    seen.into_iter().collect()
}

/// Returns the names of the scene's things of a kind.
fn names_of(finder: &Finder, kind: NameKind) -> Vec<Completion> {
    let is_given = |name: &Name| name.kind == kind && name.definition.is_some();
    let names = names::all(finder).filter(is_given).take(NAMES);
    let names = names.map(|Name { name, .. }| Completion {
        detail: format!("{} of the scene", kind.name()),
        ..item(&name, format!("{name:?}"), CompletionKind::Name, "")
    });
    names.collect()
}

/// Returns the meaning of the name or value at an offset.
pub(super) fn hover(finder: &Finder, offset: usize) -> Option<Hover> {
    let Spot { range, word, place } = finder.find(offset)?;
    if word.is_empty() {
        return None;
    }
    let of_field = |owner: Type, name: &str| {
        let field = owner.field(name)?;
        let title = format!("{name}: {}", words_of_field(field));
        Some((title, field.docs))
    };
    let of_variant = |owner: Type, name: &str| {
        let variant = owner.variant(name)?;
        Some((name.to_owned(), variant.docs))
    };
    let (title, docs) = match place {
        Fitting::Path { .. } => return None,
        Fitting::Key { owner, .. } => of_field(owner, word).or_else(|| of_variant(owner, word))?,
        Fitting::Value { value, field, .. } => of_variant(value, word).or_else(|| {
            let (owner, name) = field?;
            of_field(owner, &name).or_else(|| of_variant(owner, &name))
        })?,
    };
    Some(Hover {
        range,
        title,
        docs: docs.to_owned(),
    })
}
