//! Opens, reads and checks the mesh files that a scene names.

use std::{collections::BTreeMap, sync::Arc};

use crate::{
    diagnostic::Code,
    scene::{
        files::{self, Folder},
        format::{geometry::GeometryModel, scene::Model},
        mesh_file::{Flaw, Format, MeshFile, Note, Request},
        options::ReadOptions,
        problem::Problem,
        table::{Fault, ReadError},
        tables::{Place, and_more},
    },
    tracer::shape::mesh::Mesh,
};

/// A mesh with the faults of its file.
type Found = (Option<Arc<Mesh>>, Vec<Note>);

/// Reads all mesh files of a scene into its model, each once, and returns their problems.
pub(crate) fn read(model: &mut Model, files: &Folder<'_>, options: &ReadOptions) -> Vec<Problem> {
    let mut problems = Vec::new();
    let mut known: BTreeMap<(Box<str>, bool), Found> = BTreeMap::new();
    for at in model.meshes_in_files() {
        let variant = model.path_of(at);
        let Some(GeometryModel::Mesh(geometry)) = model.geometry_mut(at) else {
            continue;
        };
        let is_smooth = geometry.is_smooth();
        let named = geometry.file.as_mut();
        let Some(named) = named.filter(|_| !options.is_cancelled()) else {
            continue;
        };
        let place = Place {
            file: &named.path,
            variant,
        };
        let key = (named.path.clone(), is_smooth);
        if !known.contains_key(&key) {
            match open(&place, files, is_smooth) {
                Ok(found) => drop(known.insert(key.clone(), found)),
                Err(problem) => {
                    problems.push(problem);
                    continue;
                }
            }
        }
        if let Some((mesh, notes)) = known.get(&key) {
            problems.extend(notes.iter().map(|note| problem(&place, note)));
            named.mesh.clone_from(mesh);
        }
    }
    problems
}

fn open(place: &Place, files: &Folder<'_>, is_smooth: bool) -> Result<Found, Problem> {
    let format = Format::of_name(place.file).ok_or_else(|| {
        let message = "the extension does not determine the format, expected .ply, .obj or .stl";
        place.problem(Code::InvalidMesh, message)
    })?;
    let (file, length) = place.open(files)?;
    let read = MeshFile::read(file, length, format, &Request::default());
    let mut found = read.map_err(|error| match error {
        ReadError::Io(error) => place.problem(Code::FileNotFound, files::cause(error)),
        ReadError::Invalid(fault) => invalid(place, &fault),
    })?;
    let notes = std::mem::take(&mut found.notes);
    if notes.iter().any(|note| note.flaw.is_error()) {
        return Ok((None, notes));
    }
    let mesh = Mesh::new(found.vertices, found.triangles);
    let mesh = mesh.map_err(|error| place.problem(Code::InvalidMesh, error.to_string()))?;
    let mesh = match is_smooth {
        true => mesh.smooth(),
        false => mesh,
    };
    Ok((Some(mesh.into()), notes))
}

fn invalid(place: &Place, fault: &Fault) -> Problem {
    let problem = place.problem(Code::InvalidMesh, &fault.message);
    problem.help_of(fault.help.clone())
}

fn problem(place: &Place, note: &Note) -> Problem {
    let code = match note.flaw {
        flaw if flaw.is_error() => Code::InvalidMesh,
        Flaw::Clamped => Code::ColorClamped,
        _ => Code::NoEffect,
    };
    let message = format!("{}{}", note.fault.message, and_more(note.count));
    place
        .problem(code, message)
        .help_of(note.fault.help.clone())
}
