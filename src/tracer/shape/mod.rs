//! The shapes that a ray can hit, one per file.
//!
//! Everything that the rest of the crate needs from a shape is a method here, implemented in the
//! file of the shape. No other code matches on the shape, except for the fast paths of spheres and
//! planes.

#[cfg(test)]
pub(crate) mod any;
pub(crate) mod disc;
pub(crate) mod plane;
pub(crate) mod sphere;
pub(crate) mod working;

use std::sync::Arc;

use glam::DVec3;

use crate::tracer::{
    ray::Ray,
    shape::{disc::Disc, plane::Plane, sphere::Sphere, working::Working},
};

/// Defines the enum of all shapes and the methods that each shape implements in its own file.
macro_rules! shapes {
    ($($(#[$doc:meta])* $shape:ident($held:ty) = $name:literal,)*) => {
        /// A surface without a color.
        #[derive(Clone, Debug, PartialEq)]
        pub enum Shape {
            $($(#[$doc])* $shape($held)),*
        }

        impl Shape {
            /// The names of all kinds of shapes, in lowercase.
            pub const KINDS: &'static [&'static str] = &[$($name),*];

            /// The name of the kind of shape.
            pub const fn kind(&self) -> &'static str {
                match self {
                    $(Self::$shape(_) => $name),*
                }
            }

            /// Returns the lower and upper corners of the axis-aligned bounding box, or `None` if
            /// the shape is unbounded or the box is not finite in f64.
            pub fn bounds(&self) -> Option<[DVec3; 2]> {
                match self {
                    $(Self::$shape(shape) => shape.bounds()),*
                }
            }

            /// Returns a point of the shape that is farthest in a direction of unit length, or
            /// `None` if the shape is unbounded (the support mapping of E. Gilbert, D. Johnson and
            /// S. Keerthi, A fast procedure for computing the distance between complex objects in
            /// three-dimensional space, 1988).
            #[inline]
            pub(crate) fn support(&self, direction: DVec3) -> Option<DVec3> {
                match self {
                    $(Self::$shape(shape) => shape.support(direction)),*
                }
            }

            /// Returns the smallest `t` with `0 < t < t_max` at which the ray hits the shape. An
            /// infinite `t_max` excludes nothing, as an infinite `t` is never a hit.
            pub fn intersect(&self, ray: &Ray, t_max: f64) -> Option<f64> {
                match self {
                    $(Self::$shape(shape) => shape.intersect(ray, t_max)),*
                }
            }

            /// Returns every `t` with `0 < t < t_max` at which the ray crosses the surface, in
            /// ascending order.
            pub(crate) fn crossings(&self, ray: &Ray, t_max: f64) -> Crossings {
                match self {
                    $(Self::$shape(shape) => shape.crossings(ray, t_max)),*
                }
            }

            /// Returns the crossings of a ray that leaves this very surface.
            pub(crate) fn crossings_leaving(&self, ray: &Ray, t_max: f64) -> Crossings {
                match self {
                    $(Self::$shape(shape) => shape.crossings_leaving(ray, t_max)),*
                }
            }

            /// Returns the plane of a flat shape.
            pub(crate) fn plane(&self) -> Option<&Plane> {
                match self {
                    $(Self::$shape(shape) => shape.plane()),*
                }
            }

            /// Returns the unit normal at the point of the ray at `t`: outward for a closed shape,
            /// along `n` for a flat one.
            pub fn normal_at(&self, ray: &Ray, t: f64) -> DVec3 {
                match self {
                    $(Self::$shape(shape) => shape.normal_at(ray, t)),*
                }
            }

            /// Returns the solution of the shape's equation for a ray, step by step.
            #[doc(hidden)]
            pub fn working(&self, ray: &Ray) -> Working {
                match self {
                    $(Self::$shape(shape) => shape.working(ray)),*
                }
            }

            /// Calls `see` with every number that defines the shape.
            pub(crate) fn each_number(&self, see: impl FnMut(f64)) {
                match self {
                    $(Self::$shape(shape) => shape.numbers().into_iter().for_each(see)),*
                }
            }

            /// Returns the extent of the shape.
            #[inline]
            pub(crate) fn extent(&self) -> Extent<'_> {
                match self {
                    $(Self::$shape(shape) => shape.extent()),*
                }
            }

            /// Returns the distance from a point to the farthest point of the shape; infinite if
            /// the shape is unbounded.
            #[inline]
            pub(crate) fn farthest_from(&self, point: DVec3) -> f64 {
                match self {
                    $(Self::$shape(shape) => shape.farthest_from(point)),*
                }
            }

            /// Returns the position of an eye relative to the shape.
            #[inline]
            pub(crate) fn standing(&self, eye: DVec3) -> Standing {
                match self {
                    $(Self::$shape(shape) => shape.standing(eye)),*
                }
            }
        }

        $(impl From<$shape> for Shape {
            fn from(shape: $shape) -> Self {
                Self::$shape(shape.into())
            }
        })*
    };
}

shapes! {
    /// An infinite plane.
    Plane(Arc<Plane>) = "plane",
    /// The surface of a ball.
    Sphere(Sphere) = "sphere",
    /// A round piece of a plane. It is shared, so that no shape needs more memory than a sphere.
    Disc(Arc<Disc>) = "disc",
}

/// The extent of a shape.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Extent<'a> {
    /// The center and radius of a ball that contains the shape.
    Ball(DVec3, f64),
    /// A plane, which is unbounded.
    Plane(&'a Plane),
}

/// The position of an eye relative to a shape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Standing {
    /// The shape can be seen normally.
    Free,
    /// The shape is closed and the eye is inside it. Holds the center and radius of the ball that
    /// it fills.
    Inside(DVec3, f64),
    /// The eye lies exactly on the plane of a flat shape, so no ray hits it. Holds the name of that
    /// plane.
    EdgeOn(&'static str),
}

/// The ray parameters at which a ray crosses a surface: `Some` before `None`.
pub(crate) type Crossings = [Option<f64>; 2];

impl Shape {
    /// Returns true if the other shape has the same surface, at least in part, so that a ray that
    /// leaves one leaves the other: a sphere with the same numbers, or a flat shape in the same
    /// plane.
    pub(crate) fn shares_surface(&self, other: &Self) -> bool {
        match (self.plane(), other.plane()) {
            (Some(own), Some(other)) => own.contains(other),
            _ => self == other,
        }
    }

    /// Returns the smallest `t` with `0 < t < t_max` at which a ray hits the shape that leaves the
    /// surface of `own`, if it leaves any.
    ///
    /// A surface is not met at the point where the ray leaves it, which rounding errors would find
    /// a little before or behind the origin: a flat one is not met again, and of a sphere only the
    /// far side is.
    pub(crate) fn intersect_from(&self, own: Option<&Self>, ray: &Ray, t_max: f64) -> Option<f64> {
        match own {
            Some(own) if own.shares_surface(self) => self.crossings_leaving(ray, t_max)[0],
            _ => self.intersect(ray, t_max),
        }
    }

    /// Returns the crossings of a ray that leaves the surface of `own`.
    pub(crate) fn crossings_from(&self, own: &Self, ray: &Ray, t_max: f64) -> Crossings {
        if own.shares_surface(self) {
            self.crossings_leaving(ray, t_max)
        } else {
            self.crossings(ray, t_max)
        }
    }

    /// Returns the sphere, if it is one. Most scenes hold little else, so spheres have fast paths.
    pub(crate) const fn sphere(&self) -> Option<&Sphere> {
        match self {
            Self::Sphere(sphere) => Some(sphere),
            _ => None,
        }
    }
}

impl Extent<'_> {
    /// The radius of the ball; infinite for a plane.
    pub(crate) const fn radius(&self) -> f64 {
        match self {
            Self::Ball(_, radius) => *radius,
            Self::Plane(_) => f64::INFINITY,
        }
    }
}

/// Returns `t` if it lies in front of the ray's origin and before `t_max`: `0 < t < t_max`.
pub(crate) fn in_front(t: f64, t_max: f64) -> Option<f64> {
    (t > 0.0 && t < t_max).then_some(t)
}
