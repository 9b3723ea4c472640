//! Where f32 decides what need not be looked at, and how far it may err.
//!
//! # Which spheres a ray can hit
//!
//! `Sphere::intersect` solves `A·t² + B·t + C = 0` in f64 and rounds after every operation, so
//! that it also finds spheres which the ray misses by a little. What it can find is bounded. Let
//! `u = 2⁻⁵³`, `|d| = 1` (all errors scale with the direction), `D = |o - c|`, `M = max(D, r)`,
//! `p` the distance of the ray's line from the center and `h² = r² - p²`. Then
//!
//! - `B` is off by at most 8uD and `C` by 8uM², each sum of three products by 4u of its terms;
//! - so `(B² - 4AC) / 4`, which would be `h²`, is off by at most 25uM²;
//! - a root `t = (-B ± √…) / 2A`, given that discriminant, is off by at most 17uM.
//!
//! A computed `t` therefore stands for a point `o + t·d` with
//! `|o + t·d - c|² ≤ p² + (√(h² + 25uM²) + 17uM)² ≤ r² + 60uM² + …`, and 60u is less than 7e-15.
//! With 2e-14 in its place, 1.42e-7 is the root of it: **the point at a computed `t` lies
//! within `r + 1.42e-7 · M` of the center**. Every cull here says no more than that: if all
//! spheres are grown by that much, a sphere is hit at `t` only where the ray is inside its grown
//! box at that very `t`. Neither silhouettes nor tests against the nearest `t` so far need
//! anything else.
//!
//! # In f32
//!
//! All lengths are first made relative to the center of the spheres and divided by a power of
//! two, in f64, so that every sphere lies in the cube from -1 to 1: a difference rounds by u of
//! itself, wherever the world lies. No center is farther from the origin than `reach = |o| + 2`.
//! Rounding to f32 moves the origin, a plane of a box, or a center by at most `2⁻²⁴·reach`, and so
//! does each operation of the tests in `walk.rs`: with all of them counted, a plane of a box moves
//! by less than 5e-7·reach and a ray's distance from a center by less than 9e-7·reach, widening
//! included. [`SLACK`] is more than twice that.
//!
//! Where the ray's direction is almost along an axis, its other components are made
//! [`SMALLEST`], so that no quotient is infinite or NaN; over the reach of a ray that moves it by
//! 1e-9·reach, which the slack holds as well.

use glam::DVec3;

use crate::tracer::{ray::Ray, shape::sphere::Sphere};

/// How much everything is grown, in parts of the reach.
const SLACK: f64 = 2e-6;

/// The smallest component of a direction of unit length.
const SMALLEST: f64 = 1e-9;

/// Beyond this the slack would be as large as the world: the plain loop is as good.
const FARTHEST: f64 = 1e5;

/// Lengths between its ends can be multiplied four at a time, and the products neither overflow
/// nor lose digits at the lower end.
const ORDINARY: std::ops::RangeInclusive<f64> = 1e-50..=1e50;

/// A cube around spheres, and the way into its coordinates, where it reaches from -1 to 1.
#[derive(Clone, Copy, Debug)]
pub(super) struct Frame {
    center: DVec3,
    /// A power of two: dividing by it is exact.
    scale: f64,
}

/// A ray in the coordinates of a [`Frame`], made fit for the tests in f32.
#[derive(Clone, Copy, Debug)]
pub(super) struct Probe {
    /// The origin.
    pub(super) origin: [f32; 3],
    /// The direction, at unit length.
    pub(super) direction: [f32; 3],
    /// What every sphere is grown by.
    pub(super) slack: f32,
    /// The reciprocals of the direction.
    pub(super) inverse: [f32; 3],
    /// The origin moved forwards by the slack: seen from there, planes that the ray meets first
    /// lie that much nearer.
    pub(super) entering: [f32; 3],
    /// The origin moved backwards by the slack.
    pub(super) leaving: [f32; 3],
    /// Length in the frame for one unit of `t`.
    per_t: f64,
}

/// Whether a sphere can stand in a frame.
pub(super) fn fits(sphere: &Sphere) -> bool {
    sphere.center().abs().max_element() <= *ORDINARY.end() && sphere.radius() <= *ORDINARY.end()
}

impl Frame {
    /// The frame of all spheres; none where there are none, or no larger than a point.
    pub(super) fn around<'a>(spheres: impl Iterator<Item = &'a Sphere>) -> Option<Self> {
        let mut low = DVec3::INFINITY;
        let mut high = DVec3::NEG_INFINITY;
        let mut radius = 0.0_f64;
        for sphere in spheres {
            low = low.min(sphere.center());
            high = high.max(sphere.center());
            radius = radius.max(sphere.radius());
        }
        let half = (high - low).max_element() * 0.5 + radius;
        if !ORDINARY.contains(&half) {
            return None;
        }
        // The exponent alone, and one more: the least power of two above.
        let scale = f64::from_bits(half.to_bits() & (0x7ff << 52)) * 2.0;
        let center = (low + high) * 0.5;
        Some(Self { center, scale })
    }

    /// A sphere: its center and its radius.
    pub(super) fn sphere(&self, sphere: &Sphere) -> ([f32; 3], f32) {
        let center = (sphere.center() - self.center) / self.scale;
        let center = center.to_array().map(|x| x as f32);
        (center, (sphere.radius() / self.scale) as f32)
    }

    /// A ray; none where the bounds above do not hold, so that only the plain loop will do.
    pub(super) fn probe(&self, ray: &Ray) -> Option<Probe> {
        let origin = (ray.origin() - self.center) / self.scale;
        let length = ray.direction().length();
        let reach = origin.length() + 2.0;
        // NaN is in no range.
        if !(ORDINARY.contains(&length) && (0.0..=FARTHEST).contains(&reach)) {
            return None;
        }
        let direction = ray.direction() / length;
        let slack = SLACK * reach;
        let along = direction
            .to_array()
            .map(|x| x.abs().max(SMALLEST).copysign(x));
        let moved = |by: f64| -> [f32; 3] {
            std::array::from_fn(|axis| (origin[axis] + by * along[axis].signum()) as f32)
        };
        Some(Probe {
            origin: origin.to_array().map(|x| x as f32),
            direction: direction.to_array().map(|x| x as f32),
            slack: slack as f32,
            inverse: along.map(|x| (1.0 / x) as f32),
            entering: moved(slack),
            leaving: moved(-slack),
            per_t: length / self.scale,
        })
    }
}

impl Probe {
    /// How far along the ray `t` lies, or farther.
    pub(super) fn distance(&self, t: f64) -> f32 {
        (t * self.per_t * (1.0 + SLACK)) as f32
    }
}
