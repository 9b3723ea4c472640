//! Opens, reads and checks the mesh files that a scene names.

use std::collections::BTreeMap;

use crate::{
    data::{
        fault::ReadError,
        mesh::{Flaw, Format, MeshFile, Note, Request},
        table::{Names, Values},
    },
    diagnostic::{Code, path::Path},
    scene::{
        files::{self, Folder},
        format::{
            color_by::ColorByModel,
            geometry::{
                GeometryModel,
                mesh::{OfVertices, ReadMesh},
            },
            material::MaterialsModel,
            scene::Model,
            texture::TextureModel,
        },
        in_file,
        options::ReadOptions,
        place::Place,
        problem::{Focus, Problem},
    },
    text::nearest::quote,
    tracer::{color::Color, error::GeometryError, shape::mesh::Mesh},
};

/// A mesh file that was read.
struct MeshOfFile {
    /// `None` if it has errors.
    mesh: Option<ReadMesh>,
    /// The names of the properties of a vertex.
    names: Names,
    notes: Vec<Note>,
}

/// What a geometry wants of a mesh file.
#[derive(Clone, PartialEq, Eq, PartialOrd, Ord)]
struct Wanted {
    file: Box<str>,
    is_smooth: bool,
    /// True for the colors of the vertices.
    colors: bool,
    /// The property whose values determine the colors.
    value: Option<Box<str>>,
    /// True for the texture coordinates.
    uv: bool,
}

/// Reads all mesh files of a scene into its model, each once, and returns their problems.
pub(crate) fn read(model: &mut Model, files: &Folder<'_>, options: &ReadOptions) -> Vec<Problem> {
    let mut problems = Vec::new();
    let mut known: BTreeMap<Wanted, MeshOfFile> = BTreeMap::new();
    for at in model.meshes_in_files() {
        let variant = model.path_of(at);
        let Some(geometry) = model.geometry(at) else {
            continue;
        };
        let uv = needs_uv(geometry, model.materials.as_ref());
        let path_of_texture = geometry.surface().path_of_texture(variant.clone());
        let Some(GeometryModel::Mesh(geometry)) = model.geometry_mut(at) else {
            continue;
        };
        let (is_smooth, by) = (geometry.smooth(), geometry.color_by.clone());
        let colors = geometry.may_have_colors() && by.is_none();
        let named = geometry.file.as_mut();
        let Some(named) = named.filter(|_| !options.is_cancelled()) else {
            continue;
        };
        let place = Place {
            file: &named.path,
            field: "file",
            variant,
        };
        let wanted = Wanted {
            file: named.path.clone(),
            is_smooth,
            colors,
            value: by.as_ref().map(|by| by.column.clone()),
            uv,
        };
        let before = problems.len();
        let locate = |problems: &mut Vec<Problem>| {
            let problems = problems.get_mut(before..).unwrap_or_default();
            let name = || options.path_of(&*wanted.file);
            in_file::place(problems, &wanted.file, name, files);
        };
        if !known.contains_key(&wanted) {
            match open(&place, files, &wanted, options) {
                Ok(found) => drop(known.insert(wanted.clone(), found)),
                Err(problem) => {
                    problems.push(problem);
                    locate(&mut problems);
                    continue;
                }
            }
        }
        if let Some(MeshOfFile { mesh, names, notes }) = known.get(&wanted) {
            problems.extend(notes.iter().map(|note| problem(&place, note)));
            locate(&mut problems);
            if let Some(mesh) = mesh {
                problems.extend(colorless(
                    &place,
                    &mesh.vertices,
                    colors,
                    by.as_ref(),
                    names,
                ));
                if uv && !mesh.mesh.has_uv() {
                    problems.push(without_uv(&place, path_of_texture));
                }
            }
            named.mesh.clone_from(mesh);
        }
    }
    problems
}

/// Returns true if a mesh has a texture with the coordinates of its file.
fn needs_uv(mesh: &GeometryModel, materials: Option<&MaterialsModel>) -> bool {
    let texture = mesh.surface().texture(materials);
    mesh.color_by().is_none() && texture.is_some_and(TextureModel::is_natural)
}

fn without_uv(place: &Place, path: Path) -> Problem {
    let message = format!("{} has no texture coordinates", quote(place.file));
    let problem = Problem::new(Code::MissingUv, path, Focus::Value, message);
    problem.help(
        "save the mesh with texture coordinates, in an OBJ or a PLY file, or give the texture a `mapping`",
    )
}

/// Returns the problem of a file that does not determine the colors that are wanted of it.
fn colorless(
    place: &Place,
    found: &OfVertices,
    colors: bool,
    by: Option<&ColorByModel>,
    names: &Names,
) -> Option<Problem> {
    let known = match found {
        OfVertices::Values(_, range) => Some(range.is_some()),
        OfVertices::Nothing | OfVertices::Colors(_) | OfVertices::OfTriangles(_) => None,
    };
    match by {
        Some(by) => place.values(by, names, known),
        None if colors && *found == OfVertices::Nothing => {
            let help = "give it a `color` or a `material`, or save the mesh with colors";
            Some(place.without("color", help.into()))
        }
        None => None,
    }
}

fn open(
    place: &Place,
    files: &Folder<'_>,
    wanted: &Wanted,
    options: &ReadOptions,
) -> Result<MeshOfFile, Problem> {
    let format = Format::of_name(place.file).ok_or_else(|| {
        let message = "the extension does not determine the format, expected .ply, .obj or .stl";
        place.problem(Code::InvalidMesh, message)
    })?;
    let (_, file, length) = place.open_data(files, Code::InvalidMesh)?;
    let request = Request {
        colors: wanted.colors,
        value: wanted.value.as_deref(),
        uv: wanted.uv,
        cancel: options.canceller(),
    };
    let file = options.until_cancelled(file);
    let read = MeshFile::read(file, length, format, &request);
    let mut found = read.map_err(|error| match error {
        ReadError::Io(error) => place.problem(Code::FileNotFound, files::cause(error)),
        ReadError::Invalid(fault) => place.fault(Code::InvalidMesh, &fault, 1),
    })?;
    let notes = std::mem::take(&mut found.notes);
    let names = std::mem::take(&mut found.names);
    let mut mesh = None;
    if !notes.iter().any(|note| note.flaw.is_error()) {
        let built = build(found, wanted.is_smooth);
        mesh = Some(built.map_err(|error| place.problem(Code::InvalidMesh, error.to_string()))?);
    }
    Ok(MeshOfFile { mesh, names, notes })
}

/// Builds the mesh of a file, with what determines its colors.
fn build(file: MeshFile, is_smooth: bool) -> Result<ReadMesh, GeometryError> {
    let MeshFile {
        vertices,
        triangles,
        colors,
        of_triangles,
        values,
        uv,
        groups,
        ..
    } = file;
    let (mesh, vertices) = if !values.is_empty() {
        let (mesh, values) = Mesh::with(vertices, triangles, values)?;
        let range = Values::of(&values).range();
        (mesh, OfVertices::Values(values.into(), range))
    } else if !colors.is_empty() {
        let (mesh, colors) = Mesh::with(vertices, triangles, colors)?;
        let light = colors
            .into_iter()
            .map(|[r, g, b]| Color::new(r, g, b).to_linear());
        (mesh, OfVertices::Colors(light.collect()))
    } else if !of_triangles.is_empty() {
        let colors = of_triangles
            .into_iter()
            .map(|[r, g, b]| Color::new(r, g, b));
        let colors = OfVertices::OfTriangles(colors.collect());
        (Mesh::new(vertices, triangles)?, colors)
    } else {
        (Mesh::new(vertices, triangles)?, OfVertices::Nothing)
    };
    let mesh = match is_smooth {
        true => mesh.smooth(),
        false => mesh,
    };
    Ok(ReadMesh {
        mesh: mesh.with_uv(uv).with_groups(groups).into(),
        vertices,
    })
}

fn problem(place: &Place, note: &Note) -> Problem {
    let code = match note.flaw {
        flaw if flaw.is_error() => Code::InvalidMesh,
        Flaw::Clamped => Code::ColorClamped,
        Flaw::Behind | Flaw::NotFlat | Flaw::Crossing | Flaw::Colorless | Flaw::Untextured => {
            Code::OddMesh
        }
        _ => Code::NoEffect,
    };
    place.fault(code, &note.fault, note.count)
}
