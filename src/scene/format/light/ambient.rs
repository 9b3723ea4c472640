//! Light from everywhere, in a scene file.

use crate::{
    scene::format::light::kind::{LightKind, light},
    tracer::{
        error::GeometryError,
        light::{Ambient, Light},
    },
};

light! {
    /// Light from everywhere; it casts no shadows.
    pub struct AmbientLightModel = "Ambient" {}
    /// The intensity, from 0 to 1e12; 0.2 is the default.
    intensity = 0.2
}

impl LightKind for AmbientLightModel {
    fn build(&self) -> Result<Light, GeometryError> {
        let color = self.color().build();
        Ambient::new(color, self.intensity()).map(Light::from)
    }
}
