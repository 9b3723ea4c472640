//! The geometries that cast the shadows of a light, and the end of its shadow rays.

use glam::DVec3;

use crate::tracer::{
    geometry::Geometry,
    light::{Light, falloff::END, source::Source},
    ray::Ray,
};

/// The end of all shadow rays of a light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Toward {
    /// They end at this point.
    Point(DVec3),
    /// All have this direction and no end.
    Direction(DVec3),
}

impl Toward {
    /// Returns the end of a light's shadow rays; `None` if it casts no shadows.
    pub(crate) fn of(light: &Light) -> Option<Self> {
        let toward = match light.source() {
            Source::Everywhere | Source::Surroundings | Source::Viewer => return None,
            Source::Direction(to_light) => Self::Direction(to_light),
            Source::Point { position, .. } => Self::Point(position),
        };
        light.shadows().then_some(toward)
    }

    /// Returns the shadow ray of a point.
    pub(crate) fn ray(self, point: DVec3) -> Ray {
        match self {
            Self::Point(light) => Ray::new(point, light - point),
            Self::Direction(direction) => Ray::new(point, direction),
        }
    }

    /// Returns the end of the rays as a `t`.
    pub(crate) const fn t_max(self) -> f64 {
        match self {
            Self::Point(_) => END,
            Self::Direction(_) => f64::INFINITY,
        }
    }
}

/// The geometries that cast shadows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Casters {
    /// Those without any glass.
    Opaque,
    /// Those that are glass, or partly so.
    Glass,
}

impl Casters {
    /// Returns true for a geometry that casts shadows.
    #[inline(always)]
    pub(super) fn hold(self, geometry: &Geometry) -> bool {
        geometry.has_glass() == (self == Self::Glass)
    }
}
