//! Random test cases, identical in every run.

use glam::DVec3;

/// A xorshift* generator (S. Vigna, An experimental exploration of Marsaglia's xorshift generators,
/// scrambled, 2016). The seed must not be 0.
pub(crate) struct Rng(pub(crate) u64);

impl Rng {
    pub(crate) fn next(&mut self) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0.wrapping_mul(0x2545_f491_4f6c_dd1d)
    }

    /// Returns a number from 0 to `n - 1`.
    pub(crate) fn below(&mut self, n: usize) -> usize {
        ((self.next() >> 32) as usize) % n.max(1)
    }

    /// Returns a number from -1 to 1.
    pub(crate) fn signed(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    /// Returns a point in the cube from -1 to 1.
    pub(crate) fn vector(&mut self) -> DVec3 {
        DVec3::new(self.signed(), self.signed(), self.signed())
    }

    /// Returns ten to a power between `low` and `high`.
    pub(crate) fn magnitude(&mut self, low: f64, high: f64) -> f64 {
        libm::exp10(low + (self.signed() + 1.0) * 0.5 * (high - low))
    }

    /// Returns one of several values.
    pub(crate) fn one<T: Copy>(&mut self, of: &[T]) -> T {
        of[self.below(of.len())]
    }
}

/// Returns the number of cases to test: `STRAHL_CASES` if set, else a quarter of `whole`, or all of it
/// with `STRAHL_FULL`.
pub(crate) fn cases(whole: usize) -> usize {
    let given = std::env::var("STRAHL_CASES").ok();
    let few = match std::env::var_os("STRAHL_FULL") {
        Some(_) => whole,
        None => whole.div_ceil(4),
    };
    given.and_then(|n| n.parse().ok()).unwrap_or(few)
}
