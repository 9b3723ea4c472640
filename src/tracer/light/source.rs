//! Where light comes from, and how much of it.

use glam::DVec3;

use crate::tracer::{
    color::Color,
    error::GeometryError,
    light::falloff::{Fading, Falloff},
    radiance::Radiance,
    vector::in_range,
};

/// The place that light comes from. It determines the light at each point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Source {
    /// All directions.
    Everywhere,
    /// The surroundings, which only paths find.
    Surroundings,
    /// The viewer.
    Viewer,
    /// This direction, of any length, from all surfaces.
    Direction(DVec3),
    /// A point.
    Point {
        position: DVec3,
        falloff: Falloff,
        /// The cone that the light is limited to.
        cone: Option<Fading>,
    },
}

/// The size of a light, where light follows paths.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum LightSize {
    /// None.
    None,
    /// A ball of this radius around its position.
    Ball(f64),
    /// A disc at an infinite distance: the squared sine of the angle of its radius.
    Disc(f64),
}

/// The largest radius of a light.
pub(crate) const LARGEST: f64 = 1e12;
/// The largest angle of a light at an infinite distance, in degrees.
pub(crate) const WIDEST: f64 = 90.0;

/// The color and the intensity of a light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Glow {
    color: Color,
    intensity: f64,
    /// `intensity · lin(color)`
    radiance: Radiance,
}

/// The largest intensity of a light.
pub(crate) const BRIGHTEST: f64 = 1e12;

impl Glow {
    pub(crate) fn new(color: Color, intensity: f64) -> Result<Self, GeometryError> {
        let intensity = in_range(intensity, "intensity", [0.0, BRIGHTEST])?;
        Ok(Self {
            color,
            intensity,
            radiance: color.to_linear() * intensity,
        })
    }

    /// The color.
    pub const fn color(&self) -> Color {
        self.color
    }

    /// The intensity, from 0 to 1e12.
    pub const fn intensity(&self) -> f64 {
        self.intensity
    }

    /// The linear light of the color times the intensity.
    pub const fn radiance(&self) -> Radiance {
        self.radiance
    }
}
