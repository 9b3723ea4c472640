//! The orthographic camera of a scene file.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::{
    scene::format::{
        camera::{Sight, UP},
        field::{Triple, fields, rules},
    },
    tracer::{
        camera::{Camera, orthographic::OrthographicCamera},
        error::GeometryError,
    },
};

/// A camera of parallel rays: what is far is as large as what is near.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename = "Orthographic", deny_unknown_fields)]
#[schemars(inline, transform = rules::<Self>)]
pub struct OrthographicModel {
    /// The point that is the middle of the picture, where the rays start.
    pub eye: Triple,
    /// The direction of view; this or `look_at`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub gaze: Option<Triple>,
    /// The point that is seen in the middle of the picture; this or `gaze`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub look_at: Option<Triple>,
    /// The direction that is up in the picture; (0, 1, 0) is the default.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("default" = [0, 1, 0]))]
    pub up: Option<Triple>,
    /// The height of the picture in units of the scene, above 0: s of the camera equation, from the
    /// center of the bottom row to that of the top row.
    pub scale: f64,
    /// True if the scale spans the width as well, so that pixels are not square; false is the
    /// default.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("default" = false))]
    pub stretch: Option<bool>,
}

impl OrthographicModel {
    /// The camera with these directions.
    pub(crate) fn build(&self, sight: &Sight) -> Result<Camera, GeometryError> {
        let new = if self.stretch.unwrap_or(false) {
            OrthographicCamera::new
        } else {
            OrthographicCamera::with_square_pixels
        };
        Ok(new(sight.eye, sight.gaze, sight.up, self.scale)?.into())
    }
}

fields! {
    OrthographicModel {
        eye: Point,
        gaze: Direction,
        look_at: Point,
        up: Direction = UP,
        scale: Positive,
    } fixed {
        stretch,
    }
}
