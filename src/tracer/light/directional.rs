//! Parallel light.

use std::f64::consts::PI;

use glam::DVec3;

use crate::tracer::{
    color::Color,
    error::GeometryError,
    light::source::{Glow, LightSize, Source, WIDEST},
    transform::Transform,
    vector::{direction, finite, in_range},
};

/// Parallel light, as from the sun.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Directional {
    pub(super) glow: Glow,
    direction: DVec3,
    shadows: bool,
    angle: f64,
}

impl Directional {
    /// Creates a light that travels along `direction`, which may have any length. With `shadows`,
    /// geometries in its way cast shadows.
    ///
    /// # Errors
    ///
    /// Returns an error if `direction` has no direction, or if the intensity lies outside of
    /// 0..=1e12.
    pub fn new(
        towards: DVec3,
        color: Color,
        intensity: f64,
        shadows: bool,
    ) -> Result<Self, GeometryError> {
        Ok(Self {
            glow: Glow::new(color, intensity)?,
            direction: direction(finite(towards, "direction")?, "direction")?,
            shadows,
            angle: 0.0,
        })
    }

    /// Gives the light an angle, which it has where light follows paths: a disc that shines evenly, and that
    /// brings as much light to a surface as the parallel light does. The angle is the full one, in degrees:
    /// 0.53 for the sun.
    ///
    /// # Errors
    ///
    /// Returns an error if the angle lies outside of 0..=90.
    pub fn with_angle(self, angle: f64) -> Result<Self, GeometryError> {
        let angle = in_range(angle, "angle", [0.0, WIDEST])?;
        Ok(Self { angle, ..self })
    }

    /// The full angle of the disc in degrees, where light follows paths.
    pub const fn angle(&self) -> f64 {
        self.angle
    }

    /// The direction that the light travels in, as given.
    pub const fn direction(&self) -> DVec3 {
        self.direction
    }

    /// True if geometries cast shadows in this light.
    pub const fn shadows(&self) -> bool {
        self.shadows
    }

    pub(super) fn placed(&self, transform: &Transform) -> Result<Self, GeometryError> {
        let towards = transform.direction(self.direction);
        Ok(Self {
            direction: direction(finite(towards, "direction")?, "direction")?,
            ..*self
        })
    }

    pub(super) fn source(&self) -> Source {
        Source::Direction(-self.direction)
    }

    pub(super) fn size(&self) -> LightSize {
        let sine = libm::sin(self.angle / 2.0 * (PI / 180.0));
        match sine > 0.0 {
            true => LightSize::Disc(sine * sine),
            false => LightSize::None,
        }
    }

    pub(super) fn numbers(&self) -> impl Iterator<Item = f64> + use<> {
        let [x, y, z] = self.direction.to_array();
        let size = (self.angle > 0.0).then_some(self.angle);
        [x, y, z, f64::from(u8::from(self.shadows))]
            .into_iter()
            .chain(size)
    }
}
