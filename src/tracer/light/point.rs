//! A light from a point to all sides.

use glam::DVec3;

use crate::tracer::{
    color::Color,
    error::GeometryError,
    light::{
        falloff::Falloff,
        source::{Glow, LARGEST, LightSize, Source},
    },
    transform::Transform,
    vector::{finite, in_range},
};

/// Light from a point in all directions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    pub(super) glow: Glow,
    position: DVec3,
    falloff: Falloff,
    shadows: bool,
    radius: f64,
}

impl Point {
    /// Creates a light at `position`. With `shadows`, geometries in its way cast shadows.
    ///
    /// # Errors
    ///
    /// Returns an error if `position` is not finite, or if the intensity lies outside of 0..=1e12.
    pub fn new(
        position: DVec3,
        color: Color,
        intensity: f64,
        falloff: Falloff,
        shadows: bool,
    ) -> Result<Self, GeometryError> {
        Ok(Self {
            glow: Glow::new(color, intensity)?,
            position: finite(position, "position")?,
            falloff,
            shadows,
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

    /// The weakening by distance.
    pub const fn falloff(&self) -> Falloff {
        self.falloff
    }

    /// True if geometries cast shadows in this light.
    pub const fn shadows(&self) -> bool {
        self.shadows
    }

    pub(super) fn placed(&self, transform: &Transform) -> Result<Self, GeometryError> {
        Ok(Self {
            position: finite(transform.point(self.position), "position")?,
            ..*self
        })
    }

    pub(super) const fn source(&self) -> Source {
        Source::Point {
            position: self.position,
            falloff: self.falloff,
            cone: None,
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
        let shadows = f64::from(u8::from(self.shadows));
        let size = (self.radius > 0.0).then_some(self.radius);
        [x, y, z, self.falloff.number(), shadows]
            .into_iter()
            .chain(size)
    }
}
