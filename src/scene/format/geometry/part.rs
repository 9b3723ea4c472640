//! The part of a scene file: another scene file.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::scene::format::{
    field::{Name, fields, rules},
    geometry::kind::Kind,
    transform::TransformModel,
};

/// The geometries of another scene file, with their own materials.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename = "Part", deny_unknown_fields)]
#[schemars(inline, transform = rules::<Self>)]
pub struct PartModel {
    /// The scene file: a path from the folder of this file to a file .ron or .json, with `/`
    /// between its parts. It needs no camera.
    #[schemars(regex(pattern = r"\.([rR][oO][nN]|[jJ][sS][oO][nN])$"))]
    pub file: Box<str>,
    /// True to add its lights; false is the default. The light of this scene falls on the part in
    /// either case.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("default" = false))]
    pub lights: Option<bool>,
    /// The change of place, direction and size of its geometries and its lights.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub transform: Option<Box<TransformModel>>,
    /// The name of the part: no other geometry of the scene has it.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("minLength" = 1))]
    pub name: Option<Name>,
}

impl Kind for PartModel {
    #[inline]
    fn transform(&self) -> Option<&TransformModel> {
        self.transform.as_deref()
    }

    fn transform_mut(&mut self) -> Option<&mut TransformModel> {
        self.transform.as_deref_mut()
    }
}

fields! {
    PartModel {
    } fixed {
        file,
        lights,
        transform,
        name,
    }
}
