//! A light from a point, in a scene file.

use crate::{
    scene::format::light::kind::{LightKind, light},
    tracer::{
        error::GeometryError,
        light::{Light, Point},
    },
};

light! {
    /// Light from a point in all directions.
    pub struct PointLightModel = "Point" {
        /// The position.
        position | location: Point,
        /// The radius, 0 to 1e12, where light follows paths: larger lights cast softer shadows, equally bright
        /// ones. 0 is the default.
        radius: LightRadius = 0.0,
    }
    /// The intensity, from 0 to 1e12; 1 is the default; at distance 1 it makes a white matte surface white.
    intensity = 1.0
    falloff = InverseSquare
    shadows = true
}

impl LightKind for PointLightModel {
    fn build(&self) -> Result<Light, GeometryError> {
        let color = self.color().build();
        let (intensity, shadows) = (self.intensity(), self.shadows());
        let falloff = self.falloff().into();
        let point = Point::new(self.position.into(), color, intensity, falloff, shadows)?;
        point.with_radius(self.radius()).map(Light::from)
    }

    fn size(&self) -> Option<&'static str> {
        (self.radius() > 0.0).then_some("radius")
    }
}
