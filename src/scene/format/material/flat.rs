//! A surface without shading, in a scene file.

use crate::{
    scene::format::{material::kind::MaterialKind, object::object},
    tracer::{error::GeometryError, material::Material},
};

object! {
    /// Shows its color in any light.
    pub struct FlatModel = "Flat" {
        /// The color.
        color: Color,
    }
}

impl MaterialKind for FlatModel {
    fn build(&self) -> Result<Material, GeometryError> {
        Ok(Material::Flat(self.color.build()))
    }

    fn emits(&self) -> bool {
        true
    }
}
