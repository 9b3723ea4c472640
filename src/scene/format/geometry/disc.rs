//! The disc of a scene file.

use glam::DVec3;

use crate::{
    scene::format::geometry::kind::{GeometryKind, colored},
    tracer::{
        error::GeometryError,
        shape::{Shape, disc::Disc},
    },
};

colored! {
    /// A disc, seen from both sides.
    pub struct DiscModel = "Disc" {
        /// The center.
        center | position | location | c: Point,
        /// The direction that the disc is perpendicular to, of any length.
        normal | n: Direction,
        /// The radius, above 0.
        radius | r: Positive,
    } not solid
}

impl GeometryKind for DiscModel {
    // Not inlined: it would slow down the loop over a million spheres.
    #[inline(never)]
    fn shape(&self) -> Option<Result<Shape, GeometryError>> {
        let (center, normal) = (DVec3::from(self.center), DVec3::from(self.normal));
        Some(Disc::new(center, normal, self.radius).map(Shape::from))
    }
}
