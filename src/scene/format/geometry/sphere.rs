//! The sphere of a scene file.

use std::sync::Arc;

use glam::DVec3;

use crate::{
    scene::format::{geometry::kind::GeometryKind, material::MaterialModel, object::object},
    tracer::{
        error::GeometryError,
        shape::{Shape, sphere::Sphere},
    },
};

object! {
    /// A sphere.
    pub struct SphereModel = "Sphere" {
        /// The center.
        center | position | location | c: Point,
        /// The radius, above 0.
        radius | r: Positive,
        /// The color: a matte surface. Give this or `material`.
        color: Color?,
        /// The material. Give this or `color`.
        material: Thing(Arc<MaterialModel>)?,
        /// The name of the geometry: no other geometry of the scene has it.
        name: Name?,
    } one of color, material
}

impl GeometryKind for SphereModel {
    #[inline]
    fn shape(&self) -> Option<Result<Shape, GeometryError>> {
        Some(Sphere::new(DVec3::from(self.center), self.radius).map(Shape::from))
    }
}
