//! A light at the viewer, in a scene file.

use crate::{
    scene::format::light::kind::{LightKind, light},
    tracer::{
        error::GeometryError,
        light::{Headlight, Light},
    },
};

light! {
    /// Light from the viewer along every ray, mirrored ones as well; it casts no shadows.
    #[derive(Default)]
    pub struct HeadlightLightModel = "Headlight" {}
    /// The intensity, from 0 to 1e12; 1 is the default.
    intensity = 1.0
}

impl LightKind for HeadlightLightModel {
    fn build(&self) -> Result<Light, GeometryError> {
        let color = self.color().build();
        Headlight::new(color, self.intensity()).map(Light::from)
    }
}
