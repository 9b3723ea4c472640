//! A surface with a highlight, in a scene file.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::{
    scene::format::{
        color::ColorModel,
        field::{fields, rules},
    },
    tracer::{
        error::GeometryError,
        material::{Material, Phong},
    },
};

/// Scatters light, with a highlight, and may reflect a part of what is around it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename = "Phong", deny_unknown_fields)]
#[schemars(inline, transform = rules::<Self>)]
pub struct PhongModel {
    /// The color of scattered light.
    pub diffuse: ColorModel,
    /// The color of the highlight; `"#808080"` is the default.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("default" = "#808080"))]
    pub specular: Option<ColorModel>,
    /// The exponent of the highlight, above 0 and at most 1e6: the larger, the smaller the highlight;
    /// 32 is the default.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("default" = 32))]
    pub exponent: Option<f64>,
    /// The part of the surroundings that it reflects; black, which is nothing, is the default.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("default" = "#000000"))]
    pub reflection: Option<ColorModel>,
}

impl PhongModel {
    const SPECULAR: ColorModel = ColorModel::Hex([0x80; 3]);
    const EXPONENT: f64 = 32.0;

    /// The material.
    pub(crate) fn build(&self) -> Result<Material, GeometryError> {
        let or = |color: &Option<ColorModel>, default: ColorModel| {
            color.as_ref().unwrap_or(&default).build()
        };
        let specular = or(&self.specular, Self::SPECULAR);
        let reflection = or(&self.reflection, ColorModel::BLACK);
        let exponent = self.exponent.unwrap_or(Self::EXPONENT);
        Phong::new(self.diffuse.build(), specular, exponent, reflection).map(Material::from)
    }
}

fields! {
    PhongModel {
        diffuse: Color,
        specular: Color = Self::SPECULAR,
        exponent: Exponent = Self::EXPONENT,
        reflection: Color = ColorModel::BLACK,
    } fixed {}
}
