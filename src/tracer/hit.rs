//! The place where a ray meets a geometry.

use glam::DVec3;

use crate::tracer::{geometry::Geometry, ray::Ray};

/// Where and what a ray has hit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit<'a> {
    /// The ray's parameter at the point, `0 < t < ∞`: the distance from the ray's origin where
    /// its direction is a unit vector.
    pub t: f64,
    /// The point, in the world.
    pub point: DVec3,
    /// The unit normal at the point: outward from a closed shape, along `n` for a flat one, whichever
    /// side the ray comes from.
    pub normal: DVec3,
    /// Whether the ray comes from the side that the normal points to.
    pub front_face: bool,
    /// The geometry hit.
    pub geometry: &'a Geometry,
}

impl<'a> Hit<'a> {
    /// The hit of a ray at `t`, where the geometry has this normal.
    pub(crate) fn new(geometry: &'a Geometry, ray: &Ray, t: f64, normal: DVec3) -> Self {
        Self {
            t,
            point: ray.at(t),
            normal,
            front_face: ray.direction().dot(normal) < 0.0,
            geometry,
        }
    }
}
