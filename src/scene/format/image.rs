//! The size of the picture in a scene file.

use crate::{
    film::{samples::Samples, size::Size},
    scene::format::{object::object, thing::Type, variants::words},
    tracer::tone::{Tone, ToneMapping},
};

object! {
    /// The size of the picture, in pixels.
    #[derive(Default)]
    pub struct ImageModel = "Image" {
        /// The number of columns, 1 to 1,000,000; 640 is the default.
        width: Count { Size::MAX_SIDE } = 640,
        /// The number of rows, 1 to 1,000,000; 480 is the default.
        height: Count { Size::MAX_SIDE } = 480,
        /// Number of samples per pixel, a square of 1 to 64: 1, 4, 9, 16, … 4096; 1 is the default.
        /// They lie in a regular grid, and the pixel is their mean in linear light.
        samples | spp: Other { Type::Whole(|| Samples::all().collect()) }(u32) = 1,
        /// The exposure of a lit picture in stops, each of which doubles the light; 0 is the default.
        exposure: Stops = 0.0,
        /// The curve from the light of a lit picture to what a screen can show; `Clip` is the default.
        tone_mapping: Choice(ToneMappingModel) = ToneMappingModel::Clip,
    }
}

words! {
    /// The curve from the light of a lit picture to what a screen can show.
    #[derive(Copy, Default, Eq)]
    pub enum ToneMappingModel = "ToneMapping" {
        /// Cuts off light above 1.
        #[default]
        Clip,
        /// Keeps hues and compresses highlights; white becomes 0.87 of the light of a screen's white.
        Neutral,
    }
}

impl ImageModel {
    /// The image of a scene that does not describe it.
    pub(crate) const NONE: Self = Self {
        width: None,
        height: None,
        samples: None,
        exposure: None,
        tone_mapping: None,
    };

    /// Returns the exposure and the tone mapping with defaults filled in.
    pub(crate) fn tone(&self) -> Tone {
        let mapping = match self.tone_mapping() {
            ToneMappingModel::Clip => ToneMapping::Clip,
            ToneMappingModel::Neutral => ToneMapping::Neutral,
        };
        Tone::new(self.exposure(), mapping)
    }

    /// Returns the width and height with defaults filled in.
    pub(crate) fn sides(&self) -> (u32, u32) {
        (self.width(), self.height())
    }
}
