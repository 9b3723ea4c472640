//! Eight f64 in two registers of AVX2.

use std::{
    arch::x86_64::*,
    ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub},
    ptr,
};

use super::{F64x8, Kernel, LANES, Mask, Simd, float32::Float32, proof, same_with_both};

/// The proof that the processor has AVX2.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Avx2(());

#[derive(Clone, Copy)]
pub(super) struct Vector(__m256d, __m256d);

/// Lanes of all ones or all zeros.
#[derive(Clone, Copy)]
pub(super) struct Lanes(__m256d, __m256d);

/// Prefetches every cache line that holds a part of a value.
#[inline(always)]
pub(super) fn prefetch<T>(place: &T) {
    const LINE: usize = 64;
    let first: *const i8 = ptr::from_ref(place).cast();
    let mut from = 0;
    while from < size_of::<T>() {
        // SAFETY: a prefetch reads nothing, and every x86-64 processor has it.
        unsafe { _mm_prefetch::<_MM_HINT_T0>(first.wrapping_add(from)) }
        from += LINE;
    }
    // One that is no larger than its alignment is in a single line.
    if align_of::<T>() < LINE.min(size_of::<T>()) {
        let last = first.wrapping_add(size_of::<T>().saturating_sub(1));
        // SAFETY: as above.
        unsafe { _mm_prefetch::<_MM_HINT_T0>(last) }
    }
}

proof!(
    Avx2,
    "avx2,fma,bmi1,bmi2,lzcnt,popcnt",
    "avx2",
    "fma",
    "bmi1",
    "bmi2",
    "lzcnt",
    "popcnt"
);

impl Simd for Avx2 {
    type F64 = Vector;
    type Mask = Lanes;
    type F32 = Float32;

    #[inline(always)]
    fn splat(self, x: f64) -> Vector {
        // SAFETY: `self` proves that the processor has the instruction.
        let half = unsafe { _mm256_set1_pd(x) };
        Vector(half, half)
    }

    #[inline(always)]
    fn load(self, x: &[f64; LANES]) -> Vector {
        // SAFETY: as above; the eight f64 read are those of the array.
        unsafe {
            Vector(
                _mm256_loadu_pd(x.as_ptr()),
                _mm256_loadu_pd(x.as_ptr().add(4)),
            )
        }
    }

    #[inline(always)]
    fn load_twice(self, x: &[f64; LANES / 2]) -> Vector {
        // SAFETY: as above; the four f64 read are those of the array.
        let half = unsafe { _mm256_loadu_pd(x.as_ptr()) };
        Vector(half, half)
    }

    #[inline(always)]
    fn mask(self, bits: u8) -> Lanes {
        // SAFETY: as above.
        unsafe {
            let lane = _mm256_setr_epi64x(1, 2, 4, 8);
            let half = |bits: u8| {
                let bits = _mm256_and_si256(_mm256_set1_epi64x(bits.into()), lane);
                _mm256_castsi256_pd(_mm256_cmpeq_epi64(bits, lane))
            };
            Lanes(half(bits), half(bits >> 4))
        }
    }

    same_with_both!();
}

/// Methods of two values that apply an instruction to each of their halves.
macro_rules! each_half {
    ($($name:ident -> $result:ident = $instruction:expr;)*) => {$(
        #[inline(always)]
        fn $name(self, other: Self) -> $result {
            // SAFETY: there is no vector or mask without the proof of the instructions.
            unsafe { $result($instruction(self.0, other.0), $instruction(self.1, other.1)) }
        }
    )*};
}

/// A binary operator by its instruction.
macro_rules! operator {
    ($type:ident, $trait:ident, $name:ident, $instruction:ident) => {
        impl $trait for $type {
            type Output = Self;

            each_half! { $name -> Self = $instruction; }
        }
    };
}

operator!(Vector, Add, add, _mm256_add_pd);
operator!(Vector, Sub, sub, _mm256_sub_pd);
operator!(Vector, Mul, mul, _mm256_mul_pd);
operator!(Vector, Div, div, _mm256_div_pd);
operator!(Lanes, BitAnd, bitand, _mm256_and_pd);
operator!(Lanes, BitOr, bitor, _mm256_or_pd);

impl Neg for Vector {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        // SAFETY: there is no vector without the proof of the instructions.
        unsafe {
            let sign = _mm256_set1_pd(-0.0);
            Self(_mm256_xor_pd(self.0, sign), _mm256_xor_pd(self.1, sign))
        }
    }
}

// SAFETY of all below: there is no vector without the proof of the instructions, and `store`
// writes the eight f64 of its array.
impl F64x8 for Vector {
    type Mask = Lanes;

    #[inline(always)]
    fn sqrt(self) -> Self {
        // SAFETY: see above.
        unsafe { Self(_mm256_sqrt_pd(self.0), _mm256_sqrt_pd(self.1)) }
    }

    each_half! {
        min -> Self = _mm256_min_pd;
        max -> Self = _mm256_max_pd;
        lt -> Lanes = _mm256_cmp_pd::<_CMP_LT_OQ>;
        le -> Lanes = _mm256_cmp_pd::<_CMP_LE_OQ>;
        eq -> Lanes = _mm256_cmp_pd::<_CMP_EQ_OQ>;
    }

    #[inline(always)]
    fn select(mask: Lanes, yes: Self, no: Self) -> Self {
        // SAFETY: see above.
        unsafe {
            Self(
                _mm256_blendv_pd(no.0, yes.0, mask.0),
                _mm256_blendv_pd(no.1, yes.1, mask.1),
            )
        }
    }

    #[inline(always)]
    fn store(self, to: &mut [f64; LANES]) {
        // SAFETY: see above.
        unsafe {
            _mm256_storeu_pd(to.as_mut_ptr(), self.0);
            _mm256_storeu_pd(to.as_mut_ptr().add(4), self.1);
        }
    }

    #[inline(always)]
    fn largest(self) -> f64 {
        // SAFETY: see above.
        unsafe {
            let four = _mm256_max_pd(self.0, self.1);
            let two = _mm_max_pd(
                _mm256_castpd256_pd128(four),
                _mm256_extractf128_pd::<1>(four),
            );
            _mm_cvtsd_f64(_mm_max_sd(two, _mm_unpackhi_pd(two, two)))
        }
    }

    #[inline(always)]
    fn smallest(self) -> f64 {
        // SAFETY: see above.
        unsafe {
            let four = _mm256_min_pd(self.0, self.1);
            let two = _mm_min_pd(
                _mm256_castpd256_pd128(four),
                _mm256_extractf128_pd::<1>(four),
            );
            _mm_cvtsd_f64(_mm_min_sd(two, _mm_unpackhi_pd(two, two)))
        }
    }

    #[inline(always)]
    fn truncate(self) -> [i32; LANES] {
        let mut lanes = [0; LANES];
        // SAFETY: see above; the array has the eight i32 that are written.
        unsafe {
            let to: *mut __m128i = lanes.as_mut_ptr().cast();
            _mm_storeu_si128(to, _mm256_cvttpd_epi32(self.0));
            _mm_storeu_si128(to.add(1), _mm256_cvttpd_epi32(self.1));
        }
        lanes
    }
}

impl Not for Lanes {
    type Output = Self;

    #[inline(always)]
    fn not(self) -> Self {
        // SAFETY: there is no mask without the proof of the instructions.
        unsafe {
            let ones = _mm256_castsi256_pd(_mm256_set1_epi64x(-1));
            Self(_mm256_xor_pd(self.0, ones), _mm256_xor_pd(self.1, ones))
        }
    }
}

impl Mask for Lanes {
    #[inline(always)]
    fn bits(self) -> u8 {
        // SAFETY: there is no mask without the proof of the instructions.
        unsafe { (_mm256_movemask_pd(self.0) | _mm256_movemask_pd(self.1) << 4) as u8 }
    }
}
