//! A light at the viewer.

use crate::tracer::{
    color::Color,
    error::GeometryError,
    light::source::{Glow, LightSize, Source},
    transform::Transform,
};

/// Light that arrives along every ray, a mirrored one too. It is never in shadow.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Headlight {
    pub(super) glow: Glow,
}

impl Headlight {
    /// Creates a headlight.
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
        Source::Viewer
    }

    pub(super) const fn size(&self) -> LightSize {
        LightSize::None
    }

    pub(super) const fn numbers(&self) -> [f64; 0] {
        []
    }
}
