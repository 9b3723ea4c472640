//! Glass, in a scene file.

use crate::{
    scene::format::{
        color::ColorModel, material::kind::MaterialKind, object::object, texture::TextureModel,
    },
    tracer::{
        error::GeometryError,
        material::{Glass, Material},
    },
};

object! {
    /// Reflects and refracts. A plane or a disc of glass is a pane without thickness.
    pub struct GlassModel = "Glass" {
        /// The color that refracted light is multiplied by at each surface; white is the default.
        color: Color = ColorModel::WHITE,
        /// A texture, which the color is multiplied by.
        texture | map: Thing(Box<TextureModel>)?,
        /// The index of refraction, from 0.25 to 4; 1.5 is the default.
        ior | index: Refraction = 1.5,
        /// The roughness where light follows paths, 0 for a smooth surface, or 0.01 to 1; 0 is the default.
        roughness: Roughness = 0.0,
    }
}

impl MaterialKind for GlassModel {
    fn build(&self) -> Result<Material, GeometryError> {
        let color = self.color().build();
        let glass = Glass::new(color, self.ior())?;
        glass.with_roughness(self.roughness()).map(Material::from)
    }

    fn is_glass(&self) -> bool {
        true
    }

    fn texture(&self) -> Option<&TextureModel> {
        self.texture.as_deref()
    }

    fn texture_mut(&mut self) -> Option<&mut TextureModel> {
        self.texture.as_deref_mut()
    }
}
