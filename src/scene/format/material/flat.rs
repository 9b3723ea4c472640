//! A surface without shading, in a scene file.

use crate::{
    scene::format::{
        color::or_white, material::kind::MaterialKind, object::object, texture::TextureModel,
    },
    tracer::{error::GeometryError, material::Material},
};

object! {
    /// Shows its color in any light.
    pub struct FlatModel = "Flat" {
        /// The color; with a `texture`, white is the default.
        color: Color?,
        /// A texture, which the color is multiplied by.
        texture | map: Thing(Box<TextureModel>)?,
    } any of color, texture
}

impl MaterialKind for FlatModel {
    fn build(&self) -> Result<Material, GeometryError> {
        Ok(Material::Flat(or_white(self.color.as_ref())))
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
