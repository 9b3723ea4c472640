//! The light of rows of samples, and its sums by pixel.

use crate::{
    film::parts::LightParts,
    integrator::{
        batch::{Cache, Others},
        direct::Shaded,
        queue::Queue,
    },
    render::outlines::RowLines,
    tracer::{radiance::Radiance, world::World},
};

/// The memory of a thread that shades rows.
pub(super) struct Scratch {
    pub(super) known: Cache,
    pub(super) others: Others,
    pub(super) queue: Queue,
    /// The light of a row of samples.
    pub(super) samples: RowLight,
    /// The sums of a row of pixels.
    pub(super) sums: Sums,
    /// The lines on a row of samples.
    pub(super) lines: RowLines,
}

impl Scratch {
    pub(super) fn new(world: &World) -> Self {
        Self {
            known: Cache::new(world),
            others: Others::default(),
            queue: Queue::default(),
            samples: RowLight::default(),
            sums: Sums::default(),
            lines: RowLines::default(),
        }
    }
}

/// The sums of the samples of a row of pixels.
#[derive(Default)]
pub(super) struct Sums {
    pub(super) light: RowLight,
    pub(super) albedo: [Vec<f64>; 3],
    pub(super) hits: Vec<u32>,
    /// The number of samples of each pixel.
    pub(super) counts: Vec<f64>,
    /// The standard error of all light; empty unless light follows paths.
    pub(super) error: [Vec<f64>; 3],
}

impl Sums {
    /// Begins a row of pixels.
    pub(super) fn clear(&mut self, width: usize, samples: u32) {
        self.light.begin(width);
        if samples != 1 {
            self.light.parts[0]
                .iter_mut()
                .for_each(|sums| sums.fill(0.0));
        }
        let others = self.albedo.iter_mut().chain(&mut self.error);
        others.for_each(Vec::clear);
        self.hits.clear();
        self.hits.resize(width, 0);
        self.counts.clear();
        self.counts.resize(width, samples.into());
    }
}

/// The light of a row.
#[derive(Default)]
pub(super) struct RowLight {
    /// Red, green and blue of each part; empty if there is none, except for the first.
    pub(super) parts: [[Vec<f64>; 3]; LightParts::NAMES.len()],
    /// The mean of the channels of the part of a transparent background; empty if there is none.
    pub(super) behind: Vec<f64>,
}

impl RowLight {
    /// Begins a row of this length, with any light.
    pub(super) fn begin(&mut self, count: usize) {
        let [first, others @ ..] = &mut self.parts;
        first.iter_mut().for_each(|light| light.resize(count, 0.0));
        others.as_flattened_mut().iter_mut().for_each(Vec::clear);
        self.behind.clear();
    }

    pub(super) fn set(&mut self, place: usize, shaded: Shaded) {
        let count = self.parts[0][0].len();
        for (lights, part) in self.parts.iter_mut().zip(shaded.parts.all()) {
            if lights[0].is_empty() && part == Radiance::BLACK {
                continue;
            }
            for (light, channel) in lights.iter_mut().zip(part.channels) {
                light.resize(count, 0.0);
                light[place] = channel;
            }
        }
        if !self.behind.is_empty() || shaded.behind != Radiance::BLACK {
            self.behind.resize(count, 0.0);
            self.behind[place] = shaded.behind.mean();
        }
    }
}
