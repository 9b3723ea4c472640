//! A surface of metal, in a scene file.

use crate::{
    scene::format::{material::kind::MaterialKind, object::object},
    tracer::{
        error::GeometryError,
        material::{Material, Principled},
    },
};

object! {
    /// A surface of metal.
    pub struct MetalModel = "Metal" {
        /// The color.
        color: Color,
        /// The roughness, 0 for a mirror, or 0.01 to 1; 0.2 is the default.
        roughness: Roughness = 0.2,
    }
}

impl MaterialKind for MetalModel {
    fn build(&self) -> Result<Material, GeometryError> {
        let color = self.color.build();
        Principled::new(color, 1.0, self.roughness(), 1.5).map(Material::from)
    }
}
