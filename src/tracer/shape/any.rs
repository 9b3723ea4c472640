//! Random shapes for tests that take any shape.

use std::sync::Arc;

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
        instances::Instances,
        mesh::Mesh,
        plane::Plane,
        rectangle::Rectangle,
        solid::{Operation, Solid},
        sphere::Sphere,
        torus::Torus,
        triangle::Triangle,
    },
    transform::Transform,
};

/// Returns a bounded shape of any kind, around a center and of a size.
pub(crate) fn any(rng: &mut Rng, center: DVec3, size: f64) -> Result<Shape, GeometryError> {
    match rng.below(16) {
        0 => {
            let copies = copies(rng, center, size);
            or_sphere(copies, center, size)
        }
        _ => one(rng, center, size),
    }
}

/// The same without copies.
fn one(rng: &mut Rng, center: DVec3, size: f64) -> Result<Shape, GeometryError> {
    match rng.below(22) {
        19.. => placed(rng, center, size),
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
        15 => or_sphere(any_mesh(rng, center, size), center, size),
        16 => {
            let solid = solid(rng, center, size);
            or_sphere(solid, center, size)
        }
        17 => {
            let (axis, thin) = (direction(rng), rng.magnitude(-3.0, 0.0));
            let ratio = rng.one(&[0.25, 0.5, thin, 1.0 - 1e-2 * thin]);
            let radius = size / (1.0 + ratio);
            or_sphere(
                Torus::new(center, axis, radius, ratio * radius),
                center,
                size,
            )
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

/// Returns a mesh around a center and of a size: a torus, a sheet of squares, or any triangles between
/// some points, some of them without area.
pub(crate) fn any_mesh(rng: &mut Rng, center: DVec3, size: f64) -> Result<Mesh, GeometryError> {
    let [across, along] = [3 + rng.below(12), 3 + rng.below(12)];
    let (vertices, triangles): (Vec<DVec3>, _) = match rng.below(3) {
        0 => torus(across, along, rng.magnitude(-2.0, 0.0)),
        1 => {
            let height = rng.one(&[0.0, 0.2, 1e-9]);
            let (mut vertices, triangles) = torus(across, along, 0.5);
            for (number, vertex) in vertices.iter_mut().enumerate() {
                let [x, y] = [number / along, number % along].map(|at| at as f64);
                *vertex = DVec3::new(x, y, 0.0) / 14.0 + height * rng.vector();
            }
            let is_inside = |corners: &[u32; 3]| {
                let [least, most] = [corners.iter().min(), corners.iter().max()];
                most.zip(least)
                    .is_some_and(|(a, b)| a - b < 2 * along as u32)
            };
            let triangles = triangles.into_iter().filter(is_inside).collect();
            (vertices, triangles)
        }
        _ => {
            let vertices = (0..across).map(|_| direction(rng)).collect();
            let mut corner = || rng.below(across) as u32;
            let triangles = (0..5 * along).map(|_| [corner(), corner(), corner()]);
            (vertices, triangles.collect())
        }
    };
    let place = |vertex: DVec3| center + vertex * size;
    let mesh = Mesh::new(vertices.into_iter().map(place).collect(), triangles)?;
    Ok(match rng.below(2) {
        0 => mesh.smooth(),
        _ => mesh,
    })
}

/// Returns the vertices and triangles of a torus around the z axis, of radius 1 and thickness `radius`
/// with this many vertices around it and around its tube, closed and seen from outside.
pub(crate) fn torus(across: usize, along: usize, radius: f64) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let angle = |at: usize, of: usize| at as f64 / of as f64 * std::f64::consts::TAU;
    let each = || (0..across).flat_map(|i| (0..along).map(move |j| [i, j]));
    let vertex = |[i, j]: [usize; 2]| {
        let (sin, cos) = libm::sincos(angle(i, across));
        let (up, out) = libm::sincos(angle(j, along));
        let out = 1.0 + radius * out;
        DVec3::new(cos * out, sin * out, radius * up)
    };
    let number = |i: usize, j: usize| (i % across * along + j % along) as u32;
    let square = |[i, j]: [usize; 2]| {
        let [a, b, c, d] = [
            number(i, j),
            number(i + 1, j),
            number(i + 1, j + 1),
            number(i, j + 1),
        ];
        [[a, b, c], [a, c, d]]
    };
    (
        each().map(vertex).collect(),
        each().flat_map(square).collect(),
    )
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

/// Returns a shape that touches another one: a copy in its place, a box or a floor at its side, a ball that
/// shares a point with it, triangles that share its corners.
pub(crate) fn touching(rng: &mut Rng, other: &Shape) -> Result<Shape, GeometryError> {
    let Some([low, high]) = other.bounds() else {
        return Ok(other.clone());
    };
    let (size, middle) = (high - low, low + (high - low) * 0.5);
    let axis = rng.below(3);
    let side = rng.one(&[-1.0, 1.0]);
    let along = DVec3::AXES[axis] * side;
    let edge = rng.one(&[low, high]);
    match rng.below(8) {
        0 => Ok(other.clone()),
        1 => {
            let place = Transform::new(DVec3::ZERO, None, DVec3::ONE)?;
            Instances::new([other.clone()], [place]).map(Shape::from)
        }
        2 | 3 => {
            let shift = along * size;
            let shrunk = rng.one(&[DVec3::ZERO, DVec3::ZERO, 0.25 * size]) * (1.0 - along.abs());
            let cuboid = Cuboid::new(low + shift + shrunk, high + shift - shrunk);
            or_sphere(cuboid, middle + shift, size.max_element() * 0.5)
        }
        4 => Plane::new(edge, DVec3::AXES[axis] * side).map(Shape::from),
        5 => {
            let radius = size[axis].max(1e-3 * size.max_element()) * 0.5;
            Sphere::new(middle + along * 2.0 * radius, radius).map(Shape::from)
        }
        6 => {
            let [a, b] = [edge, edge + DVec3::AXES[axis] * (high - low)[axis] * side];
            let apex = a + DVec3::AXES[(axis + 1) % 3] * size.max_element();
            let roof = Mesh::new(
                vec![
                    a,
                    b,
                    apex,
                    apex + DVec3::AXES[(axis + 2) % 3] * size.max_element(),
                ],
                vec![[0, 1, 2], [1, 0, 3]],
            );
            or_sphere(roof, middle, size.max_element() * 0.5)
        }
        _ => or_sphere(
            Rectangle::new(edge, DVec3::AXES[axis] * side, DVec3::AXES[(axis + 1) % 3]),
            middle,
            size.max_element() * 0.5,
        ),
    }
}

/// Returns a placed shape: turned, stretched, mirrored, some of it to a needle or a leaf.
fn placed(rng: &mut Rng, center: DVec3, size: f64) -> Result<Shape, GeometryError> {
    let transform = transform(rng, center, size);
    let within = transform.as_ref().map_or(1.0, |map| size / map.stretch());
    let middle = rng.one(&[DVec3::ZERO, DVec3::ZERO, DVec3::ONE]) * within;
    let shape = one(rng, middle, within);
    let placed = shape.and_then(|shape| shape.placed(&transform?.into()));
    or_sphere(placed, center, size)
}

/// Returns copies of some shapes, all within a ball; some of them in the same place.
pub(crate) fn copies(rng: &mut Rng, center: DVec3, size: f64) -> Result<Instances, GeometryError> {
    let count = rng.one(&[1, 1, 2, 3, 12]);
    let shapes = (0..count).map(|_| {
        let (anywhere, within) = (rng.vector(), rng.one(&[0.5, 0.1]));
        let middle = rng.one(&[DVec3::ZERO, DVec3::X, anywhere]) * 0.5;
        one(rng, middle, within)
    });
    let shapes = shapes.collect::<Result<Vec<_>, _>>()?;
    let count = rng.one(&[1, 2, 5, 20]);
    let mut transforms: Vec<Transform> = Vec::new();
    for _ in 0..count {
        let last = transforms.last().copied();
        transforms.push(match last {
            Some(last) if rng.below(8) == 0 => last,
            _ => {
                let place = center + rng.vector() * size * 0.5;
                transform(rng, place, 0.5 * size)?
            }
        });
    }
    Instances::new(shapes, transforms)
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

/// Returns a transform that turns, mirrors, stretches and moves a little.
fn turn(rng: &mut Rng, size: f64) -> Result<Transform, GeometryError> {
    let angle = rng.one(&[0.0, 1.0, std::f64::consts::FRAC_PI_2]) * rng.signed().signum();
    let scale = [
        rng.one(&[1.0, 1.0, -1.0, 0.5]),
        rng.one(&[1.0, 1.0, 2.0]),
        1.0,
    ];
    let place = rng.vector() * 0.3 * size;
    Transform::new(place, Some((direction(rng), angle)), scale.into())
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
    let mut transforms: Vec<Arc<Transform>> = Vec::new();
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
                .map_or_else(|| one(rng, center, size), Ok),
            _ => one(rng, center, size),
        };
        // Maybe by the transform of another operand.
        let operand = match rng.below(4) {
            0 => operand.and_then(|shape| {
                transforms.push(turn(rng, size)?.into());
                let any = rng.below(transforms.len());
                match shape {
                    Shape::Solid(_) => Ok(shape),
                    shape => shape.placed(&transforms[any]),
                }
            }),
            _ => operand,
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
