//! Light from everywhere, in a scene file.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::{
    scene::format::{
        color::ColorModel,
        field::{Name, fields, rules},
    },
    tracer::{
        error::GeometryError,
        light::{Ambient, Light},
    },
};

/// Light from everywhere, which is never in shadow.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename = "Ambient", deny_unknown_fields)]
#[schemars(inline, transform = rules::<Self>)]
pub struct AmbientLightModel {
    /// The color; white is the default.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("default" = "#ffffff"))]
    pub color: Option<ColorModel>,
    /// The intensity, from 0 to 1e12; 0.2 is the default.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("default" = 0.2))]
    pub intensity: Option<f64>,
    /// The name of the light: no other light of the scene has it.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("minLength" = 1))]
    pub name: Option<Name>,
}

impl AmbientLightModel {
    /// The light.
    pub(crate) fn build(&self) -> Result<Light, GeometryError> {
        let color = ColorModel::or_white(self.color.as_ref());
        Ambient::new(color, self.intensity.unwrap_or(0.2)).map(Light::from)
    }
}

fields! {
    AmbientLightModel {
        color: Color = ColorModel::WHITE,
        intensity: Intensity = 0.2,
    } fixed {
        name,
    }
}
