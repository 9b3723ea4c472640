//! Parallel light.

use glam::DVec3;

use crate::tracer::{
    color::Color,
    error::GeometryError,
    light::source::{Glow, Source},
    transform::Transform,
    vector::{direction, finite},
};

/// Parallel light, as from the sun.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Directional {
    pub(super) glow: Glow,
    direction: DVec3,
    shadows: bool,
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
        })
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

    pub(super) fn numbers(&self) -> [f64; 4] {
        let [x, y, z] = self.direction.to_array();
        [x, y, z, f64::from(u8::from(self.shadows))]
    }
}
