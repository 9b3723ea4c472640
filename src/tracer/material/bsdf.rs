//! The scattering of light at a point of a surface: the lobes of its material around a normal.
//!
//! All directions are in a frame whose third axis is the normal on the side of the viewer.

use std::f64::consts::PI;

use glam::DVec3;

use crate::tracer::{
    color::Color,
    material::lobes::Lobes,
    radiance::Radiance,
    sampling::{UnitPair, cosine_density, cosine_weighted},
};

/// The lobes of a surface that scatter light to the viewer.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Bsdf {
    /// The part of light that is scattered evenly to all sides.
    diffuse: Radiance,
    /// The part that is reflected as by a mirror.
    mirror: Radiance,
}

/// The light that lobes scatter from one direction to the viewer.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Scattering {
    /// The value of the diffuse lobe, times the cosine of the direction.
    pub(crate) diffuse: Radiance,
    /// The same of all lobes.
    pub(crate) all: Radiance,
    /// The density with which [`Bsdf::sample`] chooses the direction.
    pub(crate) density: f64,
}

/// The direction in which a path goes on.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Onto {
    /// A direction, and whether the diffuse lobe chose it.
    Direction(DVec3, bool),
    /// The mirrored direction, with the factor of its light.
    Mirror(Radiance),
}

impl Scattering {
    /// Returns the part of the light that the diffuse lobe scatters, by channel; 0 where there is none.
    pub(crate) fn diffuse_share(&self) -> Radiance {
        let channels = self.diffuse.channels.into_iter().zip(self.all.channels);
        let mut share = Radiance::BLACK;
        for (share, (diffuse, all)) in share.channels.iter_mut().zip(channels) {
            *share = if all > 0.0 { diffuse / all } else { 0.0 };
        }
        share
    }
}

impl Bsdf {
    /// Creates the scattering of lobes.
    pub(crate) fn new(lobes: &Lobes) -> Self {
        let linear = |color: Option<Color>| color.map_or(Radiance::BLACK, Color::to_linear);
        Self {
            diffuse: linear(lobes.diffuse),
            mirror: linear(lobes.mirror),
        }
    }

    /// Returns true if a mirror is all that there is.
    pub(crate) fn is_mirror(&self) -> bool {
        self.diffuse == Radiance::BLACK
    }

    /// Returns the light that comes from a direction.
    pub(crate) fn from(&self, l: DVec3) -> Scattering {
        if l.z <= 0.0 {
            return Scattering {
                diffuse: Radiance::BLACK,
                all: Radiance::BLACK,
                density: 0.0,
            };
        }
        let diffuse = self.diffuse / PI * l.z;
        Scattering {
            diffuse,
            all: diffuse,
            density: (1.0 - self.part_of_mirror()) * cosine_density(l.z),
        }
    }

    /// The part that is reflected as by a mirror.
    pub(crate) const fn mirror(&self) -> Radiance {
        self.mirror
    }

    /// Returns the probability of the mirror.
    fn part_of_mirror(&self) -> f64 {
        let (mirror, diffuse) = (self.mirror.mean(), self.diffuse.mean());
        match mirror > 0.0 {
            true => mirror / (mirror + diffuse),
            false => 0.0,
        }
    }

    /// Chooses a lobe by a number and a direction by a pair.
    pub(crate) fn sample(&self, u: f64, pair: UnitPair) -> Onto {
        let part = self.part_of_mirror();
        match u < part {
            true => Onto::Mirror(self.mirror / part),
            false => Onto::Direction(cosine_weighted(pair), true),
        }
    }
}
