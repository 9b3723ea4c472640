//! Coordinates on the surfaces of shapes, for textures.

use std::f64::consts::PI;

use glam::DVec3;

use crate::tracer::{
    sampling::LocalFrame,
    shape::{Shape, axis::Axis},
    vector::{unit, weighted},
};

/// The direction in the middle of what goes around a ball, unless another is given.
pub(crate) const FRONT: DVec3 = DVec3::NEG_Z;

/// Returns the longitude and the latitude of a vector, each in 0..=1: 1/2 to the front, growing to the right
/// and upwards, given unit vectors to the right, up and to the front.
pub(crate) fn around_ball(q: DVec3, [right, up, front]: [DVec3; 3]) -> [f64; 2] {
    let height = unit(q).dot(up).clamp(-1.0, 1.0);
    [
        turn(q.dot(right), q.dot(front)),
        1.0 - libm::acos(height) / PI,
    ]
}

/// Returns the part of a turn from behind.
fn turn(right: f64, front: f64) -> f64 {
    0.5 + libm::atan2(right, front) / (2.0 * PI)
}

impl Shape {
    /// Returns the coordinates of a point on a face, if the shape has some: all in 0..=1 but those of a plane,
    /// which are lengths, and those of a mesh, which are any.
    pub(crate) fn uv(&self, point: DVec3, face: u64) -> Option<[f64; 2]> {
        Some(match self {
            Self::Plane(plane) => {
                let n = plane.unit_normal().abs();
                let along = if n.y >= n.x && n.y >= n.z {
                    [0, 2]
                } else if n.x >= n.z {
                    [1, 2]
                } else {
                    [0, 1]
                };
                along.map(|axis| point[axis])
            }
            Self::Sphere(sphere) => {
                around_ball(point - sphere.center(), [DVec3::X, DVec3::Y, FRONT])
            }
            Self::Ellipsoid(ellipsoid) => {
                let q = point - ellipsoid.center();
                let [a, b, c] = ellipsoid.axes().map(|axis| q.dot(axis) / axis.dot(axis));
                around_ball(DVec3::new(a, b, c), [DVec3::X, DVec3::Y, FRONT])
            }
            Self::Cylinder(it) => around_axis(it.axis(), point),
            Self::Cone(it) => around_axis(it.axis(), point),
            Self::Capsule(it) => {
                let (from, radius) = (it.from(), it.radius());
                let along = it.to() - from;
                let w = unit(along);
                let height = (point - from).dot(w) + radius;
                let [around, _] = around_line(from, w, point);
                [around, height / (along.length() + 2.0 * radius)]
            }
            Self::Torus(it) => {
                let (q, w) = (point - it.center(), unit(it.axis()));
                let [around, height] = around_line(it.center(), w, point);
                let beside = (q - height * w).length() - it.radius();
                [around, turn(height, -beside)]
            }
            Self::Disc(disc) => {
                let local = LocalFrame::new(disc.unit_normal()).inward(point - disc.center());
                [local.x, local.y].map(|part| part / (2.0 * disc.radius()) + 0.5)
            }
            Self::Rectangle(it) => weights(it.edges(), point - it.corner()),
            Self::Triangle(it) => {
                let [a, b, c] = it.corners();
                weights([b - a, c - a], point - a)
            }
            Self::Cuboid(it) => {
                let size = it.max() - it.min();
                let part = (point - it.min()) / size;
                // As seen from outside, the first grows to the right and the second upwards.
                match face {
                    0 => [part.z, part.y],
                    1 => [1.0 - part.z, part.y],
                    2 => [part.x, part.z],
                    3 => [part.x, 1.0 - part.z],
                    4 => [1.0 - part.x, part.y],
                    _ => [part.x, part.y],
                }
            }
            Self::Mesh(mesh) => {
                let [a, b, c] = mesh.corners(face)?;
                let uv = mesh.corner_uv(face)?;
                let [of_b, of_c] = weights([b - a, c - a], point - a);
                let weights = [1.0 - of_b - of_c, of_b, of_c];
                [0, 1].map(|axis| weighted(uv.map(|corner| corner[axis]), weights))
            }
            Self::Solid(_) | Self::Placed(_) | Self::Instances(_) => return None,
        })
    }
}

/// Returns the part of a turn around an axis, and the part of its length.
fn around_axis(axis: &Axis, point: DVec3) -> [f64; 2] {
    let [around, height] = around_line(axis.from, axis.w, point);
    [around, height / axis.length()]
}

/// Returns the part of a turn around a line, and the length along it.
fn around_line(from: DVec3, w: DVec3, point: DVec3) -> [f64; 2] {
    let local = LocalFrame::new(w).inward(point - from);
    [turn(local.y, local.x), local.z]
}

/// Returns the coordinates of a vector by two others that it lies in the plane of.
fn weights([e, f]: [DVec3; 2], q: DVec3) -> [f64; 2] {
    let normal = e.cross(f);
    let area = normal.dot(normal);
    [q.cross(f).dot(normal) / area, e.cross(q).dot(normal) / area]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tracer::shape::{
        capsule::Capsule,
        cuboid::Cuboid,
        cylinder::Cylinder,
        disc::Disc,
        mesh::{Mesh, MeshUv},
        plane::Plane,
        rectangle::Rectangle,
        sphere::Sphere,
        torus::Torus,
        triangle::Triangle,
    };

    #[track_caller]
    fn check(shape: impl Into<Shape>, face: u64, points: &[([f64; 3], [f64; 2])]) {
        let shape = shape.into();
        for (point, expected) in points {
            let found = shape.uv(DVec3::from(*point), face).unwrap();
            let apart = found
                .into_iter()
                .zip(expected)
                .map(|(one, other)| one - other);
            assert!(
                apart.fold(0.0, |sum, part| sum + part.abs()) < 1e-12,
                "{point:?} {found:?}"
            );
        }
    }

    #[test]
    fn coordinates_of_each_shape() {
        let (o, y) = (DVec3::ZERO, DVec3::Y);
        check(
            Plane::new(o, y).unwrap(),
            0,
            &[([3.0, 0.0, -2.0], [3.0, -2.0])],
        );
        check(
            Sphere::new(o, 2.0).unwrap(),
            0,
            &[
                ([0.0, 0.0, -2.0], [0.5, 0.5]),
                ([2.0, 0.0, 0.0], [0.75, 0.5]),
                ([-2.0, 0.0, 0.0], [0.25, 0.5]),
                ([0.0, 2.0, 0.0], [0.5, 1.0]),
            ],
        );
        let edges = [2.0 * DVec3::X, DVec3::new(1.0, 4.0, 0.0)];
        check(
            Rectangle::new(y, edges[0], edges[1]).unwrap(),
            0,
            &[([2.5, 3.0, 0.0], [1.0, 0.5])],
        );
        check(
            Triangle::new(o, DVec3::X, y).unwrap(),
            0,
            &[([0.25, 0.5, 0.0], [0.25, 0.5])],
        );
        check(
            Disc::new(o, DVec3::Z, 2.0).unwrap(),
            0,
            &[([0.0, 0.0, 0.0], [0.5, 0.5]), ([2.0, 0.0, 0.0], [1.0, 0.5])],
        );
        let tall = Cylinder::new(o, 4.0 * DVec3::Z, 1.0, true).unwrap();
        check(
            tall,
            0,
            &[
                ([1.0, 0.0, 1.0], [0.5, 0.25]),
                ([0.0, 1.0, 4.0], [0.75, 1.0]),
            ],
        );
        let capsule = Capsule::new(o, 2.0 * DVec3::Z, 1.0).unwrap();
        check(
            capsule,
            0,
            &[([1.0, 0.0, 1.0], [0.5, 0.5]), ([0.0, 0.0, 3.0], [0.5, 1.0])],
        );
        let torus = Torus::new(o, DVec3::Z, 2.0, 0.5).unwrap();
        check(
            torus,
            0,
            &[
                ([2.5, 0.0, 0.0], [0.5, 1.0]),
                ([2.0, 0.0, 0.5], [0.5, 0.75]),
            ],
        );
        let cube = || Cuboid::new(o, DVec3::ONE).unwrap();
        check(cube(), 5, &[([0.25, 0.75, 1.0], [0.25, 0.75])]);
        check(cube(), 1, &[([1.0, 0.75, 0.25], [0.75, 0.75])]);
        check(cube(), 3, &[([0.25, 1.0, 0.25], [0.25, 0.75])]);
    }

    #[test]
    fn coordinates_of_a_mesh_are_those_of_its_corners() {
        let vertices = vec![DVec3::ZERO, 2.0 * DVec3::X, DVec3::ONE, DVec3::Y];
        let mesh = || Mesh::new(vertices.clone(), vec![[0, 1, 3], [3, 0, 2], [0, 1, 2]]).unwrap();
        let uv = MeshUv {
            all: vec![[0.0, 1.0], [4.0, 1.0], [0.0, -3.0]],
            corners: vec![[0, 1, 2], [0, 0, 1], [0, 1, 3]],
        };
        let textured = mesh().with_uv(uv);
        assert_ne!(mesh(), textured);
        assert_ne!(
            mesh().numbers().collect::<Vec<_>>(),
            textured.numbers().collect::<Vec<_>>()
        );
        let textured = Shape::from(textured);
        let points = [
            ([0.0, 0.0, 0.0], [0.0, 1.0]),
            ([2.0, 0.0, 0.0], [4.0, 1.0]),
            ([0.0, 1.0, 0.0], [0.0, -3.0]),
            ([1.0, 0.25, 0.0], [2.0, 0.0]),
        ];
        check(textured.clone(), 0, &points);
        check(textured.clone(), 1, &[([0.25, 0.5, 0.25], [1.0, 1.0])]);
        assert_eq!(textured.uv(DVec3::ZERO, 2), None);
        assert_eq!(Shape::from(mesh()).uv(DVec3::ZERO, 0), None);
    }
}
