//! The name of a material, in a scene file.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::scene::format::field::{Field, Fields, Slot, Value};

/// The name of one of the scene's `materials`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(transparent)]
#[schemars(inline)]
pub struct NamedModel(pub Box<str>);

impl Fields for NamedModel {
    const FIELDS: &'static [Field] = &[];

    fn each<'m>(&'m self, _: impl FnMut(Field, Value<'m>)) {}

    fn slot(&mut self, _: &str) -> Option<Slot<'_>> {
        None
    }
}
