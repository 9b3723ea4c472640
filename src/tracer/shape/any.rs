//! Random shapes for tests that take any shape.

use glam::DVec3;

use crate::tracer::{
    error::GeometryError,
    random::Rng,
    shape::{
        Shape, capsule::Capsule, cone::Cone, cuboid::Cuboid, cylinder::Cylinder, disc::Disc,
        ellipsoid::Ellipsoid, mesh::Mesh, rectangle::Rectangle, sphere::Sphere, triangle::Triangle,
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
        15 => or_sphere(any_mesh(rng, center, size), center, size),
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
    Mesh::new(vertices.into_iter().map(place).collect(), triangles)
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
