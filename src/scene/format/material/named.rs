//! The name of a material, in a scene file.

use serde::{Deserialize, Serialize};

use crate::scene::format::thing::{Thing, Type};

/// The name of one of the scene's `materials`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct NamedModel(pub Box<str>);

impl NamedModel {
    /// The name of the variant that it is.
    pub(crate) const VARIANT: &str = "Named";
}

impl Thing for NamedModel {
    fn of_type() -> Type {
        Type::NameOfMaterial
    }
}
