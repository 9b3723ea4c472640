//! A colored surface below a clear coat, in a scene file.

use crate::{
    scene::format::{material::kind::MaterialKind, object::object},
    tracer::{
        error::GeometryError,
        material::{Material, Principled},
    },
};

object! {
    /// A colored surface below a clear coat.
    pub struct PlasticModel = "Plastic" {
        /// The color.
        color: Color,
        /// The roughness of the coat, 0 for a mirror, or 0.01 to 1; 0.3 is the default.
        roughness: Roughness = 0.3,
        /// The index of refraction of the coat, from 0.25 to 4; 1.5 is the default.
        ior: Refraction = 1.5,
    }
}

impl MaterialKind for PlasticModel {
    fn build(&self) -> Result<Material, GeometryError> {
        let color = self.color.build();
        Principled::new(color, 0.0, self.roughness(), self.ior()).map(Material::from)
    }
}
