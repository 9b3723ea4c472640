//! The weakening of light by distance, and beside the axis of a cone.

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

/// The fading of the light at the edge of a cone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Fading {
    /// The axis of the cone, as a unit vector.
    pub(crate) axis: DVec3,
    /// The cosines of the half angles at which the light begins to fade, and ends.
    pub(crate) cosines: [f64; 2],
}

impl Fading {
    /// Returns the part of the light that the cone lets through, towards a surface that sees the
    /// light along `l`.
    pub(super) fn at(&self, l: DVec3) -> f64 {
        let cosine = -(l.dot(self.axis));
        let [inner, outer] = self.cosines;
        // The cosines of a tiny angle may be equal, too: then there is nothing to fade over.
        if inner <= outer {
            return if cosine >= outer { 1.0 } else { 0.0 };
        }
        let s = ((cosine - outer) / (inner - outer)).clamp(0.0, 1.0);
        s * s * (3.0 - 2.0 * s)
    }
}
