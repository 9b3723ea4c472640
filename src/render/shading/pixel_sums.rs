//! What is known of a pixel whose light follows paths.

use std::array;

use crate::{
    film::parts::LightParts,
    integrator::{direct::Shaded, path::PathSample},
    tracer::radiance::Radiance,
};

/// The light at which the noise of a pixel counts half: in the dark, little light is enough.
const DARK: f64 = 1e-3;

/// The sums of the samples of a pixel. All that it shows is derived from them, and more samples can be added.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct PixelSums {
    /// The number of samples.
    pub(crate) count: u32,
    /// The number of those that hit something.
    pub(crate) hits: u32,
    pub(crate) light: Shaded,
    /// The squares of all light of each sample.
    squares: Radiance,
    /// The first colors, if they are wanted.
    pub(crate) albedo: Radiance,
}

impl PixelSums {
    /// The number of bytes in a file.
    pub(crate) const BYTES: usize = 128;

    /// Returns all numbers, from the first to the last field.
    pub(super) fn bytes(&self) -> [u8; Self::BYTES] {
        let [direct, specular] = self.light.parts.all();
        let lights = [
            direct,
            specular,
            self.light.behind,
            self.squares,
            self.albedo,
        ];
        let counts = [self.count, self.hits].map(u32::to_le_bytes);
        let channels = lights.iter().flat_map(|light| light.channels);
        let mut bytes = [0; Self::BYTES];
        let (first, others) = bytes.split_at_mut(8);
        first.copy_from_slice(counts.as_flattened());
        for (bytes, channel) in others.as_chunks_mut().0.iter_mut().zip(channels) {
            *bytes = channel.to_le_bytes();
        }
        bytes
    }

    /// Returns the sums from their bytes.
    pub(super) fn of_bytes(bytes: &[u8; Self::BYTES]) -> Self {
        let (first, others) = bytes.split_at(8);
        let mut counts = first
            .as_chunks()
            .0
            .iter()
            .map(|bytes| u32::from_le_bytes(*bytes));
        let mut numbers = others
            .as_chunks()
            .0
            .iter()
            .map(|bytes| f64::from_le_bytes(*bytes));
        let mut light = || Radiance {
            channels: array::from_fn(|_| numbers.next().unwrap_or_default()),
        };
        let parts = LightParts::new([light(), light()]);
        let behind = light();
        Self {
            count: counts.next().unwrap_or_default(),
            hits: counts.next().unwrap_or_default(),
            light: Shaded { parts, behind },
            squares: light(),
            albedo: light(),
        }
    }

    /// Adds the next sample.
    pub(super) fn add(&mut self, sample: &PathSample, with_albedo: bool) {
        self.count += 1;
        self.hits += u32::from(sample.first.is_some());
        self.light = self.light + sample.light;
        let all = sample.light.parts.sum();
        self.squares = self.squares + all * all;
        if let Some(color) = sample.color.filter(|_| with_albedo) {
            self.albedo = self.albedo + color.to_linear();
        }
    }

    /// Returns the variance of the mean of all light: Σ(L - mean)²/(N(N-1)), infinite for one sample.
    fn variance(&self) -> Radiance {
        let count = f64::from(self.count);
        let sum = self.light.parts.sum();
        let variance = |channel: usize| {
            let (sum, squares) = (sum.channels[channel], self.squares.channels[channel]);
            // Rounding may make the difference of equal samples negative.
            let deviation = (squares - sum * sum / count).max(0.0);
            match self.count {
                1 => f64::INFINITY,
                _ => deviation / (count * (count - 1.0)),
            }
        };
        Radiance {
            channels: array::from_fn(variance),
        }
    }

    /// Returns the standard error of the mean of all light.
    pub(crate) fn error(&self) -> Radiance {
        Radiance {
            channels: self.variance().channels.map(f64::sqrt),
        }
    }

    /// Returns the variance of the mean divided by the mean, of the channels after exposure by a factor.
    pub(super) fn noise(&self, factor: f64) -> f64 {
        let light = self.light.parts.sum().mean() * factor / f64::from(self.count);
        self.variance().mean() * factor * factor / (light + DARK)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tracer::random::Rng;

    fn sums(samples: impl IntoIterator<Item = Radiance>) -> PixelSums {
        let mut sums = PixelSums::default();
        for light in samples {
            let direct = light * 0.25;
            let parts = LightParts::new([direct, light * 0.75]);
            let light = Shaded {
                parts,
                ..Shaded::default()
            };
            let sample = PathSample {
                light,
                first: None,
                color: None,
            };
            sums.add(&sample, false);
        }
        sums
    }

    #[test]
    fn the_error_is_that_of_the_mean() {
        let gray = |light| Radiance::new(light, 0.5, 2.0 * light);
        assert_eq!(
            sums([gray(1.0)]).error(),
            Radiance::new(1.0, 1.0, 1.0) / 0.0
        );
        // The deviations are -1.5, -0.5, 0.5 and 1.5.
        let four = sums([1.0, 2.0, 3.0, 4.0].map(gray));
        let expected = (5.0_f64 / 12.0).sqrt();
        let [r, g, b] = four.error().channels;
        assert!((r - expected).abs() < 1e-15 && (b - 2.0 * expected).abs() < 1e-15);
        assert_eq!(g, 0.0);
        let mean: f64 = (2.5 + 0.5 + 5.0) / 3.0;
        let noise = (5.0 / 12.0 * 5.0 / 3.0) * 4.0 / (2.0 * mean + 0.001);
        assert!((four.noise(2.0) - noise).abs() < 1e-15);
    }

    #[test]
    fn bytes_hold_all_numbers() {
        let light = |first| Radiance::new(first, 0.1 + first, -first);
        let pixel = PixelSums {
            count: 7,
            hits: 5,
            light: Shaded {
                parts: LightParts::new([light(1.0), light(2.0)]),
                behind: light(3.0),
            },
            squares: light(4.0),
            albedo: light(5.0),
        };
        assert_eq!(PixelSums::of_bytes(&pixel.bytes()), pixel);
        let mut numbers: Vec<_> = pixel.bytes()[8..].as_chunks::<8>().0.to_vec();
        numbers.sort_unstable();
        numbers.dedup();
        assert_eq!(numbers.len(), 15, "each has a place of its own");
    }

    #[test]
    fn the_error_tells_how_far_means_lie_apart() {
        let mut random = Rng(0x5eed);
        let (mut told, mut found, count) = (0.0, 0.0, 2000);
        for _ in 0..count {
            let samples = (0..16).map(|_| Radiance::WHITE * random.signed().abs());
            let pixel = sums(samples.collect::<Vec<_>>());
            let error = pixel.error().channels[0];
            let off = pixel.light.parts.sum().channels[0] / 16.0 - 0.5;
            told += error * error;
            found += off * off;
        }
        assert!((told / found - 1.0_f64).abs() < 0.1, "{}", told / found);
    }
}
