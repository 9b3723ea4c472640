//! The group of a scene file: geometries that belong together.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::scene::format::{
    field::{Name, fields, rules},
    geometry::GeometryModel,
    transform::TransformModel,
};

/// Geometries that belong together. Each of them is seen as if it stood in the list of the scene, at
/// the place that the transform gives it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename = "Group", deny_unknown_fields)]
#[schemars(inline, transform = rules::<Self>)]
pub struct GroupModel {
    /// The geometries of the group; groups may be in groups.
    pub geometries: Vec<GeometryModel>,
    /// The change of place, direction and size of its geometries, and of the lights of its parts.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub transform: Option<Box<TransformModel>>,
    /// The name of the group: no other geometry of the scene has it.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("minLength" = 1))]
    pub name: Option<Name>,
}

fields! {
    GroupModel {
    } fixed {
        geometries,
        transform,
        name,
    }
}
