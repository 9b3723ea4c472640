//! A surface with a highlight.

use crate::tracer::{
    color::Color,
    error::GeometryError,
    material::{
        lobes::{Highlight, Lobes},
        parameters::{Number, parameters},
    },
    vector::in_range,
};

/// The largest exponent of a highlight.
pub(crate) const SHARPEST: f64 = 1e6;

parameters! {
    /// A surface that scatters light, with a highlight where a mirror would show the light (Phong,
    /// "Illumination for computer generated pictures", 1975).
    pub struct Phong {
        /// The color of scattered light.
        diffuse: Color,
        /// The color of the highlight.
        specular: Color,
        /// The exponent of the highlight.
        exponent: Number,
        /// The part of the reflected light; black if nothing is reflected.
        reflection: Color,
    }
}

impl Phong {
    /// Creates a surface that scatters light as `diffuse`, with a highlight of the color `specular`,
    /// which is the smaller the larger its `exponent`, and that reflects what is around it times
    /// `reflection`.
    ///
    /// # Errors
    ///
    /// Returns an error if the exponent is not above 0 and at most 1e6.
    pub fn new(
        diffuse: Color,
        specular: Color,
        exponent: f64,
        reflection: Color,
    ) -> Result<Self, GeometryError> {
        Ok(Self {
            diffuse,
            specular,
            exponent: in_range(exponent, "exponent", [f64::MIN_POSITIVE, SHARPEST])?,
            reflection,
        })
    }
}

pub(super) const EQUATION: &str =
    "lin(diffuse) · Σ I + lin(specular) · Σ H + lin(reflection) · L(mirror)";

pub(super) const fn lobes(phong: &Phong) -> Lobes<'_> {
    Lobes {
        diffuse: Some(phong.diffuse),
        highlight: Some(Highlight {
            color: phong.specular,
            exponent: phong.exponent,
        }),
        mirror: Some(phong.reflection),
        ..Lobes::NONE
    }
}
