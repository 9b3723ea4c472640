//! A mirror, in a scene file.

use crate::{
    scene::format::{
        color::ColorModel, material::kind::MaterialKind, object::object, texture::TextureModel,
    },
    tracer::{error::GeometryError, material::Material},
};

object! {
    /// Reflects what is around it, times a color.
    pub struct MirrorModel = "Mirror" {
        /// The color; white is the default.
        color: Color = ColorModel::WHITE,
        /// A texture, which the color is multiplied by.
        texture | map: Thing(Box<TextureModel>)?,
    }
}

impl MaterialKind for MirrorModel {
    fn build(&self) -> Result<Material, GeometryError> {
        Ok(Material::Mirror(self.color().build()))
    }

    fn texture(&self) -> Option<&TextureModel> {
        self.texture.as_deref()
    }

    fn texture_mut(&mut self) -> Option<&mut TextureModel> {
        self.texture.as_deref_mut()
    }
}
