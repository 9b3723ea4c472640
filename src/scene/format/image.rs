//! The size of the picture in a scene file.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::{
    film::{samples::Samples, size::Size},
    scene::format::field::{fields, rules},
    tracer::tone::{Tone, ToneMapping},
};

/// The size of the picture, in pixels.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename = "Image", deny_unknown_fields)]
#[schemars(transform = rules::<Self>)]
pub struct ImageModel {
    /// The number of columns, 1 to 1,000,000; 640 is the default.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("default" = 640))]
    pub width: Option<u32>,
    /// The number of rows, 1 to 1,000,000; 480 is the default.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("default" = 480))]
    pub height: Option<u32>,
    /// Number of samples per pixel, a square of 1 to 64: 1, 4, 9, 16, … 4096; 1 is the default.
    /// They lie in a regular grid, and the pixel is their mean in linear light.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("enum" = Samples::all().map(Some).chain([None]).collect::<Vec<_>>(), "default" = 1))]
    pub samples: Option<u32>,
    /// The exposure of a lit picture in stops, each of which doubles the light; 0 is the default.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("default" = 0))]
    pub exposure: Option<f64>,
    /// The curve from the light of a lit picture to what a screen can show; `Clip` is the default.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("default" = "Clip"))]
    pub tone_mapping: Option<ToneMappingModel>,
}

/// The curve from the light of a lit picture to what a screen can show.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename = "ToneMapping")]
pub enum ToneMappingModel {
    /// Cuts off light above 1.
    #[default]
    Clip,
    /// Keeps hues and compresses highlights; white becomes 0.87 of the light of a screen's white.
    Neutral,
}

impl ImageModel {
    pub(crate) const DEFAULT_WIDTH: u32 = 640;
    pub(crate) const DEFAULT_HEIGHT: u32 = 480;

    /// Returns the exposure and the tone mapping with defaults filled in.
    pub(crate) fn tone(&self) -> Tone {
        let mapping = match self.tone_mapping.unwrap_or_default() {
            ToneMappingModel::Clip => ToneMapping::Clip,
            ToneMappingModel::Neutral => ToneMapping::Neutral,
        };
        Tone::new(self.exposure.unwrap_or(0.0), mapping)
    }

    /// Returns the width and height with defaults filled in.
    pub(crate) fn sides(&self) -> (u32, u32) {
        (
            self.width.unwrap_or(Self::DEFAULT_WIDTH),
            self.height.unwrap_or(Self::DEFAULT_HEIGHT),
        )
    }
}

fields! {
    ImageModel {
        width: Count { Size::MAX_SIDE },
        height: Count { Size::MAX_SIDE },
        exposure: Stops = 0.0,
    } fixed {
        samples,
        tone_mapping,
    }
}
