//! Random shapes for tests that take any shape.

use glam::DVec3;

use crate::tracer::{
    error::GeometryError,
    random::Rng,
    shape::{
        Shape,
        capsule::Capsule,
        cone::Cone,
        cuboid::Cuboid,
        cylinder::Cylinder,
        disc::Disc,
        ellipsoid::Ellipsoid,
        plane::Plane,
        rectangle::Rectangle,
        solid::{Operation, Solid},
        sphere::Sphere,
        triangle::Triangle,
    },
};

/// Returns a bounded shape of any kind, around a center and of a size.
pub(crate) fn any(rng: &mut Rng, center: DVec3, size: f64) -> Result<Shape, GeometryError> {
    match rng.below(17) {
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
        15 => {
            let solid = solid(rng, center, size);
            or_sphere(solid, center, size)
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

/// Returns a solid of which a plane is a part, unbounded unless that part is cut away.
pub(crate) fn unbounded(rng: &mut Rng, point: DVec3, size: f64) -> Result<Shape, GeometryError> {
    let normal = rng.one(&[DVec3::Y, DVec3::NEG_Y * 2.0, DVec3::ONE]);
    let plane: Shape = Plane::new(point, normal)?.into();
    let other = solid(rng, point, size)?.into();
    let operation = rng.one(&[Operation::Union, Operation::Difference]);
    Solid::new(operation, [plane, other]).map(Shape::from)
}

/// Returns a bounded solid of any operations; some of its parts touch, are equal or share a plane.
pub(crate) fn solid(rng: &mut Rng, center: DVec3, size: f64) -> Result<Solid, GeometryError> {
    let mut operands: Vec<Shape> = Vec::new();
    for _ in 0..1 + rng.below(4) {
        let step = rng.one(&[0.0, 0.5, 1.0]) * rng.one(&[DVec3::X, DVec3::NEG_Y, DVec3::Z]);
        let any_step = rng.vector() * 0.7;
        let center = center + rng.one(&[step, step, any_step]) * size;
        let size = size * rng.one(&[0.25, 0.5, 0.5, 1.0]);
        let operand = match rng.below(6) {
            0 => solid(rng, center, size).map(Shape::from),
            1 => Cuboid::new(center - size, center + size).map(Shape::from),
            2 if !operands.is_empty() => {
                let axis = rng.one(&[DVec3::X, DVec3::NEG_Y, DVec3::Z]);
                Plane::new(center, axis * rng.magnitude(-3.0, 3.0)).map(Shape::from)
            }
            3 => operands
                .first()
                .cloned()
                .map_or_else(|| any(rng, center, size), Ok),
            _ => any(rng, center, size),
        };
        let is_solid = |shape: &Shape| Solid::new(Operation::Union, [shape.clone()]).is_ok();
        operands.extend(operand.ok().filter(is_solid));
    }
    if operands.is_empty() {
        operands.push(Sphere::new(center, size)?.into());
    }
    let is_bounded = operands.iter().all(|shape| shape.bounds().is_some());
    let operation = match is_bounded {
        true => rng.one(&[
            Operation::Union,
            Operation::Intersection,
            Operation::Difference,
        ]),
        false => rng.one(&[Operation::Intersection, Operation::Difference]),
    };
    Solid::new(operation, operands)
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
