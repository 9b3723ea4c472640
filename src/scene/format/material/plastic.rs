//! A colored surface below a clear coat, in a scene file.

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
    /// A colored surface below a clear coat.
    pub struct PlasticModel = "Plastic" {
        /// The color; with a `texture`, white is the default.
        color: Color?,
        /// A texture, which the color is multiplied by.
        texture | map: Thing(Box<TextureModel>)?,
        /// The roughness of the coat, 0 for a mirror, or 0.01 to 1; 0.3 is the default.
        roughness: Roughness = 0.3,
        /// The index of refraction of the coat, from 0.25 to 4; 1.5 is the default.
        ior: Refraction = 1.5,
    } any of color, texture
}

impl MaterialKind for PlasticModel {
    fn build(&self) -> Result<Material, GeometryError> {
        let color = or_white(self.color.as_ref());
        Principled::new(color, 0.0, self.roughness(), self.ior()).map(Material::from)
    }

    fn texture(&self) -> Option<&TextureModel> {
        self.texture.as_deref()
    }

    fn texture_mut(&mut self) -> Option<&mut TextureModel> {
        self.texture.as_deref_mut()
    }
}
