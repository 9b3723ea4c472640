//! The numbers of a path: a function of the pixel, the sample and the seed alone.
//!
//! Each pair of numbers is a point of a Sobol sequence in two dimensions, scrambled by hashes (S. Laine
//! and T. Karras, Stratified sampling for stochastic transparency, 2011; B. Burley, Practical hash-based
//! Owen scrambling, Journal of Computer Graphics Techniques, 2020). Each has an order of its own, so that
//! pairs do not depend on each other.

use crate::{
    film::size::Size,
    simd::{Kernel, LANES, Simd, isa::Isa},
    tracer::{camera::Camera, light::transport::PixelFilter, ray::Ray, sampling::UnitPair},
};

/// The pairs of one sample of a pixel.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sampler {
    /// The hash of the pixel and the seed.
    pixel: u32,
    sample: u32,
    /// The number of the first pair that is known, and the pairs from it on.
    known: (u32, [UnitPair; LANES]),
}

/// The kernel that finds eight pairs of a sample, from one on.
struct EightPairs {
    sampler: Sampler,
    first: u32,
}

/// A pair that a vertex of a path has for itself.
#[derive(Clone, Copy, Debug)]
pub(super) enum Purpose {
    /// The emitter that is aimed at; the lobe that scatters.
    Choice = 0,
    /// The point on the emitter.
    Emitter = 1,
    /// The direction in which the path goes on.
    Direction = 2,
    /// The end of the path; not used.
    Roulette = 3,
}

/// The pairs before those of the vertices: the place in the pixel, and that on the lens.
const BEFORE: u32 = 2;
/// A number beyond those of all pairs.
const BEYOND: u32 = 1 << 31;
/// The pairs of a vertex.
const OF_VERTEX: u32 = 4;

impl Sampler {
    /// Creates the numbers of a sample of a pixel of the whole picture, counted from the bottom left.
    pub(crate) fn new([x, y]: [u32; 2], sample: u32, seed: u32) -> Self {
        Self {
            pixel: mix(seed.wrapping_add(mix(y.wrapping_add(mix(x))))),
            sample,
            known: (BEYOND, [[0.0; 2]; LANES]),
        }
    }

    /// Goes on to another sample of the same pixel.
    pub(super) fn restart(&mut self, pixel: &Self, sample: u32) {
        self.pixel = pixel.pixel;
        self.sample = sample;
        self.known.0 = BEYOND;
    }

    /// Prepares the pairs of the vertex at a depth: those of two vertices at a time.
    pub(super) fn prepare(&mut self, depth: u32, isa: Isa) {
        let first = BEFORE + OF_VERTEX * (depth & !1);
        if self.known.0 != first {
            let sampler = *self;
            self.known = (first, isa.run(EightPairs { sampler, first }));
        }
    }

    /// Returns the camera's ray in a pixel counted from the bottom left: from a place on the lens, through one
    /// in the pixel.
    pub(crate) fn ray(
        &self,
        (camera, filter): (&Camera, PixelFilter),
        size: Size,
        pixel: [u32; 2],
    ) -> Ray {
        let ([u, v], [x, y]) = (filter.place(self.pair(0)), pixel.map(f64::from));
        camera.ray_from_lens((size.width(), size.height()), [x + u, y + v], self.pair(1))
    }

    /// Returns a pair of the vertex at a depth.
    pub(super) fn at(&self, depth: u32, purpose: Purpose) -> UnitPair {
        let number = BEFORE + OF_VERTEX * depth + purpose as u32;
        let (first, known) = &self.known;
        let place = number.wrapping_sub(*first) as usize;
        known
            .get(place)
            .copied()
            .unwrap_or_else(|| self.pair(number))
    }

    #[inline(always)]
    pub(crate) fn pair(&self, number: u32) -> UnitPair {
        let key = mix(number.wrapping_add(self.pixel));
        let index = owen(self.sample, key);
        let first = owen(index.reverse_bits(), mix(key ^ 1));
        let second = owen(sobol(index), mix(key ^ 2));
        [first, second].map(|bits| (f64::from(bits) + 0.5) * (1.0 / (1_u64 << 32) as f64))
    }
}

impl Kernel for EightPairs {
    type Output = [UnitPair; LANES];

    // The compiler does the same with all numbers of a loop at once.
    #[inline(always)]
    fn run<S: Simd>(self, _: S) -> Self::Output {
        let mut pairs = [[0.0; 2]; LANES];
        for (place, pair) in pairs.iter_mut().enumerate() {
            *pair = self.sampler.pair(self.first.wrapping_add(place as u32));
        }
        pairs
    }
}

/// Hashes an integer.
#[inline(always)]
const fn mix(mut x: u32) -> u32 {
    x ^= x >> 16;
    x = x.wrapping_mul(0x21f0_aaad);
    x ^= x >> 15;
    x = x.wrapping_mul(0xd35a_2d97);
    x ^ (x >> 15)
}

/// Scrambles the bits of an integer: each by a hash of the seed and of all higher bits.
#[inline(always)]
fn owen(x: u32, seed: u32) -> u32 {
    let mut y = x.reverse_bits().wrapping_add(seed);
    for factor in [0x6c50_b47c, 0xb82f_1e52, 0xc7af_e638, 0x8d22_f6e6_u32] {
        y ^= y.wrapping_mul(factor);
    }
    y.reverse_bits()
}

/// Returns the second coordinate of a point of the Sobol sequence, whose first is the reversed index.
#[inline(always)]
const fn sobol(index: u32) -> u32 {
    let mut x = index.reverse_bits();
    x ^= (x & 0x5555_5555) << 1;
    x ^= (x & 0x3333_3333) << 2;
    x ^= (x & 0x0f0f_0f0f) << 4;
    x ^= (x & 0x00ff_00ff) << 8;
    x ^ (x << 16)
}

#[cfg(test)]
mod tests {
    use super::*;

    // Shifts to the other side keep every mean, but the error of a pixel stops at 4 %.
    #[test]
    fn points_lie_one_in_each_box() {
        for (number, pixel) in [[0, 0], [3, 1], [639, 479], [5, 77]]
            .into_iter()
            .enumerate()
        {
            for first in [0, 256, 4096] {
                let points: Vec<_> = (first..first + 256)
                    .map(|sample| Sampler::new(pixel, sample, 9).pair(number as u32 * 3))
                    .collect();
                for split in 0..=8 {
                    let (columns, rows) = (1_usize << split, 256_usize >> split);
                    let mut is_taken = [false; 256];
                    for [u, v] in &points {
                        let column = (u * columns as f64) as usize;
                        let row = (v * rows as f64) as usize;
                        let taken = &mut is_taken[row * columns + column];
                        assert!(!*taken, "{pixel:?} {split}");
                        *taken = true;
                    }
                }
            }
        }
    }

    #[test]
    fn all_of_pixel_sample_seed_and_pair_count() {
        let pairs = [
            Sampler::new([1, 2], 3, 4).pair(5),
            Sampler::new([2, 1], 3, 4).pair(5),
            Sampler::new([1, 2], 4, 4).pair(5),
            Sampler::new([1, 2], 3, 5).pair(5),
            Sampler::new([1, 2], 3, 4).pair(6),
        ];
        for (index, pair) in pairs.iter().enumerate() {
            assert!(!pairs[..index].contains(pair), "{index}");
        }
        let sampler = Sampler::new([1, 2], 3, 4);
        assert_eq!(sampler.at(0, Purpose::Choice), sampler.pair(2));
        assert_eq!(sampler.at(1, Purpose::Direction), sampler.pair(8));
        for isa in Isa::all() {
            for depth in [0, 1, 2, 7, 1023] {
                let mut prepared = sampler;
                prepared.prepare(depth, isa);
                assert!(prepared.known.0 <= 2 + 4 * depth);
                for (number, purpose) in (2 + 4 * depth..).zip([
                    Purpose::Choice,
                    Purpose::Emitter,
                    Purpose::Direction,
                    Purpose::Roulette,
                ]) {
                    assert_eq!(prepared.at(depth, purpose), sampler.pair(number));
                }
                assert_eq!(
                    prepared.at(depth + 9, Purpose::Choice),
                    sampler.at(depth + 9, Purpose::Choice)
                );
            }
        }
    }
}
