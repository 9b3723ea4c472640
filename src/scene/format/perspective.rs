//! The perspective camera of a scene file.

use crate::{
    scene::format::{
        object::object,
        sight::{Sight, UP},
    },
    tracer::{
        camera::{
            Camera,
            lens::distance_to,
            perspective::{PerspectiveCamera, half_angle_of},
        },
        error::GeometryError,
    },
};

object! {
    /// A pinhole camera: all rays start at the eye.
    pub struct PerspectiveModel = "Perspective" {
        /// The viewpoint.
        eye | position | location | from | e: Point,
        /// The direction of view; give this or `look_at`.
        gaze | direction | g: Direction?,
        /// The point in the middle of the picture; give this or `gaze`.
        look_at | target | to: Point?,
        /// The direction that is up in the picture; (0, 1, 0) is the default.
        up | t | sky: Direction = UP,
        /// The full vertical angle of view in degrees, above 0 and below 180: 2α of the camera
        /// equation.
        fov ! alpha ! angle ! half_angle: Angle,
        /// The diameter of the lens in units of the scene, 0 to 1e12, where light follows paths: a larger lens
        /// blurs more of what is out of focus. 0, the default, keeps everything in focus.
        aperture ! lens_radius ! f_stop: Aperture = 0.0,
        /// The distance of the plane of focus along the line of sight, above 0 and at most 1e12; that of
        /// `look_at` is the default. Give at most one of this and `focus_at`.
        focus | focus_distance | focal_distance: FocalDistance?,
        /// A point on the plane of focus.
        focus_at | focal_point: Point?,
    } one of gaze, look_at at most one of focus, focus_at
}

impl PerspectiveModel {
    /// The camera with these directions.
    pub(crate) fn build(&self, sight: &Sight) -> Result<Camera, GeometryError> {
        let half_angle = half_angle_of(self.fov);
        let camera = PerspectiveCamera::new(sight.eye, sight.gaze, sight.up, half_angle)?;
        let aperture = self.aperture();
        Ok(match aperture > 0.0 {
            true => camera.with_lens(aperture, self.focal_distance(sight))?,
            false => camera,
        }
        .into())
    }

    /// Returns the distance at which the picture is sharp.
    pub(crate) fn focal_distance(&self, sight: &Sight) -> f64 {
        self.focus.unwrap_or_else(|| match self.focus_at {
            Some(point) => distance_to(point.into(), sight.eye, sight.gaze),
            None => sight.gaze.length(),
        })
    }
}
