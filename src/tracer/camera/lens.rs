//! The thin lens of a camera.

use glam::DVec3;

use crate::tracer::{
    camera::basis::Basis,
    error::GeometryError,
    ray::Ray,
    sampling::{UnitPair, disc},
    vector::{in_range, unit},
};

/// The largest diameter of a lens, and the largest distance of its plane of focus.
pub(crate) const LARGEST: f64 = 1e12;

/// A thin lens: only a plane in front of the camera is in focus.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ThinLens {
    aperture: f64,
    focus: f64,
}

impl ThinLens {
    /// Creates a lens of this diameter with the plane of focus at this distance along the line of sight.
    pub(crate) fn new(aperture: f64, focus: f64) -> Result<Self, GeometryError> {
        Ok(Self {
            aperture: in_range(aperture, "aperture", [0.0, LARGEST])?,
            focus: in_range(focus, "focus", [f64::MIN_POSITIVE * f64::EPSILON, LARGEST])?,
        })
    }

    /// The diameter.
    pub(crate) const fn aperture(&self) -> f64 {
        self.aperture
    }

    /// The distance of the plane of focus along the line of sight.
    pub(crate) const fn focus(&self) -> f64 {
        self.focus
    }

    /// Returns the ray that starts at a point of the lens and meets the plane of focus where the ray through
    /// its middle does.
    pub(super) fn ray(&self, basis: &Basis, middle: &Ray, pair: UnitPair) -> Ray {
        let [x, y] = disc(pair).map(|part| self.aperture / 2.0 * part);
        let shift = x * basis.u + y * basis.v;
        let sharp = middle.direction() * (self.focus / middle.direction().dot(-basis.w));
        Ray::new(middle.origin() + shift, unit(sharp - shift))
    }
}

/// Returns the distance of a point from the eye along the line of sight.
pub(crate) fn distance_to(point: DVec3, eye: DVec3, gaze: DVec3) -> f64 {
    (point - eye).dot(unit(gaze))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tracer::camera::{Camera, perspective::PerspectiveCamera};

    #[test]
    fn rays_of_a_pixel_meet_where_it_is_sharp() {
        let eye = DVec3::new(1.0, 2.0, 3.0);
        let camera =
            PerspectiveCamera::new(eye, DVec3::new(1.0, -0.5, -2.0), DVec3::Y, 0.6).unwrap();
        let pinhole = Camera::from(camera);
        let sharp = Camera::from(camera.with_lens(0.5, 4.0).unwrap());
        for pixel in [[0.0, 0.0], [3.0, 1.5], [6.0, 4.0]] {
            let middle = pinhole.ray_for(7, 5, pixel[0], pixel[1]);
            let place = middle.at(4.0 / middle.direction().dot(-pinhole.w()));
            assert!((distance_to(place, eye, pinhole.gaze()) - 4.0).abs() < 1e-14);
            for pair in [[0.1, 0.3], [0.9, 0.8], [0.999, 0.05]] {
                let ray = sharp.ray_from_lens((7, 5), pixel, pair);
                let from = ray.origin() - eye;
                assert!(from.length() < 0.25 && from.dot(pinhole.w()).abs() < 1e-15);
                assert!((ray.at(ray.t_of(place)) - place).length() < 1e-14);
                assert!((ray.direction().length() - 1.0).abs() < 1e-15);
                assert_eq!(pinhole.ray_from_lens((7, 5), pixel, pair), middle);
            }
        }
    }

    #[test]
    fn numbers_out_of_range_are_rejected() {
        for (aperture, focus) in [
            (-1.0, 1.0),
            (1.0, 0.0),
            (1.0, -2.0),
            (2e12, 1.0),
            (1.0, f64::NAN),
        ] {
            assert!(ThinLens::new(aperture, focus).is_err());
        }
    }
}
