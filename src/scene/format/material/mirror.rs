//! A mirror, in a scene file.

use crate::{
    scene::format::{color::ColorModel, material::kind::MaterialKind, object::object},
    tracer::{error::GeometryError, material::Material},
};

object! {
    /// Reflects what is around it, times a color.
    pub struct MirrorModel = "Mirror" {
        /// The color; white is the default.
        color: Color = ColorModel::WHITE,
    }
}

impl MaterialKind for MirrorModel {
    fn build(&self) -> Result<Material, GeometryError> {
        Ok(Material::Mirror(self.color().build()))
    }
}
