//! The group of a scene file: geometries that belong together.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::scene::format::{
    field::{Name, fields, rules},
    geometry::GeometryModel,
};

/// Geometries that belong together. Each of them is seen as if it stood in the list of the scene.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename = "Group", deny_unknown_fields)]
#[schemars(inline, transform = rules::<Self>)]
pub struct GroupModel {
    /// The geometries of the group; groups may be in groups.
    pub geometries: Vec<GeometryModel>,
    /// The name of the group: no other geometry of the scene has it.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("minLength" = 1))]
    pub name: Option<Name>,
}

fields! {
    GroupModel {
    } fixed {
        geometries,
        name,
    }
}
