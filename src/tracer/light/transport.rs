//! How the light of lights goes on from surface to surface.

/// How the light of a world goes on from surface to surface.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Transport {
    /// Lights shine on surfaces directly, and mirrors and glass send rays on: exact.
    #[default]
    Direct,
    /// Light follows paths from any surface to any other, of which some are sampled.
    Path(PathOptions),
}

/// How the paths of light are sampled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathOptions {
    /// The number of paths of a pixel, from 1 to [`PathOptions::MAX_SAMPLES`].
    pub samples: u32,
    /// The number of scatterings by a diffuse lobe after the first one; any number if `None`.
    pub diffuse_depth: Option<u32>,
    /// True if light gets through solid glass by the paths of its rays alone; false if it goes straight
    /// on through solid glass to where it is aimed, and no path finds a light by mirrors or solid glass
    /// behind a surface that scatters.
    pub caustics: bool,
    /// The largest channel of the light of a path after its first vertex, above 0 and at most
    /// [`PathOptions::MAX_CLAMP`]; brighter light is scaled down.
    pub clamp: Option<f64>,
    /// The seed of the numbers of all paths.
    pub seed: u32,
}

impl PathOptions {
    /// The largest number of paths of a pixel.
    pub const MAX_SAMPLES: u32 = 1 << 20;
    /// The default of the largest depth of a path.
    pub const MAX_DEPTH: u32 = 32;
    /// The largest limit of light.
    pub const MAX_CLAMP: f64 = 1e12;

    /// Returns the number of paths of a pixel within its limits.
    pub(crate) fn samples(&self) -> u32 {
        self.samples.clamp(1, Self::MAX_SAMPLES)
    }
}

impl Default for PathOptions {
    /// Returns 64 samples of any diffuse depth, with caustics.
    fn default() -> Self {
        Self {
            samples: 64,
            diffuse_depth: None,
            caustics: true,
            clamp: None,
            seed: 0,
        }
    }
}
