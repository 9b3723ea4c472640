//! Surfaces of tiny mirrors whose normals follow the distribution of Trowbridge and Reitz (GGX), with the
//! height-correlated masking of Smith (E. Heitz, Understanding the masking-shadowing function in
//! microfacet-based BRDFs, Journal of Computer Graphics Techniques, 2014).
//!
//! All vectors are in a frame whose third axis is the normal on the side of the viewer, `v`.

use std::{
    collections::BTreeMap,
    f64::consts::PI,
    fmt,
    sync::{Mutex, OnceLock, PoisonError},
};

use glam::DVec3;

use crate::tracer::{
    error::GeometryError,
    sampling::{UnitPair, circle},
    vector::{in_range, unit},
};

/// The number of angles in a table of reflected parts.
pub(super) const NODES: usize = 64;
/// The number of midpoints of each of two numbers, over which a part is averaged.
const MIDPOINTS: u32 = 64;
/// The smallest cosine of the angle of the viewer.
pub(crate) const LEAST_COSINE: f64 = 1e-12;
/// The least roughness of a surface that is not smooth.
pub(crate) const LEAST_ROUGHNESS: f64 = 0.01;
/// The smallest α.
const LEAST_ALPHA: f64 = 1e-4;

/// The distribution of the normals of tiny mirrors. A roughness of 0 is a plain mirror.
#[derive(Clone, Copy)]
pub(crate) struct Microfacets {
    /// The square of the roughness; 0 for a plain mirror.
    alpha: f64,
    /// The parts of light that it reflects, computed on first use.
    parts: &'static OnceLock<ReflectedParts>,
}

/// The parts of light that microfacets reflect, of which the Fresnel reflection
/// `f₀ + (1-f₀)(1-v·h)⁵` = `f₀·(1-f) + f` is linear in f₀: those of 1-f and of f.
struct ReflectedParts {
    nodes: [[f64; 2]; NODES],
    mean: [f64; 2],
}

impl Microfacets {
    /// Creates the distribution of a roughness from 0 to 1. Equal ones share a table, which is kept.
    pub(crate) fn new(roughness: f64) -> Self {
        let alpha = match roughness > 0.0 {
            true => (roughness * roughness).max(LEAST_ALPHA),
            false => 0.0,
        };
        Self::of_alpha(alpha)
    }

    /// Creates the distribution of an α.
    pub(crate) fn of_alpha(alpha: f64) -> Self {
        static ALL: Mutex<BTreeMap<u64, &'static OnceLock<ReflectedParts>>> =
            Mutex::new(BTreeMap::new());
        let mut all = ALL.lock().unwrap_or_else(PoisonError::into_inner);
        let new = || -> &'static _ { Box::leak(Box::new(OnceLock::new())) };
        let parts = *all.entry(alpha.to_bits()).or_insert_with(new);
        Self { alpha, parts }
    }

    /// The square of the roughness.
    pub(super) const fn alpha(&self) -> f64 {
        self.alpha
    }

    /// The roughness.
    pub(crate) fn roughness(&self) -> f64 {
        self.alpha.sqrt()
    }

    /// Returns true for a plain mirror.
    pub(crate) fn is_smooth(&self) -> bool {
        self.alpha <= 0.0
    }

    /// Returns `D`, the density of normals by area: `α² / (π ((h·n)²(α²-1) + 1)²)`.
    fn distribution(&self, h: DVec3) -> f64 {
        let squared = self.alpha * self.alpha;
        let sum = h.z * h.z * (squared - 1.0) + 1.0;
        squared / (PI * (sum * sum))
    }

    /// Returns `√(z² + α²(1-z²))`.
    fn slant(&self, z: f64) -> f64 {
        (z * z + self.alpha * self.alpha * (1.0 - z * z)).sqrt()
    }

    /// Returns the part of microfacets that is seen from a direction: `G₁`.
    fn seen(&self, z: f64) -> f64 {
        2.0 * z / (z + self.slant(z))
    }

    /// Returns the part that is seen from two directions: `G₂`.
    pub(crate) fn seen_from_both(&self, v: f64, l: f64) -> f64 {
        2.0 * v * l / (v * self.slant(l) + l * self.slant(v))
    }

    /// Returns the part of those seen from one direction that is seen from the other, too.
    pub(crate) fn seen_again(&self, v: f64, l: f64) -> f64 {
        self.seen_from_both(v, l) / self.seen(v)
    }

    /// Returns `D·G₂ / 4(v·n)`: the reflection of a mirror of this distribution, times the cosine of `l`.
    pub(crate) fn reflection(&self, v: DVec3, l: DVec3, h: DVec3) -> f64 {
        self.distribution(h) * self.seen_from_both(v.z, l.z) / (4.0 * v.z)
    }

    /// Returns a normal of those that are seen from `v` (J. Dupuy and A. Benyoub, Sampling visible GGX
    /// normals with spherical caps, 2023).
    pub(crate) fn sample(&self, v: DVec3, [s, t]: UnitPair) -> DVec3 {
        let w = unit(DVec3::new(self.alpha * v.x, self.alpha * v.y, v.z));
        let z = (1.0 - s) * (1.0 + w.z) - w.z;
        let radius = (1.0 - z * z).max(0.0).sqrt();
        let [cosine, sine] = circle(t);
        let h = DVec3::new(radius * cosine, radius * sine, z) + w;
        unit(DVec3::new(self.alpha * h.x, self.alpha * h.y, h.z))
    }

    /// Returns the density of [`Microfacets::sample`].
    pub(crate) fn density(&self, v: DVec3, h: DVec3) -> f64 {
        self.seen(v.z) * v.dot(h).max(0.0) * self.distribution(h) / v.z
    }

    /// Returns the parts of 1-f and of f that are reflected to a viewer at an angle with this cosine.
    pub(crate) fn parts(&self, cosine: f64) -> [f64; 2] {
        if self.is_smooth() {
            let f = schlick(cosine);
            return [1.0 - f, f];
        }
        let ReflectedParts { nodes, .. } = self.table();
        let (place, part) = place_of(cosine);
        let between = |channel: usize| {
            let (low, high) = (nodes[place][channel], nodes[place + 1][channel]);
            low + (high - low) * part
        };
        [between(0), between(1)]
    }

    /// Returns the means of the parts over all directions, weighted by the cosine.
    pub(crate) fn mean_parts(&self) -> [f64; 2] {
        match self.is_smooth() {
            true => [20.0 / 21.0, 1.0 / 21.0],
            false => self.table().mean,
        }
    }

    fn table(&self) -> &ReflectedParts {
        self.parts.get_or_init(|| {
            let nodes = std::array::from_fn(|place| self.reflected(node(place)));
            let mean = [0, 1].map(|part| mean(&nodes, part));
            ReflectedParts { nodes, mean }
        })
    }

    /// Returns the parts by quadrature.
    fn reflected(&self, cosine: f64) -> [f64; 2] {
        let v = DVec3::new((1.0 - cosine * cosine).sqrt(), 0.0, cosine);
        let mut sums = [0.0; 2];
        each_midpoint(|pair, weight| {
            let h = self.sample(v, pair);
            let l = mirrored(v, h);
            if l.z > 0.0 {
                let part = weight * self.seen_again(v.z, l.z);
                let f = schlick(v.dot(h));
                sums[0] += part * (1.0 - f);
                sums[1] += part * f;
            }
        });
        sums
    }
}

/// Returns the cosine of a node, of which there are more near 0.
pub(super) fn node(place: usize) -> f64 {
    let part = place as f64 / (NODES - 1) as f64;
    match place {
        0 => 1e-4,
        _ => part * part,
    }
}

/// Returns the node before a cosine, and the part of the way to the next one.
pub(super) fn place_of(cosine: f64) -> (usize, f64) {
    let place = (cosine.sqrt() * (NODES - 1) as f64).clamp(0.0, (NODES - 2) as f64) as usize;
    let [low, high] = [place, place + 1].map(node);
    (place, ((cosine - low) / (high - low)).clamp(0.0, 1.0))
}

/// Returns the mean, weighted by the cosine, of the lines between nodes.
fn mean(nodes: &[[f64; 2]; NODES], part: usize) -> f64 {
    let first = nodes[0][part] * node(0) * node(0);
    (1..NODES).fold(first, |sum, place| {
        let [low, high] = [place - 1, place].map(node);
        let [a, b] = [place - 1, place].map(|place| nodes[place][part]);
        let moment = 2.0 * a * low + a * high + b * low + 2.0 * b * high;
        sum + (high - low) * moment / 3.0
    })
}

/// Calls `see` with pairs that cover all, and with their weights: there are more where the first number
/// is near 1, at grazing angles.
pub(crate) fn each_midpoint(mut see: impl FnMut(UnitPair, f64)) {
    let middle = |place: u32| (f64::from(place) + 0.5) / f64::from(MIDPOINTS);
    for place in 0..MIDPOINTS {
        let t = middle(place);
        for other in 0..MIDPOINTS {
            let weight = 2.0 * t / f64::from(MIDPOINTS * MIDPOINTS);
            see([1.0 - t * t, middle(other)], weight);
        }
    }
}

/// Returns a roughness if it is valid.
pub(super) fn rough(roughness: f64) -> Result<f64, GeometryError> {
    match roughness == 0.0 {
        true => Ok(roughness),
        false => in_range(roughness, "roughness", [LEAST_ROUGHNESS, 1.0]),
    }
}

/// Returns the direction in which a normal mirrors another one.
pub(crate) fn mirrored(v: DVec3, h: DVec3) -> DVec3 {
    2.0 * v.dot(h) * h - v
}

/// Returns `(1 - cos)⁵` (C. Schlick, An inexpensive BRDF model for physically-based rendering, 1994).
pub(crate) fn schlick(cosine: f64) -> f64 {
    let base = 1.0 - cosine;
    let squared = base * base;
    squared * squared * base
}

impl PartialEq for Microfacets {
    fn eq(&self, other: &Self) -> bool {
        self.alpha == other.alpha
    }
}

impl fmt::Debug for Microfacets {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Microfacets")
            .field("alpha", &self.alpha)
            .finish()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tracer::random::Rng;

    // Each cell of directions gets as many samples as the density says.
    #[test]
    fn normals_have_their_density() {
        for (alpha, cosine) in [(0.3, 0.9_f64), (0.5, 0.5), (1.0, 0.2)] {
            let facets = Microfacets::of_alpha(alpha);
            let v = DVec3::new((1.0 - cosine * cosine).sqrt(), 0.0, cosine);
            let mut random = Rng(11);
            let mut number = || (random.signed() + 1.0) / 2.0;
            const CELLS: usize = 8;
            let (count, mut found) = (1 << 18, [[0.0; CELLS]; CELLS]);
            for _ in 0..count {
                let h = facets.sample(v, [number(), number()]);
                assert!((h.length() - 1.0).abs() < 1e-12 && v.dot(h) > -1e-9);
                let turn = (libm::atan2(h.y, h.x) / (2.0 * PI) + 0.5) * CELLS as f64;
                let row = (h.z * CELLS as f64) as usize;
                found[row.min(CELLS - 1)][(turn as usize).min(CELLS - 1)] += 1.0 / f64::from(count);
            }
            // In each cell, the mean of the density over z and the angle.
            const FINE: usize = 96;
            let mut all = 0.0;
            for (row, found) in found.iter().enumerate() {
                for (column, found) in found.iter().enumerate() {
                    let mut expected = 0.0;
                    for i in 0..FINE {
                        for j in 0..FINE {
                            let part = |cell: usize, fine: usize| {
                                (cell as f64 + (fine as f64 + 0.5) / FINE as f64) / CELLS as f64
                            };
                            let z = part(row, i);
                            let radius = (1.0 - z * z).sqrt();
                            let turn = (part(column, j) - 0.5) * 2.0 * PI;
                            let (sine, cosine) = libm::sincos(turn);
                            let h = DVec3::new(radius * cosine, radius * sine, z);
                            expected += facets.density(v, h);
                        }
                    }
                    expected *= 2.0 * PI / (CELLS * CELLS * FINE * FINE) as f64;
                    all += expected;
                    let error = (expected.max(1e-6) / f64::from(count)).sqrt();
                    let most = 5.0 * error + 0.01 * expected;
                    assert!(
                        (found - expected).abs() < most,
                        "{alpha} {found} {expected}"
                    );
                }
            }
            assert!((all - 1.0).abs() < 0.01, "{alpha}: {all}");
        }
    }

    #[test]
    fn parts_lie_between_those_of_a_mirror_and_nothing() {
        for roughness in [0.1, 0.5, 1.0] {
            let facets = Microfacets::new(roughness);
            for cosine in [1e-5, 0.01, 0.3, 0.7, 1.0] {
                let [a, b] = facets.parts(cosine);
                assert!(
                    a > 0.0 && b > 0.0 && a + b < 1.0 + 1e-9,
                    "{roughness} {cosine}"
                );
            }
            let [a, b] = facets.mean_parts();
            assert!(a > 0.3 && a + b < 1.0, "{roughness} {a} {b}");
        }
        let nearly = Microfacets::new(0.02).mean_parts();
        for (nearly, exact) in nearly.into_iter().zip(Microfacets::new(0.0).mean_parts()) {
            assert!((nearly - exact).abs() < 1e-3, "{nearly} {exact}");
        }
    }
}
