//! The capsule of a scene file.

use glam::DVec3;

use crate::{
    scene::{
        format::geometry::{
            faults,
            kind::{GeometryKind, colored},
        },
        problem::Problem,
    },
    tracer::{
        error::GeometryError,
        shape::{Shape, capsule::Capsule},
    },
};

colored! {
    /// A round bar with round ends: all points at a distance from a line between two points.
    pub struct CapsuleModel = "Capsule" {
        /// The center of the first end.
        from | start | base: Point,
        /// The center of the other end.
        to | end | cap: Point,
        /// The radius, above 0.
        radius | r: Positive,
    }
}

impl GeometryKind for CapsuleModel {
    // Not inlined: it would slow down the loop over a million spheres.
    #[inline(never)]
    fn shape(&self) -> Option<Result<Shape, GeometryError>> {
        let (from, to) = (DVec3::from(self.from), DVec3::from(self.to));
        Some(Capsule::new(from, to, self.radius).map(Shape::from))
    }

    fn faults(&self) -> Vec<Problem> {
        faults::of_axis([&self.from, &self.to], "capsule")
    }
}
