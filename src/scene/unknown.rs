//! Diagnostics for names in an option that the scene does not have.

use crate::{
    diagnostic::{Code, Diagnostic, path::Step},
    scene::{
        format::{geometry::GeometryModel, scene::Model},
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

/// Replaces the name of a geometry by its index.
pub(crate) fn index_of_geometry(model: &Model, steps: &mut [Part]) -> Result<(), Diagnostic> {
    let [list, geometry, ..] = steps else {
        return Ok(());
    };
    if list.name() != Some(Model::LONG) {
        return Ok(());
    }
    let count = model.geometries.len();
    let unknown = |message| Diagnostic::new(Code::UnknownPath, geometry.range.clone(), message);
    match &geometry.step {
        Step::Index(index) if *index < count => {}
        Step::Index(index) => {
            let fault = unknown(format!(
                "there is no geometry {index}, the scene has {count}"
            ));
            return Err(match count {
                0 => fault,
                _ => fault.with_help(format!("the indices are 0 to {}", count - 1)),
            });
        }
        Step::Field(_) | Step::Key(_) => {
            let name = geometry.name().unwrap_or_default();
            let mut geometries = model.geometries.iter();
            let Some(index) = geometries.position(|geometry| geometry.name() == Some(name)) else {
                let fault = unknown(format!("no geometry has the name {}", quote(name)));
                let names = model.geometries.iter().filter_map(GeometryModel::name);
                let names: Vec<_> = names.collect();
                return Err(match nearest(name, &names) {
                    Some(meant) => fault.with_help(format!("did you mean {}?", quote(meant))),
                    None => fault,
                });
            };
            geometry.step = Step::Index(index);
        }
    }
    Ok(())
}
