//! A cone of light.

use std::f64::consts::PI;

use glam::DVec3;

use crate::tracer::{
    color::Color,
    error::GeometryError,
    light::{
        Arriving, Glow, Incidence,
        falloff::{Falloff, shadow_ray, to_light},
    },
    transform::Transform,
    vector::{direction, finite, in_range, unit},
};

/// A cone of light from a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spot {
    pub(super) glow: Glow,
    position: DVec3,
    direction: DVec3,
    angle: f64,
    blend: f64,
    falloff: Falloff,
    shadows: bool,
    /// The axis of the cone, as a unit vector.
    axis: DVec3,
    /// The cosines of the half angles at which the light begins to fade, and ends.
    cosines: [f64; 2],
}

/// The shape of a cone of light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cone {
    /// The direction of its axis, of any length.
    pub direction: DVec3,
    /// The full angle in degrees, above 0 and below 180.
    pub angle: f64,
    /// The part of the half angle over which the light fades, in 0..=1.
    pub blend: f64,
}

impl Spot {
    /// Creates a spot at `position`. With `shadows`, geometries in its way cast shadows.
    ///
    /// # Errors
    ///
    /// Returns an error if `position` is not finite, if the direction of the cone has no direction,
    /// or if its angle or blend or the intensity is out of range.
    pub fn new(
        position: DVec3,
        cone: Cone,
        color: Color,
        intensity: f64,
        falloff: Falloff,
        shadows: bool,
    ) -> Result<Self, GeometryError> {
        let along = direction(finite(cone.direction, "direction")?, "direction")?;
        let angle = in_range(
            cone.angle,
            "angle",
            [f64::MIN_POSITIVE, 180.0_f64.next_down()],
        )?;
        let blend = in_range(cone.blend, "blend", [0.0, 1.0])?;
        let outer = angle / 2.0 * (PI / 180.0);
        let inner = outer * (1.0 - blend);
        Ok(Self {
            glow: Glow::new(color, intensity)?,
            position: finite(position, "position")?,
            direction: along,
            angle,
            blend,
            falloff,
            shadows,
            axis: unit(along),
            cosines: [libm::cos(inner), libm::cos(outer)],
        })
    }

    /// The position.
    pub const fn position(&self) -> DVec3 {
        self.position
    }

    /// The cone.
    pub const fn cone(&self) -> Cone {
        Cone {
            direction: self.direction,
            angle: self.angle,
            blend: self.blend,
        }
    }

    /// The weakening by distance.
    pub const fn falloff(&self) -> Falloff {
        self.falloff
    }

    /// True if geometries cast shadows in this light.
    pub const fn shadows(&self) -> bool {
        self.shadows
    }

    pub(super) fn placed(&self, transform: &Transform) -> Result<Self, GeometryError> {
        let along = transform.direction(self.direction);
        let along = direction(finite(along, "direction")?, "direction")?;
        Ok(Self {
            position: finite(transform.point(self.position), "position")?,
            direction: along,
            axis: unit(along),
            ..*self
        })
    }

    pub(super) fn arriving(&self, point: DVec3, _: DVec3) -> Option<Arriving> {
        let to_light = to_light(self.position, point)?;
        let l = unit(to_light);
        let cone = self.fade(l);
        let falloff = self.falloff.at(to_light);
        let arriving = Arriving {
            radiance: self.glow.radiance * (falloff * cone),
            from: Some(Incidence {
                l,
                falloff,
                cone,
                shadow: self.shadows.then(|| shadow_ray(to_light)),
            }),
        };
        Some(arriving)
    }

    /// The axis of the cone as a unit vector, and the cosines of the half angles at which the light
    /// begins to fade, and ends.
    pub(crate) const fn fading(&self) -> (DVec3, [f64; 2]) {
        (self.axis, self.cosines)
    }

    /// Returns the part of the light that the cone lets through, towards a surface that sees the
    /// light along `l`.
    fn fade(&self, l: DVec3) -> f64 {
        let cosine = -(l.dot(self.axis));
        let [inner, outer] = self.cosines;
        // The cosines of a tiny angle may be equal, too: then there is nothing to fade over.
        if inner <= outer {
            return if cosine >= outer { 1.0 } else { 0.0 };
        }
        let s = ((cosine - outer) / (inner - outer)).clamp(0.0, 1.0);
        s * s * (3.0 - 2.0 * s)
    }

    pub(super) fn numbers(&self) -> [f64; 10] {
        let [x, y, z] = self.position.to_array();
        let [a, b, c] = self.direction.to_array();
        let shadows = f64::from(u8::from(self.shadows));
        [
            x,
            y,
            z,
            a,
            b,
            c,
            self.angle,
            self.blend,
            self.falloff.number(),
            shadows,
        ]
    }
}
