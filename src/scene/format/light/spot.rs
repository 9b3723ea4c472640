//! A cone of light, in a scene file.

use glam::DVec3;

use crate::{
    scene::format::light::kind::{LightKind, light},
    tracer::{
        error::GeometryError,
        light::{Cone, Light, Spot},
    },
};

light! {
    /// A cone of light from a point.
    pub struct SpotLightModel = "Spot" {
        /// The position.
        position | location: Point,
        /// The direction of the cone's axis, of any length; give this or `look_at`.
        direction: Direction?,
        /// The point that the cone's axis goes through; give this or `direction`.
        look_at | point_at | target: Point?,
        /// The full angle of the cone in degrees, above 0 and below 180.
        angle: Angle,
        /// The part of the half angle over which the light fades at the edge, from 0 to 1; 0.15 is the
        /// default.
        blend | penumbra: Fraction = 0.15,
        /// The radius, 0 to 1e12, where light follows paths: larger lights cast softer shadows, equally bright
        /// ones. 0 is the default.
        radius: LightRadius = 0.0,
    }
    /// The intensity, from 0 to 1e12; 1 is the default; at distance 1 it makes a white matte surface white.
    intensity = 1.0
    falloff = InverseSquare
    shadows = true
    one of direction, look_at
}

impl LightKind for SpotLightModel {
    fn build(&self) -> Result<Light, GeometryError> {
        let to_target = || self.to_target().unwrap_or_default();
        let cone = Cone {
            direction: self.direction.map_or_else(to_target, DVec3::from),
            angle: self.angle,
            blend: self.blend(),
        };
        let (position, color) = (self.position.into(), self.color().build());
        let (intensity, falloff) = (self.intensity(), self.falloff().into());
        let spot = Spot::new(position, cone, color, intensity, falloff, self.shadows())?;
        spot.with_radius(self.radius()).map(Light::from)
    }

    fn to_target(&self) -> Option<DVec3> {
        let target = self.look_at.filter(|_| self.direction.is_none())?;
        let [from, to] = [self.position, target].map(DVec3::from);
        (from.is_finite() && to.is_finite()).then(|| to - from)
    }

    fn size(&self) -> Option<&'static str> {
        (self.radius() > 0.0).then_some("radius")
    }
}
