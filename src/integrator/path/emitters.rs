//! The emitters that paths aim at, and the choice of one at a point.

use std::f64::consts::PI;

use glam::DVec3;
use smallvec::SmallVec;

use crate::tracer::{
    light::{Light, source::Source},
    world::World,
};

/// The number of emitters whose sums need no memory of their own.
const FEW: usize = 16;

/// Everything that paths aim at: lights, in file order.
#[derive(Clone, Debug, Default)]
pub(crate) struct Emitters {
    all: Vec<Emitter>,
}

/// Something that paths aim at.
#[derive(Clone, Copy, Debug)]
pub(super) enum Emitter {
    /// A light without size.
    Light(Light),
}

impl Emitters {
    /// Lists the emitters of a world.
    pub(crate) fn new(world: &World) -> Self {
        let lights = world.lights().iter().filter(|light| match light.source() {
            Source::Everywhere | Source::Viewer => false,
            Source::Direction(_) | Source::Point { .. } => true,
        });
        Self {
            all: lights.copied().map(Emitter::Light).collect(),
        }
    }

    /// Chooses an emitter for a point by a number: with its probability, which is in proportion to the
    /// irradiance that it may bring. `None` if none brings any.
    pub(super) fn choose(&self, point: DVec3, u: f64) -> Option<(&Emitter, f64)> {
        let mut sum = 0.0;
        let weights = self.all.iter().map(|emitter| emitter.weight(point));
        let weights: SmallVec<[f64; FEW]> = weights.collect();
        let sums = weights.iter().map(|weight| {
            sum += weight;
            sum
        });
        let sums: SmallVec<[f64; FEW]> = sums.collect();
        let sum = sums.last().copied().filter(|sum| *sum > 0.0)?;
        let place = sums.partition_point(|before| *before <= u * sum);
        Some((self.all.get(place)?, weights[place] / sum))
    }
}

impl Emitter {
    /// Returns an estimate of the irradiance that it brings to a point, without shadows: its largest
    /// channel.
    fn weight(&self, point: DVec3) -> f64 {
        let weight = match self {
            Self::Light(light) => light
                .arriving(point, DVec3::Z)
                .map_or(0.0, |arriving| PI * arriving.radiance.max_channel()),
        };
        match weight.is_finite() {
            true => weight,
            false => 0.0,
        }
    }
}
