//! Directions from pairs of numbers.

use std::f64::consts::{FRAC_PI_2, PI};

use glam::DVec3;

/// Two numbers, each above 0 and below 1.
pub(crate) type UnitPair = [f64; 2];

/// Coefficients of x³, x⁵, … x¹⁵ of the sine.
pub(crate) const SINE: [f64; 7] = [
    -1.0 / 6.0,
    1.0 / 120.0,
    -1.0 / 5_040.0,
    1.0 / 362_880.0,
    -1.0 / 39_916_800.0,
    1.0 / 6_227_020_800.0,
    -1.0 / 1_307_674_368_000.0,
];
/// Coefficients of x², x⁴, … x¹⁶ of the cosine.
pub(crate) const COSINE: [f64; 8] = [
    -1.0 / 2.0,
    1.0 / 24.0,
    -1.0 / 720.0,
    1.0 / 40_320.0,
    -1.0 / 3_628_800.0,
    1.0 / 479_001_600.0,
    -1.0 / 87_178_291_200.0,
    1.0 / 20_922_789_888_000.0,
];

/// Returns the cosine and the sine of 2πu, for u in 0..=1.
///
/// Taylor series within an eighth of a turn, so that eight lanes can compute the same bits.
pub(crate) fn circle(u: f64) -> [f64; 2] {
    let quarters = (4.0 * u + 0.5).floor();
    let x = (4.0 * u - quarters) * FRAC_PI_2;
    let squared = x * x;
    let horner = |sum: f64, coefficient: &f64| (sum + coefficient) * squared;
    let sine = x * (1.0 + SINE.iter().rev().fold(0.0, horner));
    let cosine = 1.0 + COSINE.iter().rev().fold(0.0, horner);
    match quarters as u32 % 4 {
        0 => [cosine, sine],
        1 => [-sine, cosine],
        2 => [-cosine, -sine],
        _ => [sine, -cosine],
    }
}

/// Returns a point of the unit disc, evenly distributed.
pub(crate) fn disc([u, v]: UnitPair) -> [f64; 2] {
    let (radius, [cosine, sine]) = (u.sqrt(), circle(v));
    [radius * cosine, radius * sine]
}

/// Returns a direction above the plane z = 0, with the density z/π.
pub(crate) fn cosine_weighted([u, v]: UnitPair) -> DVec3 {
    let [x, y] = disc([u, v]);
    DVec3::new(x, y, (1.0 - u).sqrt())
}

/// Returns the density of [`cosine_weighted`].
pub(crate) fn cosine_density(z: f64) -> f64 {
    z / PI
}

/// Three unit vectors at right angles.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LocalFrame {
    x: DVec3,
    y: DVec3,
    z: DVec3,
}

impl LocalFrame {
    /// Creates a frame whose third axis is a unit vector (T. Duff and others, Building an orthonormal
    /// basis, revisited, Journal of Computer Graphics Techniques, 2017).
    pub(crate) fn new(n: DVec3) -> Self {
        let sign = 1.0_f64.copysign(n.z);
        let a = -1.0 / (sign + n.z);
        let b = n.x * n.y * a;
        Self {
            x: DVec3::new(1.0 + sign * n.x * n.x * a, sign * b, -sign * n.x),
            y: DVec3::new(b, sign + n.y * n.y * a, -n.y),
            z: n,
        }
    }

    /// The three vectors.
    pub(crate) const fn axes(&self) -> [&DVec3; 3] {
        [&self.x, &self.y, &self.z]
    }

    /// Returns a vector of the frame in world space.
    pub(crate) fn outward(&self, local: DVec3) -> DVec3 {
        local.x * self.x + local.y * self.y + local.z * self.z
    }

    /// Returns a vector of world space in the frame.
    pub(crate) fn inward(&self, world: DVec3) -> DVec3 {
        DVec3::new(world.dot(self.x), world.dot(self.y), world.dot(self.z))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tracer::{
        random::{Rng, cases},
        vector::unit,
    };

    #[test]
    fn circle_is_the_cosine_and_the_sine() {
        for step in 0..=1000 {
            let u = f64::from(step) / 1000.0;
            let [cosine, sine] = circle(u);
            let (expected_sine, expected_cosine) = libm::sincos(2.0 * PI * u);
            assert!((cosine - expected_cosine).abs() < 1e-15, "{u}");
            assert!((sine - expected_sine).abs() < 1e-15, "{u}");
        }
        assert_eq!(circle(0.25), [0.0, 1.0]);
    }

    #[test]
    fn a_frame_is_right_handed_and_goes_back() {
        let mut random = Rng(5);
        for _ in 0..cases(400) {
            let n = unit(random.vector());
            let frame = LocalFrame::new(n);
            assert!((frame.x.cross(frame.y) - n).length() < 1e-14, "{n}");
            let v = random.vector();
            assert!((frame.outward(frame.inward(v)) - v).length() < 1e-14);
        }
        for n in [DVec3::Z, DVec3::NEG_Z] {
            assert_eq!(LocalFrame::new(n).outward(DVec3::Z), n);
        }
    }
}
