//! The triangle of a scene file.

use glam::DVec3;

use crate::{
    diagnostic::Code,
    scene::{
        format::geometry::{
            faults::NoArea,
            kind::{GeometryKind, colored},
        },
        problem::Problem,
    },
    tracer::{
        error::GeometryError,
        shape::{Shape, triangle::Triangle},
    },
};

colored! {
    /// A triangle, seen from both sides.
    pub struct TriangleModel = "Triangle" {
        /// The first corner.
        a | v0: Point,
        /// The second corner.
        b | v1: Point,
        /// The third corner.
        c | v2: Point,
    } not solid
}

impl TriangleModel {
    fn corners(&self) -> [DVec3; 3] {
        [&self.a, &self.b, &self.c].map(|corner| DVec3::from(*corner))
    }
}

impl GeometryKind for TriangleModel {
    // Not inlined: it would slow down the loop over a million spheres.
    #[inline(never)]
    fn shape(&self) -> Option<Result<Shape, GeometryError>> {
        let [a, b, c] = self.corners();
        Some(Triangle::new(a, b, c).map(Shape::from))
    }

    fn faults(&self) -> Vec<Problem> {
        let [a, b, c] = self.corners();
        let is_finite = a.is_finite() && b.is_finite() && c.is_finite();
        let no_area = NoArea::of([b - a, c - a]).filter(|_| is_finite);
        let equal = [("b", "a", b == a), ("c", "a", c == a), ("c", "b", c == b)];
        let equal = equal.into_iter().find(|(_, _, are_equal)| *are_equal);
        let fault = no_area.map(|reason| match equal {
            Some((field, other, _)) => {
                let message =
                    format!("`{other}` and `{field}` are the same point: the triangle has no area");
                let fault = Problem::of_field(Code::ZeroVector, field, message);
                let fault = fault.help("give three different points");
                fault.beside(other, "the other one")
            }
            None => {
                let fault = reason.fault("c", "sides", "(b - a) × (c - a)");
                let on_a_line = || {
                    let message = "`a`, `b` and `c` lie on one line: the triangle has no area";
                    let help = "give a point beside the line";
                    Problem::of_field(Code::ParallelVectors, "c", message).help(help)
                };
                let fault = fault.unwrap_or_else(on_a_line);
                fault.beside("a", "`a`").beside("b", "`b`")
            }
        });
        Vec::from_iter(fault)
    }
}
