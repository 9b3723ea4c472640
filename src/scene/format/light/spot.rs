//! A cone of light, in a scene file.

use glam::DVec3;

use crate::{
    scene::format::{
        color::ColorModel,
        light::{FalloffModel, LightKind},
        object::object,
    },
    tracer::{
        error::GeometryError,
        light::{Cone, Light, Spot},
    },
};

object! {
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
    } one of direction, look_at
}

impl LightKind for SpotLightModel {
    fn build(&self) -> Result<Light, GeometryError> {
        let cone = Cone {
            direction: self.axis(),
            angle: self.angle,
            blend: self.blend(),
        };
        let (color, intensity) = (self.color().build(), self.intensity());
        let (falloff, shadows) = (self.falloff().into(), self.shadows());
        let position = self.position.into();
        Spot::new(position, cone, color, intensity, falloff, shadows).map(Light::from)
    }

    fn to_target(&self) -> Option<DVec3> {
        let points = [self.look_at?, self.position];
        let are_finite = points.as_flattened().iter().all(|x| x.is_finite());
        (self.direction.is_none() && are_finite).then(|| self.axis())
    }
}

impl SpotLightModel {
    /// The direction of the middle of the cone; 0 where neither `direction` nor `look_at` is given.
    pub(crate) fn axis(&self) -> DVec3 {
        let seen = |point| DVec3::from(point) - DVec3::from(self.position);
        let direction = self.direction.map(DVec3::from);
        direction.or(self.look_at.map(seen)).unwrap_or_default()
    }
}
