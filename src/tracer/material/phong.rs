//! A surface with a highlight.

use crate::tracer::{color::Color, error::GeometryError, vector::in_range};

/// The largest exponent of a highlight.
pub(crate) const SHARPEST: f64 = 1e6;

/// A surface that scatters light, with a highlight where a mirror would show the light (Phong,
/// "Illumination for computer generated pictures", 1975).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Phong {
    pub(super) diffuse: Color,
    pub(super) specular: Color,
    pub(super) exponent: f64,
    pub(super) reflection: Color,
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

    /// The color of scattered light.
    pub const fn diffuse(&self) -> Color {
        self.diffuse
    }

    /// The color of the highlight.
    pub const fn specular(&self) -> Color {
        self.specular
    }

    /// The exponent of the highlight.
    pub const fn exponent(&self) -> f64 {
        self.exponent
    }

    /// The part of the reflected light; black if nothing is reflected.
    pub const fn reflection(&self) -> Color {
        self.reflection
    }

    pub(super) const fn numbers(&self) -> [f64; 7] {
        let Self {
            diffuse: _,
            specular: s,
            exponent,
            reflection: r,
        } = self;
        [s.r(), s.g(), s.b(), *exponent, r.r(), r.g(), r.b()]
    }
}
