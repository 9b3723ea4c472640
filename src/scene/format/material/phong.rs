//! A surface with a highlight, in a scene file.

use crate::{
    scene::format::{color::ColorModel, material::kind::MaterialKind, object::object},
    tracer::{
        color::Color,
        error::GeometryError,
        material::{Material, Phong},
    },
};

object! {
    /// Scatters light, with a highlight, and may reflect a part of what is around it.
    pub struct PhongModel = "Phong" {
        /// The color of scattered light.
        diffuse | color: Color,
        /// The color of the highlight; `"#808080"` is the default.
        specular: Color = ColorModel::Hex([0x80; 3]),
        /// The exponent of the highlight, above 0 and at most 1e6: the larger, the smaller the highlight;
        /// 32 is the default.
        exponent | shininess: Exponent = 32.0,
        /// The part of the surroundings that it reflects; black, which is nothing, is the default.
        reflection | reflectivity: Color = ColorModel::BLACK,
    }
}

impl MaterialKind for PhongModel {
    fn build(&self) -> Result<Material, GeometryError> {
        let [diffuse, specular] = [self.diffuse.build(), self.specular().build()];
        Phong::new(
            diffuse,
            specular,
            self.exponent(),
            self.reflection().build(),
        )
        .map(Material::from)
    }

    fn moot_field(&self) -> Option<[&'static str; 2]> {
        let specular = self.specular.as_ref().map(ColorModel::build);
        let is_moot = self.exponent.is_some() && specular == Some(Color::BLACK);
        is_moot.then_some(["exponent", "`specular` is black"])
    }
}
