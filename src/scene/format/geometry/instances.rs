//! The instances of a scene file: copies of another geometry.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::scene::format::{
    field::{Name, fields, rules},
    transform::TransformModel,
};

/// Copies of another geometry of the scene, with its materials: one for each transform. However large
/// it is, all of them share its memory.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename = "Instances", deny_unknown_fields)]
#[schemars(inline, transform = rules::<Self>)]
pub struct InstancesModel {
    /// The name of the geometry, anywhere in the scene, which is also seen where it stands. The
    /// transforms of groups around it do not count.
    #[schemars(length(min = 1))]
    pub of: Box<str>,
    /// The place, direction and size of each copy.
    pub transforms: Vec<TransformModel>,
    /// The name of the instances: no other geometry of the scene has it.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("minLength" = 1))]
    pub name: Option<Name>,
}

fields! {
    InstancesModel {
    } fixed {
        of,
        transforms,
        name,
    }
}
