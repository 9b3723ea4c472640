//! The orbit of the cameras in a scene file.

use glam::DVec3;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::scene::format::{
    camera::UP,
    field::{Triple, fields, rules},
};

/// A turn of all cameras about a line, at constant speed: what they look at stays in its place in
/// the picture, and a movie that repeats goes on without a jump.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename = "Orbit", deny_unknown_fields)]
#[schemars(transform = rules::<Self>)]
pub struct OrbitModel {
    /// A point on the line, such as the one that the cameras look at.
    pub around: Triple,
    /// The direction of the line; (0, 1, 0) is the default.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("default" = [0, 1, 0]))]
    pub axis: Option<Triple>,
    /// The number of full turns in all frames; 1 is the default. Seen from where the axis points,
    /// the cameras go counterclockwise, and clockwise where the number is negative.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("default" = 1))]
    pub turns: Option<f64>,
}

impl OrbitModel {
    /// The direction of the line.
    pub(crate) fn axis(&self) -> DVec3 {
        self.axis.unwrap_or(UP).into()
    }
}

fields! {
    OrbitModel {
        around: Point,
        axis: Direction = UP,
        turns: Number = 1.0,
    } fixed {}
}
