//! Which of eight points may lie on the faces of a shape: all others surely do not, by
//! [`ContactPoint::face`](crate::tracer::shape::contact::ContactPoint).

use glam::DVec3;

use crate::{
    accel::{
        lanes::{abs, across, dot, load3, splat3, sub},
        shadow::WRONG,
    },
    simd::{F64x8, Kernel, LANES, Mask, Simd},
    tracer::shape::{Shape, around::Around, axis::Axis, plane::Planar, solid::Solid},
};

/// A length whose square may be 0 in f64.
const TINY: f64 = 1e-150;

/// The kernel that finds the points that may lie on a face of a shape, lane i as bit i.
pub(crate) struct NearFaces<'a> {
    pub(crate) shape: &'a Shape,
    pub(crate) at: &'a [[f64; LANES]; 3],
    /// How far from a point a face may be that it lies on, beside the errors of the face's own numbers.
    pub(crate) reach: f64,
    /// For each point, the number of a face that is not asked for.
    pub(crate) except: &'a [f64; LANES],
}

/// The number of no face.
pub(crate) const NO_FACE: f64 = -1.0;

impl Kernel for NearFaces<'_> {
    type Output = u8;

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> u8 {
        let near = Near {
            simd,
            at: load3(simd, self.at),
            except: simd.load(self.except),
            reach: self.reach + TINY,
        };
        match self.shape {
            Shape::Solid(solid) => (0..)
                .step_by(Solid::FACES_OF_PART as usize)
                .zip(solid.parts())
                .fold(0, |all, (first, part)| all | near.of(part, first)),
            shape => near.of(shape, 0),
        }
    }
}

/// Eight points and their reach.
struct Near<S: Simd> {
    simd: S,
    at: [S::F64; 3],
    except: S::F64,
    reach: f64,
}

impl<S: Simd> Near<S> {
    /// Returns the points that are near faces of a shape, whose numbers begin with `first`.
    #[inline(always)]
    fn of(&self, shape: &Shape, first: u64) -> u8 {
        let face = |face: u64, near: u8| {
            near & !self
                .except
                .eq(self.simd.splat((first + face) as f64))
                .bits()
        };
        // The boxes around these are computed anew each time.
        match shape {
            Shape::Sphere(it) => return face(0, self.on_ball(it.center(), it.radius())),
            Shape::Disc(it) => return face(0, self.on_plane(it.center(), it.normal())),
            Shape::Plane(it) => return face(0, self.on_plane(it.point(), it.normal())),
            _ => {}
        }
        let inside = self.in_box(shape.around().as_ref());
        if inside == 0 {
            return 0;
        }
        let near = match shape {
            Shape::Rectangle(it) => face(0, self.on_plane(it.corner(), it.in_plane().normal())),
            Shape::Triangle(it) => face(0, self.on_plane(it.corners()[0], it.in_plane().normal())),
            Shape::Cuboid(it) => (0..6).fold(0, |all, number| {
                let axis = number / 2;
                let end = [it.min(), it.max()][number % 2][axis];
                let distance = self.at[axis] - self.simd.splat(end);
                all | face(number as u64, self.within(distance, end.abs()))
            }),
            Shape::Cylinder(it) => {
                let side = face(0, self.on_side(it.axis(), it.radius(), 0.0));
                side | if it.capped() {
                    self.on_caps(it.axis(), face)
                } else {
                    0
                }
            }
            Shape::Cone(it) => {
                let side = face(0, self.on_side(it.axis(), it.radius(), it.slope()));
                side | if it.capped() {
                    self.on_caps(it.axis(), face)
                } else {
                    0
                }
            }
            Shape::Capsule(it) => {
                let radius = it.radius();
                face(0, self.on_side(it.axis(), radius, 0.0))
                    | face(1, self.on_ball(it.from(), radius))
                    | face(2, self.on_ball(it.to(), radius))
            }
            _ if shape.has_faces() => u8::MAX,
            _ => face(0, u8::MAX),
        };
        near & inside
    }

    /// Returns the points whose distance from something is within reach, given how large its numbers are.
    #[inline(always)]
    fn within(&self, distance: S::F64, size: f64) -> u8 {
        let slack = self.simd.splat(self.reach + WRONG * size);
        // NaN excludes nothing.
        !slack.lt(abs(distance)).bits()
    }

    #[inline(always)]
    fn in_box(&self, around: Option<&Around>) -> u8 {
        let Some([low, high]) = around.and_then(Around::bounds) else {
            return u8::MAX;
        };
        let reach = self.simd.splat(self.reach);
        let mut inside = u8::MAX;
        for axis in 0..3 {
            let (low, high) = (self.simd.splat(low[axis]), self.simd.splat(high[axis]));
            let at = self.at[axis];
            inside &= (low.le(at + reach) & at.le(high + reach)).bits();
        }
        inside
    }

    #[inline(always)]
    fn on_plane(&self, point: DVec3, normal: DVec3) -> u8 {
        let q = sub(self.at, splat3(self.simd, point));
        // No shorter than at unit length.
        let normal = normal * (1.0 / normal.abs().max_element());
        let distance = dot(q, splat3(self.simd, normal));
        self.within(distance, point.abs().max_element())
    }

    #[inline(always)]
    fn on_ball(&self, center: DVec3, radius: f64) -> u8 {
        let q = sub(self.at, splat3(self.simd, center));
        let distance = dot(q, q).sqrt() - self.simd.splat(radius);
        self.within(distance, center.abs().max_element() + radius)
    }

    /// The side of a cylinder or a cone.
    #[inline(always)]
    fn on_side(&self, axis: &Axis, radius: f64, slope: f64) -> u8 {
        let (simd, w) = (self.simd, splat3(self.simd, axis.w));
        let q = sub(self.at, splat3(simd, axis.from));
        let beside = across(q, w);
        let there = simd.splat(radius) + simd.splat(slope) * dot(q, w);
        let distance = dot(beside, beside).sqrt() - there;
        let distance = distance * simd.splat(1.0 / (1.0 + slope.abs()));
        let most = axis.from.abs().max(axis.to.abs()).max_element();
        self.within(distance, most + radius)
    }

    #[inline(always)]
    fn on_caps(&self, axis: &Axis, face: impl Fn(u64, u8) -> u8) -> u8 {
        face(1, self.on_plane(axis.from, axis.w)) | face(2, self.on_plane(axis.to, axis.w))
    }
}
