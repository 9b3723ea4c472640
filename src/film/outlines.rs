//! Lines where one geometry ends before another.

use crate::tracer::color::Color;

/// The outlines of a picture.
///
/// A sample is inked if a sample of the picture's own grid nearer than `width` pixels sees nothing,
/// or another geometry farther away, or the same geometry farther away by more than `depth`, or with
/// a normal that differs by more than `creases` degrees.
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
