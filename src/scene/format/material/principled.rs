//! A surface of metal, or of a clear coat above a colored one, or a mixture of both, in a scene file.

use crate::{
    scene::format::{material::kind::MaterialKind, object::object},
    tracer::{
        error::GeometryError,
        material::{Material, Principled},
    },
};

object! {
    /// A surface of metal, or of a clear coat above a colored one, or a mixture of both.
    pub struct PrincipledModel = "Principled" {
        /// The color.
        color | base_color | baseColorFactor: Color,
        /// The part that is metal, from 0 to 1; 0 is the default.
        metallic | metalness: Fraction = 0.0,
        /// The roughness, 0 for a mirror, or 0.01 to 1; 0.5 is the default.
        roughness: Roughness = 0.5,
        /// The index of refraction of the coat, from 0.25 to 4; 1.5 is the default.
        ior: Refraction = 1.5,
    }
}

impl MaterialKind for PrincipledModel {
    fn build(&self) -> Result<Material, GeometryError> {
        let color = self.color.build();
        Principled::new(color, self.metallic(), self.roughness(), self.ior()).map(Material::from)
    }
}
