//! Eight f32 in one register of AVX, for both AVX2 and AVX-512.

use std::{
    arch::x86_64::*,
    ops::{Add, Div, Mul, Sub},
};

use super::{F32x8, LANES, methods, operators};

/// A vector that exists only if the processor has AVX and FMA: [`super::avx2`] and [`super::avx512`] create
/// it.
#[derive(Clone, Copy)]
pub(super) struct Float32(__m256);

impl Float32 {
    /// `x` in each lane.
    ///
    /// # Safety
    ///
    /// The processor must have AVX and FMA.
    #[inline(always)]
    pub(super) unsafe fn splat(x: f32) -> Self {
        // SAFETY: the caller's promise.
        Self(unsafe { _mm256_set1_ps(x) })
    }

    /// The lanes of an array.
    ///
    /// # Safety
    ///
    /// The processor must have AVX and FMA.
    #[inline(always)]
    pub(super) unsafe fn load(x: &[f32; LANES]) -> Self {
        // SAFETY: the caller's promise; the eight f32 read are those of the array.
        Self(unsafe { _mm256_loadu_ps(x.as_ptr()) })
    }
}

operators! {
    Float32,
    Add add _mm256_add_ps,
    Sub sub _mm256_sub_ps,
    Mul mul _mm256_mul_ps,
    Div div _mm256_div_ps,
}

impl F32x8 for Float32 {
    methods! {
        min -> Self by Self, _mm256_min_ps;
        max -> Self by Self, _mm256_max_ps;
    }

    #[inline(always)]
    fn times_plus(self, factor: Self, more: Self) -> Self {
        // SAFETY: there is no vector without the instructions.
        Self(unsafe { _mm256_fmadd_ps(self.0, factor.0, more.0) })
    }

    #[inline(always)]
    fn with_sign_of(self, other: Self) -> Self {
        // SAFETY: there is no vector without the instructions.
        Self(unsafe {
            let sign = _mm256_set1_ps(-0.0);
            let size = _mm256_andnot_ps(sign, self.0);
            _mm256_or_ps(size, _mm256_and_ps(sign, other.0))
        })
    }

    #[inline(always)]
    fn le(self, other: Self) -> u8 {
        // SAFETY: there is no vector without the instructions.
        unsafe { _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LE_OQ>(self.0, other.0)) as u8 }
    }

    #[inline(always)]
    fn store(self, to: &mut [f32; LANES]) {
        // SAFETY: there is no vector without the instructions; the array has the eight f32 that
        // are written.
        unsafe { _mm256_storeu_ps(to.as_mut_ptr(), self.0) }
    }
}
