//! Glass, in a scene file.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::{
    scene::format::{
        color::ColorModel,
        field::{fields, rules},
    },
    tracer::{
        error::GeometryError,
        material::{Glass, Material},
    },
};

/// Reflects and refracts. A plane or a disc of glass is a pane without thickness.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename = "Glass", deny_unknown_fields)]
#[schemars(inline, transform = rules::<Self>)]
pub struct GlassModel {
    /// The color that refracted light is multiplied by at each surface; white is the default.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("default" = "#ffffff"))]
    pub color: Option<ColorModel>,
    /// The index of refraction, from 0.25 to 4; 1.5 is the default.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("default" = 1.5))]
    pub ior: Option<f64>,
}

impl GlassModel {
    /// The material.
    pub(crate) fn build(&self) -> Result<Material, GeometryError> {
        let color = ColorModel::or_white(self.color.as_ref());
        Glass::new(color, self.ior.unwrap_or(1.5)).map(Material::from)
    }
}

fields! {
    GlassModel {
        color: Color = ColorModel::WHITE,
        ior: Refraction = 1.5,
    } fixed {}
}
