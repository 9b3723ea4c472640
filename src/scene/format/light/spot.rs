//! A cone of light, in a scene file.

use glam::DVec3;
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
        light::{Cone, Light, Spot},
    },
};

/// A cone of light from a point.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename = "Spot", deny_unknown_fields)]
#[schemars(inline, transform = rules::<Self>)]
pub struct SpotLightModel {
    /// The position.
    pub position: Triple,
    /// The direction of the middle of the cone, of any length; give this or `look_at`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub direction: Option<Triple>,
    /// The point that the middle of the cone is aimed at; give this or `direction`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub look_at: Option<Triple>,
    /// The full angle of the cone in degrees, above 0 and below 180.
    pub angle: f64,
    /// The part of the half angle over which the light fades at the edge, from 0 to 1; 0.15 is the
    /// default.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("default" = 0.15))]
    pub blend: Option<f64>,
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

impl SpotLightModel {
    /// The light.
    pub(crate) fn build(&self) -> Result<Light, GeometryError> {
        let color = ColorModel::or_white(self.color.as_ref());
        let (intensity, shadows) = (self.intensity.unwrap_or(1.0), self.shadows.unwrap_or(true));
        let cone = Cone {
            direction: self.axis(),
            angle: self.angle,
            blend: self.blend.unwrap_or(0.15),
        };
        let falloff = self.falloff.unwrap_or_default().into();
        let position = self.position.into();
        Spot::new(position, cone, color, intensity, falloff, shadows).map(Light::from)
    }
}

impl SpotLightModel {
    /// The direction of the middle of the cone; 0 where neither `direction` nor `look_at` is given.
    pub(crate) fn axis(&self) -> DVec3 {
        let seen = self
            .look_at
            .map(|point| DVec3::from(point) - DVec3::from(self.position));
        self.direction
            .map(DVec3::from)
            .or(seen)
            .unwrap_or(DVec3::ZERO)
    }
}

fields! {
    SpotLightModel {
        position: Point,
        direction: Direction,
        look_at: Point,
        angle: Angle,
        blend: Fraction = 0.15,
        color: Color = ColorModel::WHITE,
        intensity: Intensity = 1.0,
    } fixed {
        falloff,
        shadows,
        name,
    }
}
