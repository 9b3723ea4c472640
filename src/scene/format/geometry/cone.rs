//! The cone of a scene file.

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
        shape::{Shape, cone::Cone},
    },
};

colored! {
    /// A cone, or a truncated cone.
    pub struct ConeModel = "Cone" {
        /// The center of the first end.
        from | start | base: Point,
        /// The middle of the other end, or the tip.
        to | end | cap: Point,
        /// The radius of the first end, above 0.
        radius | r | base_radius: Positive,
        /// The radius of the other end, at least 0. The default is 0: a tip.
        top_radius | cap_radius: Distance = 0.0,
        /// True if the ends are closed; the default. Otherwise it is open, and seen from both sides.
        capped: Flag = true,
    }
}

impl GeometryKind for ConeModel {
    // Not inlined: it would slow down the loop over a million spheres.
    #[inline(never)]
    fn shape(&self) -> Option<Result<Shape, GeometryError>> {
        let (from, to) = (DVec3::from(self.from), DVec3::from(self.to));
        let (top, capped) = (self.top_radius(), self.capped());
        Some(Cone::new(from, to, self.radius, top, capped).map(Shape::from))
    }

    fn more_numbers(&self, see: &mut dyn FnMut(f64)) {
        // It follows the other numbers, as if it were given.
        if self.top_radius.is_none() {
            see(0.0);
        }
        see(f64::from(u8::from(self.capped())));
    }

    fn faults(&self) -> Vec<Problem> {
        faults::of_axis([&self.from, &self.to], "cone")
    }
}
