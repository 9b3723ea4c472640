//! Light from everywhere, in a scene file.

use crate::{
    scene::format::{color::ColorModel, light::LightKind, object::object},
    tracer::{
        error::GeometryError,
        light::{Ambient, Light},
    },
};

object! {
    /// Light from everywhere; it casts no shadows.
    pub struct AmbientLightModel = "Ambient" {
        /// The color; white is the default.
        color: Color = ColorModel::WHITE,
        /// The intensity, from 0 to 1e12; 0.2 is the default.
        intensity | power | energy | strength: Intensity = 0.2,
        /// The name of the light: no other light of the scene has it.
        name: Name?,
    }
}

impl LightKind for AmbientLightModel {
    fn build(&self) -> Result<Light, GeometryError> {
        let color = self.color().build();
        Ambient::new(color, self.intensity()).map(Light::from)
    }
}
