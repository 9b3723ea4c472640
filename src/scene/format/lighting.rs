//! How light is evaluated, in a scene file.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::scene::format::field::{fields, rules};

/// How light is evaluated.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename = "Lighting", deny_unknown_fields)]
pub enum LightingModel {
    /// The lights shine on surfaces directly, and mirrors and glass send rays on. Exact: there is no
    /// noise.
    Direct(DirectModel),
}

impl LightingModel {
    /// Returns the largest number of reflections and refractions, if given.
    pub(crate) const fn max_depth(&self) -> Option<u32> {
        match self {
            Self::Direct(direct) => direct.max_depth,
        }
    }
}

/// The lights shine on surfaces directly, and mirrors and glass send rays on. Exact: there is no
/// noise.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename = "Direct", deny_unknown_fields)]
#[schemars(inline, transform = rules::<Self>)]
pub struct DirectModel {
    /// The largest number of reflections and refractions of a ray, 0 to 64; a ray that goes deeper
    /// sees the background. 8 is the default.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("default" = 8))]
    pub max_depth: Option<u32>,
}

fields! {
    DirectModel {
        max_depth: Depth,
    } fixed {}
}
