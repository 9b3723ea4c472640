//! The plane of a scene file.

use glam::DVec3;

use crate::{
    scene::format::geometry::kind::{GeometryKind, colored},
    tracer::{
        error::GeometryError,
        shape::{Shape, plane::Plane},
    },
};

colored! {
    /// An infinite plane, seen from both sides.
    pub struct PlaneModel = "Plane" {
        /// A point of the plane.
        point | position | location | a: Point,
        /// The direction that the plane is perpendicular to, of any length.
        normal | n: Direction,
    }
}

impl GeometryKind for PlaneModel {
    fn shape(&self) -> Option<Result<Shape, GeometryError>> {
        Some(Plane::new(DVec3::from(self.point), DVec3::from(self.normal)).map(Shape::from))
    }
}
