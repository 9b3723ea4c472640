//! Light from everywhere.

use crate::tracer::{
    color::Color,
    error::GeometryError,
    light::source::{Glow, LightSize, Source},
    transform::Transform,
};

/// Light from everywhere, which is never in shadow: the same on every surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ambient {
    pub(super) glow: Glow,
}

impl Ambient {
    /// Creates an ambient light.
    ///
    /// # Errors
    ///
    /// Returns an error if the intensity lies outside of 0..=1e12.
    pub fn new(color: Color, intensity: f64) -> Result<Self, GeometryError> {
        let glow = Glow::new(color, intensity)?;
        Ok(Self { glow })
    }

    pub(super) const fn shadows(&self) -> bool {
        false
    }

    pub(super) const fn placed(&self, _: &Transform) -> Result<Self, GeometryError> {
        Ok(*self)
    }

    pub(super) const fn source(&self) -> Source {
        Source::Everywhere
    }

    pub(super) const fn size(&self) -> LightSize {
        LightSize::None
    }

    pub(super) const fn numbers(&self) -> [f64; 0] {
        []
    }
}
