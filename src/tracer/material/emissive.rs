//! A surface that shines.

use crate::tracer::{
    color::Color, error::GeometryError, light::BRIGHTEST, radiance::Radiance, vector::in_range,
};

/// A surface that shines, whatever light falls on it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Emissive {
    pub(super) color: Color,
    pub(super) intensity: f64,
}

impl Emissive {
    /// Creates a surface that shines; with intensity 1 it shows `color`.
    ///
    /// # Errors
    ///
    /// Returns an error if the intensity lies outside of 0..=1e12.
    pub fn new(color: Color, intensity: f64) -> Result<Self, GeometryError> {
        let intensity = in_range(intensity, "intensity", [0.0, BRIGHTEST])?;
        Ok(Self { color, intensity })
    }

    /// The color.
    pub const fn color(&self) -> Color {
        self.color
    }

    /// The intensity.
    pub const fn intensity(&self) -> f64 {
        self.intensity
    }

    /// Returns the linear light of the color times the intensity.
    pub fn radiance(&self) -> Radiance {
        self.color.to_linear() * self.intensity
    }
}
