//! The error of the constructors of cameras, shapes, materials and lights.

use std::{error::Error, fmt};

use glam::DVec3;

/// An invalid camera, shape, material or light.
///
/// The constructors reject the same values as the scene format.
#[derive(Clone, PartialEq)]
#[non_exhaustive]
pub enum GeometryError {
    /// A number or a vector component is NaN or infinite.
    NotFinite {
        /// The parameter's name.
        name: &'static str,
    },
    /// A number is not above 0.
    NotPositive {
        /// The parameter's name.
        name: &'static str,
        /// The rejected value.
        value: f64,
    },
    /// A number lies outside of its range.
    OutOfRange {
        /// The parameter's name.
        name: &'static str,
        /// The rejected value.
        value: f64,
        /// The smallest and the largest valid value.
        range: [f64; 2],
    },
    /// The squared length of a vector is 0 or not finite in f64.
    NoDirection {
        /// The parameter's name.
        name: &'static str,
        /// The rejected value.
        value: DVec3,
    },
    /// `up` is parallel to the line of sight: |t × w| ≤ 1e-9 · |t|.
    ParallelVectors {
        /// The direction of view.
        gaze: DVec3,
        /// The rejected up vector.
        up: DVec3,
    },
    /// Two axes of an ellipsoid are not perpendicular.
    NotPerpendicular {
        /// The first axis.
        one: DVec3,
        /// The other one.
        other: DVec3,
    },
    /// The half angle of a perspective camera lies outside (0, π/2) radians.
    HalfAngle {
        /// The rejected angle, in radians.
        value: f64,
    },
    /// A triangle of a mesh has a corner that does not exist.
    NoVertex {
        /// The number of the triangle, from 0.
        triangle: u32,
        /// The rejected number of the corner.
        vertex: u32,
        /// The number of vertices.
        vertices: usize,
    },
    /// A camera has nothing to frame, because no geometry is bounded.
    NothingToFit,
    /// A camera that frames its geometries cannot be computed in f64, because they are too large, or
    /// too small for their distance from the origin.
    CannotFit,
}

impl fmt::Display for GeometryError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotFinite { name } => write!(f, "`{name}` must be finite"),
            Self::NotPositive { name, value } => {
                write!(f, "`{name}` must be above 0, found `{value}`")
            }
            Self::OutOfRange {
                name,
                value,
                range: [least, most],
            } => write!(
                f,
                "`{name}` must be from {least} to {most}, found `{value}`"
            ),
            Self::NoDirection { name, value } => write!(
                f,
                "`{name}` has no direction: the squared length of `{value}` is 0 or not finite"
            ),
            Self::ParallelVectors { gaze, up } => {
                write!(f, "`up` {up} is parallel to the line of sight {gaze}")
            }
            Self::NotPerpendicular { one, other } => {
                write!(f, "the axes {one} and {other} are not perpendicular")
            }
            Self::HalfAngle { value } => write!(
                f,
                "the half angle must be between 0 and π/2 radians, found `{value}`"
            ),
            Self::NoVertex {
                triangle,
                vertex,
                vertices,
            } => write!(
                f,
                "triangle {triangle} has the corner {vertex}, but there are {vertices} vertices"
            ),
            Self::NothingToFit => f.write_str("there is nothing to frame: no geometry is bounded"),
            Self::CannotFit => f.write_str(
                "the geometries cannot be framed in f64: they are too large, or too small for \
                 their distance from the origin",
            ),
        }
    }
}

/// Same as `Display`, because a `main` that returns an error prints it with `Debug`.
impl fmt::Debug for GeometryError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(self, f)
    }
}

impl Error for GeometryError {}
