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
    #[derive(Default)]
    pub struct DirectionalLightModel = "Directional" {
        /// The direction that the light travels in, of any length.
        direction: Direction,
        /// The angle that the light appears under in degrees, 0 to 90, where light follows paths: larger ones
        /// cast softer shadows. 0 is the default; the sun has 0.53.
        angle: LightAngle = 0.0,
    }
    /// The intensity, from 0 to 1e12; 1 is the default; head-on it makes a white matte surface white.
    intensity = 1.0
    shadows = true
}

impl LightKind for DirectionalLightModel {
    fn build(&self) -> Result<Light, GeometryError> {
        let color = self.color().build();
        let (intensity, shadows) = (self.intensity(), self.shadows());
        let light = Directional::new(self.direction.into(), color, intensity, shadows)?;
        light.with_angle(self.angle()).map(Light::from)
    }

    fn size(&self) -> Option<&'static str> {
        (self.angle() > 0.0).then_some("angle")
    }
}
