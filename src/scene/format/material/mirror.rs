//! A mirror, in a scene file.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::{
    scene::format::{
        color::ColorModel,
        field::{fields, rules},
    },
    tracer::{error::GeometryError, material::Material},
};

/// Reflects what is around it, times a color.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename = "Mirror", deny_unknown_fields)]
#[schemars(inline, transform = rules::<Self>)]
pub struct MirrorModel {
    /// The color; white is the default.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("default" = "#ffffff"))]
    pub color: Option<ColorModel>,
}

impl MirrorModel {
    /// The material.
    pub(crate) fn build(&self) -> Result<Material, GeometryError> {
        Ok(Material::Mirror(ColorModel::or_white(self.color.as_ref())))
    }
}

fields! {
    MirrorModel {
        color: Color = ColorModel::WHITE,
    } fixed {}
}
