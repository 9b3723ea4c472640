//! A surface that shines, in a scene file.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::{
    scene::format::{
        color::ColorModel,
        field::{fields, rules},
    },
    tracer::{
        error::GeometryError,
        material::{Emissive, Material},
    },
};

/// Shines, whatever light falls on it, but lights nothing else.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename = "Emissive", deny_unknown_fields)]
#[schemars(inline, transform = rules::<Self>)]
pub struct EmissiveModel {
    /// The color.
    pub color: ColorModel,
    /// The intensity, from 0 to 1e12; 1 is the default, which looks as `color`.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("default" = 1))]
    pub intensity: Option<f64>,
}

impl EmissiveModel {
    /// The material.
    pub(crate) fn build(&self) -> Result<Material, GeometryError> {
        Emissive::new(self.color.build(), self.intensity.unwrap_or(1.0)).map(Material::from)
    }
}

fields! {
    EmissiveModel {
        color: Color,
        intensity: Intensity = 1.0,
    } fixed {}
}
