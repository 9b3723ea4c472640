//! The group of a scene file: geometries that belong together.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::scene::format::{
    field::{Name, fields, rules},
    geometry::{
        GeometryModel,
        kind::{FIELDS, Kind},
        nesting::Inside,
    },
    scene::Model,
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

impl Kind for GroupModel {
    fn inside(&self) -> [Option<Inside<'_>>; FIELDS] {
        [Some(Inside::list(Model::LONG, &self.geometries)), None]
    }

    fn inside_mut(&mut self) -> [&mut [GeometryModel]; FIELDS] {
        [&mut self.geometries, &mut []]
    }

    #[inline]
    fn transform(&self) -> Option<&TransformModel> {
        self.transform.as_deref()
    }

    fn transform_mut(&mut self) -> Option<&mut TransformModel> {
        self.transform.as_deref_mut()
    }
}

fields! {
    GroupModel {
    } fixed {
        geometries,
        transform,
        name,
    }
}
