//! The way of a setting: from the root of a model to the value, which is read there as in a file.

use std::{borrow::Cow, ops::Range};

use serde::{Serialize, de::DeserializeOwned};

use super::Value;
use crate::{
    diagnostic::{
        Code, Diagnostic,
        path::{Path, Step},
    },
    scene::{
        convert,
        format::{
            scene::Model,
            thing::{Follow, GivenFields, Record, Set, Type, Variant},
        },
        path::PathPart,
        problem::syntax_fault,
        recover::{fix::removal, recover_at, text::name_of},
        unknown,
    },
    text::{
        nearest::quote,
        syntax::{self, NodeId, NodeKind, Syntax, Tree},
    },
};

/// Sets the value at the end of `steps` in a model, or nothing if there are faults.
pub(super) fn fill(
    model: &mut Model,
    steps: &[PathPart],
    value: &Value,
    syntax: Syntax,
) -> Result<(), Vec<Diagnostic>> {
    let fill = Fill {
        steps,
        value,
        syntax,
        path: Vec::new(),
    };
    fill.thing(model)
}

/// A value on its way to its place.
struct Fill<'a> {
    steps: &'a [PathPart],
    value: &'a Value,
    syntax: Syntax,
    /// The way so far.
    path: Vec<Step>,
}

impl Follow for Fill<'_> {
    type Out = Result<(), Vec<Diagnostic>>;

    fn thing<T: Record>(mut self, thing: &mut T) -> Self::Out {
        let [part, rest @ ..] = self.inside() else {
            *thing = self.read(["", &self.value.text, ""])?;
            return Ok(());
        };
        if !thing.is_given() {
            *thing = self.create(Some(T::of_type()), None)?;
            return Ok(());
        }
        let is_map = matches!(T::of_type(), Type::Map(..));
        if rest.is_empty() && self.value.removes && thing.remove(&part.step) {
            return Ok(());
        }
        let is_replaced = |(set, given): &(&Set, GivenFields)| {
            let name = part.name();
            name.is_some_and(|name| set.instead_of(name, given).is_some())
        };
        if !rest.is_empty() && thing.sets().iter().any(is_replaced) {
            return Err(vec![self.not_given(self.path.len())]);
        }
        // RON cannot write `$schema`.
        key(part, !is_map, self.syntax).map_err(|fault| vec![fault])?;
        self.path.push(match part.name().filter(|_| is_map) {
            Some(name) => Step::Key(name.into()),
            None => part.step.clone(),
        });
        match thing.enter(&part.step, self) {
            Ok(done) => done,
            Err(mut fill) => {
                fill.path.pop();
                Err(fill.nowhere(thing, part))
            }
        }
    }

    fn value<T: Serialize + DeserializeOwned>(self, value: &mut T) -> Self::Out {
        if self.inside().is_empty() {
            *value = self.read(["", &self.value.text, ""])?;
            return Ok(());
        }
        let text = convert::write(value, self.syntax);
        let tree = syntax::parse(&text, self.syntax);
        let root = tree
            .root()
            .filter(|id| tree.node(*id).kind() != NodeKind::Null);
        *value = match root {
            None => self.create(None, None)?,
            Some(root) => {
                let place = self.place_in(&text, &tree, root);
                let (place, new) = place.map_err(|fault| vec![fault])?;
                self.read([&text[..place.start], new, &text[place.end..]])?
            }
        };
        Ok(())
    }
}

impl<'a> Fill<'a> {
    /// The rest of the way.
    fn inside(&self) -> &'a [PathPart] {
        self.steps.get(self.path.len()..).unwrap_or_default()
    }

    /// Returns the place of an element of a value, such as a number of a vector or a key of a track, in
    /// the text of the value, and what is written there. An entry of a map is removed with its key.
    fn place_in(
        &self,
        text: &str,
        tree: &Tree,
        mut node: NodeId,
    ) -> Result<(Range<usize>, &str), Diagnostic> {
        let mut inside = self.inside();
        while let [part, rest @ ..] = inside {
            inside = rest;
            let entry =
                |(key, _): &(NodeId, NodeId)| part.name() == Some(&*name_of(text, tree, *key));
            node = match (tree.node(node).kind(), &part.step) {
                (NodeKind::List | NodeKind::Tuple, Step::Index(at)) => {
                    let element = tree.children(node).nth(*at);
                    element.ok_or_else(|| no_element(part, *at, tree.children(node).count()))?
                }
                (_, Step::Index(_)) => return Err(no_list(part)),
                (NodeKind::Map, _) => match tree.fields(node).find(entry) {
                    Some((key, value)) if rest.is_empty() && self.value.removes => {
                        let entry = tree.node(key).range().start..tree.node(value).range().end;
                        let removal = removal(text, tree, entry).map(|edit| edit.range);
                        return Ok((removal.unwrap_or_default(), ""));
                    }
                    Some((_, value)) => value,
                    None => {
                        let names = tree.fields(node).map(|(key, _)| name_of(text, tree, key));
                        return Err(self.no_entry(part, &names.collect::<Vec<_>>()));
                    }
                },
                _ => return Err(no_struct(part)),
            };
        }
        Ok((tree.node(node).range(), &self.value.text))
    }

    /// Reads a thing that is not given, whose type is given if it has one, with nothing but the fields
    /// that lead to the value. `variant` is the variant, if that is known.
    fn create<T: DeserializeOwned>(
        &self,
        mut of_type: Option<Type>,
        mut variant: Option<&str>,
    ) -> Result<T, Vec<Diagnostic>> {
        let (mut before, mut after) = (String::new(), String::new());
        for part in self.inside() {
            let Some(name) = part.name() else {
                // A missing list has no elements to set.
                return Err(vec![self.not_given(self.path.len().saturating_sub(1))]);
            };
            let found = match (variant.take(), of_type) {
                (Some(name), Some(one_of)) => one_of.variant(name),
                (None, Some(Type::OneOf(one_of))) => meant(one_of.variants, name),
                _ => None,
            };
            let content = found.and_then(|it| it.content).map(|of_type| of_type());
            let is_object = matches!(of_type, Some(Type::Object(..) | Type::OneOf(_)));
            let [open, close] = match is_object {
                true => self.syntax.brackets(),
                false => ["{", "}"],
            };
            let (around, end) = match (found.map(|it| it.name), self.syntax) {
                (Some(name), Syntax::Ron) => (name.to_owned(), ""),
                (Some(name), Syntax::Json) => (format!("{{\"{name}\": "), "}"),
                (None, _) => (String::new(), ""),
            };
            let key = key(part, is_object, self.syntax).map_err(|fault| vec![fault])?;
            before += &format!("{around}{open}{key}: ");
            after = format!("{after}{close}{end}");
            of_type = content.or(of_type).and_then(|of_type| of_type.value(name));
        }
        self.read([&before, &self.value.text, &after])
    }

    /// Reads the text between two others as the reader of files does.
    fn read<T: DeserializeOwned>(
        &self,
        [before, new, after]: [&str; 3],
    ) -> Result<T, Vec<Diagnostic>> {
        /// The maximum number of faults kept for one value: nobody reads more.
        const MOST_FAULTS: usize = 100;
        let text = [before, new, after].concat();
        let tree = syntax::parse(&text, self.syntax);
        let recovered = recover_at(&text, &tree, MOST_FAULTS, &self.path);
        let faults = tree.faults().iter().map(syntax_fault);
        let faults: Vec<_> = faults.chain(recovered.diagnostics).collect();
        match recovered.model {
            Some(read) if faults.is_empty() => Ok(read),
            _ => Err(self.placed(faults, &text, before.len()..before.len() + new.len())),
        }
    }

    /// Moves the faults of a value in a text to their places in the setting.
    fn placed(&self, faults: Vec<Diagnostic>, text: &str, value: Range<usize>) -> Vec<Diagnostic> {
        let place = &self.value.range;
        let is_inside = |range: &Range<usize>| value.start <= range.start && range.end <= value.end;
        let (inside, outside): (Vec<_>, Vec<_>) = faults
            .into_iter()
            .partition(|fault| is_inside(&fault.range));
        // A fault outside of the value is a fault of the path.
        if !outside.is_empty() {
            let unknown = outside
                .into_iter()
                .find(|fault| fault.code == Code::UnknownField);
            let Some(fault) = unknown else {
                return vec![self.not_given(self.path.len().saturating_sub(1))];
            };
            let key = text.get(fault.range.clone()).unwrap_or_default();
            let mut new = self.steps.iter().skip(self.path.len().saturating_sub(1));
            let step = new.find(|step| step.name() == Some(key.trim_matches('"')));
            return vec![Diagnostic {
                code: Code::UnknownPath,
                range: step.map(|step| step.range.clone()).unwrap_or_default(),
                path: Path::ROOT,
                ..fault
            }];
        }
        let at = |offset: usize| place.start + offset.saturating_sub(value.start).min(place.len());
        let inside = inside.into_iter().map(|mut fault| {
            fault.labels.retain(|label| is_inside(&label.range));
            for label in &mut fault.labels {
                label.range = at(label.range.start)..at(label.range.end);
            }
            fault.range = at(fault.range.start)..at(fault.range.end);
            fault
        });
        inside.collect()
    }

    /// Returns the diagnostic of a missing value that the setting needs.
    fn not_given(&self, index: usize) -> Diagnostic {
        let part = self.steps.get(index);
        let name = quote(part.and_then(PathPart::name).unwrap_or_default());
        let range = part.map(|part| part.range.clone()).unwrap_or_default();
        let message = format!("{name} is not given: nothing in it can be set");
        Diagnostic::new(Code::UnknownPath, range, message)
    }

    /// Returns the diagnostic of the next step, which leads nowhere in a thing.
    fn nowhere<T: Record>(&self, thing: &T, part: &PathPart) -> Vec<Diagnostic> {
        let steps = thing.steps();
        let fields: Vec<_> = thing.fields().iter().map(|field| field.name).collect();
        vec![match (T::of_type(), &part.step) {
            (Type::List(..), Step::Index(at)) => no_element(part, *at, steps.len()),
            (_, Step::Index(_)) => no_list(part),
            (Type::List(..), _) => no_struct(part),
            (Type::Map(..), _) => {
                let names = steps.iter().filter_map(Step::name).map(Cow::from);
                self.no_entry(part, &names.collect::<Vec<_>>())
            }
            _ if fields.is_empty() => no_struct(part),
            _ if self.inside().iter().any(|part| part.name().is_none()) => {
                // The name of a list may be misspelt.
                let fault = self.not_given(self.path.len());
                fault.meaning(part.name().unwrap_or_default(), &fields)
            }
            // Alone in its struct, so that the field it resembles does not count as given.
            (of_type, _) => match self.create::<T>(Some(of_type), thing.variant()) {
                Ok(_) => no_struct(part),
                Err(faults) => return faults,
            },
        }]
    }

    /// Returns the diagnostic of the name of a map that is not one of `known`.
    fn no_entry(&self, part: &PathPart, known: &[Cow<'_, str>]) -> Diagnostic {
        let known: Vec<_> = known.iter().map(|name| &**name).collect();
        // One of the `cameras` is a camera.
        let map = self.path.last().and_then(Step::name).unwrap_or_default();
        let kind = map.strip_suffix('s').unwrap_or(map);
        Diagnostic {
            code: Code::UnknownPath,
            range: part.range.clone(),
            ..unknown::name(kind, part.name().unwrap_or_default(), &known)
        }
    }
}

/// Returns the variant that is meant by a field of what is not given: the first if it has the field and needs
/// none, the only one that has it, or the first if none does.
fn meant(variants: &[Variant], field: &str) -> Option<Variant> {
    let has_it = |variant: &&Variant| variant.fields().iter().any(|it| it.name == field);
    let needs_none = |variant: &&Variant| variant.fields().iter().all(|it| !it.is_required);
    if let Some(first) = variants.first().filter(has_it).filter(needs_none) {
        return Some(*first);
    }
    let mut having = variants.iter().filter(has_it);
    match [having.next(), having.next()] {
        [found, None] => found.or(variants.first()).copied(),
        _ => None,
    }
}

/// Returns a key as written in an object or a map.
fn key(part: &PathPart, is_object: bool, syntax: Syntax) -> Result<String, Diagnostic> {
    let name = part.name().unwrap_or_default();
    if !is_object || syntax == Syntax::Json {
        return Ok(serde_json::Value::from(name).to_string());
    }
    let is_of_a_word = |letter: char| letter.is_ascii_alphanumeric() || letter == '_';
    match name.chars().all(is_of_a_word) && !name.starts_with(|it: char| it.is_ascii_digit()) {
        true => Ok(name.to_owned()),
        false => Err(fault(part, format!("unknown field {}", quote(name)))),
    }
}

fn fault(part: &PathPart, message: String) -> Diagnostic {
    Diagnostic::new(Code::UnknownPath, part.range.clone(), message)
}

fn no_list(part: &PathPart) -> Diagnostic {
    fault(part, "not a list: it has no elements".to_owned())
}

fn no_struct(part: &PathPart) -> Diagnostic {
    fault(part, "not a struct: it has no fields".to_owned())
}

fn no_element(part: &PathPart, at: usize, count: usize) -> Diagnostic {
    fault(part, format!("there is no element {at}, there are {count}"))
}
