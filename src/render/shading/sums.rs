//! The light of rows of samples, and its sums by pixel.

use crate::{
    film::samples::Samples,
    integrator::{
        batch::{Cache, Others},
        direct::Shaded,
    },
    tracer::{radiance::Radiance, world::World},
};

/// The memory of a thread that shades rows.
pub(super) struct Scratch {
    pub(super) known: Cache,
    pub(super) others: Others,
    /// The light of a row of samples.
    pub(super) samples: RowLight,
    /// The sums of a row of pixels.
    pub(super) sums: Sums,
}

impl Scratch {
    pub(super) fn new(world: &World) -> Self {
        Self {
            known: Cache::new(world),
            others: Others::default(),
            samples: RowLight::default(),
            sums: Sums::default(),
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
            self.light.direct.iter_mut().for_each(|sums| sums.fill(0.0));
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
    /// Red, green and blue.
    pub(super) direct: [Vec<f64>; 3],
    /// Empty if there is none.
    pub(super) specular: Vec<Radiance>,
    /// The mean of the channels of the part of a transparent background; empty if there is none.
    pub(super) behind: Vec<f64>,
}

impl RowLight {
    /// Begins a row of this length, with any light.
    pub(super) fn begin(&mut self, count: usize) {
        for light in &mut self.direct {
            light.resize(count, 0.0);
        }
        self.specular.clear();
        self.behind.clear();
    }

    pub(super) fn direct(&self, place: usize) -> Radiance {
        let [r, g, b] = &self.direct;
        Radiance::new(r[place], g[place], b[place])
    }

    pub(super) fn specular(&self, place: usize) -> Radiance {
        let specular = self.specular.get(place);
        specular.copied().unwrap_or(Radiance::BLACK)
    }

    pub(super) fn set(&mut self, place: usize, shaded: Shaded) {
        for (light, channel) in self.direct.iter_mut().zip(shaded.direct.channels) {
            light[place] = channel;
        }
        if self.specular.is_empty() && shaded.specular != Radiance::BLACK {
            self.specular.resize(self.direct[0].len(), Radiance::BLACK);
        }
        if let Some(specular) = self.specular.get_mut(place) {
            *specular = shaded.specular;
        }
        if self.behind.is_empty() && shaded.behind != Radiance::BLACK {
            self.behind.resize(self.direct[0].len(), 0.0);
        }
        if let Some(behind) = self.behind.get_mut(place) {
            *behind = shaded.behind.mean();
        }
    }
}
