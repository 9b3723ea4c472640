//! What the constructors of cameras and shapes refuse.

use std::{error::Error, fmt};

use glam::DVec3;

/// A camera or a shape that cannot be.
///
/// The constructors refuse what the scene format refuses, by the same rules.
#[derive(Clone, PartialEq)]
#[non_exhaustive]
pub enum GeometryError {
    /// A number or a component is NaN or infinite.
    NotFinite {
        /// The parameter's name.
        name: &'static str,
    },
    /// A number that must lie above 0 does not.
    NotPositive {
        /// The parameter's name.
        name: &'static str,
        /// What was given.
        value: f64,
    },
    /// A vector whose squared length in f64 is 0 or not finite.
    NoDirection {
        /// The parameter's name.
        name: &'static str,
        /// What was given.
        value: DVec3,
    },
    /// `up` is parallel to the line of sight: |t × w| ≤ 1e-9 · |t|.
    ParallelVectors {
        /// The direction of view.
        gaze: DVec3,
        /// What was given as up.
        up: DVec3,
    },
    /// The half angle of a perspective camera lies outside of (0, π/2) radians.
    HalfAngle {
        /// What was given, in radians.
        value: f64,
    },
}

impl fmt::Display for GeometryError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotFinite { name } => write!(f, "`{name}` must be finite"),
            Self::NotPositive { name, value } => {
                write!(f, "`{name}` must be above 0, found `{value}`")
            }
            Self::NoDirection { name, value } => write!(
                f,
                "`{name}` has no direction: the squared length of `{value}` is 0 or not finite"
            ),
            Self::ParallelVectors { gaze, up } => {
                write!(f, "`up` {up} is parallel to the line of sight {gaze}")
            }
            Self::HalfAngle { value } => write!(
                f,
                "the half angle must lie between 0 and π/2 radians, found `{value}`"
            ),
        }
    }
}

/// Writes the same as `Display`: `main` prints a returned error with `Debug`.
impl fmt::Debug for GeometryError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(self, f)
    }
}

impl Error for GeometryError {}
