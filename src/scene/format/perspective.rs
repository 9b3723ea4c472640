//! The perspective camera of a scene file.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::{
    scene::format::{
        camera::{Sight, UP},
        field::{Triple, fields, rules},
    },
    tracer::{
        camera::{
            Camera,
            perspective::{PerspectiveCamera, half_angle_of},
        },
        error::GeometryError,
    },
};

/// A pinhole camera: all rays start at the eye.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename = "Perspective", deny_unknown_fields)]
#[schemars(inline, transform = rules::<Self>)]
pub struct PerspectiveModel {
    /// The point that the scene is seen from.
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
    /// The full vertical angle of view in degrees, above 0 and below 180: 2α of the camera
    /// equation.
    pub fov: f64,
}

impl PerspectiveModel {
    /// The camera with these directions.
    pub(crate) fn build(&self, sight: &Sight) -> Result<Camera, GeometryError> {
        let half_angle = half_angle_of(self.fov);
        Ok(PerspectiveCamera::new(sight.eye, sight.gaze, sight.up, half_angle)?.into())
    }
}

fields! {
    PerspectiveModel {
        eye: Point,
        gaze: Direction,
        look_at: Point,
        up: Direction = UP,
        fov: Angle,
    } fixed {}
}
