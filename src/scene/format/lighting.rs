//! How light is evaluated, in a scene file.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::{
    scene::format::{field::variants, object::object},
    tracer::world::Lighting,
};

/// How light is evaluated.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename = "Lighting", deny_unknown_fields)]
pub enum LightingModel {
    /// The lights shine on surfaces directly, and mirrors and glass send rays on. Exact: there is no
    /// noise.
    Direct(DirectModel),
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
    #[schemars(inline)]
    pub struct DirectModel = "Direct" {
        /// The largest number of reflections and refractions of a ray, 0 to 64; a ray that goes deeper
        /// sees the background. 8 is the default.
        max_depth: Depth = Lighting::MAX_DEPTH,
    }
}

variants! {
    LightingModel {
        Direct(DirectModel),
    }
}
