//! Directions from pairs of numbers in lanes: the equations of [`sampling`](crate::tracer::sampling), in their order of
//! operations.

use std::f64::consts::FRAC_PI_2;

use crate::{
    accel::lanes::splat3,
    simd::{F64x8, LANES, Simd},
    tracer::sampling::{COSINE, LocalFrame, SINE},
};

/// Three unit vectors at right angles, in lanes.
pub(super) struct FrameLanes<S: Simd>([[S::F64; 3]; 3]);

impl<S: Simd> FrameLanes<S> {
    /// The same as [`LocalFrame::new`](crate::tracer::sampling::LocalFrame).
    #[inline(always)]
    pub(super) fn new(simd: S, n: [S::F64; 3]) -> Self {
        let (zero, one) = (simd.splat(0.0), simd.splat(1.0));
        let [x, y, z] = n;
        // The sign of 0 counts, too.
        let is_down = z.lt(zero) | (z.eq(zero) & (one / z).lt(zero));
        let sign = S::F64::select(is_down, -one, one);
        let a = -one / (sign + z);
        let b = x * y * a;
        Self([
            [one + sign * x * x * a, sign * b, -sign * x],
            [b, sign + y * y * a, -y],
            n,
        ])
    }

    /// The same frame in all lanes.
    #[inline(always)]
    pub(super) fn one(simd: S, frame: &LocalFrame) -> Self {
        let [x, y, z] = frame.axes();
        Self([splat3(simd, *x), splat3(simd, *y), splat3(simd, *z)])
    }

    /// Returns vectors of the frame in world space.
    #[inline(always)]
    pub(super) fn outward(&self, local: [S::F64; 3]) -> [S::F64; 3] {
        let [x, y, z] = &self.0;
        let mut sum = *z;
        for axis in 0..3 {
            sum[axis] = local[0] * x[axis] + local[1] * y[axis] + local[2] * z[axis];
        }
        sum
    }
}

/// Returns the cosine and the sine of 2πu, as [`circle`](crate::tracer::sampling::circle) does.
#[inline(always)]
pub(super) fn circle<S: Simd>(simd: S, u: S::F64) -> [S::F64; 2] {
    let (four, half, one) = (simd.splat(4.0), simd.splat(0.5), simd.splat(1.0));
    let whole = (four * u + half).truncate();
    let (mut quarters, mut turned) = ([0.0; LANES], [0_u8; 4]);
    for (lane, quarter) in whole.into_iter().enumerate() {
        quarters[lane] = f64::from(quarter);
        turned[quarter as usize % 4] |= 1 << lane;
    }
    let x = (four * u - simd.load(&quarters)) * simd.splat(FRAC_PI_2);
    let squared = x * x;
    let [mut of_sine, mut of_cosine] = [simd.splat(0.0); 2];
    for coefficient in SINE.iter().rev() {
        of_sine = (of_sine + simd.splat(*coefficient)) * squared;
    }
    for coefficient in COSINE.iter().rev() {
        of_cosine = (of_cosine + simd.splat(*coefficient)) * squared;
    }
    let (sine, cosine) = (x * (one + of_sine), one + of_cosine);
    let is_odd = simd.mask(turned[1] | turned[3]);
    let first = S::F64::select(is_odd, sine, cosine);
    let second = S::F64::select(is_odd, cosine, sine);
    [
        S::F64::select(simd.mask(turned[1] | turned[2]), -first, first),
        S::F64::select(simd.mask(turned[2] | turned[3]), -second, second),
    ]
}
