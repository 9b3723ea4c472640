//! A light from a point, in a scene file.

use crate::{
    scene::format::{
        color::ColorModel,
        light::{FalloffModel, LightKind},
        object::object,
    },
    tracer::{
        error::GeometryError,
        light::{Light, Point},
    },
};

object! {
    /// Light from a point in all directions.
    pub struct PointLightModel = "Point" {
        /// The position.
        position | location: Point,
        /// The color; white is the default.
        color: Color = ColorModel::WHITE,
        /// The intensity, from 0 to 1e12; 1 is the default; at distance 1 it makes a white matte surface white.
        intensity | power | energy | strength: Intensity = 1.0,
        /// The weakening by distance; `InverseSquare` is the default.
        falloff | decay: Choice(FalloffModel) = FalloffModel::InverseSquare,
        /// True if geometries cast shadows in this light; the default.
        shadows: Flag = true,
        /// The name of the light: no other light of the scene has it.
        name: Name?,
    }
}

impl LightKind for PointLightModel {
    fn build(&self) -> Result<Light, GeometryError> {
        let color = self.color().build();
        let (intensity, shadows) = (self.intensity(), self.shadows());
        let falloff = self.falloff().into();
        Point::new(self.position.into(), color, intensity, falloff, shadows).map(Light::from)
    }
}
