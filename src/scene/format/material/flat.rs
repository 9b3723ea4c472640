//! A surface without shading, in a scene file.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::{
    scene::format::{
        color::ColorModel,
        field::{fields, rules},
    },
    tracer::{error::GeometryError, material::Material},
};

/// Shows its color in any light.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename = "Flat", deny_unknown_fields)]
#[schemars(inline, transform = rules::<Self>)]
pub struct FlatModel {
    /// The color.
    pub color: ColorModel,
}

impl FlatModel {
    /// The material.
    pub(crate) fn build(&self) -> Result<Material, GeometryError> {
        Ok(Material::Flat(self.color.build()))
    }
}

fields! {
    FlatModel {
        color: Color,
    } fixed {}
}
