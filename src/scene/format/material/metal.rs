//! A surface of metal, in a scene file.

use crate::{
    scene::format::{
        color::or_white, material::kind::MaterialKind, object::object, texture::TextureModel,
    },
    tracer::{
        error::GeometryError,
        material::{Material, Principled},
    },
};

object! {
    /// A surface of metal.
    pub struct MetalModel = "Metal" {
        /// The color; with a `texture`, white is the default.
        color: Color?,
        /// A texture, which the color is multiplied by.
        texture | map: Thing(Box<TextureModel>)?,
        /// The roughness, 0 for a mirror, or 0.01 to 1; 0.2 is the default.
        roughness: Roughness = 0.2,
    } any of color, texture
}

impl MaterialKind for MetalModel {
    fn build(&self) -> Result<Material, GeometryError> {
        let color = or_white(self.color.as_ref());
        Principled::new(color, 1.0, self.roughness(), 1.5).map(Material::from)
    }

    fn texture(&self) -> Option<&TextureModel> {
        self.texture.as_deref()
    }

    fn texture_mut(&mut self) -> Option<&mut TextureModel> {
        self.texture.as_deref_mut()
    }
}
