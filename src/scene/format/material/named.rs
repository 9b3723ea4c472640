//! The name of a material, in a scene file.

use std::ops::ControlFlow;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::scene::format::{
    field::{Field, Fields, Value},
    thing::{See, Thing, Type},
};

/// The name of one of the scene's `materials`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(transparent)]
#[schemars(inline)]
pub struct NamedModel(pub Box<str>);

impl Fields for NamedModel {
    const FIELDS: &'static [Field] = &[];

    fn each<'m>(&'m self, _: impl FnMut(Field, Value<'m>)) {}
}

impl Thing for NamedModel {
    fn of_type() -> Type {
        Type::Object(Self::FIELDS)
    }

    fn things(&self, _: See) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }
}
