//! Random shapes for tests that take any shape.

use glam::DVec3;

use crate::tracer::{
    error::GeometryError,
    random::Rng,
    shape::{Shape, disc::Disc, sphere::Sphere},
};

/// Returns a bounded shape of any kind, around a center and of a size.
pub(crate) fn any(rng: &mut Rng, center: DVec3, size: f64) -> Result<Shape, GeometryError> {
    match rng.below(2) {
        0 => Sphere::new(center, size).map(Shape::from),
        _ => {
            let axis = rng.one(&[DVec3::X, DVec3::NEG_Y, DVec3::Z, DVec3::ONE]);
            let other = rng.vector();
            let normal = rng.one(&[axis, axis + 1e-9 * other, other]);
            let length = rng.magnitude(-150.0, 150.0);
            let length = rng.one(&[1.0, 1.0, length]);
            Disc::new(center, normal * length, size).map(Shape::from)
        }
    }
}
