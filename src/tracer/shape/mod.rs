//! The shapes that a ray can meet.

pub(crate) mod plane;
pub(crate) mod sphere;

use glam::DVec3;

use crate::tracer::{
    ray::Ray,
    shape::{plane::Plane, sphere::Sphere},
};

/// A surface without a color.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shape {
    /// An infinite plane.
    Plane(Plane),
    /// The surface of a ball.
    Sphere(Sphere),
}

impl Shape {
    /// The lower and the upper corner of the least box along the axes that holds the shape; none
    /// where it has no end, or the box is not finite in f64.
    pub fn bounds(&self) -> Option<[DVec3; 2]> {
        match self {
            Self::Plane(plane) => plane.bounds(),
            Self::Sphere(sphere) => sphere.bounds(),
        }
    }

    /// The smallest `t` with `0 < t < t_max` at which the ray meets the shape. An infinite `t_max`
    /// leaves out nothing, as an infinite `t` is never a hit.
    pub fn intersect(&self, ray: &Ray, t_max: f64) -> Option<f64> {
        match self {
            Self::Plane(plane) => plane.intersect(ray, t_max),
            Self::Sphere(sphere) => sphere.intersect(ray, t_max),
        }
    }

    /// The unit normal at the point of the ray at `t`: outward for a sphere, along the plane's
    /// `n` for a plane.
    pub fn normal_at(&self, ray: &Ray, t: f64) -> DVec3 {
        match self {
            Self::Plane(plane) => plane.unit_normal(),
            Self::Sphere(sphere) => sphere.normal_at(ray, t),
        }
    }

    /// The sphere, if it is one: most scenes hold little else, and a sphere has ways of its own.
    pub(crate) const fn sphere(&self) -> Option<&Sphere> {
        match self {
            Self::Plane(_) => None,
            Self::Sphere(sphere) => Some(sphere),
        }
    }
}

impl From<Plane> for Shape {
    fn from(plane: Plane) -> Self {
        Self::Plane(plane)
    }
}

impl From<Sphere> for Shape {
    fn from(sphere: Sphere) -> Self {
        Self::Sphere(sphere)
    }
}

/// `t`, if it lies before the ray's origin and nearer than `t_max`: `0 < t < t_max`.
pub(crate) fn in_front(t: f64, t_max: f64) -> Option<f64> {
    (t > 0.0 && t < t_max).then_some(t)
}
