//! The surroundings that rays see where they hit nothing.

use glam::DVec3;

use crate::tracer::{
    error::GeometryError,
    light::{
        environment::{Sky, SkyLight},
        picture::SkyAxes,
    },
    radiance::Radiance,
    texels::Texels,
    vector::{direction, finite, unit},
};

/// The surroundings that rays see where they hit nothing, in place of one color. They light nothing by
/// themselves: light from all around is an [`Environment`](crate::light::Environment).
#[derive(Clone, Debug, PartialEq)]
pub struct Backdrop(Scenery);

#[derive(Clone, Debug, PartialEq)]
enum Scenery {
    Sky { sky: SkyLight, up: DVec3 },
    Picture { texels: Texels, axes: SkyAxes },
}

impl Backdrop {
    /// Creates a sky whose zenith lies in the direction `up`.
    ///
    /// # Errors
    ///
    /// Returns an error if `up` has no direction.
    pub fn of_sky(sky: Sky, up: DVec3) -> Result<Self, GeometryError> {
        let up = unit(direction(finite(up, "up")?, "up")?);
        let sky = SkyLight::new(sky);
        Ok(Self(Scenery::Sky { sky, up }))
    }

    /// Creates a picture of all directions: the zenith, in the direction `up`, is its first row, and its middle
    /// lies in the direction -z, turned about the zenith by `rotation`, in degrees, counterclockwise as seen
    /// from there.
    ///
    /// # Errors
    ///
    /// Returns an error if `up` has no direction, or if `rotation` is not finite.
    pub fn of_picture(texels: Texels, up: DVec3, rotation: f64) -> Result<Self, GeometryError> {
        let axes = SkyAxes::turned(up, rotation)?;
        Ok(Self(Scenery::Picture { texels, axes }))
    }

    /// The name of the kind of backdrop, in lowercase.
    pub const fn kind(&self) -> &'static str {
        match self.0 {
            Scenery::Sky { .. } => "sky",
            Scenery::Picture { .. } => "image",
        }
    }

    /// Returns the light from the direction of a unit vector.
    pub(crate) fn radiance(&self, d: DVec3) -> Radiance {
        match &self.0 {
            Scenery::Sky { sky, up } => sky.light(d.dot(*up)),
            Scenery::Picture { texels, axes } => axes.radiance(texels, d),
        }
    }

    /// Returns the largest channel of all its light, or more.
    pub(crate) const fn brightest(&self) -> f64 {
        match &self.0 {
            Scenery::Sky { .. } => 1.0,
            Scenery::Picture { texels, .. } => texels.brightest(),
        }
    }

    /// Calls `see` with all numbers.
    pub(crate) fn each_number(&self, mut see: impl FnMut(f64)) {
        match &self.0 {
            Scenery::Sky { sky, up } => {
                up.to_array().into_iter().for_each(&mut see);
                sky.sky.channels().for_each(see);
            }
            Scenery::Picture { texels, axes } => {
                axes.numbers().for_each(&mut see);
                texels.numbers().for_each(see);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tracer::{
        color::Color,
        light::{environment::Environment, picture::SkyPicture},
        random::Rng,
        shape::target::on_ball,
    };

    #[test]
    fn a_backdrop_looks_like_the_light_of_the_same() {
        let mut random = Rng(4);
        let mut number = || f64::from(random.magnitude(-2.0, 1.0) as f32);
        let light = (0..6 * 3).map(|_| [number() as f32, 0.5, number() as f32]);
        let texels = Texels::new(6, 3, light.collect()).unwrap();
        let [zenith, horizon, ground] =
            [0.1, 0.6, 0.9].map(|part| Color::new(part, 0.5, 1.0 - part));
        let sky = Sky {
            zenith,
            horizon,
            ground,
        };
        let up = DVec3::new(0.2, 0.9, -0.3);
        let picture = SkyPicture::new(texels.clone()).unwrap();
        let pairs = [
            (
                Backdrop::of_sky(sky, up).unwrap(),
                Environment::of_sky(sky, up, 1.0).unwrap(),
            ),
            (
                Backdrop::of_picture(texels, up, 77.0).unwrap(),
                Environment::of_picture(&picture, up, 77.0, 1.0).unwrap(),
            ),
        ];
        for (backdrop, environment) in pairs {
            for _ in 0..1000 {
                let d = on_ball([random.signed().abs(), random.signed().abs()], DVec3::Y);
                let seen = backdrop.radiance(d);
                assert_eq!(seen, environment.radiance(d));
                assert!(seen.max_channel() <= backdrop.brightest());
            }
        }
    }

    #[test]
    fn a_sky_blends_with_the_height() {
        let sky = Sky {
            zenith: Color::WHITE,
            horizon: Color::BLACK,
            ground: Color::new(1.0, 0.0, 0.0),
        };
        let backdrop = Backdrop::of_sky(sky, 3.0 * DVec3::Y).unwrap();
        let at = |d: DVec3| backdrop.radiance(d).channels;
        assert_eq!(at(DVec3::Y), [1.0; 3]);
        assert_eq!(at(DVec3::Z), [0.0; 3]);
        assert_eq!(at(DVec3::new(0.8, 0.6, 0.0)), [0.6; 3]);
        assert_eq!(at(DVec3::new(0.0, -0.8, 0.6)), [0.8, 0.0, 0.0]);
        assert!(Backdrop::of_sky(sky, DVec3::ZERO).is_err());
    }
}
