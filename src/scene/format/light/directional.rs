//! Parallel light, in a scene file.

use crate::{
    scene::format::{color::ColorModel, light::LightKind, object::object},
    tracer::{
        error::GeometryError,
        light::{Directional, Light},
    },
};

object! {
    /// Parallel light, as from the sun.
    pub struct DirectionalLightModel = "Directional" {
        /// The direction that the light travels in, of any length.
        direction: Direction,
        /// The color; white is the default.
        color: Color = ColorModel::WHITE,
        /// The intensity, from 0 to 1e12; 1 is the default; head-on it makes a white matte surface white.
        intensity | power | energy | strength: Intensity = 1.0,
        /// True if geometries cast shadows in this light; the default.
        shadows: Flag = true,
        /// The name of the light: no other light of the scene has it.
        name: Name?,
    }
}

impl LightKind for DirectionalLightModel {
    fn build(&self) -> Result<Light, GeometryError> {
        let color = self.color().build();
        let (intensity, shadows) = (self.intensity(), self.shadows());
        Directional::new(self.direction.into(), color, intensity, shadows).map(Light::from)
    }
}
