//! Diagnostics for names in an option that the scene does not have.

use crate::{
    diagnostic::{Code, Diagnostic, path::Step},
    scene::{
        format::{
            field::{Field, Fields},
            geometry::{GeometryModel, PartModel},
            light::LightModel,
            scene::Model,
        },
        path::Part,
    },
    text::nearest::{list, nearest, quote},
};

/// Returns the diagnostic for an unknown name, with its place in the text of the option.
pub(crate) fn name(kind: &str, name: &str, known: &[&str]) -> Diagnostic {
    let found = quote(name);
    let message = match known {
        [] => format!("unknown {kind} {found}, the scene has none with a name"),
        _ => format!("unknown {kind} {found}, expected one of {}", list(known)),
    };
    let diagnostic = Diagnostic::new(Code::UnknownName, 0..name.len(), message);
    match nearest(name, known) {
        Some(meant) => diagnostic.with_help(format!("did you mean {}?", quote(meant))),
        None => diagnostic,
    }
}

/// Replaces the name of a geometry or a light by its index. Fails for a path that leads into a part.
pub(crate) fn index_of_name(model: &Model, steps: &mut [Part]) -> Result<(), Diagnostic> {
    let [list, element, inside @ ..] = steps else {
        return Ok(());
    };
    match list.name() {
        Some(Model::LONG) => {
            let names = model.geometries.iter().map(GeometryModel::name);
            index_in("geometry", names, element)?;
            outside_of_parts(model, element, inside)
        }
        Some("lights") => {
            let lights = model.lights.as_deref().unwrap_or_default();
            index_in("light", lights.iter().map(LightModel::name), element)
        }
        _ => Ok(()),
    }
}

/// Rejects a path that leads on into the file of a part.
fn outside_of_parts(model: &Model, element: &Part, inside: &[Part]) -> Result<(), Diagnostic> {
    let Step::Index(index) = element.step else {
        return Ok(());
    };
    let part = model.geometries.get(index).and_then(GeometryModel::part);
    let (Some(part), Some(next)) = (part, inside.first()) else {
        return Ok(());
    };
    let is_in = |fields: &[Field]| fields.iter().any(|(name, _)| Some(*name) == next.name());
    if is_in(PartModel::FIELDS) || next.name().is_some() && !is_in(Model::FIELDS) {
        return Ok(());
    }
    let file = quote(&part.file);
    let message = format!("the path leads into {file}, whose values cannot be changed from here");
    let fault = Diagnostic::new(Code::UnknownPath, next.range.clone(), message);
    Err(fault.with_help(format!("change them in {file}")))
}

/// Replaces the name of an element of a list by its index; `names` are those of all elements.
fn index_in<'m>(
    what: &str,
    names: impl ExactSizeIterator<Item = Option<&'m str>> + Clone,
    element: &mut Part,
) -> Result<(), Diagnostic> {
    let count = names.len();
    let unknown = |message| Diagnostic::new(Code::UnknownPath, element.range.clone(), message);
    match &element.step {
        Step::Index(index) if *index < count => {}
        Step::Index(index) => {
            let fault = unknown(format!("there is no {what} {index}, the scene has {count}"));
            return Err(match count {
                0 => fault,
                _ => fault.with_help(format!("the indices are 0 to {}", count - 1)),
            });
        }
        Step::Field(_) | Step::Key(_) => {
            let name = element.name().unwrap_or_default();
            let Some(index) = names.clone().position(|known| known == Some(name)) else {
                let fault = unknown(format!("no {what} has the name {}", quote(name)));
                let names: Vec<_> = names.flatten().collect();
                return Err(match nearest(name, &names) {
                    Some(meant) => fault.with_help(format!("did you mean {}?", quote(meant))),
                    None => fault,
                });
            };
            element.step = Step::Index(index);
        }
    }
    Ok(())
}
