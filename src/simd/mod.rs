//! Eight f64 at once, with the instructions that the processor has.
//!
//! A kernel is written once, over [`Simd`], and compiled for each [`Isa`](isa::Isa). Every operation is the
//! IEEE 754 one, rounded separately and never fused, so that all instruction sets give the same
//! bits, except where [`F32x8`] says so. Where an instruction set computes it in another way, a proof says why these are the same.
//!
//! Only three files, all in this module, use `unsafe`, some of it by the macros here, always on the
//! condition that the processor has the instructions. A value of [`avx2::Avx2`] or [`avx512::Avx512`] proves this: only
//! detection creates one, and only such a value creates vectors.

#[cfg(target_arch = "x86_64")]
#[allow(unsafe_code, reason = "instructions that not every processor has")]
mod avx2;
#[cfg(target_arch = "x86_64")]
#[allow(unsafe_code, reason = "instructions that not every processor has")]
mod avx512;
#[cfg(target_arch = "x86_64")]
#[allow(unsafe_code, reason = "instructions that not every processor has")]
mod float32;
pub(crate) mod isa;
#[forbid(unsafe_code)]
mod scalar;

use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};

/// Number of lanes in a vector.
pub(crate) const LANES: usize = 8;

/// An instruction set that a kernel is compiled for; it creates vectors.
pub(crate) trait Simd: Copy {
    /// Eight f64.
    type F64: F64x8<Mask = Self::Mask>;
    /// Eight booleans.
    type Mask: Mask;
    /// Eight f32.
    type F32: F32x8;

    /// Returns a vector with `x` in each lane.
    fn splat(self, x: f64) -> Self::F64;

    /// Returns the lanes of an array.
    fn load(self, x: &[f64; LANES]) -> Self::F64;

    /// Returns the lanes of an array, twice.
    fn load_twice(self, x: &[f64; LANES / 2]) -> Self::F64;

    /// Returns a vector with `x` in each lane.
    fn splat_f32(self, x: f32) -> Self::F32;

    /// Returns the lanes of an array.
    fn load_f32(self, x: &[f32; LANES]) -> Self::F32;

    /// Returns the mask whose lane i is bit i.
    fn mask(self, bits: u8) -> Self::Mask;

    /// Returns, for each lane, one of sixteen numbers: that at the place which four bits of `places` are,
    /// those of lane 0 the lowest.
    #[inline(always)]
    fn pick(self, from: [Self::F64; 2], places: u32) -> Self::F64 {
        let mut numbers = [[0.0; LANES]; 2];
        from[0].store(&mut numbers[0]);
        from[1].store(&mut numbers[1]);
        let mut picked = [0.0; LANES];
        for (lane, picked) in picked.iter_mut().enumerate() {
            *picked = numbers.as_flattened()[(places >> (4 * lane)) as usize % (2 * LANES)];
        }
        self.load(&picked)
    }

    /// Prefetches a value before its use.
    fn prefetch<T>(self, place: &T);

    /// Runs a kernel as a function of its own, with the same instructions.
    fn call<K: Kernel>(self, kernel: K) -> K::Output;
}

/// The proof of an instruction set: its detection, and kernels compiled for it.
#[cfg(target_arch = "x86_64")]
macro_rules! proof {
    ($type:ident, $all:literal, $($feature:tt),*) => {
        impl $type {
            pub(super) fn detect() -> Option<Self> {
                let all = [$(is_x86_feature_detected!($feature)),*];
                (!all.contains(&false)).then_some(Self(()))
            }

            #[inline(always)]
            pub(super) fn run<K: Kernel>(self, kernel: K) -> K::Output {
                #[target_feature(enable = $all)]
                fn with_them<K: Kernel>(simd: $type, kernel: K) -> K::Output {
                    kernel.run(simd)
                }
                // SAFETY: `self` proves that the processor has these instructions.
                unsafe { with_them(self, kernel) }
            }
        }
    };
}
#[cfg(target_arch = "x86_64")]
use proof;

/// The methods of [`Simd`] that are the same with AVX2 and AVX-512.
#[cfg(target_arch = "x86_64")]
macro_rules! same_with_both {
    () => {
        #[inline(always)]
        fn splat_f32(self, x: f32) -> Float32 {
            // SAFETY: `self` proves that the processor has AVX and FMA.
            unsafe { Float32::splat(x) }
        }

        #[inline(always)]
        fn load_f32(self, x: &[f32; LANES]) -> Float32 {
            // SAFETY: `self` proves that the processor has AVX and FMA.
            unsafe { Float32::load(x) }
        }

        #[inline(always)]
        fn prefetch<T>(self, place: &T) {
            prefetch(place);
        }

        #[inline(always)]
        fn call<K: Kernel>(self, kernel: K) -> K::Output {
            self.run(kernel)
        }
    };
}
#[cfg(target_arch = "x86_64")]
use same_with_both;

/// Methods of two vectors in one register each, by their instructions.
#[cfg(target_arch = "x86_64")]
macro_rules! methods {
    ($($name:ident -> $result:ident by $as_result:expr, $instruction:expr;)*) => {$(
        #[inline(always)]
        fn $name(self, other: Self) -> $result {
            // SAFETY: there is no vector without the proof of the instructions.
            $as_result(unsafe { $instruction(self.0, other.0) })
        }
    )*};
}
#[cfg(target_arch = "x86_64")]
use methods;

/// Operators of two vectors in one register each, by their instructions.
#[cfg(target_arch = "x86_64")]
macro_rules! operators {
    ($type:ident, $($trait:ident $name:ident $instruction:ident,)*) => {$(
        impl $trait for $type {
            type Output = Self;

            methods! { $name -> Self by Self, $instruction; }
        }
    )*};
}
#[cfg(target_arch = "x86_64")]
use operators;

/// Eight f64.
pub(crate) trait F64x8:
    Copy
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    type Mask: Mask;

    fn sqrt(self) -> Self;
    /// Returns `self < other ? self : other` for each lane: with a NaN in either, `other`.
    fn min(self, other: Self) -> Self;
    /// Returns `self > other ? self : other` for each lane: with a NaN in either, `other`.
    fn max(self, other: Self) -> Self;
    /// Compares each lane. All comparisons are false if either operand is NaN.
    fn lt(self, other: Self) -> Self::Mask;
    fn le(self, other: Self) -> Self::Mask;
    fn eq(self, other: Self) -> Self::Mask;
    /// Returns `yes` where `mask` is set, `no` elsewhere.
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self;
    fn store(self, to: &mut [f64; LANES]);
    /// Returns the largest lane; none is NaN.
    fn largest(self) -> f64;
    /// Returns the smallest lane; none is NaN.
    fn smallest(self) -> f64;
    /// Returns the quotients of vectors and their lengths.
    #[inline(always)]
    fn over_length(vectors: [Self; 3], lengths: Self) -> [Self; 3] {
        let [x, y, z] = vectors;
        [x / lengths, y / lengths, z / lengths]
    }
    /// Returns the integral part of each lane, which must fit into an i32.
    fn truncate(self) -> [i32; LANES];
}

/// Eight f32, for calculations that may be coarse.
pub(crate) trait F32x8:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self>
{
    /// Returns `self < other ? self : other` for each lane: with a NaN in either, `other`.
    fn min(self, other: Self) -> Self;
    /// Returns `self > other ? self : other` for each lane: with a NaN in either, `other`.
    fn max(self, other: Self) -> Self;
    /// Returns `self * factor + more`; the product may be rounded or not.
    fn times_plus(self, factor: Self, more: Self) -> Self;
    /// Returns the absolute values with the signs of others.
    fn with_sign_of(self, other: Self) -> Self;
    /// Returns the result of `self <= other`, lane i as bit i; false if either operand is NaN.
    fn le(self, other: Self) -> u8;
    fn store(self, to: &mut [f32; LANES]);
}

/// Eight booleans.
pub(crate) trait Mask:
    Copy + BitAnd<Output = Self> + BitOr<Output = Self> + Not<Output = Self>
{
    /// Returns lane i as bit i.
    fn bits(self) -> u8;
}

/// Lane i is bit i.
impl Mask for u8 {
    #[inline(always)]
    fn bits(self) -> u8 {
        self
    }
}

/// Work that is compiled for each instruction set.
pub(crate) trait Kernel {
    type Output;

    /// Does the work. It must be `#[inline(always)]`, and so must everything it calls with vectors:
    /// code that is not inlined is compiled without the instructions.
    fn run<S: Simd>(self, simd: S) -> Self::Output;
}
