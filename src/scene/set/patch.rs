//! Replacement of a value in the text of its owner.

use std::ops::Range;

use serde::{Serialize, de::DeserializeOwned};

use super::Setting;
use crate::{
    diagnostic::{
        Code, Diagnostic,
        path::{Path, Step},
    },
    scene::{
        convert,
        format::scene::Model,
        path::Part,
        problem::syntax_fault,
        recover::{self, fix::removal, name_of},
        unknown,
    },
    text::{
        nearest::{nearest, quote},
        syntax::{self, Kind, NodeId, Syntax, Tree},
    },
};

/// The fields that are maps, by the names on their path, with the kind of their values.
const MAPS: [(&[&str], &str); 3] = [
    (&["cameras"], "camera"),
    (&["materials"], "material"),
    (&["animation", "tracks"], "track"),
];

/// The fields that are enums, with the variant that is meant where there is none. A number that it
/// needs is its only field.
const MEANT: [(&str, &str); 2] = [("lighting", "Direct"), ("projection", "Perspective")];

/// Returns the kind of values in the map at the end of the steps, if it is one.
fn map_at(steps: &[Part]) -> Option<&'static str> {
    let names = || steps.iter().map(Part::name);
    let mut maps = MAPS.iter();
    let leads = |path: &[&str]| names().eq(path.iter().map(|name| Some(*name)));
    maps.find_map(|(path, kind)| leads(path).then_some(*kind))
}

/// The place for a value in a text.
struct Hole {
    /// The range that the value replaces; empty for an insertion.
    range: Range<usize>,
    /// The text inserted around the value: the keys of fields that are not yet given.
    before: String,
    after: String,
    /// The index of the first step to such a field.
    new_from: usize,
    /// The end of the struct that contains the insertion.
    end: usize,
    /// True if an entry of a map is removed with its key.
    is_entry: bool,
}

impl Hole {
    /// Creates a hole at what is given, to which the steps lead.
    fn at(range: Range<usize>, steps: &[Part], is_entry: bool) -> Self {
        Self {
            end: range.end,
            range,
            before: String::new(),
            after: String::new(),
            new_from: steps.len(),
            is_entry,
        }
    }

    /// Returns the text with the value inserted, and the new range of the value.
    fn filled(&self, text: &str, value: &str, rest: usize) -> (String, Range<usize>) {
        let value = if self.is_entry { "" } else { value };
        let start = self.range.start + self.before.len();
        let [head, rest] = [&text[..self.range.start], &text[rest..]];
        let filled = [head, &self.before, value, &self.after, rest].concat();
        (filled, start..start + value.len())
    }
}

/// The value of a setting and its range in the setting.
pub(super) struct Value {
    pub(super) range: Range<usize>,
    pub(super) text: String,
    /// True if a field is removed.
    pub(super) removes: bool,
}

impl Value {
    /// Returns the value of a setting as a text without quotes, if it may be one.
    pub(super) fn bare(setting: &Setting) -> Option<Self> {
        let range = setting.bare()?;
        let text = setting.text.get(range.clone())?;
        Some(Self {
            text: serde_json::Value::from(text).to_string(),
            range,
            removes: false,
        })
    }

    /// Reads the value of a setting.
    pub(super) fn of(setting: &Setting, syntax: Syntax) -> Result<Self, Vec<Diagnostic>> {
        let start = setting.value;
        if setting.value().trim().is_empty() {
            let message = "expected a value after `=`";
            return Err(vec![Diagnostic::new(Code::Syntax, start..start, message)]);
        }
        // A removal may be written as in either syntax.
        let trimmed = setting.value().trim();
        if ["null", "None"].contains(&trimmed) {
            let start = start + setting.value().find(trimmed).unwrap_or_default();
            return Ok(Self {
                range: start..start + trimmed.len(),
                text: match syntax {
                    Syntax::Ron => "None".to_owned(),
                    Syntax::Json => "null".to_owned(),
                },
                removes: true,
            });
        }
        let tree = syntax::parse(setting.value(), syntax);
        if let [_, ..] = tree.faults() {
            let faults = tree.faults().iter().map(|fault| {
                let range = fault.range.start + start..fault.range.end + start;
                let labels = Vec::new();
                let fault = syntax_fault(fault);
                Diagnostic {
                    range,
                    labels,
                    ..fault
                }
            });
            return Err(faults.collect());
        }
        let range = tree.root().map_or(0..0, |root| tree.node(root).range());
        let text = setting.value().get(range.clone()).unwrap_or("");
        Ok(Self {
            range: range.start + start..range.end + start,
            text: text.to_owned(),
            removes: false,
        })
    }
}

/// Returns a copy of `whole` with one value replaced, to which `steps` lead.
pub(super) fn patched<T: Serialize + DeserializeOwned>(
    whole: &T,
    steps: &[Part],
    value: &Value,
    syntax: Syntax,
) -> Result<T, Vec<Diagnostic>> {
    let text = convert::write(whole, syntax);
    let tree = syntax::parse(&text, syntax);
    let hole = hole(&text, &tree, steps, value.removes).map_err(|fault| vec![fault])?;
    let (filled, placed) = hole.filled(&text, &value.text, hole.range.end);
    /// The maximum number of faults kept for one value: nobody reads more.
    const MOST_FAULTS: usize = 100;
    let recovered = |text: &str| {
        let tree = syntax::parse(text, syntax);
        let recovered = recover::recover::<T>(text, &tree, MOST_FAULTS);
        let mut faults: Vec<_> = tree.faults().iter().map(syntax_fault).collect();
        faults.extend(recovered.diagnostics);
        (recovered.model, faults)
    };
    let faults = match recovered(&filled) {
        (Some(patched), faults) if faults.is_empty() => return Ok(patched),
        (_, faults) => faults,
    };
    let is_inside = |range: &Range<usize>| placed.start <= range.start && range.end <= placed.end;
    let (inside, outside): (Vec<_>, Vec<_>) = faults
        .into_iter()
        .partition(|fault| is_inside(&fault.range));
    // A fault outside of the value is a fault of the path.
    if outside.iter().any(|fault| fault.code == Code::UnknownField) {
        // Alone in its struct, so that the field it resembles does not count as given.
        let (alone, _) = hole.filled(&text, &value.text, hole.end);
        return Err(vec![unknown_field(
            steps,
            &hole,
            recovered(&alone).1,
            &alone,
        )]);
    }
    if !outside.is_empty() {
        return Err(vec![not_given(steps, hole.new_from)]);
    }
    let moved = |range: Range<usize>| {
        let length = value.range.len();
        let at =
            |offset: usize| value.range.start + offset.saturating_sub(placed.start).min(length);
        at(range.start)..at(range.end)
    };
    let inside = inside.into_iter().map(|mut fault| {
        fault.labels.retain(|label| is_inside(&label.range));
        for label in &mut fault.labels {
            label.range = moved(label.range.clone());
        }
        fault.range = moved(fault.range);
        fault
    });
    Err(inside.collect())
}

/// Returns the diagnostic of an unknown field, in the words of the file reader.
fn unknown_field(steps: &[Part], hole: &Hole, faults: Vec<Diagnostic>, text: &str) -> Diagnostic {
    let mut faults = faults.into_iter();
    let Some(fault) = faults.find(|fault| fault.code == Code::UnknownField) else {
        return not_given(steps, hole.new_from);
    };
    let key = text
        .get(fault.range.clone())
        .unwrap_or("")
        .trim_matches('"');
    let mut new = steps.iter().skip(hole.new_from);
    let step = new.find(|step| step.name() == Some(key));
    Diagnostic {
        code: Code::UnknownPath,
        range: step.map(|step| step.range.clone()).unwrap_or_default(),
        path: Path::ROOT,
        ..fault
    }
}

/// Returns the diagnostic of a missing value that the setting needs.
fn not_given(steps: &[Part], index: usize) -> Diagnostic {
    let (name, range) = match steps.get(index) {
        Some(step) => (step.name().unwrap_or_default(), step.range.clone()),
        None => ("the value", 0..0),
    };
    let message = format!("{} is not given: nothing in it can be set", quote(name));
    Diagnostic::new(Code::UnknownPath, range, message)
}

/// Returns the place for the value.
fn hole(text: &str, tree: &Tree, steps: &[Part], removes: bool) -> Result<Hole, Diagnostic> {
    let Some(mut node) = tree.root() else {
        return Err(Diagnostic::new(Code::UnknownPath, 0..0, "there is nothing"));
    };
    for (index, step) in steps.iter().enumerate() {
        let map = map_at(steps.get(..index).unwrap_or_default());
        let nothing = |what: String| Diagnostic::new(Code::UnknownPath, step.range.clone(), what);
        match &step.step {
            Step::Index(at) => {
                let list = tree.node(node);
                let is_variant = list.name().is_some();
                if is_variant || !matches!(list.kind(), Kind::List | Kind::Tuple) {
                    return Err(nothing("not a list: it has no elements".to_owned()));
                }
                let count = tree.children(node).count();
                node = tree.children(node).nth(*at).ok_or_else(|| {
                    nothing(format!("there is no element {at}, there are {count}"))
                })?;
            }
            Step::Field(_) | Step::Key(_) => {
                let name = step.name().unwrap_or_default();
                let owner = match map {
                    Some(_) => node,
                    None => body(text, tree, node),
                };
                let has_fields = match tree.node(owner).kind() {
                    Kind::Struct | Kind::Map | Kind::Unit => true,
                    // `Ambient()`, none of whose fields is given.
                    Kind::Tuple => tree.children(owner).next().is_none(),
                    _ => false,
                };
                if !has_fields {
                    return Err(nothing("not a struct: it has no fields".to_owned()));
                }
                let mut fields = tree.fields(owner);
                let key = |id| name_of(text, tree, id);
                let given = fields.find(|(id, _)| key(*id) == name);
                let is_last = index + 1 == steps.len();
                match (given, map) {
                    (Some((key, value)), Some(_)) if removes && is_last => {
                        let entry = tree.node(key).range().start..tree.node(value).range().end;
                        let removal = removal(text, tree, entry).map(|edit| edit.range);
                        return Ok(Hole::at(removal.unwrap_or_default(), steps, true));
                    }
                    (Some((_, value)), _) => node = value,
                    (None, Some(kind)) => {
                        let known: Vec<_> = tree.fields(owner).map(|(id, _)| key(id)).collect();
                        let known: Vec<_> = known.iter().map(|name| &**name).collect();
                        return Err(Diagnostic {
                            code: Code::UnknownPath,
                            range: step.range.clone(),
                            ..unknown::name(kind, name, &known)
                        });
                    }
                    (None, None) => return new_field(text, tree, owner, steps, index),
                }
            }
        }
    }
    let range = tree.node(node).range();
    Ok(Hole::at(range, steps, false))
}

/// Returns the hole for a field that a struct does not give yet, and for fields inside of it.
fn new_field(
    text: &str,
    tree: &Tree,
    owner: NodeId,
    steps: &[Part],
    new_from: usize,
) -> Result<Hole, Diagnostic> {
    let range = tree.node(owner).range();
    let name_end = tree.node(owner).name().map_or(range.start, |name| name.end);
    let start = tree.bracket_after(text, name_end, range.end) + 1;
    let (open, close) = match tree.syntax() {
        Syntax::Ron => ('(', ')'),
        Syntax::Json => ('{', '}'),
    };
    let (mut before, mut after) = (String::new(), String::new());
    let mut variant = None;
    for step in steps.iter().skip(new_from) {
        let Some(name) = step.name() else {
            // A missing list has no elements to set; but its name may be misspelt.
            let name = steps.get(new_from).and_then(Part::name).unwrap_or_default();
            let given: Vec<_> = tree
                .fields(owner)
                .map(|(id, _)| name_of(text, tree, id))
                .collect();
            let mut known: Vec<_> = given.iter().map(|name| &**name).collect();
            known.push(Model::LONG);
            let fault = not_given(steps, new_from);
            return Err(match nearest(name, &known) {
                Some(meant) => fault.with_help(format!("did you mean {}?", quote(meant))),
                None => fault,
            });
        };
        if !before.is_empty() {
            if let Some(variant) = variant {
                let (begin, end) = alone(variant, tree.syntax());
                before.push_str(&begin);
                after.push_str(end);
            }
            before.push(open);
            after.push(close);
        }
        let mut enums = MEANT.iter();
        variant = enums.find_map(|(field, variant)| (*field == name).then_some(*variant));
        before.push_str(&key(name, tree.syntax()).ok_or_else(|| {
            let message = format!("unknown field {}", quote(name));
            Diagnostic::new(Code::UnknownPath, step.range.clone(), message)
        })?);
        before.push_str(": ");
    }
    if tree.fields(owner).next().is_some() {
        after.push_str(", ");
    }
    Ok(Hole {
        range: start..start,
        before,
        after,
        new_from,
        end: range.end.saturating_sub(close.len_utf8()),
        is_entry: false,
    })
}

/// Returns what stands before and after the fields of a variant.
fn alone(variant: &str, syntax: Syntax) -> (String, &'static str) {
    match syntax {
        Syntax::Ron => (variant.to_owned(), ""),
        Syntax::Json => (format!("{{\"{variant}\": "), "}"),
    }
}

/// Returns the key of a field, if it is a valid one.
fn key(name: &str, syntax: Syntax) -> Option<String> {
    let is_of_a_word = |letter: char| letter.is_ascii_alphanumeric() || letter == '_';
    match syntax {
        Syntax::Json => serde_json::to_string(name).ok(),
        Syntax::Ron => {
            let is_word = name.chars().all(is_of_a_word)
                && !name.starts_with(|first: char| first.is_ascii_digit());
            is_word.then(|| name.to_owned())
        }
    }
}

/// Returns the node with the fields of a value: for a JSON variant the inner object.
fn body(text: &str, tree: &Tree, node: NodeId) -> NodeId {
    let mut fields = tree.fields(node);
    match (tree.syntax(), fields.next(), fields.next()) {
        (Syntax::Json, Some((key, body)), None)
            if name_of(text, tree, key).starts_with(|first: char| first.is_ascii_uppercase()) =>
        {
            body
        }
        _ => node,
    }
}
