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
    /// A transform cannot be inverted in f64.
    NotInvertible {
        /// The determinant of the matrix.
        determinant: f64,
    },
    /// A shape has no inside, so that it cannot be put together with solids.
    NotSolid {
        /// The kind of the shape.
        kind: &'static str,
    },
    /// No solid is given of which others could be put together.
    NoOperand,
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
    /// A picture has not as many pixels as its sides say, or none.
    TexelCount {
        /// The number of pixels in a row.
        width: u32,
        /// The number of rows.
        height: u32,
        /// The number of pixels.
        found: u64,
    },
    /// The light of a pixel is below 0, infinite or NaN.
    Texel {
        /// The number of its column, from 0 at the left.
        column: u32,
        /// The number of its row, from 0 at the top.
        row: u32,
        /// The rejected light.
        value: f64,
    },
    /// A picture that should shine is black.
    BlackPicture,
    /// A picture that should shine does not fit into memory.
    PictureMemory {
        /// The number of pixels in a row.
        width: u32,
        /// The number of rows.
        height: u32,
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
            Self::NotInvertible { determinant } => write!(
                f,
                "the transform cannot be inverted: its determinant is {determinant}"
            ),
            Self::NotSolid { kind } => write!(f, "a {kind} that is open or flat has no inside"),
            Self::NoOperand => f.write_str("there is no solid to put together"),
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
            Self::TexelCount {
                width,
                height,
                found,
            } => write!(
                f,
                "a picture of {width}x{height} pixels has {found} of them"
            ),
            Self::Texel { column, row, value } => write!(
                f,
                "pixel ({column}, {row}), from the top left, has the light `{value}`, expected a number of at least 0"
            ),
            Self::BlackPicture => f.write_str("the picture is black"),
            Self::PictureMemory { width, height } => {
                write!(f, "a picture of {width}x{height} does not fit into memory")
            }
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
