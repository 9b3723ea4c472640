//! The faces that a point lies on.
//!
//! A point where a ray has arrived, `P = o + t·d`, has errors of rounding. It lies on every face that is
//! nearer than these, not on the one alone that the ray hit: where faces meet, where one shape lies on
//! another, where a copy stands in the place of its original. A gap that is wider stays a gap.
//!
//! With `ε = 2⁻⁴⁸`, `s` the largest of `|oᵢ| + |t·dᵢ|`, and the distance `δ` of P from the face that was
//! hit, the place of P is uncertain by `r = ε·s + min(2δ, 2⁻³⁰·s)`. A face has an equation `f = 0` with the
//! gradient G, in a space that P is mapped to: `p = L⁻¹·(P - s)`, uncertain by `e = ε·|L⁻¹|·(|P| + |s|)`
//! more. P lies on it if `|f(p)| ≤ r·|L⁻ᵀG| + Σ|Gᵢ|·(ε·(|pᵢ| + sizeᵢ) + eᵢ)`, with the numbers of the
//! equation in `size`, and if p lies in its extent, widened by the same errors.
//!
//! What is farther than `2⁻²⁷` of the larger of P and o from the box of a shape is not asked: that is more than `r`, but
//! beside tiny flat shapes `f/|L⁻ᵀG|` is no distance.

use glam::DVec3;

use crate::tracer::{
    ray::Ray,
    shape::{Shape, around::Around},
    transform::Transform,
    vector::unit,
};

/// The part of a number by which it may be wrong: 16 roundings.
const EPSILON: f64 = 16.0 * f64::EPSILON;

/// The largest part of its coordinates by which a point counts as away from the face that was hit: 2⁻³⁰.
const FARTHEST: f64 = 1.0 / (1 << 30) as f64;

/// The part of the coordinates of a point by which a box around it reaches all faces that it lies on: 2⁻²⁷.
pub(crate) const REACH: f64 = 1.0 / (1 << 27) as f64;

/// The largest number of edges around a face.
const EDGES: usize = 4;

/// A point where a ray has arrived, as a shape sees it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ContactPoint {
    /// The point, in the space of the shape.
    pub(crate) point: DVec3,
    /// The origin of the ray there.
    pub(crate) origin: DVec3,
    /// The point in the world.
    world: DVec3,
    /// The largest of its numbers, `s`.
    scale: f64,
    /// The uncertainty of its place in the world, `r`.
    uncertainty: f64,
    /// How far from it a face may be that it lies on.
    reach: f64,
    /// How it was mapped, if it was.
    mapping: Option<Mapping>,
}

/// The map from the world to the space of a shape.
#[derive(Clone, Copy, Debug)]
struct Mapping {
    /// The rows of the linear part.
    rows: [DVec3; 3],
    /// The sum of the absolute shifts.
    shift: DVec3,
}

/// The equation of a face at a point.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FaceEquation {
    /// `f`
    pub(crate) value: f64,
    /// `G`
    pub(crate) gradient: DVec3,
    /// The absolute numbers of the equation.
    pub(crate) size: DVec3,
    /// By how much `f` may be off beside all that.
    pub(crate) more: f64,
}

/// An edge of a face beside a point.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FaceEdge {
    /// The distance of the point from the edge, above 0 over the face.
    pub(crate) distance: f64,
    /// A vector from the edge into the face.
    pub(crate) inward: DVec3,
}

/// A face beside a point.
#[derive(Clone, Copy, Debug)]
pub(crate) struct NearFace {
    /// The number of the face.
    pub(crate) face: u64,
    /// Its distance from the point in the world, `|f|/|L⁻ᵀG|`.
    pub(crate) distance: f64,
    /// True if the point lies on it.
    pub(crate) is_touched: bool,
    /// The unit vector along its gradient in the world.
    pub(crate) normal: DVec3,
    /// If the point lies on edges of it: vectors whose products with a direction in the world have the sign
    /// of those with the vectors into the face.
    pub(crate) edges: [Option<DVec3>; EDGES],
}

impl NearFace {
    /// Creates a face of which nothing is known but that the point does not lie on it.
    pub(crate) const fn far(face: u64) -> Self {
        Self {
            face,
            distance: f64::INFINITY,
            is_touched: false,
            normal: DVec3::ZERO,
            edges: [None; EDGES],
        }
    }
}

impl ContactPoint {
    /// Creates the point where a ray arrives at `t`, as uncertain as any may be: it lies on no face that
    /// this one does not lie on.
    pub(crate) fn vague(ray: &Ray, t: f64) -> Self {
        let scale = (ray.origin().abs() + (t * ray.direction()).abs()).max_element();
        Self {
            point: ray.at(t),
            origin: ray.origin(),
            world: ray.at(t),
            scale,
            uncertainty: (EPSILON + FARTHEST) * scale,
            reach: 0.0,
            mapping: None,
        }
        .with_reach(0.0)
    }

    /// Returns the point at this distance from the face that was hit.
    pub(crate) fn at_distance(&self, distance: f64) -> Self {
        let away = (2.0 * distance).min(FARTHEST * self.scale);
        Self {
            uncertainty: EPSILON * self.scale + away,
            ..*self
        }
    }

    fn with_reach(self, more: f64) -> Self {
        let most = self.point.abs().max(self.origin.abs()).max_element();
        Self {
            reach: REACH * most + more,
            ..self
        }
    }

    /// Returns the point before a transform.
    pub(crate) fn before(&self, transform: &Transform) -> Self {
        let rows = match self.mapping {
            None => transform.inverse(),
            Some(Mapping { rows, .. }) => {
                let column = |axis: usize| DVec3::from(rows.map(|row| row[axis]));
                let columns = [column(0), column(1), column(2)];
                let of = |row: DVec3| DVec3::from(columns.map(|column| row.dot(column)));
                transform.inverse().map(of)
            }
        };
        let shift = self.mapping.map_or(DVec3::ZERO, |mapping| mapping.shift);
        let before = Self {
            point: transform.point_back(self.point),
            origin: transform.point_back(self.origin),
            mapping: Some(Mapping {
                rows,
                shift: shift + transform.shift().abs(),
            }),
            ..*self
        };
        let (_, stretch) = before.mapped_back(DVec3::ZERO);
        let errors = before.error_of_mapping().element_sum();
        before.with_reach(4.0 * ((EPSILON + FARTHEST) * self.scale * stretch + errors))
    }

    /// The largest of its numbers, `s`.
    pub(crate) const fn size(&self) -> f64 {
        self.scale
    }

    /// Returns by how much the equation of a ball that is at most so large may be off 0 at a point on it, or
    /// more.
    pub(crate) fn slack_of_ball(&self, radius: f64) -> f64 {
        2.0 * self.reach * (radius + self.reach)
    }

    /// The corners of a box around all faces that the point lies on.
    pub(crate) fn around(&self) -> [DVec3; 2] {
        [self.point - self.reach, self.point + self.reach]
    }

    /// Returns true if a face in a box may be one that the point lies on.
    pub(crate) fn is_near(&self, [low, high]: [DVec3; 2]) -> bool {
        let [from, to] = self.around();
        low.cmple(to).all() && high.cmpge(from).all()
    }

    /// The same for a cube around a center with half its size.
    fn is_within(&self, center: DVec3, half: f64) -> bool {
        (self.point - center).abs().max_element() <= half + self.reach
    }

    /// Calls `see` with a face, given its equation at the point and the edges around it, if it has any, unless
    /// it is far away, as most are.
    #[inline]
    pub(crate) fn see<const N: usize>(
        &self,
        face: u64,
        equation: &FaceEquation,
        edges: impl FnOnce() -> [FaceEdge; N],
        see: &mut dyn FnMut(&NearFace),
    ) {
        let most = self.reach + EPSILON * equation.size.max_element();
        let bound = 2.0 * most * equation.gradient.abs().element_sum() + equation.more;
        let is_far = equation.value.abs() > bound;
        if !is_far {
            see(&self.face(face, equation, &edges()));
        }
    }

    #[inline(never)]
    fn face(&self, face: u64, equation: &FaceEquation, edges: &[FaceEdge]) -> NearFace {
        let FaceEquation {
            value,
            gradient,
            size,
            more,
        } = *equation;
        let mut near = NearFace::far(face);
        let of_mapping = self.error_of_mapping();
        let errors = EPSILON * (self.point.abs() + size) + of_mapping;
        let (normal, stretch) = self.mapped_back(gradient);
        let length = normal.length();
        let bound = self.uncertainty * length + gradient.abs().dot(errors) + more;
        near.distance = value.abs() / length;
        near.is_touched = value.abs() <= bound;
        if near.is_touched {
            near.normal = unit(normal);
            let slack = self.uncertainty * stretch + errors.element_sum();
            for (place, edge) in near.edges.iter_mut().zip(edges) {
                near.is_touched &= edge.distance >= -slack;
                let is_on_edge = edge.distance <= slack;
                *place = is_on_edge.then(|| self.mapped_back(edge.inward).0);
            }
        }
        near
    }

    /// Returns `L⁻ᵀG`, and the Frobenius norm of `L⁻¹`, which bounds how far an error is magnified.
    fn mapped_back(&self, gradient: DVec3) -> (DVec3, f64) {
        let Some(Mapping { rows, .. }) = self.mapping else {
            return (gradient, 1.0);
        };
        let [x, y, z] = rows;
        let normal = (x * gradient.x + y * gradient.y) + z * gradient.z;
        let squares = rows.map(|row| row.dot(row));
        (normal, squares.iter().sum::<f64>().sqrt())
    }

    /// Returns `e`.
    fn error_of_mapping(&self) -> DVec3 {
        self.mapping.map_or(DVec3::ZERO, |Mapping { rows, shift }| {
            let numbers = self.world.abs() + shift;
            EPSILON * DVec3::from(rows.map(|row| row.abs().dot(numbers)))
        })
    }
}

impl Shape {
    /// Calls `see` with each face and its place beside a point, if the point is near the shape.
    #[inline(never)]
    pub(crate) fn each_face_near(&self, at: &ContactPoint, see: &mut dyn FnMut(&NearFace)) {
        let is_near = match self {
            Self::Sphere(sphere) => at.is_within(sphere.center(), sphere.radius()),
            Self::Disc(disc) => at.is_within(disc.center(), disc.radius()),
            Self::Cuboid(cuboid) => at.is_near([cuboid.min(), cuboid.max()]),
            _ => {
                let around = self.around().as_ref().and_then(Around::bounds);
                around.is_none_or(|around| at.is_near(around))
            }
        };
        if is_near {
            self.each_face(at, see);
        }
    }
}

impl FaceEquation {
    /// Creates that of a plane through a point: `(p - a)·n`.
    pub(crate) fn plane(at: &ContactPoint, a: DVec3, n: DVec3) -> Self {
        Self {
            value: (at.point - a).dot(n),
            gradient: n,
            size: a.abs(),
            more: 0.0,
        }
    }

    /// Creates that of a ball: `|p - c|² - r²`.
    pub(crate) fn ball(at: &ContactPoint, center: DVec3, radius: f64) -> Self {
        let q = at.point - center;
        Self {
            value: q.dot(q) - radius * radius,
            gradient: 2.0 * q,
            size: center.abs() + radius,
            more: 0.0,
        }
    }
}

impl FaceEdge {
    /// The edges of a face that has none.
    pub(crate) const fn none() -> [Self; 0] {
        []
    }

    /// Returns those of a convex polygon in a plane with the normal `n`, counterclockwise around it.
    pub(crate) fn of_polygon<const N: usize>(
        corners: &[DVec3; N],
        n: DVec3,
        point: DVec3,
    ) -> [Self; N] {
        std::array::from_fn(|corner| {
            let (from, to) = (corners[corner], corners[(corner + 1) % N]);
            let inward = n.cross(to - from);
            Self {
                distance: (point - from).dot(inward) / inward.length(),
                inward,
            }
        })
    }

    /// Returns that of a circle.
    pub(crate) fn of_circle(from_center: DVec3, radius: f64) -> [Self; 1] {
        [Self {
            distance: radius - from_center.length(),
            inward: -from_center,
        }]
    }

    /// Returns those at both ends of an interval along a unit vector, at a height in it.
    pub(crate) fn of_interval(height: f64, [low, high]: [f64; 2], along: DVec3) -> [Self; 2] {
        [
            Self {
                distance: height - low,
                inward: along,
            },
            Self {
                distance: high - height,
                inward: -along,
            },
        ]
    }
}

#[cfg(test)]
mod tests {
    use std::{f64::consts::PI, sync::Arc};

    use super::*;
    use crate::tracer::{
        color::Color,
        geometry::Geometry,
        shape::{
            Shape,
            capsule::Capsule,
            cuboid::Cuboid,
            cylinder::Cylinder,
            disc::Disc,
            face::FaceId,
            mesh::Mesh,
            plane::Plane,
            solid::{Operation, Solid},
            sphere::Sphere,
            triangle::Triangle,
        },
        world::World,
    };

    fn world(shapes: impl IntoIterator<Item = Shape>) -> World {
        let geometries = shapes.into_iter();
        let geometries = geometries.map(|shape| Geometry::new(shape, Color::WHITE));
        World::new(geometries.collect(), Color::BLACK)
    }

    /// Returns the faces at the first hit of a ray from one point through another.
    fn faces(world: &World, from: DVec3, through: DVec3) -> Vec<(usize, u64)> {
        let ray = Ray::new(from, through - from);
        let (index, hit) = world.hit(&ray).unwrap();
        let found = world.faces_at(&ray, index, &hit).into_iter();
        found
            .map(|FaceId { geometry, face }| (geometry, face))
            .collect()
    }

    /// A roof of four triangles around a tip.
    fn roof() -> Mesh {
        let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
        let corners = corners.map(|[x, y]| DVec3::new(x / 3.0, y / 3.0, 0.0));
        let tip = DVec3::new(0.1, 0.2, 0.7);
        let vertices = corners.into_iter().chain([tip]).collect();
        let triangles = vec![[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]];
        Mesh::new(vertices, triangles).unwrap()
    }

    /// Returns transforms that turn, stretch and move.
    fn transforms() -> impl Iterator<Item = Arc<Transform>> {
        let steps = [0.0, 1.0, 1e3, 1e5].into_iter();
        steps.flat_map(|far| {
            [1.0, 1e-6, 1e6].map(|size| {
                let axis = DVec3::new(1.0, 2.0, 0.5);
                let scale = DVec3::new(1.0, 0.3, 2.0) * size;
                let shift = DVec3::new(0.1, 0.7, -0.3) * far * size;
                Arc::new(Transform::new(shift, Some((axis, 0.3)), scale).unwrap())
            })
        })
    }

    #[test]
    fn a_point_on_an_edge_lies_on_both_faces_and_one_on_a_tip_on_all() {
        let mesh = Shape::from(roof());
        for transform in transforms() {
            let world = world([mesh.clone().placed(&transform).unwrap()]);
            let from = transform.point(DVec3::new(0.3, -0.2, 9.0));
            let see =
                |x: f64, y: f64, z: f64| faces(&world, from, transform.point(DVec3::new(x, y, z)));
            assert_eq!(see(0.1, 0.2, 0.7), [(0, 0), (0, 1), (0, 2), (0, 3)]);
            let [a, tip] = [
                DVec3::new(1.0 / 3.0, -1.0 / 3.0, 0.0),
                DVec3::new(0.1, 0.2, 0.7),
            ];
            for part in [0.1, 0.35, 0.8] {
                let at = a + part * (tip - a);
                assert_eq!(see(at.x, at.y, at.z), [(0, 0), (0, 1)], "{transform:?}");
            }
            let middle = (a + tip + DVec3::new(1.0 / 3.0, 1.0 / 3.0, 0.0)) / 3.0;
            assert_eq!(see(middle.x, middle.y, middle.z), [(0, 1)]);
        }
    }

    #[test]
    fn equal_surfaces_are_one_and_gaps_are_gaps() {
        let ball =
            |gap: f64| Shape::from(Sphere::new(DVec3::new(0.3, 0.0, 0.0), 0.7 - gap).unwrap());
        let copies = crate::tracer::shape::instances::Instances::new(
            [ball(0.0)],
            [Transform::new(DVec3::ZERO, None, DVec3::ONE).unwrap()],
        );
        let (from, through) = (DVec3::new(3.0, 2.0, 9.0), DVec3::new(0.4, 0.1, 0.0));
        let touching = world([ball(0.0), ball(0.0), copies.unwrap().into(), ball(0.1)]);
        assert_eq!(faces(&touching, from, through), [(0, 0), (1, 0), (2, 0)]);
        for gap in [1e-9, 1e-12] {
            let apart = world([ball(0.0), ball(gap)]);
            assert_eq!(faces(&apart, from, through), [(0, 0)], "{gap}");
        }
        // On the floor, and a little above.
        let floor = Shape::from(Plane::new(DVec3::ZERO, DVec3::Z).unwrap());
        let cube = |gap: f64| {
            let [low, high] = [DVec3::new(-1.0, -1.0, gap), DVec3::ONE];
            Shape::from(Cuboid::new(low, high).unwrap())
        };
        let below = DVec3::new(0.3, 0.2, -1.0);
        let under = |gap| {
            faces(
                &world([cube(gap), floor.clone()]),
                below,
                DVec3::new(0.1, 0.1, 0.0),
            )
        };
        assert_eq!(under(0.0), [(0, 4), (1, 0)]);
        assert_eq!(under(1e-12), [(1, 0)]);
        // Beside the box.
        let beside = faces(
            &world([cube(0.0), floor]),
            DVec3::new(3.0, 0.0, 1.0),
            DVec3::X * 2.0,
        );
        assert_eq!(beside, [(1, 0)]);
    }

    #[test]
    fn rims_joints_and_corners() {
        let cube = Shape::from(Cuboid::new(DVec3::ZERO, DVec3::ONE / 3.0).unwrap());
        let corner = faces(&world([cube]), DVec3::new(3.0, 4.0, 5.0), DVec3::ONE / 3.0);
        assert_eq!(corner, [(0, 1), (0, 3), (0, 5)]);

        let [a, b] = [DVec3::new(0.1, 0.0, 0.2), DVec3::new(0.1, 0.0, 1.2)];
        let at = |angle: f64, height: f64| {
            let (sin, cos) = libm::sincos(angle);
            DVec3::new(0.1 + 0.3 * cos, 0.3 * sin, 0.2 + height)
        };
        let from = DVec3::new(4.0, 1.0, 3.0);
        let closed = Shape::from(Cylinder::new(a, b, 0.3, true).unwrap());
        let open = Shape::from(Cylinder::new(a, b, 0.3, false).unwrap());
        let capsule = Shape::from(Capsule::new(a, b, 0.3).unwrap());
        for angle in [0.0, PI / 9.0, 0.5] {
            let rim = |shape: &Shape| faces(&world([shape.clone()]), from, at(angle, 1.0));
            assert_eq!(rim(&closed), [(0, 0), (0, 2)]);
            assert_eq!(rim(&open), [(0, 0)]);
            assert_eq!(rim(&capsule), [(0, 0), (0, 2)]);
        }
        let [disc, side] = [
            Disc::new(b, DVec3::Z, 0.3).unwrap(),
            Disc::new(b, DVec3::Z, 0.2).unwrap(),
        ];
        let lid = world([open, disc.into(), side.into()]);
        assert_eq!(faces(&lid, from, at(0.5, 1.0)), [(0, 0), (1, 0)]);
    }

    #[test]
    fn the_parts_of_solids_and_placed_ones() {
        let cube = |x: f64| {
            let corner = DVec3::new(x, 0.0, 0.0);
            Shape::from(Cuboid::new(corner, corner + 1.0).unwrap())
        };
        let both = Solid::new(Operation::Union, [cube(0.0), cube(1.0)]).unwrap();
        let leaf = Triangle::new(
            DVec3::new(0.5, -1.0, 1.0),
            DVec3::new(3.0, 0.5, 1.0),
            DVec3::new(0.5, 2.0, 1.0),
        )
        .unwrap();
        for transform in transforms() {
            let [solid, leaf] = [both.clone().into(), Shape::from(leaf)]
                .map(|shape: Shape| shape.placed(&transform).unwrap());
            let world = world([solid, leaf]);
            let from = transform.point(DVec3::new(0.3, -0.2, 9.0));
            let through = transform.point(DVec3::new(1.0, 0.6, 1.0));
            let mut found = faces(&world, from, through);
            found.sort_unstable();
            let expected = [(0, 1), (0, 5), (0, 8), (0, 13), (1, 0)];
            assert_eq!(found, expected, "{transform:?}");
        }
    }
}
