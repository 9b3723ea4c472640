//! The light of the pixels of a lit picture, or of one with outlines.

use std::ops::Range;

use crate::film::parts::LightParts;

/// The light of pixels before exposure, in planes of one number per pixel. An empty plane is 0
/// everywhere.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct LightPlanes {
    /// The parts by channel: the mean of all samples; if the background is transparent, that of the
    /// samples that hit something, without its light.
    pub(crate) parts: [[Vec<f64>; 3]; LightParts::NAMES.len()],
    /// The mean of the linear first colors of all samples, black where nothing is hit.
    pub(crate) albedo: [Vec<f64>; 3],
    /// The fraction of the samples that hit something.
    pub(crate) coverage: Vec<f64>,
    /// The part of a transparent background that shows in these samples, in mirrors and through
    /// glass: the mean of the channels.
    pub(crate) behind: Vec<f64>,
    /// The standard error of the mean of all light, by channel; empty unless light follows paths.
    pub(crate) error: [Vec<f64>; 3],
    /// The number of samples; empty unless light follows paths.
    pub(crate) samples: Vec<f64>,
}

/// The light of neighboring pixels, as in [`LightPlanes`].
#[derive(Clone, Copy, Debug)]
pub(crate) struct LightRun<'a> {
    pub(crate) parts: [[&'a [f64]; 3]; LightParts::NAMES.len()],
    pub(crate) albedo: [&'a [f64]; 3],
    pub(crate) coverage: &'a [f64],
    pub(crate) behind: &'a [f64],
    pub(crate) error: [&'a [f64]; 3],
    pub(crate) samples: &'a [f64],
}

impl LightPlanes {
    /// Returns the light of some pixels.
    pub(super) fn run(&self, pixels: Range<usize>) -> LightRun<'_> {
        let [direct, specular] = &self.parts;
        LightRun {
            parts: [channels(direct, &pixels), channels(specular, &pixels)],
            albedo: channels(&self.albedo, &pixels),
            coverage: of(&self.coverage, &pixels),
            behind: of(&self.behind, &pixels),
            error: channels(&self.error, &pixels),
            samples: of(&self.samples, &pixels),
        }
    }
}

impl LightRun<'_> {
    /// Returns the part of a pixel that hides the background.
    pub(crate) fn alpha(&self, place: usize) -> f64 {
        self.coverage[place] * (1.0 - self.behind.get(place).unwrap_or(&0.0))
    }
}

fn of<'a>(plane: &'a [f64], pixels: &Range<usize>) -> &'a [f64] {
    plane.get(pixels.clone()).unwrap_or_default()
}

fn channels<'a>(planes: &'a [Vec<f64>; 3], pixels: &Range<usize>) -> [&'a [f64]; 3] {
    planes.each_ref().map(|plane| of(plane, pixels))
}
