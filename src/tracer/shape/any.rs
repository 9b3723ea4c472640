//! Random shapes for tests that take any shape.

use std::sync::Arc;

use glam::DVec3;

use crate::tracer::{
    error::GeometryError,
    random::Rng,
    shape::{
        Shape, capsule::Capsule, cone::Cone, cuboid::Cuboid, cylinder::Cylinder, disc::Disc,
        ellipsoid::Ellipsoid, rectangle::Rectangle, sphere::Sphere, triangle::Triangle,
    },
    transform::Transform,
};

/// Returns a bounded shape of any kind, around a center and of a size.
pub(crate) fn any(rng: &mut Rng, center: DVec3, size: f64) -> Result<Shape, GeometryError> {
    match rng.below(19) {
        16.. => placed(rng, center, size),
        0..8 => Sphere::new(center, size).map(Shape::from),
        8 => {
            let normal = direction(rng);
            let length = rng.magnitude(-150.0, 150.0);
            let length = rng.one(&[1.0, 1.0, length]);
            Disc::new(center, normal * length, size).map(Shape::from)
        }
        9 => {
            let [u, v] = [direction(rng), direction(rng)].map(|edge| edge * size);
            or_sphere(Rectangle::new(center, u, v), center, size)
        }
        10 => {
            let [a, b, c] = [0, 1, 2].map(|_| center + direction(rng) * size);
            or_sphere(Triangle::new(a, b, c), center, size)
        }
        11 => {
            let half = part(rng) * size;
            or_sphere(Cuboid::new(center - half, center + half), center, size)
        }
        12 => {
            let along = direction(rng) * size;
            let (radius, capped) = (size * rng.magnitude(-3.0, 0.0), rng.below(3) > 0);
            let cylinder = Cylinder::new(center - along, center + along, radius, capped);
            or_sphere(cylinder, center, size)
        }
        13 => {
            let along = direction(rng) * size * rng.one(&[1.0, 1.0, 1e-2, 1e-5, 1e-9]);
            let radius = size * rng.magnitude(-2.0, 0.0);
            let top = rng.one(&[0.0, 0.0, 0.5, 1.0, 2.0]) * radius;
            let capped = rng.below(3) > 0;
            let cone = Cone::new(center - along, center + along, radius, top, capped);
            or_sphere(cone, center, size)
        }
        14 => {
            let along = direction(rng) * size;
            let radius = size * rng.magnitude(-3.0, 0.0);
            let capsule = Capsule::new(center - along, center + along, radius);
            or_sphere(capsule, center, size)
        }
        _ => {
            let a = direction(rng).normalize_or(DVec3::X);
            let (b, c) = a.any_orthonormal_pair();
            let [x, y, z] = part(rng).to_array();
            let flat = rng.one(&[1.0, 1.0, 1.0, 1e-4, 1e-8, 1e-12]);
            let axes = [x * a, y * b, z * flat * c].map(|axis| axis * size);
            or_sphere(Ellipsoid::new(center, axes), center, size)
        }
    }
}

/// Returns shapes as they are, or placed by one transform.
pub(crate) fn place_some(
    rng: &mut Rng,
    center: DVec3,
    shapes: impl IntoIterator<Item = Shape>,
) -> Vec<Shape> {
    let transform = match rng.below(3) {
        0 => transform(rng, center, 1.0).ok().map(Arc::new),
        _ => None,
    };
    let place = |shape: Shape| match &transform {
        Some(transform) => shape.placed(transform).ok(),
        None => Some(shape),
    };
    shapes.into_iter().filter_map(place).collect()
}

/// Returns a placed shape: turned, stretched, mirrored, some of it to a needle or a leaf.
fn placed(rng: &mut Rng, center: DVec3, size: f64) -> Result<Shape, GeometryError> {
    let transform = transform(rng, center, size);
    let within = transform.as_ref().map_or(1.0, |map| size / map.stretch());
    let middle = rng.one(&[DVec3::ZERO, DVec3::ZERO, DVec3::ONE]) * within;
    let shape = any(rng, middle, within);
    let placed = shape.and_then(|shape| shape.placed(&transform?.into()));
    or_sphere(placed, center, size)
}

/// Returns a transform that moves the origin to a point, and stretches by about `size` or by 1.
fn transform(rng: &mut Rng, center: DVec3, size: f64) -> Result<Transform, GeometryError> {
    let stretch = rng.one(&[1.0, 1.0, size]);
    let flat = rng.one(&[1.0, 1.0, 1.0, -1.0, 1e-3, 1e-7, 1e-12]);
    let scale = part(rng) * DVec3::new(1.0, flat, 1.0) * stretch;
    let angle = rng.one(&[0.0, 1.0, std::f64::consts::FRAC_PI_2]) * rng.signed().signum();
    let turned = Transform::new(center, Some((direction(rng), angle)), scale)?;
    match rng.below(4) {
        0 => turned.times(&Transform::new(
            DVec3::ZERO,
            Some((DVec3::X, 0.5)),
            part(rng),
        )?),
        _ => Ok(turned),
    }
}

/// Returns a direction of about unit length: often along an axis, or nearly so.
fn direction(rng: &mut Rng) -> DVec3 {
    let axis = rng.one(&[DVec3::X, DVec3::NEG_Y, DVec3::Z, DVec3::ONE]);
    let other = rng.vector();
    rng.one(&[axis, axis + 1e-9 * other, other])
}

/// Returns three lengths of at most 1, sometimes equal ones.
fn part(rng: &mut Rng) -> DVec3 {
    let all = DVec3::new(
        rng.magnitude(-2.0, 0.0),
        rng.magnitude(-2.0, 0.0),
        rng.magnitude(-2.0, 0.0),
    );
    rng.one(&[DVec3::ONE, all])
}

/// Returns a shape, or a sphere if f64 has none of this size at this place.
fn or_sphere(
    shape: Result<impl Into<Shape>, GeometryError>,
    center: DVec3,
    size: f64,
) -> Result<Shape, GeometryError> {
    match shape {
        Ok(shape) => Ok(shape.into()),
        Err(_) => Sphere::new(center, size).map(Shape::from),
    }
}
