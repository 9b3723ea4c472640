//! The disc of a scene file.

use std::sync::Arc;

use glam::DVec3;

use crate::{
    scene::format::{
        field::Triple, geometry::kind::GeometryKind, material::MaterialModel, object::object,
    },
    tracer::{
        error::GeometryError,
        shape::{Shape, disc::Disc},
    },
};

object! {
    /// A disc, seen from both sides.
    pub struct DiscModel = "Disc" {
        /// The center.
        // Discs are few: boxed, so that no geometry needs more memory than a sphere.
        center | position | location | c: Point(Box<Triple>),
        /// The direction that the disc is perpendicular to, of any length.
        normal | n: Direction(Box<Triple>),
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

impl GeometryKind for DiscModel {
    // Not inlined: it would slow down the loop over a million spheres.
    #[inline(never)]
    fn shape(&self) -> Option<Result<Shape, GeometryError>> {
        let (center, normal) = (DVec3::from(*self.center), DVec3::from(*self.normal));
        Some(Disc::new(center, normal, self.radius).map(Shape::from))
    }
}
