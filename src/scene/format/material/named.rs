//! The name of a material, in a scene file.

use serde::{Deserialize, Serialize};

use crate::scene::format::{
    material::kind::MaterialKind,
    texture::TextureModel,
    thing::{Thing, Type},
};

/// The name of one of the scene's `materials`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct NamedModel(pub Box<str>);

impl NamedModel {
    /// The name of the variant that it is.
    pub(crate) const VARIANT: &str = "Named";

    /// Returns the name, in place of a description.
    pub(super) fn described(&self) -> Result<&dyn MaterialKind, &str> {
        Err(&self.0)
    }

    pub(super) const fn texture_mut(&mut self) -> Option<&mut TextureModel> {
        None
    }
}

impl Thing for NamedModel {
    fn of_type() -> Type {
        Type::NameOfMaterial
    }
}
