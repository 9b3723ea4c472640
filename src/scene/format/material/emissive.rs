//! A surface that shines, in a scene file.

use crate::{
    scene::format::{
        color::or_white, material::kind::MaterialKind, object::object, texture::TextureModel,
    },
    tracer::{
        error::GeometryError,
        material::{Emissive, Material},
    },
};

object! {
    /// Shines, whatever light falls on it, but lights nothing else.
    pub struct EmissiveModel = "Emissive" {
        /// The color; with a `texture`, white is the default.
        color: Color?,
        /// A texture, which the color is multiplied by.
        texture | map: Thing(Box<TextureModel>)?,
        /// The intensity, from 0 to 1e12; 1 is the default, which looks as `color`.
        intensity | strength: Intensity = 1.0,
    } any of color, texture
}

impl MaterialKind for EmissiveModel {
    fn build(&self) -> Result<Material, GeometryError> {
        Emissive::new(or_white(self.color.as_ref()), self.intensity()).map(Material::from)
    }

    fn emits(&self) -> bool {
        true
    }

    fn texture(&self) -> Option<&TextureModel> {
        self.texture.as_deref()
    }

    fn texture_mut(&mut self) -> Option<&mut TextureModel> {
        self.texture.as_deref_mut()
    }
}
