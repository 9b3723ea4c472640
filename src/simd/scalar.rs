//! Eight f64 in an array: for every processor, and the yardstick of the others.

use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};

use super::{F32x8, F64x8, LANES, Mask, Simd};

#[derive(Clone, Copy)]
pub(super) struct Scalar;

#[derive(Clone, Copy)]
pub(super) struct Vector([f64; LANES]);

#[derive(Clone, Copy)]
pub(super) struct Float32([f32; LANES]);

/// Lane i is bit i.
#[derive(Clone, Copy)]
pub(super) struct Bits(u8);

impl Simd for Scalar {
    type F64 = Vector;
    type Mask = Bits;
    type F32 = Float32;

    #[inline(always)]
    fn splat(self, x: f64) -> Vector {
        Vector([x; LANES])
    }

    #[inline(always)]
    fn load(self, x: &[f64; LANES]) -> Vector {
        Vector(*x)
    }

    #[inline(always)]
    fn load_twice(self, x: &[f64; LANES / 2]) -> Vector {
        Vector(std::array::from_fn(|lane| x[lane % x.len()]))
    }

    #[inline(always)]
    fn splat_f32(self, x: f32) -> Float32 {
        Float32([x; LANES])
    }

    #[inline(always)]
    fn load_f32(self, x: &[f32; LANES]) -> Float32 {
        Float32(*x)
    }

    #[inline(always)]
    fn prefetch<T>(self, _place: &T) {}
}

impl Vector {
    #[inline(always)]
    fn with(self, other: Self, of: impl Fn(f64, f64) -> f64) -> Self {
        let mut lanes = self.0;
        for (lane, other) in lanes.iter_mut().zip(other.0) {
            *lane = of(*lane, other);
        }
        Self(lanes)
    }

    #[inline(always)]
    fn compare(self, other: Self, of: impl Fn(f64, f64) -> bool) -> Bits {
        let mut bits = 0;
        for (lane, (a, b)) in self.0.into_iter().zip(other.0).enumerate() {
            bits |= u8::from(of(a, b)) << lane;
        }
        Bits(bits)
    }
}

impl Add for Vector {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        self.with(other, |a, b| a + b)
    }
}

impl Sub for Vector {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self.with(other, |a, b| a - b)
    }
}

impl Mul for Vector {
    type Output = Self;

    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        self.with(other, |a, b| a * b)
    }
}

impl Div for Vector {
    type Output = Self;

    #[inline(always)]
    fn div(self, other: Self) -> Self {
        self.with(other, |a, b| a / b)
    }
}

impl Neg for Vector {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        Self(self.0.map(|a| -a))
    }
}

impl F64x8 for Vector {
    type Mask = Bits;

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
    fn lt(self, other: Self) -> Bits {
        self.compare(other, |a, b| a < b)
    }

    #[inline(always)]
    fn le(self, other: Self) -> Bits {
        self.compare(other, |a, b| a <= b)
    }

    #[inline(always)]
    fn eq(self, other: Self) -> Bits {
        self.compare(other, |a, b| a == b)
    }

    #[inline(always)]
    fn select(mask: Bits, yes: Self, no: Self) -> Self {
        let mut lanes = yes.0;
        for (lane, (to, no)) in lanes.iter_mut().zip(no.0).enumerate() {
            if mask.0 >> lane & 1 == 0 {
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
    fn truncate(self) -> [i32; LANES] {
        self.0.map(|x| x as i32)
    }
}

impl BitAnd for Bits {
    type Output = Self;

    #[inline(always)]
    fn bitand(self, other: Self) -> Self {
        Self(self.0 & other.0)
    }
}

impl BitOr for Bits {
    type Output = Self;

    #[inline(always)]
    fn bitor(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }
}

impl Not for Bits {
    type Output = Self;

    #[inline(always)]
    fn not(self) -> Self {
        Self(!self.0)
    }
}

impl Mask for Bits {
    #[inline(always)]
    fn bits(self) -> u8 {
        self.0
    }
}

impl Float32 {
    #[inline(always)]
    fn with(self, other: Self, of: impl Fn(f32, f32) -> f32) -> Self {
        let mut lanes = self.0;
        for (lane, other) in lanes.iter_mut().zip(other.0) {
            *lane = of(*lane, other);
        }
        Self(lanes)
    }
}

impl Add for Float32 {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        self.with(other, |a, b| a + b)
    }
}

impl Sub for Float32 {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self.with(other, |a, b| a - b)
    }
}

impl Mul for Float32 {
    type Output = Self;

    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        self.with(other, |a, b| a * b)
    }
}

impl F32x8 for Float32 {
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        self.with(other, |a, b| if a < b { a } else { b })
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        self.with(other, |a, b| if a > b { a } else { b })
    }

    #[inline(always)]
    fn le(self, other: Self) -> u8 {
        let mut bits = 0;
        for (lane, (a, b)) in self.0.into_iter().zip(other.0).enumerate() {
            bits |= u8::from(a <= b) << lane;
        }
        bits
    }

    #[inline(always)]
    fn store(self, to: &mut [f32; LANES]) {
        *to = self.0;
    }
}
