//! The intersection equations for eight rays at a time: the textbook's formulas, in their order of
//! operations.

use glam::DVec3;

use crate::{
    simd::{F64x8, LANES, Mask, Simd},
    tracer::shape::around::{Around, GROWTH, Near, ORDINARY_LENGTHS, ROUNDING},
};

/// The division in the solutions of quadratic equations.
pub(super) trait Divide<S: Simd> {
    /// Returns `x/2A`.
    #[inline(always)]
    fn over_2a(&self, simd: S, x: S::F64, a: S::F64) -> S::F64 {
        x / (simd.splat(2.0) * a)
    }
}

/// Returns the smallest `t` with `0 < t < ∞` that solves `A·t² + B·t + C = 0`, and the lanes that
/// have one; `None` if no lane has a discriminant of at least `lowest`, which is at most 0. Same as
/// [`Sphere::intersect`].
#[inline(always)]
pub(super) fn first_root<S: Simd, D: Divide<S>>(
    simd: S,
    divide: &D,
    a: S::F64,
    (b, c): (S::F64, S::F64),
    lowest: S::F64,
) -> Option<(S::F64, S::Mask)> {
    let (zero, infinity) = (simd.splat(0.0), simd.splat(f64::INFINITY));
    let discriminant = b * b - (simd.splat(4.0) * a) * c;
    if lowest.le(discriminant).bits() == 0 {
        return None;
    }
    let meets = zero.le(discriminant);
    let root = discriminant.sqrt();
    let mut found = divide.over_2a(simd, -b - root, a);
    let mut counts = zero.lt(found) & found.lt(infinity);
    let leaving = meets & !counts;
    if leaving.bits() != 0 {
        let far = divide.over_2a(simd, -b + root, a);
        let leaving = leaving & zero.lt(far) & far.lt(infinity);
        found = S::F64::select(leaving, far, found);
        counts = counts | leaving;
    }
    Some((found, counts))
}

#[inline(always)]
pub(crate) fn splat3<S: Simd>(simd: S, v: DVec3) -> [S::F64; 3] {
    [simd.splat(v.x), simd.splat(v.y), simd.splat(v.z)]
}

#[inline(always)]
pub(crate) fn load3<S: Simd>(simd: S, axes: &[[f64; LANES]; 3]) -> [S::F64; 3] {
    [
        simd.load(&axes[0]),
        simd.load(&axes[1]),
        simd.load(&axes[2]),
    ]
}

/// Stores vectors by axis.
#[inline(always)]
pub(crate) fn store3<V: F64x8>(vectors: [V; 3], to: &mut [[f64; LANES]; 3]) {
    for (axis, to) in vectors.into_iter().zip(to) {
        axis.store(to);
    }
}

/// Returns the absolute value; 0 of either sign for 0.
#[inline(always)]
pub(crate) fn abs<V: F64x8>(x: V) -> V {
    x.max(-x)
}

/// Returns `(a.x·b.x + a.y·b.y) + a.z·b.z`.
#[inline(always)]
pub(crate) fn dot<V: F64x8>(a: [V; 3], b: [V; 3]) -> V {
    (a[0] * b[0] + a[1] * b[1]) + a[2] * b[2]
}

#[inline(always)]
pub(crate) fn sub<V: F64x8>(a: [V; 3], b: [V; 3]) -> [V; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// Returns what vectors have across an axis: `v - (v·w)·w`.
#[inline(always)]
pub(crate) fn across<V: F64x8>(v: [V; 3], w: [V; 3]) -> [V; 3] {
    let along = dot(v, w);
    [
        v[0] - along * w[0],
        v[1] - along * w[1],
        v[2] - along * w[2],
    ]
}

/// Returns `v/|v|`.
#[inline(always)]
pub(crate) fn unit<V: F64x8>(v: [V; 3]) -> [V; 3] {
    V::over_length(v, dot(v, v).sqrt())
}

/// Returns lanes in which the rays' points at `t` lie in a box and a ball: all but a few, found in the
/// same way as by [`Around::holds`](crate::tracer::shape::around::Around::holds).
#[inline(always)]
pub(super) fn surely_holds<S: Simd>(
    simd: S,
    near: &Near,
    [origins, [x, y, z]]: [[S::F64; 3]; 2],
    t: S::F64,
) -> S::Mask {
    let from = sub(origins, splat3(simd, near.center));
    let point = [from[0] + t * x, from[1] + t * y, from[2] + t * z];
    let slack = abs(from[0]).max(abs(from[1])).max(abs(from[2])) * simd.splat(GROWTH);
    let (low, high) = (splat3(simd, near.low), splat3(simd, near.high));
    let mut holds = dot(point, point).le(simd.splat(near.squared));
    for axis in 0..3 {
        let is_above = low[axis].le(point[axis] + slack);
        holds = holds & is_above & (point[axis] - slack).le(high[axis]);
    }
    holds
}

/// Returns the rays that may meet a shape in the box of an [`Around`] with `0 < t < t_max`: those of
/// [`Around::may_meet`], and maybe others.
#[inline(always)]
pub(super) fn may_meet<S: Simd>(
    simd: S,
    around: &Around,
    [origins, directions]: [[S::F64; 3]; 2],
    t_max: S::F64,
) -> u8 {
    let (center, [low, high], radius) = around.middle();
    let most = low.abs().max(high.abs()) + center.abs();
    let from = sub(origins, splat3(simd, center));
    let reach = abs(from[0]).max(abs(from[1])).max(abs(from[2]));
    let reach = reach.max(simd.splat(radius));
    let length = dot(directions, directions).sqrt();
    let [least, longest] = [ORDINARY_LENGTHS.start(), ORDINARY_LENGTHS.end()];
    let (least, longest) = (simd.splat(*least), simd.splat(*longest));
    let ordinary = least.le(reach.min(length)) & reach.max(length).le(longest);
    let origin = abs(origins[0]).max(abs(origins[1])).max(abs(origins[2]));
    let most = origin.max(simd.splat(most.max_element()));
    let slack = simd.splat(20.0 * GROWTH) * reach + simd.splat(4.0 * ROUNDING) * most;
    let (low, high) = (splat3(simd, low), splat3(simd, high));
    let (mut near, mut far) = (simd.splat(0.0), t_max);
    for axis in 0..3 {
        let inverse = simd.splat(1.0) / directions[axis];
        let one = ((low[axis] - slack) - from[axis]) * inverse;
        let other = ((high[axis] + slack) - from[axis]) * inverse;
        // NaN excludes nothing: of it and another number, that is taken.
        near = one.min(other).max(near);
        far = one.max(other).min(far);
    }
    (near.le(far) | !ordinary).bits()
}

/// Returns the positions of the set bits of a mask.
#[inline(always)]
pub(crate) fn bits(mask: impl Into<u32>) -> impl Iterator<Item = usize> {
    let mut mask = mask.into();
    std::iter::from_fn(move || {
        let bit = mask.trailing_zeros();
        mask &= mask.wrapping_sub(1);
        (bit < u32::BITS).then_some(bit as usize)
    })
}
