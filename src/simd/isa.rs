//! The instruction sets that the processor has.

use std::{fmt, str::FromStr};

use crate::simd::{Kernel, scalar::Scalar};
#[cfg(target_arch = "x86_64")]
use crate::simd::{avx2, avx512};

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

    /// Returns true if eight numbers have instructions of their own.
    pub(crate) fn has_vectors(self) -> bool {
        self.0 != Known::Scalar
    }

    /// Runs a kernel with these instructions, if they are for eight numbers: others are not worth their place in the
    /// program.
    #[inline]
    pub(crate) fn run_with_vectors<K: Kernel>(self, kernel: K) -> Option<K::Output> {
        match self.0 {
            Known::Scalar => {
                let _ = kernel;
                None
            }
            #[cfg(target_arch = "x86_64")]
            Known::Avx2(found) => Some(found.run(kernel)),
            #[cfg(target_arch = "x86_64")]
            Known::Avx512(found) => Some(found.run(kernel)),
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
    use crate::{
        simd::{F32x8, F64x8, LANES, Mask, Simd},
        tracer::random::{Rng, cases},
    };

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
