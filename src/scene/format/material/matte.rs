//! A matte surface, in a scene file.

use crate::{
    scene::format::{material::kind::MaterialKind, object::object},
    tracer::{error::GeometryError, material::Material},
};

object! {
    /// Scatters light evenly to all sides.
    pub struct MatteModel = "Matte" {
        /// The color.
        color | diffuse: Color,
    }
}

impl MaterialKind for MatteModel {
    fn build(&self) -> Result<Material, GeometryError> {
        Ok(Material::Matte(self.color.build()))
    }
}
