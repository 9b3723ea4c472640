//! `--lights`, `--look` and `--outlines`: what a picture shows and the scene does not have.

use std::path::Path;

use clap::builder::TypedValueParser;
use strahl::{Document, ReadOptions, scene::Look};

use super::{failure::Failure, words::one_of};

/// What is added to a scene.
#[derive(clap::Args)]
#[group(skip)]
pub(super) struct AdditionArgs {
    /// Light a scene that has no `lights`, without editing it
    #[arg(long, value_name = "NAME", value_enum)]
    lights: Option<Lights>,
    /// Light the scene by a look, in place of its own lights: `studio` is a sky and a soft sun, by 256 paths per
    /// pixel
    #[arg(long, value_name = "NAME", value_parser = looks(), conflicts_with = "lights")]
    look: Option<Look>,
    /// Draw outlines, the default ones where the scene has no `outlines`
    #[arg(long)]
    outlines: bool,
}

/// The lights of a scene that has none.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum Lights {
    /// A white light at the camera, without shadows
    Headlight,
}

/// Returns the parser of an option that names a look.
pub(super) fn looks() -> impl TypedValueParser<Value = Look> {
    one_of(Look::ALL.iter().copied(), |look| look.name().into())
}

impl AdditionArgs {
    /// Adds these to the options for reading scenes.
    pub(super) fn of(&self, options: ReadOptions) -> ReadOptions {
        let headlight = match self.lights {
            Some(Lights::Headlight) => true,
            None => false,
        };
        let options = options.headlight(headlight).look(self.look);
        options.outlines(self.outlines)
    }

    /// Rejects `--lights` for a scene with lights.
    pub(super) fn check(&self, scene: &Path, document: &Document) -> Result<(), Failure> {
        if self.lights.is_some() && document.has_lights() {
            let why = "has `lights` of its own: --lights is for scenes without; leave it out";
            return Err(Failure::refused(scene, why));
        }
        Ok(())
    }
}
