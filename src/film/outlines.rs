//! Lines where one geometry ends before another.

use crate::tracer::color::Color;

/// The outlines of a picture.
///
/// A line is `width` pixels wide. It lies on a geometry that ends in front of nothing, in front of
/// another, or in front of itself by more than `depth`. Where neither of two ends in front of the
/// other, because they cut each other or lie side by side, and where the normals of one differ by more
/// than `creases` degrees, each side has a share of the line.
///
/// A sample is compared with each near sample of its own geometry, and of each other one with the
/// nearest sample that sees it. Its share is 1 towards nothing, towards another geometry that its ray
/// meets as well while that one's ray does not meet its own, and towards its own geometry if that lies
/// behind by more than `depth`. In the opposite case it is 0. Otherwise it is `b / (a + b)`, with the
/// cosines `a` and `b` between normal and ray of both samples. The sample is outlined if the other one is
/// nearer than `width` and, from halfway between them, its share of `width` or less away.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outlines {
    /// The width of the lines in pixels, above 0.
    pub width: f64,
    /// The color of the lines.
    pub color: Color,
    /// The difference of depths along the rays that makes a line within one geometry.
    pub depth: Option<f64>,
    /// The angle in degrees between normals that makes a line within one geometry.
    pub creases: Option<f64>,
}

impl Outlines {
    /// The width of the lines unless told otherwise, in pixels.
    pub const WIDTH: f64 = 1.5;

    /// Returns the number of pixels around a part of a picture that its lines depend on.
    pub(crate) fn margin(&self) -> u32 {
        self.width.ceil() as u32
    }

    /// Returns true if lines within one geometry are drawn.
    pub(crate) const fn are_within(&self) -> bool {
        self.depth.is_some() || self.creases.is_some()
    }
}

impl Default for Outlines {
    fn default() -> Self {
        Self {
            width: Self::WIDTH,
            color: Color::BLACK,
            depth: None,
            creases: None,
        }
    }
}
