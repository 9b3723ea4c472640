//! A light at the viewer, in a scene file.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::{
    scene::format::{
        color::ColorModel,
        field::{Name, fields, rules},
    },
    tracer::{
        error::GeometryError,
        light::{Headlight, Light},
    },
};

/// Light along whatever ray arrives, a mirrored one too. It is never in shadow.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename = "Headlight", deny_unknown_fields)]
#[schemars(inline, transform = rules::<Self>)]
pub struct HeadlightLightModel {
    /// The color; white is the default.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("default" = "#ffffff"))]
    pub color: Option<ColorModel>,
    /// The intensity, from 0 to 1e12; 1 is the default.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("default" = 1))]
    pub intensity: Option<f64>,
    /// The name of the light: no other light of the scene has it.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("minLength" = 1))]
    pub name: Option<Name>,
}

impl HeadlightLightModel {
    /// The light.
    pub(crate) fn build(&self) -> Result<Light, GeometryError> {
        let color = ColorModel::or_white(self.color.as_ref());
        Headlight::new(color, self.intensity.unwrap_or(1.0)).map(Light::from)
    }
}

fields! {
    HeadlightLightModel {
        color: Color = ColorModel::WHITE,
        intensity: Intensity = 1.0,
    } fixed {
        name,
    }
}
