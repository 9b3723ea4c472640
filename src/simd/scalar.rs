//! Eight numbers in an array: for every processor, and the reference for the other instruction sets.

use std::ops::{Add, Div, Mul, Neg, Sub};

use super::{F32x8, F64x8, Kernel, LANES, Simd};

#[derive(Clone, Copy)]
pub(super) struct Scalar;

/// Eight numbers of one type.
#[derive(Clone, Copy)]
pub(super) struct Lanes<T>([T; LANES]);

impl Simd for Scalar {
    type F64 = Lanes<f64>;
    type Mask = u8;
    type F32 = Lanes<f32>;

    #[inline(always)]
    fn splat(self, x: f64) -> Lanes<f64> {
        Lanes([x; LANES])
    }

    #[inline(always)]
    fn load(self, x: &[f64; LANES]) -> Lanes<f64> {
        Lanes(*x)
    }

    #[inline(always)]
    fn load_twice(self, x: &[f64; LANES / 2]) -> Lanes<f64> {
        Lanes(std::array::from_fn(|lane| x[lane % x.len()]))
    }

    #[inline(always)]
    fn splat_f32(self, x: f32) -> Lanes<f32> {
        Lanes([x; LANES])
    }

    #[inline(always)]
    fn load_f32(self, x: &[f32; LANES]) -> Lanes<f32> {
        Lanes(*x)
    }

    #[inline(always)]
    fn mask(self, bits: u8) -> u8 {
        bits
    }

    #[inline(always)]
    fn prefetch<T>(self, _place: &T) {}

    #[inline(always)]
    fn call<K: Kernel>(self, kernel: K) -> K::Output {
        kernel.run(self)
    }
}

impl<T: Copy> Lanes<T> {
    #[inline(always)]
    fn with(self, other: Self, of: impl Fn(T, T) -> T) -> Self {
        let mut lanes = self.0;
        for (lane, other) in lanes.iter_mut().zip(other.0) {
            *lane = of(*lane, other);
        }
        Self(lanes)
    }

    /// Returns the results of a comparison, lane i as bit i.
    #[inline(always)]
    fn compare(self, other: Self, of: impl Fn(&T, &T) -> bool) -> u8 {
        let mut bits = 0;
        for (lane, (a, b)) in self.0.iter().zip(&other.0).enumerate() {
            bits |= u8::from(of(a, b)) << lane;
        }
        bits
    }
}

/// A binary operator of each lane.
macro_rules! operator {
    ($trait:ident, $name:ident) => {
        impl<T: Copy + $trait<Output = T>> $trait for Lanes<T> {
            type Output = Self;

            #[inline(always)]
            fn $name(self, other: Self) -> Self {
                self.with(other, T::$name)
            }
        }
    };
}

operator!(Add, add);
operator!(Sub, sub);
operator!(Mul, mul);
operator!(Div, div);

impl Neg for Lanes<f64> {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        Self(self.0.map(f64::neg))
    }
}

impl F64x8 for Lanes<f64> {
    type Mask = u8;

    #[inline(always)]
    fn sqrt(self) -> Self {
        Self(self.0.map(f64::sqrt))
    }

    #[inline(always)]
    fn min(self, other: Self) -> Self {
        self.with(other, |a, b| if a < b { a } else { b })
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        self.with(other, |a, b| if a > b { a } else { b })
    }

    #[inline(always)]
    fn lt(self, other: Self) -> u8 {
        self.compare(other, f64::lt)
    }

    #[inline(always)]
    fn le(self, other: Self) -> u8 {
        self.compare(other, f64::le)
    }

    #[inline(always)]
    fn eq(self, other: Self) -> u8 {
        self.compare(other, f64::eq)
    }

    #[inline(always)]
    fn select(mask: u8, yes: Self, no: Self) -> Self {
        let mut lanes = yes.0;
        for (lane, (to, no)) in lanes.iter_mut().zip(no.0).enumerate() {
            if mask >> lane & 1 == 0 {
                *to = no;
            }
        }
        Self(lanes)
    }

    #[inline(always)]
    fn store(self, to: &mut [f64; LANES]) {
        *to = self.0;
    }

    #[inline(always)]
    fn largest(self) -> f64 {
        self.0.into_iter().fold(f64::NEG_INFINITY, f64::max)
    }

    #[inline(always)]
    fn smallest(self) -> f64 {
        self.0.into_iter().fold(f64::INFINITY, f64::min)
    }

    #[inline(always)]
    fn truncate(self) -> [i32; LANES] {
        self.0.map(|x| x as i32)
    }
}

impl F32x8 for Lanes<f32> {
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        self.with(other, |a, b| if a < b { a } else { b })
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        self.with(other, |a, b| if a > b { a } else { b })
    }

    #[inline(always)]
    fn times_plus(self, factor: Self, more: Self) -> Self {
        self * factor + more
    }

    #[inline(always)]
    fn with_sign_of(self, other: Self) -> Self {
        self.with(other, f32::copysign)
    }

    #[inline(always)]
    fn le(self, other: Self) -> u8 {
        self.compare(other, f32::le)
    }

    #[inline(always)]
    fn store(self, to: &mut [f32; LANES]) {
        *to = self.0;
    }
}
