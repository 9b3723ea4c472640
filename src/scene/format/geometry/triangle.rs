//! The triangle of a scene file.

use glam::DVec3;

use crate::{
    diagnostic::Code,
    scene::format::geometry::{
        clash::{Clash, NoArea},
        kind::{GeometryKind, colored},
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
    }
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

    fn clashes(&self) -> Vec<Clash> {
        let [a, b, c] = self.corners();
        let is_finite = a.is_finite() && b.is_finite() && c.is_finite();
        let no_area = NoArea::of([b - a, c - a]).filter(|_| is_finite);
        let equal = [("b", "a", b == a), ("c", "a", c == a), ("c", "b", c == b)];
        let equal = equal.into_iter().find(|(_, _, are_equal)| *are_equal);
        let clash = no_area.map(|reason| match equal {
            Some((field, other, _)) => Clash::new(
                Code::ZeroVector,
                field,
                format!("`{other}` and `{field}` are the same point: the triangle has no area"),
                "give three different points",
            )
            .with(other, [], "the other one"),
            None => {
                let clash = reason.clash("c", "sides", "(b - a) × (c - a)");
                let on_a_line = || {
                    let message = "`a`, `b` and `c` lie on one line: the triangle has no area";
                    let help = "give a point beside the line";
                    Clash::new(Code::ParallelVectors, "c", message, help)
                };
                let clash = clash.unwrap_or_else(on_a_line);
                clash.with("a", [], "`a`").with("b", [], "`b`")
            }
        });
        Vec::from_iter(clash)
    }
}
