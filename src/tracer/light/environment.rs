//! Light from the surroundings.

use glam::DVec3;

use crate::tracer::{
    color::Color,
    error::GeometryError,
    light::source::{Glow, LightSize, Source},
    radiance::Radiance,
    transform::Transform,
    vector::{direction, finite, unit},
};

/// Light that comes from all directions, where light follows paths: of one color, or of a sky. A ray that
/// hits nothing shows it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Environment {
    pub(super) glow: Glow,
    sky: Option<Sky>,
    up: DVec3,
    is_visible: bool,
}

/// The colors of a sky: above, at the horizon and below. In between, they blend in linear light with the
/// height of the direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sky {
    /// The color above.
    pub zenith: Color,
    /// The color at the horizon.
    pub horizon: Color,
    /// The color below.
    pub ground: Color,
}

/// The number of heights above the horizon, and below it, over which the light of a sky is averaged.
const HEIGHTS: u32 = 64;

impl Environment {
    /// Creates light of one color.
    ///
    /// # Errors
    ///
    /// Returns an error if the intensity lies outside of 0..=1e12.
    pub fn new(color: Color, intensity: f64) -> Result<Self, GeometryError> {
        Ok(Self {
            glow: Glow::new(color, intensity)?,
            sky: None,
            up: DVec3::Y,
            is_visible: true,
        })
    }

    /// Creates the light of a sky whose zenith lies in the direction `up`.
    ///
    /// # Errors
    ///
    /// Returns an error if the intensity lies outside of 0..=1e12, or if `up` has no direction.
    pub fn of_sky(sky: Sky, up: DVec3, intensity: f64) -> Result<Self, GeometryError> {
        Ok(Self {
            sky: Some(sky),
            up: unit(direction(finite(up, "up")?, "up")?),
            ..Self::new(Color::WHITE, intensity)?
        })
    }

    /// Sets whether the camera's rays show it: otherwise they show the background.
    #[must_use]
    pub const fn visible(self, is_visible: bool) -> Self {
        Self { is_visible, ..self }
    }

    /// True if the camera's rays show it.
    pub const fn is_visible(&self) -> bool {
        self.is_visible
    }

    /// The colors, if it is a sky.
    pub const fn sky(&self) -> Option<Sky> {
        self.sky
    }

    /// Returns the light from the direction of a unit vector.
    pub(crate) fn radiance(&self, d: DVec3) -> Radiance {
        match self.sky {
            None => self.glow.radiance(),
            Some(sky) => sky.light(d.dot(self.up)) * self.glow.intensity(),
        }
    }

    /// Returns the mean of the largest channel over all directions.
    pub(crate) fn mean(&self) -> f64 {
        let Some(sky) = self.sky else {
            return self.glow.radiance().max_channel();
        };
        let middles = (0..HEIGHTS).map(|place| (f64::from(place) + 0.5) / f64::from(HEIGHTS));
        let both = middles.flat_map(|height| [height, -height]);
        let sum = both.fold(0.0, |sum, height| sum + sky.light(height).max_channel());
        sum / f64::from(2 * HEIGHTS) * self.glow.intensity()
    }

    pub(super) const fn shadows(&self) -> bool {
        true
    }

    pub(super) fn placed(&self, transform: &Transform) -> Result<Self, GeometryError> {
        let up = transform.direction(self.up);
        Ok(Self {
            up: unit(direction(finite(up, "up")?, "up")?),
            ..*self
        })
    }

    pub(super) const fn source(&self) -> Source {
        Source::Surroundings
    }

    pub(super) const fn size(&self) -> LightSize {
        LightSize::None
    }

    pub(super) fn numbers(&self) -> impl Iterator<Item = f64> + use<> {
        let colors = self.sky.map(|sky| [sky.zenith, sky.horizon, sky.ground]);
        let channels = colors.into_iter().flatten();
        let channels = channels.flat_map(|color| [color.r(), color.g(), color.b()]);
        let [x, y, z] = self.up.to_array();
        let is_visible = f64::from(u8::from(self.is_visible));
        [is_visible, x, y, z].into_iter().chain(channels)
    }
}

impl Sky {
    /// Returns the light of a direction with this cosine to the zenith.
    fn light(&self, height: f64) -> Radiance {
        let horizon = self.horizon.to_linear();
        let end = if height > 0.0 {
            self.zenith
        } else {
            self.ground
        };
        horizon + (end.to_linear() - horizon) * height.abs()
    }
}
