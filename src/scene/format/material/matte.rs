//! A matte surface, in a scene file.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::{
    scene::format::{
        color::ColorModel,
        field::{fields, rules},
    },
    tracer::{error::GeometryError, material::Material},
};

/// Scatters light evenly to all sides.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename = "Matte", deny_unknown_fields)]
#[schemars(inline, transform = rules::<Self>)]
pub struct MatteModel {
    /// The color.
    pub color: ColorModel,
}

impl MatteModel {
    /// The material.
    pub(crate) fn build(&self) -> Result<Material, GeometryError> {
        Ok(Material::Matte(self.color.build()))
    }
}

fields! {
    MatteModel {
        color: Color,
    } fixed {}
}
