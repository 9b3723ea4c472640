//! How light is evaluated, in a scene file.

use crate::{
    scene::format::{object::object, variants::variants},
    tracer::{
        light::transport::{PathOptions, PixelFilter, Transport},
        world::Lighting,
    },
};

variants! {
    /// How light is evaluated.
    pub enum LightingModel = "Lighting" {
        /// The lights shine on surfaces directly, and mirrors and glass send rays on. Exact: there is no
        /// noise.
        Direct(DirectModel),
        /// Light follows paths from surface to surface: soft shadows, and light that surfaces send to each
        /// other. The picture is the mean of samples, so there is noise.
        Path(PathModel) | PathTracing | PathTracer,
    }
}

impl LightingModel {
    /// Returns the largest number of reflections and refractions, with the default filled in.
    pub(crate) fn max_depth(&self) -> u32 {
        match self {
            Self::Direct(direct) => direct.max_depth(),
            Self::Path(path) => path.max_depth(),
        }
    }

    /// Returns how light goes on from surface to surface.
    pub(crate) fn transport(&self) -> Transport {
        match self {
            Self::Direct(_) => Transport::Direct,
            Self::Path(path) => Transport::Path(path.options()),
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
        max_depth: Natural { 64 } = Lighting::MAX_DEPTH,
    }
}

object! {
    /// Light follows paths from surface to surface: soft shadows, and light that surfaces send to each
    /// other. The picture is the mean of samples, so there is noise.
    #[derive(Default)]
    pub struct PathModel = "Path" {
        /// The number of paths per pixel, 1 to 1,048,576; 64 is the default. Four times as many have half
        /// the noise; powers of 2 have the least.
        samples | spp: Count { PathOptions::MAX_SAMPLES } = PathOptions::default().samples,
        /// The largest number of scatterings of a path, 0 to 1024; a longer path brings no light. 32 is the
        /// default.
        max_depth: Natural { 1024 } = PathOptions::MAX_DEPTH,
        /// The largest number of diffuse scatterings after the first one, 0 to 1024: 0 is the light of
        /// `Direct` with soft shadows. Without it, there is no such limit.
        diffuse_depth: Natural { 1024 }?,
        /// True if light reaches surfaces through solid glass and by mirrors, as bright and noisy patches; the
        /// default. False lets it go straight through solid glass: less noise, but not exact.
        caustics: Flag = true,
        /// The largest light of a path after its first surface, above 0 and at most 1e12; brighter light is
        /// reduced to it: less noise, but not exact. Without it, there is no such limit.
        clamp: Limit?,
        /// The noise at which a part of the picture has enough samples, 0.0001 to 1, such as 0.01: squares of
        /// 8 x 8 pixels may end after 64 samples, 128 and so on. `samples` is then the largest number. It
        /// is a slight bias. Without it, every pixel has all samples.
        noise: Noise?,
        /// The seed of the samples, 0 to 4294967295; 0 is the default.
        seed: Natural { u32::MAX } = 0,
        /// The distribution of paths around the center of a pixel; `Box()` is the default.
        filter: Thing(FilterModel)?,
    }
}

variants! {
    /// The distribution of paths around the center of a pixel.
    pub enum FilterModel = "Filter" {
        /// Evenly over the pixel.
        Box(BoxFilterModel),
        /// Around the center of the pixel, by a normal distribution: smoother edges, and a softer picture.
        Gaussian(GaussianFilterModel),
    }
}

object! {
    /// Evenly over the pixel.
    #[derive(Default)]
    pub struct BoxFilterModel = "Box" {}
}

object! {
    /// Around the center of the pixel, by a normal distribution: smoother edges, and a softer picture.
    #[derive(Default)]
    pub struct GaussianFilterModel = "Gaussian" {
        /// The standard deviation in pixels, above 0 and at most 4; 0.5 is the default.
        sigma: FilterWidth = 0.5,
    }
}

impl FilterModel {
    fn build(&self) -> PixelFilter {
        match self {
            Self::Box(_) => PixelFilter::Box,
            Self::Gaussian(gaussian) => PixelFilter::Gaussian(gaussian.sigma()),
        }
    }
}

impl PathModel {
    fn options(&self) -> PathOptions {
        PathOptions {
            samples: self.samples(),
            diffuse_depth: self.diffuse_depth,
            caustics: self.caustics(),
            clamp: self.clamp,
            noise: self.noise,
            seed: self.seed(),
            filter: self
                .filter
                .as_ref()
                .map_or(PixelFilter::Box, FilterModel::build),
        }
    }
}
