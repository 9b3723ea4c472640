//! The plane of a scene file.

use std::sync::Arc;

use glam::DVec3;

use crate::{
    scene::format::{
        field::Triple, geometry::kind::GeometryKind, material::MaterialModel, object::object,
    },
    tracer::{
        error::GeometryError,
        shape::{Shape, plane::Plane},
    },
};

object! {
    /// An infinite plane, seen from both sides.
    pub struct PlaneModel = "Plane" {
        /// A point of the plane.
        point | position | location | a: Point,
        /// The direction that the plane is perpendicular to, of any length.
        // Planes are few: boxed, so that no geometry needs more memory than a sphere.
        normal | n: Direction(Box<Triple>),
        /// The color: a matte surface. Give this or `material`.
        color: Color?,
        /// The material. Give this or `color`.
        material: Thing(Arc<MaterialModel>)?,
        /// The name of the geometry: no other geometry of the scene has it.
        name: Name?,
    } one of color, material
}

impl GeometryKind for PlaneModel {
    fn shape(&self) -> Option<Result<Shape, GeometryError>> {
        Some(Plane::new(DVec3::from(self.point), DVec3::from(*self.normal)).map(Shape::from))
    }
}
