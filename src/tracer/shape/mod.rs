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
    /// The smallest `t` with `0 < t < ∞` at which the ray meets the shape.
    pub fn intersect(&self, ray: &Ray) -> Option<f64> {
        match self {
            Self::Plane(plane) => plane.intersect(ray),
            Self::Sphere(sphere) => sphere.intersect(ray),
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

/// `t`, if it lies before the ray's origin: `0 < t < ∞`.
pub(crate) fn in_front(t: f64) -> Option<f64> {
    (t > 0.0 && t < f64::INFINITY).then_some(t)
}
