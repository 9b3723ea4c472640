//! How the light of lights goes on from surface to surface.

use crate::tracer::sampling::{UnitPair, circle};

/// How the light of a world goes on from surface to surface.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Transport {
    /// Lights shine on surfaces directly, and mirrors and glass send rays on: exact.
    #[default]
    Direct,
    /// Light follows paths from any surface to any other, of which some are sampled.
    Path(PathOptions),
}

/// How the paths of light are sampled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathOptions {
    /// The number of paths of a pixel, from 1 to [`PathOptions::MAX_SAMPLES`].
    pub samples: u32,
    /// The number of scatterings by a diffuse lobe after the first one; any number if `None`.
    pub diffuse_depth: Option<u32>,
    /// True if light gets through solid glass by the paths of its rays alone; false if it goes straight
    /// on through solid glass to where it is aimed, and no path finds a light by mirrors or solid glass
    /// behind a surface that scatters.
    pub caustics: bool,
    /// The largest channel of the light of a path after its first vertex, above 0 and at most
    /// [`PathOptions::MAX_CLAMP`]; brighter light is scaled down.
    pub clamp: Option<f64>,
    /// The noise at which a part of the picture has fewer samples: the error of light of brightness 1, in
    /// [`PathOptions::NOISE`]; `None` if every pixel has all samples.
    pub noise: Option<f64>,
    /// The seed of the numbers of all paths.
    pub seed: u32,
    /// The distribution of paths around the center of a pixel.
    pub filter: PixelFilter,
}

/// The distribution of paths around the center of a pixel.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum PixelFilter {
    /// Evenly over the pixel.
    #[default]
    Box,
    /// Around its center, by a normal distribution of this standard deviation in pixels, above 0 and at most
    /// [`PixelFilter::WIDEST`].
    Gaussian(f64),
}

impl PixelFilter {
    /// The largest standard deviation.
    pub const WIDEST: f64 = 4.0;

    /// Returns the place of a path relative to the center of the pixel.
    pub(crate) fn place(self, [u, v]: UnitPair) -> [f64; 2] {
        match self {
            Self::Box => [u - 0.5, v - 0.5],
            // G. Box and M. Muller, A note on the generation of random normal deviates, 1958.
            Self::Gaussian(sigma) => {
                let radius = sigma * (-2.0 * libm::log(u)).sqrt();
                circle(v).map(|part| radius * part)
            }
        }
    }
}

impl PathOptions {
    /// The largest number of paths of a pixel.
    pub const MAX_SAMPLES: u32 = 1 << 20;
    /// The default of the largest depth of a path.
    pub const MAX_DEPTH: u32 = 32;
    /// The largest limit of light.
    pub const MAX_CLAMP: f64 = 1e12;
    /// The smallest and the largest limit of noise.
    pub const NOISE: [f64; 2] = [1e-4, 1.0];

    /// Returns the number of paths of a pixel within its limits.
    pub(crate) fn samples(&self) -> u32 {
        self.samples.clamp(1, Self::MAX_SAMPLES)
    }
}

impl Default for PathOptions {
    /// Returns 64 samples of any diffuse depth, with caustics.
    fn default() -> Self {
        Self {
            samples: 64,
            diffuse_depth: None,
            caustics: true,
            clamp: None,
            noise: None,
            seed: 0,
            filter: PixelFilter::Box,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_have_the_deviation_of_their_filter() {
        let side = 400;
        let middle = |place: i32| (f64::from(place) + 0.5) / f64::from(side);
        for (filter, expected) in [
            (PixelFilter::Box, 1.0 / 12.0),
            (PixelFilter::Gaussian(0.5), 0.25),
            (PixelFilter::Gaussian(2.0), 4.0),
        ] {
            let (mut sums, mut squares) = ([0.0; 2], [0.0; 2]);
            for column in 0..side {
                for row in 0..side {
                    let place = filter.place([middle(column), middle(row)]);
                    for axis in 0..2 {
                        sums[axis] += place[axis];
                        squares[axis] += place[axis] * place[axis];
                    }
                }
            }
            let count = f64::from(side * side);
            for axis in 0..2 {
                assert!((sums[axis] / count).abs() < 1e-12, "{filter:?}");
                let variance = squares[axis] / count;
                assert!(
                    (variance / expected - 1.0).abs() < 2e-3,
                    "{filter:?} {variance}"
                );
            }
        }
    }
}
