//! Vector operations beyond glam's own `dot` and `cross`, and checks of numbers and vectors.

use std::ops::{Add, Mul};

use glam::DVec3;

use crate::tracer::error::GeometryError;

/// Returns `v / |v|`, by three divisions.
///
/// glam's `normalize` multiplies by a reciprocal: one more rounding, which changes pixels far from
/// the origin.
pub(crate) fn unit(v: DVec3) -> DVec3 {
    v / v.length()
}

/// Returns `(u·a + v·b) + w·c`: what a point of a triangle has if its corners have `a`, `b` and `c`.
pub(crate) fn weighted<T>([a, b, c]: [T; 3], [u, v, w]: [f64; 3]) -> T
where
    T: Add<Output = T> + Mul<f64, Output = T>,
{
    (a * u + b * v) + c * w
}

/// Returns `v` if it has a direction: its squared length in f64 is neither 0 nor infinite nor NaN.
pub(crate) fn direction(v: DVec3, name: &'static str) -> Result<DVec3, GeometryError> {
    if is_direction(v) {
        Ok(v)
    } else {
        Err(GeometryError::NoDirection { name, value: v })
    }
}

/// Returns true if `v` has a direction; see [`direction`].
pub(crate) fn is_direction(v: DVec3) -> bool {
    let squared = v.dot(v);
    squared > 0.0 && squared.is_finite()
}

/// Returns the reason why two finite points are not the ends of a shape, if they are too close or too
/// far apart.
#[inline]
pub(crate) fn why_no_axis([from, to]: [DVec3; 2]) -> Option<&'static str> {
    if !from.is_finite() || !to.is_finite() || is_direction(to - from) {
        None
    } else if from == to {
        Some("are the same point")
    } else {
        Some("have a squared distance that is 0 or not finite in an f64")
    }
}

/// Returns `v` if every component is finite.
pub(crate) fn finite(v: DVec3, name: &'static str) -> Result<DVec3, GeometryError> {
    if v.is_finite() {
        Ok(v)
    } else {
        Err(GeometryError::NotFinite { name })
    }
}

/// Returns `x` if it is finite and above 0.
pub(crate) fn positive(x: f64, name: &'static str) -> Result<f64, GeometryError> {
    if !x.is_finite() {
        return Err(GeometryError::NotFinite { name });
    }
    if x <= 0.0 {
        return Err(GeometryError::NotPositive { name, value: x });
    }
    Ok(x)
}

/// Returns `x` if it lies in a range, both ends included.
pub(crate) fn in_range(x: f64, name: &'static str, range: [f64; 2]) -> Result<f64, GeometryError> {
    let [least, most] = range;
    if (least..=most).contains(&x) {
        Ok(x)
    } else {
        Err(GeometryError::OutOfRange {
            name,
            value: x,
            range,
        })
    }
}

/// Returns the first point of those that are farthest in a direction.
pub(crate) fn farthest_along<const N: usize>(
    points: [DVec3; N],
    direction: DVec3,
) -> Option<DVec3> {
    let farther = |one: DVec3, other: DVec3| match other.dot(direction) > one.dot(direction) {
        true => other,
        false => one,
    };
    points.into_iter().reduce(farther)
}

/// Returns the unit vector perpendicular to the unit vector `n` that points farthest in a direction;
/// 0 if that is along `n`, so that all points around `n` are equally far.
pub(crate) fn rim(n: DVec3, direction: DVec3) -> DVec3 {
    let outward = direction - direction.dot(n) * n;
    match is_direction(outward) {
        true => unit(outward),
        false => DVec3::ZERO,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    // 0.1 + 0.2 + 0.3 differs from 0.1 + (0.2 + 0.3) in its last bit, so this detects a dot product
    // that is fused or adds in another order.
    #[test]
    fn dot_adds_from_left_to_right() {
        let v = DVec3::new(0.1, 0.2, 0.3);
        assert_eq!(
            v.dot(DVec3::ONE).to_bits(),
            ((0.1 + 0.2) + 0.3_f64).to_bits()
        );
        assert_ne!(
            v.dot(DVec3::ONE).to_bits(),
            (0.1 + (0.2 + 0.3_f64)).to_bits()
        );
    }

    // The square of 1 + 2^-30 has bits beyond an f64, which only a fused operation keeps.
    #[test]
    fn dot_and_cross_are_not_fused() {
        let a = 1.0 + f64::EPSILON * 4_194_304.0;
        let squared = a * a;
        assert_eq!(
            DVec3::new(a, -1.0, 0.0).dot(DVec3::new(a, squared, 0.0)),
            0.0
        );
        let cross = DVec3::new(a, squared, 0.0).cross(DVec3::new(1.0, a, 0.0));
        assert_eq!(cross.z, 0.0);
    }

    #[test]
    fn cross_is_right_handed() {
        assert_eq!(DVec3::X.cross(DVec3::Y), DVec3::Z);
        let v = DVec3::new(1.0, 2.0, 3.0).cross(DVec3::new(4.0, 5.0, 6.0));
        assert_eq!(v, DVec3::new(-3.0, 6.0, -3.0));
    }

    // 12 / 17 and 12 * (1 / 17) differ in the last bit.
    #[test]
    fn unit_divides() {
        let v = unit(DVec3::new(1.0, 12.0, 12.0));
        assert_eq!(v.y.to_bits(), (12.0 / 17.0_f64).to_bits());
        assert_ne!(v.y.to_bits(), (12.0 * (1.0 / 17.0_f64)).to_bits());
    }

    #[test]
    fn a_direction_has_a_usable_squared_length() {
        assert!(is_direction(DVec3::new(0.0, 1e-150, 0.0)));
        assert!(!is_direction(DVec3::ZERO));
        assert!(
            !is_direction(DVec3::new(1e-170, 0.0, 0.0)),
            "squared, it is 0"
        );
        assert!(
            !is_direction(DVec3::new(1e160, 0.0, 0.0)),
            "squared, it is infinite"
        );
        assert!(!is_direction(DVec3::NAN));
    }
}
