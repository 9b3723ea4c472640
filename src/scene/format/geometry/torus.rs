//! The torus of a scene file.

use glam::DVec3;

use crate::{
    diagnostic::Code,
    scene::{
        format::geometry::{
            faults::number,
            kind::{GeometryKind, colored},
        },
        problem::Problem,
    },
    tracer::{
        error::GeometryError,
        shape::{Shape, torus::Torus},
    },
};

colored! {
    /// A torus: a round tube that is bent to a ring.
    pub struct TorusModel = "Torus" {
        /// The center of the ring.
        center | position | location | c: Point,
        /// The axis of the ring, of any length: the direction through the hole.
        axis | normal | n | direction: Direction,
        /// The radius of the ring, from the center to the middle of the tube: above 0.
        radius | major | major_radius | ring_radius: Positive,
        /// The radius of the tube: above 0 and below `radius`.
        tube_radius | minor | minor_radius | tube: Positive,
    }
}

impl GeometryKind for TorusModel {
    // Not inlined: it would slow down the loop over a million spheres.
    #[inline(never)]
    fn shape(&self) -> Option<Result<Shape, GeometryError>> {
        let (center, axis) = (DVec3::from(self.center), DVec3::from(self.axis));
        Some(Torus::new(center, axis, self.radius, self.tube_radius).map(Shape::from))
    }

    fn faults(&self) -> Vec<Problem> {
        let [ring, tube] = [self.radius, self.tube_radius];
        if tube < ring || !(ring > 0.0 && tube.is_finite()) {
            return Vec::new();
        }
        let message = format!(
            "`tube_radius` must be below `radius`, which is `{}`, found `{}`",
            number(ring),
            number(tube)
        );
        let help = "a torus has a hole: write a `radius` from its center to the middle of the tube";
        let fault = Problem::of_field(Code::OutOfRange, "tube_radius", message).help(help);
        vec![fault.beside("radius", "the radius of the ring")]
    }
}
