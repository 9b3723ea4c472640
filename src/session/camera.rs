//! Cameras that follow a hand: orbit, pan and dolly.

use glam::{DMat3, DVec3};

use crate::tracer::{
    camera::{Camera, orthographic::OrthographicCamera, perspective::PerspectiveCamera},
    error::GeometryError,
    vector::unit,
};

/// A movement of what a picture shows.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Motion {
    /// The turn about the point looked at, in degrees: to the right, and up.
    pub orbit: [f64; 2],
    /// The shift in heights of the picture: to the right, and up.
    pub pan: [f64; 2],
    /// The approach to the point looked at: the natural logarithm of the factor by which it gets
    /// nearer, or larger.
    pub dolly: f64,
}

/// The smallest angle between the direction of view and `up`, in degrees.
const POLE: f64 = 1.0;
/// A degree in radians.
const DEGREE: f64 = std::f64::consts::PI / 180.0;

impl Motion {
    /// Returns the camera after the movement, about a pivot in front of it, and where the pivot is
    /// then.
    pub(super) fn of(
        self,
        camera: &Camera,
        pivot: DVec3,
    ) -> Result<(Camera, DVec3), GeometryError> {
        let to_eye = camera.eye() - pivot;
        let turn = self.turn(camera);
        let nearer = libm::exp(-self.dolly);
        let (distance, height) = match camera {
            Camera::Perspective(inner) => {
                let depth = to_eye.dot(camera.w()) * nearer;
                (nearer, 2.0 * depth * libm::tan(inner.half_angle()))
            }
            Camera::Orthographic(inner) => (1.0, inner.scale() * nearer),
        };
        let [right, up] = self.pan;
        let shift = turn * (camera.u() * -(right * height) + camera.v() * -(up * height));
        let eye = pivot + turn * to_eye * distance + shift;
        let (gaze, up) = (turn * camera.gaze(), camera.up());
        let camera = match camera {
            Camera::Perspective(inner) => {
                PerspectiveCamera::new(eye, gaze, up, inner.half_angle())?.into()
            }
            Camera::Orthographic(inner) => {
                let new = match inner.stretch() {
                    true => OrthographicCamera::new,
                    false => OrthographicCamera::with_square_pixels,
                };
                new(eye, gaze, up, inner.scale() * nearer)?.into()
            }
        };
        Ok((camera, pivot + shift))
    }

    /// Returns the rotation of the camera. What it shows follows the hand, so the camera turns the
    /// other way, and not over the pole.
    fn turn(self, camera: &Camera) -> DMat3 {
        let [right, up] = self.orbit;
        let pole = unit(camera.up());
        // The angle between the direction of view and `up`, from 0 to 180 degrees.
        let angle = libm::acos(-camera.w().dot(pole).clamp(-1.0, 1.0)) / DEGREE;
        let range = POLE.min(angle)..=(180.0 - POLE).max(angle);
        let tilted = angle - (angle - up).clamp(*range.start(), *range.end());
        rotation(pole, -right) * rotation(camera.u(), tilted)
    }
}

/// Returns the rotation about a unit vector by an angle in degrees, counterclockwise for who looks
/// against the vector (Rodrigues' formula).
fn rotation(axis: DVec3, degrees: f64) -> DMat3 {
    let (sine, cosine) = libm::sincos(degrees * DEGREE);
    let column =
        |v: DVec3| v * cosine + axis.cross(v) * sine + axis * (axis.dot(v) * (1.0 - cosine));
    DMat3::from_cols(column(DVec3::X), column(DVec3::Y), column(DVec3::Z))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn camera() -> Camera {
        PerspectiveCamera::new(DVec3::Z * 5.0, DVec3::NEG_Z, DVec3::Y, 0.5)
            .unwrap()
            .into()
    }

    fn moved(motion: Motion) -> (Camera, DVec3) {
        motion.of(&camera(), DVec3::ZERO).unwrap()
    }

    fn near(one: DVec3, other: DVec3) {
        assert!((one - other).length() < 1e-12, "{one} {other}");
    }

    #[test]
    fn what_is_seen_turns_with_the_hand() {
        // A point in front of the pivot moves to the right of the picture.
        let (right, pivot) = moved(Motion {
            orbit: [90.0, 0.0],
            ..Motion::default()
        });
        near(right.eye(), DVec3::X * -5.0);
        near(pivot, DVec3::ZERO);
        assert!(right.u().dot(DVec3::Z) > 0.99);
        // It moves up if the camera goes down.
        let (up, _) = moved(Motion {
            orbit: [0.0, 30.0],
            ..Motion::default()
        });
        near(up.eye(), DVec3::new(0.0, -2.5, 5.0 * 0.75_f64.sqrt()));
        near(up.w() * 5.0, up.eye());
    }

    #[test]
    fn no_turn_goes_over_the_pole() {
        for up in [-500.0, 500.0] {
            let (moved, _) = moved(Motion {
                orbit: [10.0, up],
                ..Motion::default()
            });
            assert!(moved.eye().y.abs() > 4.99 && moved.eye().y.abs() < 5.0);
        }
    }

    #[test]
    fn a_shift_by_the_height_of_the_picture_and_an_approach() {
        let (moved, pivot) = moved(Motion {
            pan: [0.0, 1.0],
            dolly: libm::log(2.0),
            ..Motion::default()
        });
        let height = 2.0 * 2.5 * libm::tan(0.5);
        near(moved.eye(), DVec3::new(0.0, -height, 2.5));
        near(pivot, DVec3::new(0.0, -height, 0.0));
    }
}
