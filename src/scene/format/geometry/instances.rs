//! The instances of a scene file: copies of another geometry.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::{
    scene::format::{
        field::{Name, fields, rules},
        geometry::kind::Kind,
        transform::TransformModel,
    },
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
    #[serde(skip_serializing_if = "Option::is_none")]
    pub transforms: Option<Vec<TransformModel>>,
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

impl Kind for InstancesModel {
    fn more_numbers(&self, see: &mut dyn FnMut(f64)) {
        self.of.bytes().for_each(|byte| see(byte.into()));
        let transforms = self.transforms.iter().flatten();
        let rows = transforms.filter_map(|transform| Some(transform.build().ok()?.rows()));
        rows.for_each(|rows| rows.as_flattened().iter().for_each(|number| see(*number)));
    }
}
