//! The orthographic camera of a scene file.

use crate::{
    scene::format::{
        object::object,
        sight::{Sight, UP},
    },
    tracer::{
        camera::{Camera, orthographic::OrthographicCamera},
        error::GeometryError,
    },
};

object! {
    /// A camera with parallel rays: distance does not change size.
    pub struct OrthographicModel = "Orthographic" {
        /// The point that is the middle of the picture, where the rays start.
        eye | position | location | from | e: Point,
        /// The direction of view; give this or `look_at`.
        gaze | direction | g: Direction?,
        /// The point in the middle of the picture; give this or `gaze`.
        look_at | target | to: Point?,
        /// The direction that is up in the picture; (0, 1, 0) is the default.
        up | t | sky: Direction = UP,
        /// The height of the picture in units of the scene, above 0: s of the camera equation, from the
        /// center of the bottom row to that of the top row.
        scale | s: Positive,
        /// True if the scale spans the width as well, so that pixels are not square; false is the
        /// default.
        stretch: Flag = false,
    } one of gaze, look_at
}

impl OrthographicModel {
    /// The camera with these directions.
    pub(crate) fn build(&self, sight: &Sight) -> Result<Camera, GeometryError> {
        let new = if self.stretch() {
            OrthographicCamera::new
        } else {
            OrthographicCamera::with_square_pixels
        };
        Ok(new(sight.eye, sight.gaze, sight.up, self.scale)?.into())
    }
}
