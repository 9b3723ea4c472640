//! Random cases for tests, the same in every run.

/// A xorshift* generator (S. Vigna, An experimental exploration of Marsaglia's xorshift
/// generators, scrambled, 2016); its seed is any number but 0.
pub(crate) struct Rng(pub(crate) u64);

impl Rng {
    pub(crate) fn next(&mut self) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0.wrapping_mul(0x2545_f491_4f6c_dd1d)
    }

    /// A number from 0 to `n - 1`.
    pub(crate) fn below(&mut self, n: usize) -> usize {
        ((self.next() >> 32) as usize) % n.max(1)
    }
}

/// How many cases are tried: so many, unless `STRAHL_CASES` says otherwise.
pub(crate) fn cases(default: usize) -> usize {
    let given = std::env::var("STRAHL_CASES").ok();
    given.and_then(|n| n.parse().ok()).unwrap_or(default)
}
