//! How light is evaluated, in a scene file.

use crate::{
    scene::format::{object::object, variants::variants},
    tracer::world::Lighting,
};

variants! {
    /// How light is evaluated.
    pub enum LightingModel = "Lighting" {
        /// The lights shine on surfaces directly, and mirrors and glass send rays on. Exact: there is no
        /// noise.
        Direct(DirectModel),
    }
}

impl LightingModel {
    /// Returns the largest number of reflections and refractions, with the default filled in.
    pub(crate) fn max_depth(&self) -> u32 {
        match self {
            Self::Direct(direct) => direct.max_depth(),
        }
    }
}

object! {
    /// The lights shine on surfaces directly, and mirrors and glass send rays on. Exact: there is no
    /// noise.
    #[derive(Default)]
    pub struct DirectModel = "Direct" {
        /// The largest number of reflections and refractions of a ray, 0 to 64; a ray that goes deeper
        /// sees the background. 8 is the default.
        max_depth: Depth = Lighting::MAX_DEPTH,
    }
}
