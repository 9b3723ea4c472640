//! The light of rows of samples, and its sums by pixel.

use std::array;

use crate::{
    film::{parts::LightParts, samples::Samples},
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
    pub(super) albedo: Vec<Radiance>,
    pub(super) hits: Vec<u32>,
    /// The part of a transparent background that shows in these hits.
    pub(super) behind: Vec<f64>,
}

impl Sums {
    /// Begins a row of pixels.
    pub(super) fn clear(&mut self, width: usize, samples: Samples) {
        self.light.begin(width);
        if samples != Samples::ONE {
            self.light.first.iter_mut().for_each(|sums| sums.fill(0.0));
        }
        self.albedo.clear();
        self.hits.clear();
        self.hits.resize(width, 0);
        self.behind.clear();
        self.behind.resize(width, 0.0);
    }
}

/// The light of a row.
#[derive(Default)]
pub(super) struct RowLight {
    /// Red, green and blue of the first part, which all samples have.
    pub(super) first: [Vec<f64>; 3],
    /// The other parts; empty if there is none.
    pub(super) others: [Vec<Radiance>; LightParts::NAMES.len() - 1],
    /// The mean of the channels of the part of a transparent background; empty if there is none.
    pub(super) behind: Vec<f64>,
}

impl RowLight {
    /// Begins a row of this length, with any light.
    pub(super) fn begin(&mut self, count: usize) {
        for light in &mut self.first {
            light.resize(count, 0.0);
        }
        self.others.iter_mut().for_each(Vec::clear);
        self.behind.clear();
    }

    /// Returns the light at a place.
    pub(super) fn parts(&self, place: usize) -> LightParts {
        let [r, g, b] = &self.first;
        let first = Radiance::new(r[place], g[place], b[place]);
        LightParts::new(array::from_fn(|part| match part.checked_sub(1) {
            None => first,
            Some(other) => self.others[other].get(place).copied().unwrap_or_default(),
        }))
    }

    pub(super) fn set(&mut self, place: usize, shaded: Shaded) {
        let [first, others @ ..] = shaded.parts.all();
        for (light, channel) in self.first.iter_mut().zip(first.channels) {
            light[place] = channel;
        }
        for (lights, other) in self.others.iter_mut().zip(others) {
            if lights.is_empty() && other != Radiance::BLACK {
                lights.resize(self.first[0].len(), Radiance::BLACK);
            }
            if let Some(light) = lights.get_mut(place) {
                *light = other;
            }
        }
        if self.behind.is_empty() && shaded.behind != Radiance::BLACK {
            self.behind.resize(self.first[0].len(), 0.0);
        }
        if let Some(behind) = self.behind.get_mut(place) {
            *behind = shaded.behind.mean();
        }
    }
}
