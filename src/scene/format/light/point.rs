//! A light from a point, in a scene file.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::{
    scene::format::{
        color::ColorModel,
        field::{Name, Triple, fields, rules},
        light::FalloffModel,
    },
    tracer::{
        error::GeometryError,
        light::{Light, Point},
    },
};

/// Light from a point to all sides.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename = "Point", deny_unknown_fields)]
#[schemars(inline, transform = rules::<Self>)]
pub struct PointLightModel {
    /// The position.
    pub position: Triple,
    /// The color; white is the default.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("default" = "#ffffff"))]
    pub color: Option<ColorModel>,
    /// The intensity, from 0 to 1e12; 1 is the default; at distance 1 it makes a white matte surface white.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("default" = 1))]
    pub intensity: Option<f64>,
    /// The weakening by distance; `InverseSquare` is the default.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("default" = "InverseSquare"))]
    pub falloff: Option<FalloffModel>,
    /// True if geometries cast shadows in this light; the default.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("default" = true))]
    pub shadows: Option<bool>,
    /// The name of the light: no other light of the scene has it.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("minLength" = 1))]
    pub name: Option<Name>,
}

impl PointLightModel {
    /// The light.
    pub(crate) fn build(&self) -> Result<Light, GeometryError> {
        let color = ColorModel::or_white(self.color.as_ref());
        let (intensity, shadows) = (self.intensity.unwrap_or(1.0), self.shadows.unwrap_or(true));
        let falloff = self.falloff.unwrap_or_default().into();
        Point::new(self.position.into(), color, intensity, falloff, shadows).map(Light::from)
    }
}

fields! {
    PointLightModel {
        position: Point,
        color: Color = ColorModel::WHITE,
        intensity: Intensity = 1.0,
    } fixed {
        falloff,
        shadows,
        name,
    }
}
