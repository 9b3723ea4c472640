//! The mesh of a scene file.

use std::sync::Arc;

use glam::DVec3;
use serde::{Deserialize, Serialize};

use crate::{
    diagnostic::Code,
    scene::{
        format::{
            color_by::ColorByModel,
            field::FieldKind,
            geometry::{
                faults::{not_finite, value},
                kind::{GeometryKind, geometry},
            },
            material::MaterialModel,
            numbers::Triple,
            texture::TextureModel,
            thing::Type,
        },
        problem::{Focus, Problem},
    },
    tracer::{
        color::Color,
        error::GeometryError,
        geometry::Geometry,
        material::{Material, binding::VertexColors},
        radiance::Radiance,
        shape::{Shape, mesh::Mesh},
        vector::is_direction,
    },
};

geometry! {
    /// A triangle mesh, seen from both sides.
    pub struct MeshModel = "Mesh" {
        /// The mesh file: a path from the folder of the scene to a file .ply, .obj or .stl, with `/`
        /// between its parts. Give this, or `vertices` and `triangles`.
        file | path: File { &["ply", "obj", "stl"] }(MeshFileModel)?,
        /// The corners of the triangles. They cannot change over time.
        vertices | points | positions: Other { Type::List(|| Type::Value(FieldKind::Point), 0) }(Vec<Triple>)?,
        /// The triangles: three numbers of `vertices` each, from 0. Seen from the outside of a closed
        /// mesh, they go around counterclockwise.
        triangles | faces | indices: Other { Type::List(|| Type::Tuple(|| Type::Whole(Vec::new), 3), 1) }(Vec<[u32; 3]>)?,
        /// True to shade it like a curved surface, with normals between those of the corners; false is the
        /// default. Its outline and its shadows remain those of the triangles.
        smooth: Flag = false,
        /// The color: a matte surface; with a `texture`, white is the default. Give at most one of this and
        /// `material`, and one of them where the file has no colors of its vertices or faces, which are used
        /// without either.
        color: Color?,
        /// Colors by the values of a property of the vertices in `file`: one of a PLY file, or the
        /// coordinate `x`, `y` or `z`. They are interpolated inside of each triangle. Give at most one of
        /// this and `color`.
        color_by: Thing(ColorByModel)?,
        /// A texture, which the color is multiplied by. A `material` has its own.
        texture: Thing(Arc<TextureModel>)?,
        /// The material. Give at most one of this and `color`; the colors of `color_by` replace its first
        /// color.
        material: Thing(Arc<MaterialModel>)?,
    } at most one of color + texture, material any of file, vertices not solid
}

/// The path of a mesh file, and its mesh.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct MeshFileModel {
    /// The path from the folder of the scene.
    pub path: Box<str>,
    /// The mesh, once the file is read.
    #[serde(skip)]
    pub(crate) mesh: Option<ReadMesh>,
}

/// A mesh that was read from a file.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct ReadMesh {
    pub(crate) mesh: Arc<Mesh>,
    pub(crate) vertices: OfVertices,
}

/// What determines the colors of a mesh in its file.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum OfVertices {
    Nothing,
    /// The linear light of the color of each vertex.
    Colors(Arc<[Radiance]>),
    /// The value of each vertex, with the smallest and the largest finite one.
    Values(Arc<[f64]>, Option<[f64; 2]>),
    /// The color of each triangle.
    OfTriangles(Arc<[Color]>),
}

impl From<&str> for MeshFileModel {
    fn from(path: &str) -> Self {
        Self {
            path: path.into(),
            mesh: None,
        }
    }
}

impl GeometryKind for MeshModel {
    // Not inlined: it would slow down the loop over a million spheres.
    #[inline(never)]
    fn shape(&self) -> Option<Result<Shape, GeometryError>> {
        match &self.file {
            Some(file) => {
                let read = file.mesh.as_ref()?;
                Some(Ok(Shape::Mesh(Arc::clone(&read.mesh))))
            }
            None => {
                let vertices = self.vertices().iter().copied().map(DVec3::from);
                let mesh = Mesh::new(vertices.collect(), self.triangles().to_vec());
                Some(mesh.map(|mesh| match self.smooth() {
                    true => mesh.smooth().into(),
                    false => mesh.into(),
                }))
            }
        }
    }

    fn faults(&self) -> Vec<Problem> {
        if self.vertices.is_none() || self.triangles.is_none() {
            return Vec::new();
        }
        if self.triangles().is_empty() {
            let message = "a mesh has at least one triangle";
            let help = "write three numbers of vertices, as in `triangles: [(0, 1, 2)]`";
            return vec![Problem::of_field(Code::WrongType, "triangles", message).help(help)];
        }
        let mut faults: Vec<_> = self.infinite().chain(self.without_vertices()).collect();
        if faults.is_empty() {
            faults.extend(self.without_area());
        }
        faults
    }

    fn more_numbers(&self, see: &mut dyn FnMut(f64)) {
        self.vertices().iter().flatten().for_each(|x| see(*x));
        let count = self.vertices().len();
        // Meshes are not equal because both have a corner that is wrong.
        let number = |corner: u32| match corner as usize {
            index if index < count => f64::from(corner),
            _ => f64::NAN,
        };
        let corners = self.triangles().iter().flatten();
        corners.for_each(|corner| see(number(*corner)));
    }
}

impl MeshModel {
    /// What determines the colors of the vertices, if it is in the file, and is read.
    fn vertex_colors(&self) -> Option<VertexColors> {
        match &self.file.as_ref()?.mesh.as_ref()?.vertices {
            OfVertices::Nothing => None,
            OfVertices::Colors(colors) => Some(VertexColors::Colors(Arc::clone(colors))),
            OfVertices::Values(values, range) => {
                let scale = self.color_by.as_ref()?.build(*range);
                Some(VertexColors::Values(Arc::clone(values), scale))
            }
            OfVertices::OfTriangles(colors) => Some(VertexColors::OfTriangles(Arc::clone(colors))),
        }
    }

    /// Builds the mesh with its material.
    // Not inlined: see `shape`.
    #[inline(never)]
    pub(super) fn build(&self, shape: Shape, material: Material) -> Geometry {
        let geometry = Geometry::new(shape, material);
        match self.vertex_colors() {
            Some(vertices) => geometry.by_vertex(vertices),
            None => geometry,
        }
    }

    /// Returns true if its vertices are asked for its colors.
    pub(crate) const fn may_have_colors(&self) -> bool {
        let has_some = self.file.is_some() || self.color_by.is_some();
        let is_given = self.color.is_some() || self.texture.is_some() || self.material.is_some();
        has_some && !is_given
    }

    /// The vertices in the scene.
    pub(crate) fn vertices(&self) -> &[Triple] {
        self.vertices.as_deref().unwrap_or_default()
    }

    /// The triangles in the scene.
    pub(crate) fn triangles(&self) -> &[[u32; 3]] {
        self.triangles.as_deref().unwrap_or_default()
    }

    /// Returns the faults of vertices that are not finite.
    fn infinite(&self) -> impl Iterator<Item = Problem> {
        let coordinates = self
            .vertices()
            .iter()
            .enumerate()
            .flat_map(|(index, vertex)| {
                let axes = vertex.iter().enumerate();
                axes.map(move |(axis, number)| ([index, axis], number))
            });
        let infinite = coordinates.filter(|(_, number)| !number.is_finite());
        infinite.map(|(place, _)| not_finite("vertices", place))
    }

    /// Returns the faults of corners that no vertex has.
    fn without_vertices(&self) -> impl Iterator<Item = Problem> {
        let count = self.vertices().len();
        let exists = move |corner: &u32| (*corner as usize) < count;
        let corners = || self.triangles().iter().flatten();
        let from_one = corners().all(|corner| *corner as usize <= count && *corner > 0);
        let help = if from_one {
            "the numbers begin with 0, not with 1: subtract 1 from all of them".to_owned()
        } else {
            match count {
                0 => {
                    "give the vertices, as in `vertices: [(0, 0, 0), (1, 0, 0), (0, 1, 0)]`".into()
                }
                count => format!("write a number in 0 to {}", count - 1),
            }
        };
        let places = self
            .triangles()
            .iter()
            .enumerate()
            .flat_map(|(index, corners)| {
                let corners = corners.iter().enumerate();
                corners.map(move |(place, corner)| ([index, place], corner))
            });
        let missing = places.filter(move |(_, corner)| !exists(corner));
        missing.map(move |(place, _)| {
            let message = match count {
                0 => "there is no such vertex: the mesh has none".to_owned(),
                1 => "there is no such vertex: the mesh has 1 vertex".to_owned(),
                count => format!("there is no such vertex: the mesh has {count} vertices"),
            };
            let place = value("triangles", place);
            Problem::new(Code::OutOfRange, place, Focus::Value, message).help(&*help)
        })
    }

    /// Returns the warning of triangles without area, if there are any.
    fn without_area(&self) -> Option<Problem> {
        let corner = |number: u32| {
            self.vertices()
                .get(number as usize)
                .copied()
                .map(DVec3::from)
        };
        let is_flat = |corners: &[u32; 3]| match corners.map(corner) {
            [Some(a), Some(b), Some(c)] => !is_direction((b - a).cross(c - a)),
            _ => false,
        };
        let flat = self.triangles().iter().enumerate();
        let mut flat = flat.filter(|(_, corners)| is_flat(corners));
        let (first, _) = flat.next()?;
        let message = match flat.count() {
            0 => "this triangle has no area and is never seen".to_owned(),
            others => format!(
                "{} of {} triangles have no area and are never seen; this is the first",
                others + 1,
                self.triangles().len()
            ),
        };
        let help = "leave out the triangles whose corners lie on a line";
        let place = value("triangles", [first]);
        Some(Problem::new(Code::NoEffect, place, Focus::Value, message).help(help))
    }
}
