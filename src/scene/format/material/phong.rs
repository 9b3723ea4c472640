//! A surface with a highlight, in a scene file.

use crate::{
    scene::format::{
        color::{ColorModel, or_white},
        material::kind::MaterialKind,
        object::object,
        texture::TextureModel,
    },
    tracer::{
        color::Color,
        error::GeometryError,
        material::{Material, Phong},
    },
};

object! {
    /// Scatters light, with a highlight, and may reflect a part of what is around it.
    pub struct PhongModel = "Phong" {
        /// The color of scattered light; with a `texture`, white is the default.
        diffuse | color: Color?,
        /// A texture, which `diffuse` is multiplied by.
        texture | map: Thing(Box<TextureModel>)?,
        /// The color of the highlight; `"#808080"` is the default.
        specular: Color = ColorModel::Hex([0x80; 3]),
        /// The exponent of the highlight, above 0 and at most 1e6: the larger, the smaller the highlight;
        /// 32 is the default.
        exponent | shininess: Exponent = 32.0,
        /// The part of the surroundings that it reflects; black, which is nothing, is the default.
        reflection | reflectivity: Color = ColorModel::BLACK,
    } any of diffuse, texture
}

impl MaterialKind for PhongModel {
    fn build(&self) -> Result<Material, GeometryError> {
        let [diffuse, specular] = [or_white(self.diffuse.as_ref()), self.specular().build()];
        Phong::new(
            diffuse,
            specular,
            self.exponent(),
            self.reflection().build(),
        )
        .map(Material::from)
    }

    fn texture(&self) -> Option<&TextureModel> {
        self.texture.as_deref()
    }

    fn texture_mut(&mut self) -> Option<&mut TextureModel> {
        self.texture.as_deref_mut()
    }

    fn moot_field(&self) -> Option<[&'static str; 2]> {
        let specular = self.specular.as_ref().map(ColorModel::build);
        let is_moot = self.exponent.is_some() && specular == Some(Color::BLACK);
        is_moot.then_some(["exponent", "`specular` is black"])
    }
}
