//! Light from the surroundings.

use std::f64::consts::PI;

use glam::DVec3;

use crate::tracer::{
    color::Color,
    error::GeometryError,
    light::{
        picture::{SkyAxes, SkyPicture, SkyView},
        source::{Glow, LightSize, Source},
    },
    radiance::Radiance,
    sampling::UnitPair,
    shape::target::on_ball,
    transform::Transform,
    vector::{direction, finite, unit},
};

/// Light that comes from all directions, where light follows paths: of one color, or of a sky. A ray that
/// hits nothing shows it.
#[derive(Clone, Debug, PartialEq)]
pub struct Environment {
    pub(super) glow: Glow,
    shine: Shine,
    up: DVec3,
    is_visible: bool,
}

/// What the surroundings look like.
#[derive(Clone, Debug, PartialEq)]
enum Shine {
    /// The same in all directions.
    Even,
    Sky(SkyLight),
    Picture(SkyView),
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

/// A sky and the linear light of its colors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct SkyLight {
    pub(super) sky: Sky,
    linear: [Radiance; 3],
}

/// The number of heights above the horizon, and below it, over which the light of a sky is averaged.
const HEIGHTS: u32 = 64;

/// The density of directions that are evenly distributed.
const EVEN: f64 = 1.0 / (4.0 * PI);

impl Environment {
    /// Creates light of one color.
    ///
    /// # Errors
    ///
    /// Returns an error if the intensity lies outside of 0..=1e12.
    pub fn new(color: Color, intensity: f64) -> Result<Self, GeometryError> {
        Ok(Self {
            glow: Glow::new(color, intensity)?,
            shine: Shine::Even,
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
            shine: Shine::Sky(SkyLight::new(sky)),
            up: unit(direction(finite(up, "up")?, "up")?),
            ..Self::new(Color::WHITE, intensity)?
        })
    }

    /// Creates the light of a picture of all directions: the zenith, in the direction `up`, is its first row, and
    /// its middle lies in the direction -z, turned about the zenith by `rotation`, in degrees, counterclockwise
    /// as seen from there.
    ///
    /// # Errors
    ///
    /// Returns an error if the intensity lies outside of 0..=1e12, if `up` has no
    /// direction, or if `rotation` is not finite.
    pub fn of_picture(
        picture: &SkyPicture,
        up: DVec3,
        rotation: f64,
        intensity: f64,
    ) -> Result<Self, GeometryError> {
        let axes = SkyAxes::turned(up, rotation)?;
        Ok(Self {
            shine: Shine::Picture(SkyView::new(picture.clone(), axes)),
            up: axes.up,
            ..Self::new(Color::WHITE, intensity)?
        })
    }

    /// Sets whether the camera's rays show it: otherwise they show the background.
    #[must_use]
    pub fn visible(self, is_visible: bool) -> Self {
        Self { is_visible, ..self }
    }

    /// True if the camera's rays show it.
    pub const fn is_visible(&self) -> bool {
        self.is_visible
    }

    /// True if it is a picture.
    pub(crate) const fn is_picture(&self) -> bool {
        matches!(self.shine, Shine::Picture(_))
    }

    /// The colors, if it is a sky.
    pub const fn sky(&self) -> Option<Sky> {
        match self.shine {
            Shine::Sky(SkyLight { sky, .. }) => Some(sky),
            Shine::Even | Shine::Picture(_) => None,
        }
    }

    /// Returns the light from the direction of a unit vector.
    pub(crate) fn radiance(&self, d: DVec3) -> Radiance {
        match &self.shine {
            Shine::Even => self.glow.radiance(),
            Shine::Sky(sky) => sky.light(d.dot(self.up)) * self.glow.intensity(),
            Shine::Picture(picture) => picture.radiance(d) * self.glow.intensity(),
        }
    }

    /// Returns the mean of the largest channel over all directions.
    pub(crate) fn mean(&self) -> f64 {
        let sky = match &self.shine {
            Shine::Even => return self.glow.radiance().max_channel(),
            Shine::Sky(sky) => sky,
            Shine::Picture(picture) => return picture.mean() * self.glow.intensity(),
        };
        let middles = (0..HEIGHTS).map(|place| (f64::from(place) + 0.5) / f64::from(HEIGHTS));
        let both = middles.flat_map(|height| [height, -height]);
        let sum = both.fold(0.0, |sum, height| sum + sky.light(height).max_channel());
        sum / f64::from(2 * HEIGHTS) * self.glow.intensity()
    }

    /// Returns a direction to aim at, and its density.
    pub(crate) fn sample(&self, pair: UnitPair) -> (DVec3, f64) {
        match &self.shine {
            Shine::Even | Shine::Sky(_) => (on_ball(pair, DVec3::Z), EVEN),
            Shine::Picture(picture) => picture.sample(pair),
        }
    }

    /// Returns the density of a direction that is aimed at.
    pub(crate) fn density(&self, d: DVec3) -> f64 {
        match &self.shine {
            Shine::Even | Shine::Sky(_) => EVEN,
            Shine::Picture(picture) => picture.density(d),
        }
    }

    pub(super) const fn shadows(&self) -> bool {
        true
    }

    pub(super) fn placed(&self, transform: &Transform) -> Result<Self, GeometryError> {
        let up = transform.direction(self.up);
        let up = unit(direction(finite(up, "up")?, "up")?);
        let shine = match &self.shine {
            Shine::Picture(picture) => {
                Shine::Picture(picture.placed(up, |vector| transform.direction(vector)))
            }
            other => other.clone(),
        };
        Ok(Self { up, shine, ..*self })
    }

    pub(super) const fn source(&self) -> Source {
        Source::Surroundings
    }

    pub(super) const fn size(&self) -> LightSize {
        LightSize::None
    }

    pub(super) fn numbers(&self) -> impl Iterator<Item = f64> + use<> {
        let sky = self.sky().into_iter();
        let channels = sky.flat_map(|sky| sky.channels());
        let of_picture = match &self.shine {
            Shine::Even | Shine::Sky(_) => None,
            Shine::Picture(picture) => Some(picture.numbers()),
        };
        let [x, y, z] = self.up.to_array();
        let is_visible = f64::from(u8::from(self.is_visible));
        let all = [is_visible, x, y, z].into_iter().chain(channels);
        all.chain(of_picture.into_iter().flatten())
    }
}

impl Sky {
    /// Returns the channels of all colors.
    pub(crate) fn channels(&self) -> impl Iterator<Item = f64> + use<> {
        let colors = [self.zenith, self.horizon, self.ground].into_iter();
        colors.flat_map(|color| [color.r(), color.g(), color.b()])
    }
}

impl SkyLight {
    pub(super) fn new(sky: Sky) -> Self {
        Self {
            sky,
            linear: [sky.zenith, sky.horizon, sky.ground].map(Color::to_linear),
        }
    }

    /// Returns the light of a direction with this cosine to the zenith.
    pub(super) fn light(&self, height: f64) -> Radiance {
        let [zenith, horizon, ground] = self.linear;
        let end = if height > 0.0 { zenith } else { ground };
        horizon + (end - horizon) * height.abs()
    }
}
