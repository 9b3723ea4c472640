//! A surface that shines, in a scene file.

use crate::{
    scene::format::{material::kind::MaterialKind, object::object},
    tracer::{
        error::GeometryError,
        material::{Emissive, Material},
    },
};

object! {
    /// Shines, whatever light falls on it, but lights nothing else.
    pub struct EmissiveModel = "Emissive" {
        /// The color.
        color: Color,
        /// The intensity, from 0 to 1e12; 1 is the default, which looks as `color`.
        intensity | strength: Intensity = 1.0,
    }
}

impl MaterialKind for EmissiveModel {
    fn build(&self) -> Result<Material, GeometryError> {
        Emissive::new(self.color.build(), self.intensity()).map(Material::from)
    }

    fn emits(&self) -> bool {
        true
    }
}
