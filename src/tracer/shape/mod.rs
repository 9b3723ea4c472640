//! The shapes that a ray can meet, one file each.
//!
//! What the rest of the crate has to know of a shape is a method here, which the file of the shape
//! answers. Nothing else asks which shape it is, but for the fast ways of spheres and planes.

pub(crate) mod plane;
pub(crate) mod sphere;
pub(crate) mod working;

use glam::DVec3;

use crate::tracer::{
    ray::Ray,
    shape::{plane::Plane, sphere::Sphere, working::Working},
};

/// The enum of all shapes, and its methods that each shape answers in its own file.
macro_rules! shapes {
    ($($(#[$doc:meta])* $shape:ident($held:ty) = $name:literal,)*) => {
        /// A surface without a color.
        #[derive(Clone, Debug, PartialEq)]
        pub enum Shape {
            $($(#[$doc])* $shape($held)),*
        }

        impl Shape {
            /// The names of all kinds of shapes, in lower case.
            pub const KINDS: &'static [&'static str] = &[$($name),*];

            /// The name of its kind.
            pub const fn kind(&self) -> &'static str {
                match self {
                    $(Self::$shape(_) => $name),*
                }
            }

            /// The lower and the upper corner of the least box along the axes that holds the shape;
            /// none where it has no end, or the box is not finite in f64.
            pub fn bounds(&self) -> Option<[DVec3; 2]> {
                match self {
                    $(Self::$shape(shape) => shape.bounds()),*
                }
            }

            /// The smallest `t` with `0 < t < t_max` at which the ray meets the shape. An infinite
            /// `t_max` leaves out nothing, as an infinite `t` is never a hit.
            pub fn intersect(&self, ray: &Ray, t_max: f64) -> Option<f64> {
                match self {
                    $(Self::$shape(shape) => shape.intersect(ray, t_max)),*
                }
            }

            /// The unit normal at the point of the ray at `t`: outward for a closed shape, along
            /// `n` for a flat one.
            pub fn normal_at(&self, ray: &Ray, t: f64) -> DVec3 {
                match self {
                    $(Self::$shape(shape) => shape.normal_at(ray, t)),*
                }
            }

            /// How its equation is solved for a ray, number by number.
            #[doc(hidden)]
            pub fn working(&self, ray: &Ray) -> Working {
                match self {
                    $(Self::$shape(shape) => shape.working(ray)),*
                }
            }

            /// Passes on all numbers that make it what it is.
            pub(crate) fn each_number(&self, see: impl FnMut(f64)) {
                match self {
                    $(Self::$shape(shape) => shape.numbers().into_iter().for_each(see)),*
                }
            }

            /// Where it lies as a whole.
            #[inline]
            pub(crate) fn extent(&self) -> Extent<'_> {
                match self {
                    $(Self::$shape(shape) => shape.extent()),*
                }
            }

            /// The largest distance of one of its points from a point; infinite where it has no
            /// end.
            #[inline]
            pub(crate) fn farthest_from(&self, point: DVec3) -> f64 {
                match self {
                    $(Self::$shape(shape) => shape.farthest_from(point)),*
                }
            }

            /// How an eye at a point stands to it.
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
    Plane(Plane) = "plane",
    /// The surface of a ball.
    Sphere(Sphere) = "sphere",
}

/// Where a shape lies as a whole.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Extent<'a> {
    /// Within a ball: its center and radius.
    Ball(DVec3, f64),
    /// It is a plane, and has no end.
    Plane(&'a Plane),
}

/// How an eye stands to a shape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Standing {
    /// The shape may be seen like any other.
    Free,
    /// The shape is closed, fills a ball of this center and radius, and the eye is in it.
    Inside(DVec3, f64),
    /// The eye lies exactly on the plane of a flat shape, so that no ray meets it: what that plane
    /// is called.
    EdgeOn(&'static str),
}

impl Shape {
    /// The sphere, if it is one: most scenes hold little else, and a sphere has ways of its own.
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

/// `t`, if it lies before the ray's origin and nearer than `t_max`: `0 < t < t_max`.
pub(crate) fn in_front(t: f64, t_max: f64) -> Option<f64> {
    (t > 0.0 && t < t_max).then_some(t)
}
