//! Parallel light, in a scene file.

use crate::{
    scene::format::light::kind::{LightKind, light},
    tracer::{
        error::GeometryError,
        light::{Directional, Light},
    },
};

light! {
    /// Parallel light, as from the sun.
    pub struct DirectionalLightModel = "Directional" {
        /// The direction that the light travels in, of any length.
        direction: Direction,
    }
    /// The intensity, from 0 to 1e12; 1 is the default; head-on it makes a white matte surface white.
    intensity = 1.0
    shadows = true
}

impl LightKind for DirectionalLightModel {
    fn build(&self) -> Result<Light, GeometryError> {
        let color = self.color().build();
        let (intensity, shadows) = (self.intensity(), self.shadows());
        Directional::new(self.direction.into(), color, intensity, shadows).map(Light::from)
    }
}
