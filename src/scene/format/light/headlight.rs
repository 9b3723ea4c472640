//! A light at the viewer, in a scene file.

use crate::{
    scene::format::{color::ColorModel, light::LightKind, object::object},
    tracer::{
        error::GeometryError,
        light::{Headlight, Light},
    },
};

object! {
    /// Light from the viewer along every ray, mirrored ones as well; it casts no shadows.
    #[derive(Default)]
    pub struct HeadlightLightModel = "Headlight" {
        /// The color; white is the default.
        color: Color = ColorModel::WHITE,
        /// The intensity, from 0 to 1e12; 1 is the default.
        intensity: Intensity = 1.0,
        /// The name of the light: no other light of the scene has it.
        name: Name?,
    }
}

impl LightKind for HeadlightLightModel {
    fn build(&self) -> Result<Light, GeometryError> {
        let color = self.color().build();
        Headlight::new(color, self.intensity()).map(Light::from)
    }
}
