//! A cone of light.

use std::f64::consts::PI;

use glam::DVec3;

use crate::tracer::{
    color::Color,
    error::GeometryError,
    light::{
        falloff::{Fading, Falloff},
        source::{Glow, LARGEST, LightSize, Source},
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
    fading: Fading,
    radius: f64,
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
            fading: Fading {
                axis: unit(along),
                cosines: [libm::cos(inner), libm::cos(outer)],
            },
            radius: 0.0,
        })
    }

    /// Gives the light a radius, which it has where light follows paths: a ball that shines evenly, and
    /// that brings as much light to a surface as the point does. No ray hits it.
    ///
    /// # Errors
    ///
    /// Returns an error if the radius lies outside of 0..=1e12.
    pub fn with_radius(self, radius: f64) -> Result<Self, GeometryError> {
        let radius = in_range(radius, "radius", [0.0, LARGEST])?;
        Ok(Self { radius, ..self })
    }

    /// The radius, where light follows paths.
    pub const fn radius(&self) -> f64 {
        self.radius
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
            fading: Fading {
                axis: unit(along),
                ..self.fading
            },
            ..*self
        })
    }

    pub(super) const fn source(&self) -> Source {
        Source::Point {
            position: self.position,
            falloff: self.falloff,
            cone: Some(self.fading),
        }
    }

    pub(super) const fn size(&self) -> LightSize {
        match self.radius > 0.0 {
            true => LightSize::Ball(self.radius),
            false => LightSize::None,
        }
    }

    pub(super) fn numbers(&self) -> impl Iterator<Item = f64> + use<> {
        let [x, y, z] = self.position.to_array();
        let [a, b, c] = self.direction.to_array();
        let shadows = f64::from(u8::from(self.shadows));
        let size = (self.radius > 0.0).then_some(self.radius);
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
        .into_iter()
        .chain(size)
    }
}
