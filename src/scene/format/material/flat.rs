//! A surface without shading, in a scene file.

use crate::{
    scene::format::object::object,
    tracer::{error::GeometryError, material::Material},
};

object! {
    /// Shows its color in any light.
    pub struct FlatModel = "Flat" {
        /// The color.
        color: Color,
    }
}

impl FlatModel {
    /// The material.
    pub(crate) fn build(&self) -> Result<Material, GeometryError> {
        Ok(Material::Flat(self.color.build()))
    }
}
