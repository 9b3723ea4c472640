//! A surface of metal, or of a clear coat above a colored one, or a mixture of both, in a scene file.

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
    /// A surface of metal, or of a clear coat above a colored one, or a mixture of both.
    pub struct PrincipledModel = "Principled" {
        /// The color; with a `texture`, white is the default.
        color | base_color | baseColorFactor: Color?,
        /// A texture, which the color is multiplied by.
        texture | map: Thing(Box<TextureModel>)?,
        /// The part that is metal, from 0 to 1; 0 is the default.
        metallic | metalness: Fraction = 0.0,
        /// The roughness, 0 for a mirror, or 0.01 to 1; 0.5 is the default.
        roughness: Roughness = 0.5,
        /// The index of refraction of the coat, from 0.25 to 4; 1.5 is the default.
        ior: Refraction = 1.5,
    } any of color, texture
}

impl MaterialKind for PrincipledModel {
    fn build(&self) -> Result<Material, GeometryError> {
        let color = or_white(self.color.as_ref());
        Principled::new(color, self.metallic(), self.roughness(), self.ior()).map(Material::from)
    }

    fn texture(&self) -> Option<&TextureModel> {
        self.texture.as_deref()
    }

    fn texture_mut(&mut self) -> Option<&mut TextureModel> {
        self.texture.as_deref_mut()
    }
}
