//! Parallel light, in a scene file.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::{
    scene::format::{
        color::ColorModel,
        field::{Name, Triple, fields, rules},
    },
    tracer::{
        error::GeometryError,
        light::{Directional, Light},
    },
};

/// Parallel light, as from the sun.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename = "Directional", deny_unknown_fields)]
#[schemars(inline, transform = rules::<Self>)]
pub struct DirectionalLightModel {
    /// The direction that the light travels in, of any length.
    pub direction: Triple,
    /// The color; white is the default.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("default" = "#ffffff"))]
    pub color: Option<ColorModel>,
    /// The intensity, from 0 to 1e12; 1 is the default; head-on it makes a white matte surface white.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("default" = 1))]
    pub intensity: Option<f64>,
    /// True if geometries cast shadows in this light; the default.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("default" = true))]
    pub shadows: Option<bool>,
    /// The name of the light: no other light of the scene has it.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("minLength" = 1))]
    pub name: Option<Name>,
}

impl DirectionalLightModel {
    /// The light.
    pub(crate) fn build(&self) -> Result<Light, GeometryError> {
        let color = ColorModel::or_white(self.color.as_ref());
        let (intensity, shadows) = (self.intensity.unwrap_or(1.0), self.shadows.unwrap_or(true));
        Directional::new(self.direction.into(), color, intensity, shadows).map(Light::from)
    }
}

fields! {
    DirectionalLightModel {
        direction: Direction,
        color: Color = ColorModel::WHITE,
        intensity: Intensity = 1.0,
    } fixed {
        shadows,
        name,
    }
}
