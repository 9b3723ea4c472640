//! Diagnostics for names in an option that the scene does not have.

use crate::{
    diagnostic::{Code, Diagnostic, path::Step},
    scene::{
        format::{
            field::Field,
            geometry::{GeometryModel, PartModel, ordinal::Ordinal},
            light::LightModel,
            scene::Model,
        },
        path::PathPart,
    },
    text::nearest::{nearest, one_of, quote},
};

/// Returns the diagnostic for an unknown name, with its place in the text of the option.
pub(crate) fn name(kind: &str, name: &str, known: &[&str]) -> Diagnostic {
    let message = message(kind, name, known);
    let diagnostic = Diagnostic::new(Code::UnknownName, 0..name.len(), message);
    diagnostic.meaning(name, known)
}

/// Returns the message about an unknown name.
pub(crate) fn message(kind: &str, name: &str, known: &[&str]) -> String {
    let found = quote(name);
    match known {
        [] => format!("unknown {kind} {found}, the scene has none with a name"),
        _ => {
            let expected = one_of(known, nearest(name, known).is_some());
            format!("unknown {kind} {found}, expected {expected}")
        }
    }
}

/// Replaces the name of a light by its index, and that of a geometry by the steps that lead to it.
/// Fails for a path that leads into a part.
pub(crate) fn index_of_name(model: &Model, steps: &mut Vec<PathPart>) -> Result<(), Diagnostic> {
    let [list, element, ..] = &mut **steps else {
        return Ok(());
    };
    match list.name() {
        Some(Model::LONG) => {
            index_of_geometry(model, steps)?;
            outside_of_parts(model, steps)
        }
        Some("lights") => {
            let lights = model.lights.as_deref().unwrap_or_default();
            let names = lights.iter().map(LightModel::name);
            index_in(["light", "the scene"], names, element)
        }
        _ => Ok(()),
    }
}

/// Replaces the names of geometries by their places: a name in the scene's list is that of any
/// geometry, one in the list of another geometry is that of an element.
fn index_of_geometry(model: &Model, steps: &mut Vec<PathPart>) -> Result<(), Diagnostic> {
    let Some(element) = steps.get_mut(1) else {
        return Ok(());
    };
    let nested = element.name().and_then(|name| {
        let mut all = model.walk();
        all.find(|(_, geometry)| geometry.name() == Some(name))
    });
    match nested {
        Some((at, _)) => {
            let range = element.range.clone();
            let path = model.path_of(at);
            let way = path.steps().iter().skip(1).map(|step| PathPart {
                step: step.clone(),
                range: range.clone(),
            });
            steps.splice(1..2, way);
        }
        None if element.index().is_some() => {
            let names = model.geometries.iter().map(GeometryModel::name);
            index_in(["geometry", "the scene"], names, element)?;
        }
        None => {
            let names = model.walk().map(|(_, geometry)| geometry.name());
            let names: Vec<_> = names.collect();
            index_in(["geometry", "the scene"], names.into_iter(), element)?;
        }
    }
    // The elements of lists inside of it, up to a field of another kind.
    while let Some((at, rest)) = geometry_on(model, steps) {
        let at_field = steps.len() - rest.len();
        let around = model.geometry(at);
        let mut lists = around.into_iter().flat_map(GeometryModel::inside);
        let list = lists.find(|inside| {
            let is_it = rest.first().and_then(PathPart::name) == Some(inside.field);
            is_it && inside.is_list
        });
        let (Some(list), Some(element)) = (list, steps.get_mut(at_field + 1)) else {
            break;
        };
        let names = list.geometries.iter().map(GeometryModel::name);
        index_in(["geometry", "the list"], names, element)?;
    }
    Ok(())
}

/// Returns the innermost geometry on a path, and the steps in it.
pub(crate) fn geometry_on<'s>(
    model: &Model,
    steps: &'s [PathPart],
) -> Option<(Ordinal, &'s [PathPart])> {
    let path: Vec<_> = steps.iter().map(|part| part.step.clone()).collect();
    let (at, count) = model.geometry_on(&path)?;
    Some((at, steps.get(count..)?))
}

/// Rejects a path that leads on into the file of a part.
fn outside_of_parts(model: &Model, steps: &[PathPart]) -> Result<(), Diagnostic> {
    let found = geometry_on(model, steps);
    let part = found.and_then(|(at, inside)| Some((model.geometry(at)?.part()?, inside.first()?)));
    let Some((part, next)) = part else {
        return Ok(());
    };
    let is_in = |fields: &[Field]| fields.iter().any(|field| Some(field.name) == next.name());
    if is_in(PartModel::FIELDS) || next.name().is_some() && !is_in(Model::FIELDS) {
        return Ok(());
    }
    let file = quote(&part.file);
    let message = format!("the path leads into {file}, whose values cannot be changed from here");
    let fault = Diagnostic::new(Code::UnknownPath, next.range.clone(), message);
    Err(fault.with_help(format!("change them in {file}")))
}

/// Replaces the name of an element of a list by its index; `names` are those of all elements. `what`
/// they are, and what has them, is for the message.
fn index_in<'m>(
    [what, owner]: [&str; 2],
    names: impl ExactSizeIterator<Item = Option<&'m str>> + Clone,
    element: &mut PathPart,
) -> Result<(), Diagnostic> {
    let count = names.len();
    let unknown = |message| Diagnostic::new(Code::UnknownPath, element.range.clone(), message);
    match &element.step {
        Step::Index(index) if *index < count => {}
        Step::Index(index) => {
            let fault = unknown(format!("there is no {what} {index}, {owner} has {count}"));
            return Err(match count {
                0 => fault,
                _ => fault.with_help(format!("the indices are 0 to {}", count - 1)),
            });
        }
        Step::Field(_) | Step::Key(_) => {
            let name = element.name().unwrap_or_default();
            let Some(index) = names.clone().position(|known| known == Some(name)) else {
                let fault = unknown(format!("no {what} has the name {}", quote(name)));
                return Err(fault.meaning(name, &names.flatten().collect::<Vec<_>>()));
            };
            element.step = Step::Index(index);
        }
    }
    Ok(())
}
