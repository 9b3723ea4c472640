//! The weakening of light by distance.

use glam::DVec3;

/// The weakening of light by distance.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Falloff {
    /// As in nature: a quarter of the light at twice the distance.
    #[default]
    InverseSquare,
    /// No weakening.
    Constant,
}

/// The upper bound of `t` on a shadow ray to a point. Just below 1, so that a surface that the light
/// lies on does not shadow it.
pub(crate) const END: f64 = 1.0 - 1.0 / (1_u64 << 32) as f64;

impl Falloff {
    /// Returns the weakening of the light from a point at `to_light`, relative to the surface:
    /// `1/|L - p|²`, or 1.
    pub(super) fn at(self, to_light: DVec3) -> f64 {
        match self {
            Self::InverseSquare => 1.0 / to_light.dot(to_light),
            Self::Constant => 1.0,
        }
    }

    pub(super) const fn number(self) -> f64 {
        match self {
            Self::InverseSquare => 0.0,
            Self::Constant => 1.0,
        }
    }
}
