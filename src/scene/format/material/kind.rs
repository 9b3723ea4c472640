//! What each kind of material answers.

use crate::{
    scene::format::texture::TextureModel,
    tracer::{error::GeometryError, material::Material},
};

/// What each kind of material answers in its own file.
pub(crate) trait MaterialKind {
    /// The material.
    fn build(&self) -> Result<Material, GeometryError>;

    /// Returns itself; the name of a material that is described elsewhere has a method in place of this.
    fn described(&self) -> Result<&dyn MaterialKind, &str>
    where
        Self: Sized,
    {
        Ok(self)
    }

    /// The texture.
    fn texture(&self) -> Option<&TextureModel> {
        None
    }

    /// The texture, for a change.
    fn texture_mut(&mut self) -> Option<&mut TextureModel> {
        None
    }

    /// Returns true if it is bright whatever light falls on it.
    fn emits(&self) -> bool {
        false
    }

    /// Returns true if light goes through.
    fn is_glass(&self) -> bool {
        false
    }

    /// Returns a field that is given in vain, and the reason.
    fn moot_field(&self) -> Option<[&'static str; 2]> {
        None
    }
}
