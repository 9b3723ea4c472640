//! Which of eight points may lie on the faces of a shape: all others surely do not, by
//! [`ContactPoint::face`](crate::tracer::shape::contact::ContactPoint).

use glam::DVec3;
use smallvec::SmallVec;

use crate::{
    accel::{
        lanes::{across, dot, load3, splat3, sub},
        shadow::WRONG,
    },
    simd::{F64x8, Kernel, LANES, Mask, Simd},
    tracer::{
        shape::{
            Shape,
            around::Around,
            axis::Axis,
            contact::REACH,
            instances::Instances,
            mesh::{Mesh, box_around},
            plane::Planar,
            solid::Solid,
        },
        transform::Transform,
    },
};

/// A length whose square may be 0 in f64.
pub(super) const TINY: f64 = 1e-150;

/// The kernel that finds the points that may lie on a face of a shape, lane i as bit i.
pub(crate) struct NearFaces<'a> {
    pub(crate) shape: &'a Shape,
    pub(crate) at: &'a [[f64; LANES]; 3],
    /// The points that are asked for.
    pub(crate) lanes: u8,
    /// How far from a point a face may be that it lies on, beside the errors of the face's own numbers.
    pub(crate) reach: f64,
    /// If the points lie on the shape: for each, the number of the face that is not asked for.
    pub(crate) except: Option<&'a [f64; LANES]>,
}

impl Kernel for NearFaces<'_> {
    type Output = u8;

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> u8 {
        let near = Near {
            simd,
            at: load3(simd, self.at),
            lanes: self.lanes,
            except: self.except.map(|faces| simd.load(faces)),
            reach: self.reach + TINY,
        };
        match self.shape {
            Shape::Placed(placed) => {
                let lanes = self.lanes & near.in_box(placed.around().as_ref());
                let mapped = Mapped::new(simd, &near, placed.transform());
                return near.mapped(&mapped, placed.shape(), (0, lanes));
            }
            Shape::Instances(copies) => return near.copies(copies),
            _ => {}
        }
        let mut parts = SmallVec::<[usize; 16]>::new();
        let solid = match self.shape {
            Shape::Solid(solid) => {
                solid.each_near(near.around(self.lanes), &mut |part| parts.push(part));
                Some(solid)
            }
            _ => {
                parts.push(0);
                None
            }
        };
        let (mut all, mut found) = (0, SmallVec::<[(usize, Beside); 16]>::new());
        // A loop, because the test is inlined wherever it stands.
        for part in parts {
            let shape = match solid {
                Some(solid) => solid.part(part).0,
                None => self.shape,
            };
            let beside = near.of(shape, part as u64 * Solid::FACES_OF_PART);
            all |= beside.near;
            if solid.is_some() {
                found.push((part, beside));
            }
        }
        match solid {
            // Where a part is cut away, or inside of others, its faces are not those of the solid.
            Some(solid) if all != 0 && self.except.is_none() => {
                let [inside, outside] = solid.root().sides(&found, &|it| [it.inside, it.outside]);
                all & !(inside | outside)
            }
            _ => all,
        }
    }
}

/// Returns how far from a ball points may be that lie on it, given the reach for other shapes. Its equation may be
/// wrong by the squared distance of the origin, times 4ε (see [`Sphere`](crate::tracer::shape::sphere::Sphere)); a
/// height by that divided by the radius.
#[inline(always)]
pub(super) fn slack_of_ball(reach: f64, center: DVec3, radius: f64) -> f64 {
    let size = center.abs().max_element() + radius;
    let away = reach / REACH + size;
    reach + WRONG * size + 12.0 * f64::EPSILON * (away * away) / radius
}

/// The largest number of copies that are tested, for points nearby.
const COPIES: usize = 8;

/// The largest number of triangles that are tested, for points nearby.
const TRIANGLES: usize = 24;

/// Eight points and their reach.
struct Near<S: Simd> {
    simd: S,
    at: [S::F64; 3],
    lanes: u8,
    except: Option<S::F64>,
    reach: f64,
}

/// Points that are mapped to the space of a shape.
struct Mapped {
    at: [[f64; LANES]; 3],
    reach: f64,
}

impl Mapped {
    /// Maps points back by a transform.
    #[inline(always)]
    fn new<S: Simd>(simd: S, near: &Near<S>, transform: &Transform) -> Self {
        let from = sub(near.at, splat3(simd, transform.shift()));
        let mut mapped = Self {
            at: [[0.0; LANES]; 3],
            reach: 0.0,
        };
        let mut squared = 0.0;
        for (at, row) in mapped.at.iter_mut().zip(transform.inverse()) {
            dot(splat3(simd, row), from).store(at);
            squared += row.dot(row);
        }
        // The errors of the map too: the coordinates of a point are at most 2²⁰ times the reach.
        let shift = transform.shift().abs().max_element();
        mapped.reach = 2.0 * squared.sqrt() * (near.reach + WRONG * shift);
        mapped
    }
}

/// Points beside a shape, lane i as bit i.
struct Beside {
    /// Those that may lie on a face that is asked for.
    near: u8,
    /// Those that are surely inside, away from all faces.
    inside: u8,
    /// The same outside.
    outside: u8,
}

impl Beside {
    /// Those beside a solid that fills all of space.
    const ANYWHERE: Self = Self {
        near: 0,
        inside: u8::MAX,
        outside: 0,
    };

    /// Returns the points beside the intersection of two solids. Of the surface of each, only what the other does
    /// not cut off is a face.
    #[inline(always)]
    fn and(self, other: Self) -> Self {
        let outside = self.outside | other.outside;
        Self {
            near: (self.near | other.near) & !outside,
            inside: self.inside & other.inside,
            outside,
        }
    }
}

impl<S: Simd> Near<S> {
    /// Returns the points beside a shape, the numbers of whose faces begin with `first`.
    #[inline(always)]
    fn of(&self, shape: &Shape, first: u64) -> Beside {
        match shape {
            Shape::Sphere(it) => self.ball(first, it.center(), it.radius()),
            Shape::Disc(it) => self.plane(first, it.center(), it.normal()),
            Shape::Plane(it) => self.plane(first, it.point(), it.normal()),
            Shape::Cuboid(it) => {
                let mut whole = Beside::ANYWHERE;
                // A loop: in a kernel, a closure may be a call.
                for face in 0..6 {
                    let axis = face / 2;
                    let (end, at) = ([it.min(), it.max()][face % 2][axis], self.at[axis]);
                    let height = at - self.simd.splat(end);
                    let height = if face % 2 == 0 { -height } else { height };
                    whole = whole.and(self.beside(first + face as u64, height, end.abs()));
                }
                whole
            }
            Shape::Cylinder(it) => {
                let side = self.side(first, it.axis(), (it.radius(), 0.0));
                self.between_ends(first, it.axis(), (side, it.capped()))
            }
            Shape::Cone(it) => {
                let side = self.side(first, it.axis(), (it.radius(), it.slope()));
                self.between_ends(first, it.axis(), (side, it.capped()))
            }
            _ => {
                let in_box = self.in_box(shape.around().as_ref());
                let mut near = u8::MAX;
                if in_box != 0 {
                    near = match shape {
                        Shape::Rectangle(it) => {
                            let normal = it.in_plane().normal();
                            self.plane(first, it.corner(), normal).near
                        }
                        Shape::Triangle(it) => {
                            let normal = it.in_plane().normal();
                            self.plane(first, it.corners()[0], normal).near
                        }
                        Shape::Capsule(it) => {
                            let radius = it.radius();
                            let side = self.side(first, it.axis(), (radius, 0.0));
                            side.near
                                | self.ball(first + 1, it.from(), radius).near
                                | self.ball(first + 2, it.to(), radius).near
                        }
                        Shape::Mesh(it) => self.mesh(first, it, in_box & self.lanes),
                        _ if shape.has_faces() => u8::MAX,
                        _ => self.asked(first, u8::MAX),
                    };
                }
                Beside {
                    near: near & in_box,
                    inside: 0,
                    outside: !in_box,
                }
            }
        }
    }

    /// Returns which of some points may lie on a face of a shape that they are mapped to, the numbers of whose faces
    /// begin with `first`.
    #[inline(always)]
    fn mapped(&self, mapped: &Mapped, shape: &Shape, (first, lanes): (u64, u8)) -> u8 {
        if lanes == 0 {
            return 0;
        }
        let mut except = [0.0; LANES];
        if let Some(faces) = self.except {
            (faces - self.simd.splat(first as f64)).store(&mut except);
        }
        lanes
            & self.simd.call(NearFaces {
                shape,
                at: &mapped.at,
                lanes,
                reach: mapped.reach,
                except: self.except.map(|_| &except),
            })
    }

    /// Returns which of the points may lie on a face of copies.
    #[inline(always)]
    fn copies(&self, copies: &Instances) -> u8 {
        let mut lanes = self.lanes & self.in_box(copies.around().as_ref());
        if lanes == 0 {
            return 0;
        }
        let mut nearest = SmallVec::<[usize; COPIES]>::new();
        copies.each_near(self.around(lanes), &mut |copy| nearest.push(copy));
        if nearest.len() > COPIES {
            return lanes;
        }
        let (mut near, faces) = (0, copies.faces_of_copy());
        for copy in nearest {
            let Some(transform) = copies.transform(copy) else {
                return lanes;
            };
            let mapped = Mapped::new(self.simd, self, &transform);
            for part in 0..copies.shapes().len() {
                let Some((shape, first)) = copies.part(part) else {
                    return lanes;
                };
                let found = self.mapped(&mapped, shape, (copy as u64 * faces + first, lanes));
                near |= found;
                lanes &= !found;
            }
        }
        near
    }

    /// Returns those of some points that do not lie on a face because it is the one that is not asked for.
    #[inline(always)]
    fn asked(&self, face: u64, lanes: u8) -> u8 {
        let except = self
            .except
            .map_or(0, |except| except.eq(self.simd.splat(face as f64)).bits());
        lanes & !except
    }

    /// Returns the points beside a surface, given their heights above it and how large its numbers are.
    #[inline(always)]
    fn beside(&self, face: u64, height: S::F64, size: f64) -> Beside {
        self.beside_within(face, height, self.reach + WRONG * size)
    }

    /// The same for heights that may be wrong by this.
    #[inline(always)]
    fn beside_within(&self, face: u64, height: S::F64, slack: f64) -> Beside {
        let slack = self.simd.splat(slack);
        // NaN excludes nothing.
        let (inside, outside) = (height.lt(-slack).bits(), slack.lt(height).bits());
        Beside {
            near: self.asked(face, !(inside | outside)),
            inside,
            outside,
        }
    }

    #[inline(always)]
    fn ball(&self, face: u64, center: DVec3, radius: f64) -> Beside {
        let q = sub(self.at, splat3(self.simd, center));
        let height = dot(q, q).sqrt() - self.simd.splat(radius);
        self.beside_within(face, height, slack_of_ball(self.reach, center, radius))
    }

    #[inline(always)]
    fn in_box(&self, around: Option<&Around>) -> u8 {
        match around.and_then(Around::bounds) {
            Some(corners) => self.between(corners),
            None => u8::MAX,
        }
    }

    /// Returns the points that may lie in a box.
    #[inline(always)]
    fn between(&self, [low, high]: [DVec3; 2]) -> u8 {
        let reach = self.simd.splat(self.reach);
        let mut inside = u8::MAX;
        for axis in 0..3 {
            let (low, high) = (self.simd.splat(low[axis]), self.simd.splat(high[axis]));
            let at = self.at[axis];
            inside &= (low.le(at + reach) & at.le(high + reach)).bits();
        }
        inside
    }

    /// Returns the box around all that some points may lie on.
    #[inline(always)]
    fn around(&self, lanes: u8) -> [DVec3; 2] {
        let (simd, mask) = (self.simd, self.simd.mask(lanes));
        let least = |x: S::F64| S::F64::select(mask, x, simd.splat(f64::INFINITY)).smallest();
        let [x, y, z] = self.at;
        let low = DVec3::new(least(x), least(y), least(z));
        let high = -DVec3::new(least(-x), least(-y), least(-z));
        [low - self.reach, high + self.reach]
    }

    #[inline(always)]
    fn plane(&self, face: u64, point: DVec3, normal: DVec3) -> Beside {
        let q = sub(self.at, splat3(self.simd, point));
        // No shorter than at unit length.
        let normal = normal * (1.0 / normal.abs().max_element());
        let height = dot(q, splat3(self.simd, normal));
        self.beside(face, height, point.abs().max_element())
    }

    /// Returns which of some points may lie on a triangle of a mesh.
    #[inline(always)]
    fn mesh(&self, first: u64, mesh: &Mesh, lanes: u8) -> u8 {
        let (mut triangles, mut count) = ([(0, [DVec3::ZERO; 3]); TRIANGLES], 0);
        mesh.each_near(self.around(lanes), &mut |face, corners| {
            if let Some(triangle) = triangles.get_mut(count) {
                *triangle = (face, corners);
            }
            count += 1;
        });
        let Some(triangles) = triangles.get(..count) else {
            return lanes;
        };
        let mut near = 0;
        for (face, corners) in triangles {
            let [a, b, c] = *corners;
            let plane = self.plane(first + face, a, (b - a).cross(c - a));
            if plane.near & lanes & !near != 0 {
                near |= plane.near & self.between(box_around(*corners));
            }
        }
        near & lanes
    }

    /// The side of a cylinder or a cone, given its radius at the beginning and its slope.
    #[inline(always)]
    fn side(&self, face: u64, axis: &Axis, (radius, slope): (f64, f64)) -> Beside {
        let (simd, w) = (self.simd, splat3(self.simd, axis.w));
        let q = sub(self.at, splat3(simd, axis.from));
        let beside = across(q, w);
        let there = simd.splat(radius) + simd.splat(slope) * dot(q, w);
        let height = dot(beside, beside).sqrt() - there;
        let height = height * simd.splat(1.0 / (1.0 + slope.abs()));
        let most = axis.from.abs().max(axis.to.abs()).max_element();
        self.beside(face, height, most + radius)
    }

    /// Returns the points beside a side and the ends, which are faces if they are closed.
    #[inline(always)]
    fn between_ends(&self, first: u64, axis: &Axis, (side, is_closed): (Beside, bool)) -> Beside {
        let mut ends = [
            self.plane(first + 1, axis.from, -axis.w),
            self.plane(first + 2, axis.to, axis.w),
        ];
        if !is_closed {
            ends.iter_mut().for_each(|end| end.near = 0);
        }
        let [from, to] = ends;
        side.and(from).and(to)
    }
}
