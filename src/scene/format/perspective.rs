//! The perspective camera of a scene file.

use crate::{
    scene::format::{
        object::object,
        sight::{Sight, UP},
    },
    tracer::{
        camera::{
            Camera,
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
    } one of gaze, look_at
}

impl PerspectiveModel {
    /// The camera with these directions.
    pub(crate) fn build(&self, sight: &Sight) -> Result<Camera, GeometryError> {
        let half_angle = half_angle_of(self.fov);
        Ok(PerspectiveCamera::new(sight.eye, sight.gaze, sight.up, half_angle)?.into())
    }
}
