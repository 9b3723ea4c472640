//! Eight f64 in one register of AVX-512.

use std::{
    arch::x86_64::*,
    convert::identity,
    ops::{Add, Div, Mul, Neg, Sub},
};

use super::{
    F64x8, Kernel, LANES, Simd, avx2::prefetch, float32::Float32, methods, operators, proof,
    same_with_both,
};

/// The proof that the processor has AVX-512 F, DQ, BW and VL.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Avx512(());

#[derive(Clone, Copy)]
pub(super) struct Vector(__m512d);

/// The range of numbers whose quotients, and the rests of those, lose no digits.
const LEAST: f64 = 1e-100;
const MOST: f64 = 1e100;

proof!(
    Avx512,
    "avx512f,avx512dq,avx512bw,avx512vl,fma,bmi1,bmi2,lzcnt,popcnt",
    "avx512f",
    "avx512dq",
    "avx512bw",
    "avx512vl",
    "fma",
    "bmi1",
    "bmi2",
    "lzcnt",
    "popcnt"
);

impl Simd for Avx512 {
    type F64 = Vector;
    type Mask = __mmask8;
    type F32 = Float32;

    #[inline(always)]
    fn splat(self, x: f64) -> Vector {
        // SAFETY: `self` proves that the processor has the instruction.
        Vector(unsafe { _mm512_set1_pd(x) })
    }

    #[inline(always)]
    fn load(self, x: &[f64; LANES]) -> Vector {
        // SAFETY: as above; the eight f64 read are those of the array.
        Vector(unsafe { _mm512_loadu_pd(x.as_ptr()) })
    }

    #[inline(always)]
    fn load_twice(self, x: &[f64; LANES / 2]) -> Vector {
        // SAFETY: as above; the four f64 read are those of the array.
        Vector(unsafe { _mm512_broadcast_f64x4(_mm256_loadu_pd(x.as_ptr())) })
    }

    #[inline(always)]
    fn mask(self, bits: u8) -> __mmask8 {
        bits
    }

    #[inline(always)]
    fn pick(self, [low, high]: [Vector; 2], places: u32) -> Vector {
        // SAFETY: `self` proves that the processor has the instructions. The permutation takes the four
        // lowest bits of each index.
        unsafe {
            let bits = _mm512_setr_epi64(0, 4, 8, 12, 16, 20, 24, 28);
            let places = _mm512_srlv_epi64(_mm512_set1_epi64(places.into()), bits);
            Vector(_mm512_permutex2var_pd(low.0, places, high.0))
        }
    }

    same_with_both!();
}

operators! {
    Vector,
    Add add _mm512_add_pd,
    Sub sub _mm512_sub_pd,
    Mul mul _mm512_mul_pd,
    Div div _mm512_div_pd,
}

impl Neg for Vector {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        // SAFETY: there is no vector without the proof of the instructions.
        Self(unsafe { _mm512_xor_pd(self.0, _mm512_set1_pd(-0.0)) })
    }
}

// SAFETY of all below: there is no vector without the proof of the instructions, and `store`
// writes the eight f64 of its array.
impl F64x8 for Vector {
    type Mask = __mmask8;

    #[inline(always)]
    fn sqrt(self) -> Self {
        // SAFETY: see above.
        Self(unsafe { _mm512_sqrt_pd(self.0) })
    }

    methods! {
        min -> Self by Self, _mm512_min_pd;
        max -> Self by Self, _mm512_max_pd;
        lt -> __mmask8 by identity, _mm512_cmp_pd_mask::<_CMP_LT_OQ>;
        le -> __mmask8 by identity, _mm512_cmp_pd_mask::<_CMP_LE_OQ>;
        eq -> __mmask8 by identity, _mm512_cmp_pd_mask::<_CMP_EQ_OQ>;
    }

    #[inline(always)]
    fn select(mask: __mmask8, yes: Self, no: Self) -> Self {
        // SAFETY: see above.
        Self(unsafe { _mm512_mask_blend_pd(mask, no.0, yes.0) })
    }

    #[inline(always)]
    fn store(self, to: &mut [f64; LANES]) {
        // SAFETY: see above.
        unsafe { _mm512_storeu_pd(to.as_mut_ptr(), self.0) }
    }

    #[inline(always)]
    fn largest(self) -> f64 {
        // SAFETY: see above.
        unsafe { _mm512_reduce_max_pd(self.0) }
    }

    #[inline(always)]
    fn smallest(self) -> f64 {
        // SAFETY: see above.
        unsafe { _mm512_reduce_min_pd(self.0) }
    }

    /// Divides once. With y, the reciprocal of b rounded to the nearest number, and a quotient q of
    /// a and b that is off by at most one unit in the last place, `q + (a - b·q)·y` rounds to the same
    /// number as a/b if both operations are fused (Markstein, 1990, theorem 8). The first such step
    /// brings `a·y` close enough for that. All numbers are far from those that lose digits.
    #[inline(always)]
    fn over_length(vectors: [Self; 3], lengths: Self) -> [Self; 3] {
        let [x, y, z] = vectors;
        // SAFETY: see above.
        unsafe {
            let least = _mm512_set1_pd(LEAST);
            let smallest = _mm512_min_pd(_mm512_abs_pd(x.0), _mm512_abs_pd(y.0));
            let smallest = _mm512_min_pd(smallest, _mm512_abs_pd(z.0));
            let is_near = _mm512_cmp_pd_mask::<_CMP_GE_OQ>(smallest, least)
                & _mm512_cmp_pd_mask::<_CMP_LE_OQ>(lengths.0, _mm512_set1_pd(MOST));
            if is_near != u8::MAX {
                return [x / lengths, y / lengths, z / lengths];
            }
            let reciprocal = _mm512_div_pd(_mm512_set1_pd(1.0), lengths.0);
            let over = |a: __m512d| {
                let step = |q| {
                    let rest = _mm512_fnmadd_pd(lengths.0, q, a);
                    _mm512_fmadd_pd(rest, reciprocal, q)
                };
                Self(step(step(_mm512_mul_pd(a, reciprocal))))
            };
            [over(x.0), over(y.0), over(z.0)]
        }
    }

    #[inline(always)]
    fn truncate(self) -> [i32; LANES] {
        let mut lanes = [0; LANES];
        // SAFETY: see above; the array has the eight i32 that are written.
        unsafe {
            let integers = _mm512_cvttpd_epi32(self.0);
            _mm256_storeu_si256(lanes.as_mut_ptr().cast(), integers);
        }
        lanes
    }
}
