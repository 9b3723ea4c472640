//! A surface that shines.

use crate::tracer::{
    color::Color,
    error::GeometryError,
    light::source::BRIGHTEST,
    material::{
        lobes::Lobes,
        parameters::{Number, parameters},
    },
    radiance::Radiance,
    vector::in_range,
};

parameters! {
    /// A surface that shines, whatever light falls on it.
    pub struct Emissive {
        /// The color.
        color: Color,
        /// The intensity.
        intensity: Number,
    }
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

    /// Creates a surface that shows `color`.
    pub(super) const fn one(color: Color) -> Self {
        let intensity = 1.0;
        Self { color, intensity }
    }

    /// Returns the linear light of the color times the intensity.
    pub fn radiance(&self) -> Radiance {
        self.color.to_linear() * self.intensity
    }
}

pub(super) const EQUATION: &str = "intensity · lin(color)";

pub(super) const fn lobes(emissive: &Emissive) -> Lobes<'_> {
    Lobes {
        emission: Some(*emissive),
        ..Lobes::NONE
    }
}
