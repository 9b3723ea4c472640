//! The orthographic camera.

use glam::DVec3;

use crate::tracer::{camera::basis::Basis, error::GeometryError, ray::Ray, vector::positive};

/// A camera whose rays are all parallel: there is no perspective, so lengths can be measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OrthographicCamera {
    pub(crate) basis: Basis,
    scale: f64,
    stretch: bool,
}

impl OrthographicCamera {
    /// Creates a camera by the exact equation of the course: `scale` spans the width AND the height
    /// of the picture, from the center of the first pixel to that of the last.
    ///
    /// In a picture that is not square, a sphere becomes an ellipse.
    ///
    /// # Errors
    ///
    /// Returns an error if a number is not finite, `gaze` or `up` has no direction, the two are
    /// parallel, or the scale is not above 0.
    pub fn new(eye: DVec3, gaze: DVec3, up: DVec3, scale: f64) -> Result<Self, GeometryError> {
        let scale = positive(scale, "scale")?;
        Ok(Self {
            basis: Basis::new(eye, gaze, up)?,
            scale,
            stretch: true,
        })
    }

    /// Creates a camera with square pixels: `scale` spans the height, from the center of the bottom
    /// row to that of the top row.
    ///
    /// A sphere looks round in a picture of any aspect ratio.
    ///
    /// # Errors
    ///
    /// Same as [`OrthographicCamera::new`].
    pub fn with_square_pixels(
        eye: DVec3,
        gaze: DVec3,
        up: DVec3,
        scale: f64,
    ) -> Result<Self, GeometryError> {
        Ok(Self {
            stretch: false,
            ..Self::new(eye, gaze, up, scale)?
        })
    }

    /// Returns every field, for callers that must not miss one.
    pub(crate) const fn parts(&self) -> (Basis, f64, bool) {
        let Self {
            basis,
            scale,
            stretch,
        } = *self;
        (basis, scale, stretch)
    }

    /// The scale s, in units of the scene.
    pub const fn scale(&self) -> f64 {
        self.scale
    }

    /// Returns true if the scale spans the width as well as the height.
    pub const fn stretch(&self) -> bool {
        self.stretch
    }

    /// Returns the ray through a point of the picture, in pixels from the bottom left.
    ///
    /// Its direction is `-w` and its origin `e + s·((x-(W-1)/2)/(H-1))·u +
    /// s·((y-(H-1)/2)/(H-1))·v`; with [`OrthographicCamera::stretch`] the first divisor is `W-1`. A
    /// divisor of 0 counts as 1.
    pub fn ray_for(&self, width: u32, height: u32, x: f64, y: f64) -> Ray {
        self.ray_of(self.column(width, height, x) + self.row(height, y))
    }

    /// Returns the ray from an origin.
    pub(crate) fn ray_of(&self, origin: DVec3) -> Ray {
        Ray::new(origin, -self.basis.w)
    }

    /// Returns the part of the origin that all pixels of a column share: `e +
    /// s·((x-(W-1)/2)/(H-1))·u`.
    pub(crate) fn column(&self, width: u32, height: u32, x: f64) -> DVec3 {
        let middle = (f64::from(width) - 1.0) / 2.0;
        let sx = self.scale * ((x - middle) / self.pixels_across(width, height));
        self.basis.eye + sx * self.basis.u
    }

    /// Returns the part of the origin that all pixels of a row share: `s·((y-(H-1)/2)/(H-1))·v`.
    pub(crate) fn row(&self, height: u32, y: f64) -> DVec3 {
        let middle = (f64::from(height) - 1.0) / 2.0;
        let sy = self.scale * ((y - middle) / pixels(height));
        sy * self.basis.v
    }

    /// Returns the camera for a picture of `factor` times the size that shows the same; `None` if one scale
    /// cannot span both of its sides.
    pub(crate) fn magnified(&self, width: u32, height: u32, factor: u32) -> Option<Self> {
        // The scale ends in the middle of the outermost pixels, which become smaller.
        let ratio = |side: u32| {
            let steps = pixels(side) * f64::from(factor);
            Some(pixels(side.checked_mul(factor)?) / steps)
        };
        let down = ratio(height)?;
        let across = if self.stretch { ratio(width)? } else { down };
        let scale = self.scale * down;
        (across == down && scale.is_finite()).then_some(Self { scale, ..*self })
    }

    /// Returns the number of pixels that the scale spans horizontally.
    pub(crate) fn pixels_across(&self, width: u32, height: u32) -> f64 {
        pixels(if self.stretch { width } else { height })
    }
}

/// Returns the number of steps from the first pixel of a side to the last, at least 1.
pub(crate) fn pixels(side: u32) -> f64 {
    f64::from(side.max(2) - 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    type Constructor = fn(DVec3, DVec3, DVec3, f64) -> Result<OrthographicCamera, GeometryError>;

    fn origins(new: Constructor, width: u32, height: u32) -> (DVec3, DVec3) {
        let camera = new(DVec3::ZERO, DVec3::NEG_Z, DVec3::Y, 3.0).unwrap();
        let last = (f64::from(width) - 1.0, f64::from(height) - 1.0);
        let first = camera.ray_for(width, height, 0.0, 0.0);
        let last = camera.ray_for(width, height, last.0, last.1);
        assert_eq!(first.direction(), DVec3::NEG_Z);
        assert_eq!(last.direction(), DVec3::NEG_Z);
        (first.origin(), last.origin())
    }

    #[test]
    fn without_square_pixels_the_scale_spans_both_sides() {
        let (first, last) = origins(OrthographicCamera::new, 5, 3);
        assert_eq!(first, DVec3::new(-1.5, -1.5, 0.0));
        assert_eq!(last, DVec3::new(1.5, 1.5, 0.0));
    }

    #[test]
    fn with_square_pixels_the_scale_spans_the_height() {
        let (first, last) = origins(OrthographicCamera::with_square_pixels, 5, 3);
        assert_eq!(first, DVec3::new(-3.0, -1.5, 0.0));
        assert_eq!(last, DVec3::new(3.0, 1.5, 0.0));
    }

    #[test]
    fn a_single_row_or_column_divides_by_one() {
        let (first, last) = origins(OrthographicCamera::new, 1, 1);
        assert_eq!((first, last), (DVec3::ZERO, DVec3::ZERO));
        let (first, last) = origins(OrthographicCamera::with_square_pixels, 3, 1);
        assert_eq!(first, DVec3::new(-3.0, 0.0, 0.0));
        assert_eq!(last, DVec3::new(3.0, 0.0, 0.0));
    }

    #[test]
    fn impossible_scales_are_rejected() {
        for scale in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            let camera = OrthographicCamera::new(DVec3::ZERO, DVec3::NEG_Z, DVec3::Y, scale);
            assert!(camera.is_err());
        }
    }
}
