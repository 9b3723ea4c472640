//! The pinhole camera.

use std::f64::consts::PI;

use glam::DVec3;

use crate::tracer::{
    camera::{basis::Basis, lens::ThinLens},
    error::GeometryError,
    ray::Ray,
    vector::unit,
};

/// A pinhole camera: all rays start at the eye, or, where light follows paths, on its lens.
///
/// Its angle is the half angle α between the center of the picture and its upper edge, in radians;
/// the field of view of a scene file is 2α, in degrees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PerspectiveCamera {
    pub(crate) basis: Basis,
    half_angle: f64,
    /// tan α, needed for every ray.
    tangent: f64,
    pub(super) lens: Option<ThinLens>,
}

impl PerspectiveCamera {
    /// Creates a camera at `eye` that looks along `gaze`, with `up` pointing upwards in the picture
    /// and the half angle α in radians.
    ///
    /// # Errors
    ///
    /// Returns an error if a number is not finite, `gaze` or `up` has no direction, the two are
    /// parallel, or the angle lies outside (0, π/2).
    pub fn new(eye: DVec3, gaze: DVec3, up: DVec3, half_angle: f64) -> Result<Self, GeometryError> {
        if !(half_angle > 0.0 && half_angle < PI / 2.0) {
            return Err(GeometryError::HalfAngle { value: half_angle });
        }
        Ok(Self {
            basis: Basis::new(eye, gaze, up)?,
            half_angle,
            tangent: libm::tan(half_angle),
            lens: None,
        })
    }

    /// Gives the camera a thin lens, which it has where light follows paths: `aperture` is its diameter, `focus`
    /// the distance of the plane of focus along the line of sight, both in units of the scene.
    ///
    /// # Errors
    ///
    /// Returns an error if `aperture` lies outside of 0..=1e12, or if `focus` is not above 0 and at most 1e12.
    pub fn with_lens(self, aperture: f64, focus: f64) -> Result<Self, GeometryError> {
        let lens = ThinLens::new(aperture, focus)?;
        let lens = (aperture > 0.0).then_some(lens);
        Ok(Self { lens, ..self })
    }

    /// The diameter of the lens and the distance of its plane of focus, unless the diameter is 0.
    pub fn lens(&self) -> Option<[f64; 2]> {
        self.lens.map(|lens| [lens.aperture(), lens.focus()])
    }

    /// Returns every field, for callers that must not miss one.
    pub(crate) const fn parts(&self) -> (Basis, f64, Option<ThinLens>) {
        let Self {
            basis,
            half_angle,
            tangent: _,
            lens,
        } = *self;
        (basis, half_angle, lens)
    }

    /// The half angle α, in radians.
    pub const fn half_angle(&self) -> f64 {
        self.half_angle
    }

    /// Returns the ray through a point of the picture, in pixels from the bottom left.
    ///
    /// It starts at the eye in the direction `r/|r|` with `r = -w·((H/2)/tan α) + u·(x-(W-1)/2) +
    /// v·(y-(H-1)/2)`.
    pub fn ray_for(&self, width: u32, height: u32, x: f64, y: f64) -> Ray {
        self.ray_of(self.column(width, height, x) + self.row(height, y))
    }

    /// Returns the ray whose direction is `r/|r|`.
    pub(crate) fn ray_of(&self, r: DVec3) -> Ray {
        Ray::new(self.basis.eye, unit(r))
    }

    /// Returns the part of r that all pixels of a column share: `-w·((H/2)/tan α) + u·(x-(W-1)/2)`.
    pub(crate) fn column(&self, width: u32, height: u32, x: f64) -> DVec3 {
        let Basis { u, w, .. } = self.basis;
        -w * self.distance(height) + u * (x - (f64::from(width) - 1.0) / 2.0)
    }

    /// Returns the part of r that all pixels of a row share: `v·(y-(H-1)/2)`.
    pub(crate) fn row(&self, height: u32, y: f64) -> DVec3 {
        self.basis.v * (y - (f64::from(height) - 1.0) / 2.0)
    }

    /// Returns the distance from the eye to the picture, in pixels: `(H/2)/tan α`.
    pub(crate) fn distance(&self, height: u32) -> f64 {
        (f64::from(height) / 2.0) / self.tangent
    }
}

/// Returns the half angle α in radians for a full vertical field of view in degrees, above 0:
/// `(fov/2)·(π/180)`.
pub(crate) fn half_angle_of(fov: f64) -> f64 {
    // Below about 3e-322 degrees this rounds to 0. The smallest number above 0 replaces it: the
    // picture is infinitely far away with either.
    ((fov / 2.0) * (PI / 180.0)).max(f64::MIN_POSITIVE * f64::EPSILON)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn camera(half_angle: f64) -> Result<PerspectiveCamera, GeometryError> {
        PerspectiveCamera::new(DVec3::Y, DVec3::NEG_Z, DVec3::Y, half_angle)
    }

    #[test]
    fn the_middle_pixel_looks_straight_ahead() {
        let ray = camera(PI / 4.0).unwrap().ray_for(3, 5, 1.0, 2.0);
        assert_eq!(ray, Ray::new(DVec3::Y, DVec3::NEG_Z));
    }

    // H = 2 and tan α = 0.5 put the picture at distance 2. The corner is at (-0.5, -0.5, -2), whose
    // length is √4.5.
    #[test]
    fn a_corner_by_hand() {
        let camera = camera(libm::atan(0.5)).unwrap();
        let distance = 1.0 / libm::tan(camera.half_angle());
        assert!((distance - 2.0).abs() < 1e-15);
        let length = (distance * distance + 0.5).sqrt();
        let direction = camera.ray_for(2, 2, 0.0, 0.0).direction();
        assert!((direction - DVec3::new(-0.5, -0.5, -distance) / length).length() < 1e-15);
        assert!(
            camera.ray_for(2, 2, 1.0, 1.0).direction().y > 0.0,
            "y counts upwards"
        );
    }

    #[test]
    fn angles_outside_the_range_are_rejected() {
        for angle in [0.0, -0.1, PI / 2.0, 2.0, f64::NAN, f64::INFINITY] {
            assert!(matches!(
                camera(angle),
                Err(GeometryError::HalfAngle { .. })
            ));
        }
    }

    #[test]
    fn half_angles_of_fields_of_view() {
        assert_eq!(half_angle_of(90.0), PI / 4.0);
        assert!(camera(half_angle_of(180.0_f64.next_down())).is_ok());
        assert!(camera(half_angle_of(180.0)).is_err());
        assert!(camera(half_angle_of(5e-324)).is_ok());
    }
}
