//! Eight f64 at once, with the instructions that the processor has.
//!
//! A kernel is written once, over [`Simd`], and compiled for each [`Isa`]. Every operation is the
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
#[forbid(unsafe_code)]
mod scalar;

use std::{
    fmt::{self, Debug},
    ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub},
    str::FromStr,
};

use self::scalar::Scalar;

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

/// An instruction set that this processor has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Isa(Known);

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Known {
    Scalar,
    #[cfg(target_arch = "x86_64")]
    Avx2(avx2::Avx2),
    #[cfg(target_arch = "x86_64")]
    Avx512(avx512::Avx512),
}

impl Isa {
    /// Returns all instruction sets that this processor has, the best last.
    pub fn all() -> Vec<Self> {
        [
            Some(Known::Scalar),
            #[cfg(target_arch = "x86_64")]
            avx2::Avx2::detect().map(Known::Avx2),
            #[cfg(target_arch = "x86_64")]
            avx512::Avx512::detect().map(Known::Avx512),
        ]
        .into_iter()
        .flatten()
        .map(Self)
        .collect()
    }

    /// Returns the best instruction set that this processor has.
    pub fn best() -> Self {
        #[cfg(target_arch = "x86_64")]
        {
            if let Some(found) = avx512::Avx512::detect() {
                return Self(Known::Avx512(found));
            }
            if let Some(found) = avx2::Avx2::detect() {
                return Self(Known::Avx2(found));
            }
        }
        Self(Known::Scalar)
    }

    /// Returns the name: `scalar`, `avx2` or `avx512`.
    pub const fn name(self) -> &'static str {
        match self.0 {
            Known::Scalar => "scalar",
            #[cfg(target_arch = "x86_64")]
            Known::Avx2(_) => "avx2",
            #[cfg(target_arch = "x86_64")]
            Known::Avx512(_) => "avx512",
        }
    }

    /// Runs a kernel with these instructions.
    #[inline]
    pub(crate) fn run<K: Kernel>(self, kernel: K) -> K::Output {
        match self.0 {
            Known::Scalar => run_scalar(kernel),
            #[cfg(target_arch = "x86_64")]
            Known::Avx2(found) => found.run(kernel),
            #[cfg(target_arch = "x86_64")]
            Known::Avx512(found) => found.run(kernel),
        }
    }
}

/// Runs a kernel apart from the choice of instructions, which is short without it.
#[inline(never)]
fn run_scalar<K: Kernel>(kernel: K) -> K::Output {
    kernel.run(Scalar)
}

impl Default for Isa {
    fn default() -> Self {
        Self::best()
    }
}

impl fmt::Display for Isa {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for Isa {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, String> {
        let all = Self::all();
        let found = all.iter().find(|isa| isa.name() == name);
        found.copied().ok_or_else(|| {
            let names: Vec<_> = all.iter().map(|isa| isa.name()).collect();
            format!("this processor has {}", names.join(", "))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tracer::random::{Rng, cases};

    const NUMBERS: [f64; 12] = [
        0.0,
        -0.0,
        1.0,
        -1.5,
        0.1,
        3e-310,
        -7.3e250,
        1e300,
        f64::INFINITY,
        f64::NEG_INFINITY,
        f64::NAN,
        12345.678,
    ];

    /// Every operation on two vectors, as bits.
    struct All([f64; LANES], [f64; LANES]);

    impl Kernel for All {
        type Output = Vec<u64>;

        #[inline(always)]
        fn run<S: Simd>(self, simd: S) -> Vec<u64> {
            let (a, b) = (simd.load(&self.0), simd.load(&self.1));
            let mut bits = Vec::new();
            let small = S::F64::select((a * a).lt(simd.splat(1e18)), a, simd.splat(7.9));
            for vector in [
                a + b,
                a - b,
                a * b,
                a / b,
                -a,
                a.sqrt(),
                a.min(b),
                a.max(b),
                S::F64::select(a.lt(b), a, simd.splat(2.0)),
                S::F64::select(!(a.le(b) | a.eq(b)), a, b),
            ] {
                let mut lanes = [0.0; LANES];
                vector.store(&mut lanes);
                // IEEE 754 leaves only the bits of a NaN open.
                bits.extend(lanes.map(|x| if x.is_nan() { 1 } else { x.to_bits() }));
            }
            for mask in [
                a.lt(b),
                a.le(b),
                a.eq(b),
                !a.lt(b),
                a.lt(b) & b.lt(a),
                a.lt(b) | b.lt(a),
            ] {
                bits.push(mask.bits().into());
            }
            let number = |x: S::F64| S::F64::select(x.le(x), x, simd.splat(-3.0));
            bits.push(number(a).largest().to_bits());
            bits.push(number(a).smallest().to_bits());
            bits.extend((0..=u8::MAX).map(|bits| u64::from(simd.mask(bits).bits())));
            bits.extend(small.truncate().map(|x| x as u64));
            let float = |x: f64| x as f32;
            let (a, b) = (self.0.map(float), self.1.map(float));
            let (a, b) = (simd.load_f32(&a), simd.load_f32(&b));
            for vector in [
                a + b,
                a - b,
                a * b,
                a / b,
                a.min(b),
                a.max(b),
                a.with_sign_of(b),
                simd.splat_f32(0.1),
            ] {
                let mut lanes = [0.0; LANES];
                vector.store(&mut lanes);
                bits.extend(lanes.map(|x| if x.is_nan() { 1 } else { x.to_bits().into() }));
            }
            bits.push(a.le(b).into());
            for places in [0x7654_3210, 0xfedc_ba98, 0x08f3_3c19] {
                let mut lanes = [0.0; LANES];
                let doubled = small + small;
                simd.pick([small, doubled], places).store(&mut lanes);
                bits.extend(lanes.map(f64::to_bits));
            }
            bits
        }
    }

    #[test]
    fn all_instruction_sets_give_the_same_bits() {
        for shift in 0..NUMBERS.len() {
            for turn in 0..NUMBERS.len() {
                let number = |at: usize| NUMBERS[at % NUMBERS.len()];
                let a = std::array::from_fn(|lane| number(lane + shift));
                let b = std::array::from_fn(|lane| number(lane * 5 + turn));
                let expected = Isa(Known::Scalar).run(All(a, b));
                for isa in Isa::all() {
                    assert_eq!(isa.run(All(a, b)), expected, "{}: {a:?} {b:?}", isa.name());
                }
            }
        }
    }

    /// Vectors divided by their lengths, as bits.
    struct Units([[f64; LANES]; 3]);

    impl Kernel for Units {
        type Output = [[u64; LANES]; 4];

        #[inline(always)]
        fn run<S: Simd>(self, simd: S) -> [[u64; LANES]; 4] {
            let [x, y, z] = self.0.map(|lanes| simd.load(&lanes));
            let lengths = (x * x + y * y + z * z).sqrt();
            let [x, y, z] = S::F64::over_length([x, y, z], lengths);
            [x, y, z, lengths].map(|vector| {
                let mut lanes = [0.0; LANES];
                vector.store(&mut lanes);
                lanes.map(|x| if x.is_nan() { 1 } else { x.to_bits() })
            })
        }
    }

    #[test]
    fn unit_vectors_are_those_of_divisions() {
        let mut random = Rng(17);
        for case in 0..cases(40_000) {
            let spread = [0.0, 1.0, 20.0, 300.0][case % 4];
            let mut number = || match random.below(40) {
                0 => random.one(&[0.0, -0.0, 1.0, f64::INFINITY, f64::NAN]),
                _ => random.signed() * random.magnitude(-spread, spread),
            };
            let vectors = [(); 3].map(|()| [(); LANES].map(|()| number()));
            let expected = Isa(Known::Scalar).run(Units(vectors));
            for isa in Isa::all() {
                assert_eq!(isa.run(Units(vectors)), expected, "{isa}: {vectors:?}");
            }
        }
    }

    #[test]
    fn scalar_operations_are_those_of_rust() {
        let a = [1.0, -2.5, f64::NAN, 0.3, 9.0, -0.0, 1e300, 5.0];
        let b = [3.0; LANES];
        let found = Isa(Known::Scalar).run(All(a, b));
        for (lane, (a, b)) in a.into_iter().zip(b).enumerate() {
            let quotient = f64::from_bits(found[3 * LANES + lane]);
            assert!(quotient == a / b || (a / b).is_nan());
            assert_eq!(found[10 * LANES] >> lane & 1 == 1, a < b);
        }
    }

    #[test]
    fn names_round_trip() {
        for isa in Isa::all() {
            assert_eq!(isa.name().parse(), Ok(isa));
        }
        assert!("mmx".parse::<Isa>().unwrap_err().contains("scalar"));
        assert_eq!(Isa::all().last(), Some(&Isa::best()));
    }
}
