//! The hit of a ray on a geometry.

use std::borrow::Cow;

use glam::DVec3;

use crate::tracer::{
    color::Color,
    geometry::Geometry,
    material::{Interpolation, Material, binding::MaterialBinding},
    ray::Ray,
    shape::{face::Crossing, mesh::MeshGroup},
};

/// The point and the geometry that a ray hits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit<'a> {
    /// The ray parameter of the point, `0 < t < ∞`: the distance from the ray's origin if its
    /// direction is a unit vector.
    pub t: f64,
    /// The point, in world space.
    pub point: DVec3,
    /// The unit normal at the point: outward for a closed shape, along `n` for a flat one. It does
    /// not depend on the side that the ray comes from.
    pub normal: DVec3,
    /// True if the ray comes from the side that the normal points to, or along the surface.
    pub front_face: bool,
    /// The number of the face that was hit, in the order that the shape documents; 0 for a shape
    /// with one face.
    pub face: u64,
    /// The geometry that was hit.
    pub geometry: &'a Geometry,
    /// The weights of the corners of the triangle that was hit, if its vertices determine the color;
    /// else 0.
    weights: [f64; 3],
}

impl<'a> Hit<'a> {
    /// Returns the material of the geometry at the point.
    #[inline]
    pub fn material(&self) -> Cow<'a, Material> {
        let (_, binding, face) = self.geometry.surface(self.face);
        match binding {
            MaterialBinding::Plain(material) => Cow::Borrowed(material),
            MaterialBinding::ByFace(materials) => Cow::Borrowed(materials.of(face)),
            MaterialBinding::ByShape(_) => Cow::Borrowed(binding.main()),
            MaterialBinding::ByVertex(materials) => {
                let color = materials.of_triangle(face).or_else(|| {
                    let interpolation = self.interpolation()?;
                    Some(interpolation.color())
                });
                Cow::Owned(materials.with_color(color.unwrap_or_default()))
            }
            MaterialBinding::Textured(textured) => {
                let material = self.geometry.textured_at(self.face, self.point);
                material.map_or(Cow::Borrowed(textured.material()), Cow::Owned)
            }
        }
    }

    /// Returns how the first color of the material follows from what the corners of the triangle have
    /// that was hit, if the vertices of the mesh determine it.
    pub fn interpolation(&self) -> Option<Interpolation<'a>> {
        let (shape, binding, face) = self.geometry.surface(self.face);
        let MaterialBinding::ByVertex(materials) = binding else {
            return None;
        };
        let corners = shape.mesh()?.triangles().get(face as usize)?;
        materials.at(*corners, self.weights)
    }

    /// Returns the number of the face in its shape, which in a copy is one of the prototype; `None` for
    /// a shape with one face.
    pub fn face_of_shape(&self) -> Option<u64> {
        self.geometry.face_of_shape(self.face)
    }

    /// Returns the group of the triangle of a mesh, if it has one.
    pub fn mesh_group(&self) -> Option<&'a MeshGroup> {
        let (shape, _, face) = self.geometry.surface(self.face);
        shape.mesh()?.group_of(usize::try_from(face).ok()?)
    }

    /// Returns the first color of the material at the point, which it shows in a scene without
    /// lights.
    pub fn color(&self) -> Color {
        self.material().color()
    }

    /// Creates the hit of a ray at a crossing, where the geometry has this normal.
    pub(crate) fn new(
        geometry: &'a Geometry,
        ray: &Ray,
        Crossing { t, face }: Crossing,
        normal: DVec3,
    ) -> Self {
        let weights = match geometry.surface(face).1 {
            MaterialBinding::Plain(_)
            | MaterialBinding::ByFace(_)
            | MaterialBinding::Textured(_)
            | MaterialBinding::ByShape(_) => None,
            MaterialBinding::ByVertex(_) => geometry.shape().weights_at(ray, face),
        };
        Self {
            t,
            point: ray.at(t),
            normal,
            front_face: ray.direction().dot(normal) <= 0.0,
            face,
            geometry,
            weights: weights.unwrap_or_default(),
        }
    }
}
