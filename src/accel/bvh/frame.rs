//! Culling in f32, and its error bounds.
//!
//! Boxes are tested in f32, the shapes in them by the textbook's formulas. So a box has to be grown
//! until every ray that hits one of its shapes also meets the box.
//!
//! # Which spheres a ray can hit
//!
//! `Sphere::intersect` solves `A·t² + B·t + C = 0` in f64 and rounds after every operation, so it
//! also finds spheres that the ray misses by a little. This error is bounded. Let `|d| = 1` (all
//! errors scale with the direction), `u = 2⁻⁵³`, `D = |o - c|`, `M = max(D, r)`, `p` the distance
//! of the ray's line from the center and `h² = r² - p²`. Then
//!
//! - `B` is off by at most 8uD and `C` by 8uM²: each is a sum of three products, off by 4u of its
//!   terms;
//! - so `(B² - 4AC) / 4`, which would be `h²`, is off by at most 25uM²;
//! - a root `t = (-B ± √…) / 2A`, given that discriminant, is off by at most 17uM.
//!
//! A computed `t` therefore stands for a point `o + t·d` with
//!
//! `|o + t·d - c|² ≤ p² + (√(h² + 25uM²) + 17uM)² ≤ r² + 60uM² + …`, and 60u is less than 7e-15.
//! Rounded up to 2e-14, its square root is 1.42e-7: **the point at a computed `t` lies within `r +
//! 1.42e-7 · M` of the center**. Culling needs only this: if all spheres are grown by that much, a
//! sphere is hit at `t` only where the ray is inside its grown box at that very `t`. Silhouettes
//! and tests against the nearest `t` so far need nothing else.
//!
//! # Other shapes
//!
//! The same is required of any other shape and its bounds: the point `o + t·d` at a `t` that it
//! returns lies within 1.42e-7 of the larger of its distance and its size from the box. [`Hull`]
//! adds the margin for rounded coordinates: a sphere's equation has no points in it, but others
//! may, and those round by u of their distance from the world's origin.
//!
//! # In f32
//!
//! All lengths are first made relative to the center of the spheres and multiplied by a power of
//! two, in f64, so that every shape lies in the cube from -1 to 1: a difference rounds by u of
//! itself, wherever the world lies. No center is farther than `reach = |x| + |y| + |z| + 2` from an
//! origin at x, y, z. Rounding to f32 moves the origin, a center or a plane of a box by at most
//! `2⁻²⁴·reach`, and so does each operation of the tests in `traverse.rs`: in total, a plane of a box
//! moves by less than 6e-7·reach, widening included. [`SLACK`] is three times that. The product of the
//! origin and the reciprocal there is one of them, and so is its sum with the slack: their errors are
//! those of an origin that is moved by `2⁻²⁴` of itself. A product that is fused is not rounded.
//!
//! If the ray's direction is almost along an axis, its other components are raised to [`SMALLEST`],
//! so that no quotient is infinite or NaN; over the reach of a ray this moves it by 2e-9·reach,
//! which the slack covers as well.

use std::array;

use glam::DVec3;

use crate::{
    accel::{
        lanes::{abs, dot, splat3, sub},
        rounding,
    },
    simd::{F64x8, Mask, Simd},
    tracer::{
        ray::Ray,
        shape::{Shape, contact::REACH},
    },
};

/// The margin by which boxes are grown, as a fraction of the reach.
const SLACK: f64 = 2e-6;

/// The smallest component of a direction of about unit length.
pub(super) const SMALLEST: f32 = 1e-9;

/// The largest reach. Beyond it the slack would be as large as the world, and the plain loop is as
/// good.
const FARTHEST: f64 = 1e5;

/// The largest number of a point, in the frame, from which the boxes of all shapes that it lies on are surely met: they
/// are no farther than [`REACH`] of it, half of the slack of a ray that begins at the center.
const FARTHEST_CONTACT: f64 = SLACK / REACH;

/// The range of lengths of which products of four neither overflow nor lose digits at the lower
/// end.
const ORDINARY: std::ops::RangeInclusive<f64> = 1e-50..=1e50;

/// The bits of the exponent of an f64: alone, they are those of the next smaller power of two.
const EXPONENT: u64 = 0x7ff << 52;

/// The bits of a power of two and of its reciprocal together.
const RECIPROCAL: u64 = (2 * 1023) << 52;

/// A cube around shapes and the map to its coordinates, in which it spans -1 to 1.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Frame {
    center: DVec3,
    /// The factor from lengths to the frame: a power of two, so that multiplication is exact.
    scale: f64,
}

/// A ray in the coordinates of a [`Frame`], for the tests in f32.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Probe {
    /// The center of the frame, as seen from the origin.
    pub(super) center: [f32; 3],
    /// The direction, at a length from 1/√3 to 2. A component may be as small as 0.
    pub(super) direction: [f32; 3],
    /// The margin by which boxes are grown.
    pub(super) slack: f32,
    /// The distance per unit of `t`, in lengths of that direction.
    per_t: f64,
}

/// Eight rays in the coordinates of a [`Frame`], prepared for the tests in f32: for each number of a
/// [`Probe`], one that is at least as far on as that of each ray.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Beam {
    /// The smallest and the largest reciprocals; both have the same sign.
    pub(super) inverse: [[f32; 3]; 2],
    pub(super) entering: [f32; 3],
    pub(super) leaving: [f32; 3],
    /// The distance before which nothing is met.
    pub(super) nearest: f32,
    per_t: f64,
}

/// A box around a shape.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Hull {
    center: DVec3,
    /// Half the size along each axis.
    half: DVec3,
}

impl Hull {
    /// Returns the box around a shape that is bounded and not too large.
    pub(super) fn new(shape: &Shape) -> Option<Self> {
        let hull = match shape.sphere() {
            // Kept exact: f64 has no box for a small sphere that is far away.
            Some(sphere) => Self {
                center: sphere.center(),
                half: DVec3::splat(sphere.radius()),
            },
            None => Self::of_box(shape.bounds()?),
        };
        hull.is_ordinary().then_some(hull)
    }

    /// Returns the box whose corners are these, grown by the rounding error of points in it.
    pub(crate) fn of_box([low, high]: [DVec3; 2]) -> Self {
        let rounding = rounding(low.abs().max(high.abs()));
        Self {
            center: (low + high) * 0.5,
            half: (high - low) * 0.5 + rounding,
        }
    }

    /// Returns true if the box is not too large.
    pub(crate) fn is_ordinary(&self) -> bool {
        let farthest = self.center.abs().max(self.half).max_element();
        farthest <= *ORDINARY.end()
    }
}

impl Frame {
    /// Returns the frame of all boxes; `None` if there are none, or if they are no larger than a
    /// point.
    pub(crate) fn around(hulls: impl Iterator<Item = Hull>) -> Option<Self> {
        let mut low = DVec3::INFINITY;
        let mut high = DVec3::NEG_INFINITY;
        let mut largest = 0.0_f64;
        hulls.for_each(|hull| {
            low = low.min(hull.center);
            high = high.max(hull.center);
            largest = largest.max(hull.half.max_element());
        });
        let center = (low + high) * 0.5;
        // From the rounded center, which may lie at the edge of spheres far from 0.
        let half = (high - center).max(center - low).max_element() + largest;
        if !ORDINARY.contains(&half) {
            return None;
        }
        // The exponent alone, plus one: the next larger power of two.
        let scale = 0.5 / f64::from_bits(half.to_bits() & EXPONENT);
        Some(Self { center, scale })
    }

    /// Returns a box in the frame: its center and half its size.
    pub(crate) fn hull(&self, hull: &Hull) -> [[f32; 3]; 2] {
        [hull.center - self.center, hull.half]
            .map(|length| (length * self.scale).to_array().map(|x| x as f32))
    }

    /// Returns the corners of a box in the frame that meets the boxes of all shapes near another one, given
    /// its corners: a little larger. They are finite, so that a lane of a node without a box is outside.
    pub(crate) fn near(&self, corners: [DVec3; 2]) -> [[f32; 3]; 2] {
        let [center, half] = self.hull(&Hull::of_box(corners));
        let reach = center.iter().map(|x| x.abs()).sum::<f32>() + 2.0;
        let half = half.map(|half| half + SLACK as f32 * reach);
        // NaN becomes finite as well.
        [
            array::from_fn(|axis| (center[axis] - half[axis]).max(f32::MIN)),
            array::from_fn(|axis| (center[axis] + half[axis]).min(f32::MAX)),
        ]
    }

    /// Returns true if a box, given its corners, may meet one around a shape.
    pub(crate) fn may_meet(&self, corners: [DVec3; 2]) -> bool {
        let [low, high] = self.near(corners);
        (0..3).all(|axis| low[axis] <= 1.0 && -1.0 <= high[axis])
    }

    /// Returns true if a ray that begins at a point may miss the boxes of shapes that it lies on, given the largest
    /// of the point's numbers: then these may be as far from it as boxes are grown, or more.
    pub(crate) fn is_far(&self, size: f64) -> bool {
        size * self.scale > FARTHEST_CONTACT
    }

    /// Returns a ray in the frame; `None` if the bounds above do not hold, so that the ray needs
    /// the plain loop. Inlined: a probe that is moved as a whole is waited for.
    #[inline(always)]
    pub(crate) fn probe(&self, ray: &Ray) -> Option<Probe> {
        let center = (self.center - ray.origin()) * self.scale;
        let size = ray.direction().abs().element_sum();
        let reach = center.abs().element_sum() + 2.0;
        // NaN is in no range.
        if !(ORDINARY.contains(&size) && (0.0..=FARTHEST).contains(&reach)) {
            return None;
        }
        // The next smaller power of two and its reciprocal: a root would be waited for.
        let length = f64::from_bits(size.to_bits() & EXPONENT);
        let direction = ray.direction() * f64::from_bits(RECIPROCAL - length.to_bits());
        Some(Probe {
            center: center.as_vec3().to_array(),
            direction: direction.as_vec3().to_array(),
            slack: (SLACK * reach) as f32,
            per_t: length * self.scale,
        })
    }
}

impl Frame {
    /// Returns rays in the frame that meet nothing before the `t` of `from`; `None` if one of them has
    /// no probe, or if they point to different sides along an axis.
    #[inline(always)]
    pub(crate) fn beam<S: Simd>(
        &self,
        simd: S,
        [origin, direction]: [[S::F64; 3]; 2],
        from: f64,
    ) -> Option<Beam> {
        let scale = simd.splat(self.scale);
        let [x, y, z] = sub(origin, splat3(simd, self.center));
        let origin = [x * scale, y * scale, z * scale];
        let length = dot(direction, direction).sqrt();
        let reach = abs(origin[0]) + abs(origin[1]) + abs(origin[2]) + simd.splat(2.0);
        let (least, most) = (simd.splat(*ORDINARY.start()), simd.splat(*ORDINARY.end()));
        let have_probes = least.le(length) & length.le(most) & reach.le(simd.splat(FARTHEST));
        if have_probes.bits() != u8::MAX {
            return None;
        }
        let slack = SLACK * reach.largest();
        let inverse = simd.splat(1.0) / length;
        let mut beam = Beam {
            inverse: [[0.0; 3]; 2],
            entering: [0.0; 3],
            leaving: [0.0; 3],
            nearest: (from * (length.smallest() * self.scale) * (1.0 - SLACK)) as f32,
            per_t: length.largest() * self.scale,
        };
        for axis in 0..3 {
            let along = direction[axis] * inverse;
            let along = [along.smallest(), along.largest()];
            if along[0].is_sign_negative() != along[1].is_sign_negative() {
                return None;
            }
            let sides = [origin[axis].smallest(), origin[axis].largest()];
            let [back, ahead, forwards] = match along[0].is_sign_negative() {
                true => [sides[1], sides[0], -1.0],
                false => [sides[0], sides[1], 1.0],
            };
            for (inverse, along) in beam.inverse.iter_mut().zip(along) {
                let along = along as f32;
                inverse[axis] = 1.0 / along.abs().max(SMALLEST).copysign(along);
            }
            beam.entering[axis] = (ahead + slack * forwards) as f32;
            beam.leaving[axis] = (back - slack * forwards) as f32;
        }
        Some(beam)
    }
}

impl Beam {
    /// Returns the distance of `t` along any of the rays, or slightly more.
    #[inline(always)]
    pub(super) fn distance(&self, t: f64) -> f32 {
        (t * self.per_t * (1.0 + SLACK)) as f32
    }
}

impl Probe {
    /// Returns the distance of `t` along the ray, or slightly more.
    #[inline(always)]
    pub(super) fn distance(&self, t: f64) -> f32 {
        (t * self.per_t * (1.0 + SLACK)) as f32
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tracer::random::{Rng, cases};
    use crate::tracer::shape::sphere::Sphere;

    /// Returns the distance of the point at `t` from the sphere, in units of `M`. It is computed
    /// relative to the center, where it keeps its digits.
    fn beyond(sphere: &Sphere, ray: &Ray, t: f64) -> f64 {
        let outward = (ray.origin() - sphere.center()) + t * ray.direction();
        let distance = (ray.origin() - sphere.center()).length();
        (outward.length() - sphere.radius()) / distance.max(sphere.radius())
    }

    #[test]
    fn a_computed_t_is_close_to_its_sphere() {
        let mut rng = Rng(7);
        let (mut hits, mut widest) = (0, 0.0_f64);
        for _ in 0..cases(20_000) {
            let sphere = Sphere::new(rng.vector(), rng.magnitude(-12.0, 1.0)).unwrap();
            let origin = sphere.center() + rng.vector() * rng.magnitude(-3.0, 6.0);
            // To the edge of the sphere, plus or minus as much as rounding may add.
            let to = sphere.center() - origin;
            let aside = to.cross(rng.vector());
            let radius = sphere.radius() + 1e-7 * to.length() * rng.signed();
            let ray = Ray::new(origin, to + aside * (radius / aside.length()));
            if let Some(t) = sphere.intersect(&ray, f64::INFINITY) {
                hits += 1;
                widest = widest.max(beyond(&sphere, &ray, t));
            }
        }
        assert!(hits > cases(20_000) / 10, "{hits}");
        // The error does occur, and stays below the bound.
        assert!((3e-9..1.42e-7).contains(&widest), "{widest}");
    }

    #[test]
    fn boxes_are_inside_the_cube() {
        let mut rng = Rng(8);
        for _ in 0..cases(500) {
            let (middle, size) = (
                rng.vector() * rng.magnitude(-3.0, 9.0),
                rng.magnitude(-9.0, 9.0),
            );
            let hull = |rng: &mut Rng| {
                let radius = size * rng.magnitude(-6.0, 1.0);
                let sphere = Sphere::new(middle + rng.vector() * size, radius).unwrap();
                Hull::new(&sphere.into()).unwrap()
            };
            let hulls: Vec<Hull> = (0..9).map(|_| hull(&mut rng)).collect();
            let frame = Frame::around(hulls.iter().copied()).unwrap();
            for hull in &hulls {
                let [center, half] = frame.hull(hull);
                // Rounding to f32 may move either beyond the edge, which the slack covers.
                let edge = 1.0 + f32::EPSILON;
                let inside = |(center, half): (&f32, &f32)| center.abs() + half <= edge;
                assert!(center.iter().zip(&half).all(inside), "{hull:?}");
            }
        }
        assert!(Frame::around([].into_iter()).is_none());
    }

    #[test]
    fn unbounded_rays_have_no_probe() {
        let sphere = Sphere::new(DVec3::ZERO, 1.0).unwrap();
        let frame = Frame::around(Hull::new(&sphere.into()).into_iter()).unwrap();
        let probe = |origin: DVec3, direction: DVec3| frame.probe(&Ray::new(origin, direction));
        assert!(probe(DVec3::X * 1000.0, DVec3::Y * 1e49).is_some());
        assert!(probe(DVec3::X, DVec3::ZERO).is_none());
        assert!(probe(DVec3::X, DVec3::Y * 1e51).is_none());
        assert!(probe(DVec3::X, DVec3::NAN).is_none());
        assert!(probe(DVec3::X * 1e6, DVec3::Y).is_none());
        assert!(probe(DVec3::INFINITY, DVec3::Y).is_none());
    }
}
