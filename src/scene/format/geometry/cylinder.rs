//! The cylinder of a scene file.

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
        shape::{Shape, cylinder::Cylinder},
    },
};

colored! {
    /// A cylinder.
    pub struct CylinderModel = "Cylinder" {
        /// The center of the first end.
        from | start | base: Point,
        /// The center of the other end.
        to | end | cap: Point,
        /// The radius, above 0.
        radius | r: Positive,
        /// True if the ends are closed; the default. Otherwise it is open, and seen from both sides.
        capped: Flag = true,
    }
}

impl GeometryKind for CylinderModel {
    // Not inlined: it would slow down the loop over a million spheres.
    #[inline(never)]
    fn shape(&self) -> Option<Result<Shape, GeometryError>> {
        let (from, to) = (DVec3::from(self.from), DVec3::from(self.to));
        Some(Cylinder::new(from, to, self.radius, self.capped()).map(Shape::from))
    }

    fn more_numbers(&self, see: &mut dyn FnMut(f64)) {
        see(f64::from(u8::from(self.capped())));
    }

    fn faults(&self) -> Vec<Problem> {
        faults::of_axis([&self.from, &self.to], "cylinder")
    }
}
