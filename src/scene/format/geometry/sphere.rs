//! The sphere of a scene file.

use glam::DVec3;

use crate::{
    scene::format::geometry::kind::{GeometryKind, colored},
    tracer::{
        error::GeometryError,
        shape::{Shape, sphere::Sphere},
    },
};

colored! {
    /// A sphere.
    pub struct SphereModel = "Sphere" {
        /// The center.
        center | position | location | c: Point,
        /// The radius, above 0.
        radius | r: Positive,
    } rare in SphereRest
}

impl GeometryKind for SphereModel {
    #[inline]
    fn shape(&self) -> Option<Result<Shape, GeometryError>> {
        Some(Sphere::new(DVec3::from(self.center), self.radius).map(Shape::from))
    }
}
