//! A mirror, in a scene file.

use crate::{
    scene::format::{color::ColorModel, object::object},
    tracer::{error::GeometryError, material::Material},
};

object! {
    /// Reflects what is around it, times a color.
    pub struct MirrorModel = "Mirror" {
        /// The color; white is the default.
        color: Color = ColorModel::WHITE,
    }
}

impl MirrorModel {
    /// The material.
    pub(crate) fn build(&self) -> Result<Material, GeometryError> {
        Ok(Material::Mirror(self.color().build()))
    }
}
