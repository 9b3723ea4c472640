//! Whether two pictures are the same, and where not.

mod exr;
mod flip;
mod heat;
pub(crate) mod layers;
pub(crate) mod limit;
mod numpy;
mod pfm;
pub(crate) mod picture;
mod plane;
mod shown;
mod ssim;
mod tally;
#[cfg(test)]
mod tests;
mod tile;
mod values;

use std::path::{Path, PathBuf};

use serde::Serialize;

use self::{
    tally::Tally,
    tile::{Measured, Pair},
    values::WHITE,
};
pub use layers::LayerComparison;
pub use limit::PictureOptions;
pub use picture::Picture;

use crate::{
    diagnostic::error::Error,
    film::size::Size,
    image_file::{
        self, Sink,
        pixel::{Pixel, Sample},
    },
    parallel::{Cancel, Pool},
    simd::Isa,
};

/// How two pictures of one size differ.
///
/// Differences are in steps of a channel of 8 bits: 255 is that of black and white. Those of files
/// of integers are between display values (sRGB), those of two files of floats between their
/// linear light.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Comparison {
    /// The size of both.
    #[serde(skip)]
    pub size: Size,
    /// Whether linear light was compared, as in two files of floats, or display values.
    #[serde(skip)]
    pub is_linear: bool,
    /// How many pixels differ.
    pub different: u64,
    /// How many of them are infinite or no number in one picture, and another thing in the other.
    pub not_finite: u64,
    /// Column and row, from 0 at the top left, of the first that differs.
    pub first: Option<[u32; 2]>,
    /// The least rectangle with all that differ: its first column and row, its width and height.
    pub bounds: Option<[u32; 4]>,
    /// The largest difference of a channel; infinite where there is one that is not finite.
    pub max_delta: f64,
    /// The mean difference of all channels of all pixels; infinite as the largest.
    pub mean_delta: f64,
    /// The peak signal-to-noise ratio in decibels: infinite for equal pictures, and negative
    /// infinite where there is a difference that is not finite.
    pub psnr: f64,
    /// The mean structural similarity: 1 for equal pictures.
    pub ssim: f64,
    /// The mean of FLIP: 0 for equal pictures, at most 1.
    pub flip: f64,
    /// Whether there are colors. If not, all of the above says that they are equal.
    pub has_colors: bool,
    /// The named numbers beside the colors, where both files are of formats that have such: EXR, NPY
    /// and NPZ.
    pub layers: Vec<LayerComparison>,
}

impl Comparison {
    /// Whether no pixel differs in anything.
    pub fn is_equal(&self) -> bool {
        self.different == 0 && self.layers.iter().all(LayerComparison::is_equal)
    }
}

/// How pictures are compared.
#[derive(Clone, Debug, Default)]
pub struct CompareOptions {
    threads: Option<usize>,
    cancel: Cancel,
    heat: Option<PathBuf>,
    isa: Isa,
}

impl CompareOptions {
    /// On all cores, without a heat picture.
    pub fn new() -> Self {
        Self::default()
    }

    /// So many threads instead of one for each core; the numbers are the same. 0 means one for each
    /// core.
    #[must_use]
    pub fn threads(mut self, threads: usize) -> Self {
        self.threads = (threads > 0).then_some(threads);
        self
    }

    /// What can cancel the work.
    #[must_use]
    pub fn cancel(mut self, cancel: Cancel) -> Self {
        self.cancel = cancel;
        self
    }

    /// Writes a picture of where they differ to a file, whose ending tells the format: the brighter,
    /// the larger the error of FLIP, and what differs at all is never as dark as what does not.
    #[must_use]
    pub fn heat(mut self, path: impl AsRef<Path>) -> Self {
        self.heat = Some(path.as_ref().to_owned());
        self
    }
}

impl Picture {
    /// Compares two pictures; `None` if they are not of one size, and then there is no heat picture
    /// either.
    ///
    /// # Errors
    ///
    /// A heat picture that cannot be written, and a cancelled comparison.
    pub fn compare(
        &self,
        other: &Self,
        options: &CompareOptions,
    ) -> Result<Option<Comparison>, Error> {
        self.measure(
            other,
            options,
            options.heat.is_some(),
            |measure| match &options.heat {
                None => measure(&mut |_| Ok(())),
                Some(path) => image_file::save(path, self.size(), &options.cancel, measure),
            },
        )
    }

    /// Compares two pictures and draws the heat picture, a PNG file, which [`CompareOptions::heat`]
    /// would write.
    ///
    /// # Errors
    ///
    /// A cancelled comparison.
    pub fn compare_with_heat(
        &self,
        other: &Self,
        options: &CompareOptions,
    ) -> Result<Option<(Comparison, Vec<u8>)>, Error> {
        let mut heat = Vec::new();
        let found = self.measure(other, options, true, |measure| {
            let rgb = Pixel::Rgb(Sample::U8);
            image_file::to_png(&mut heat, self.size(), rgb, measure)
        })?;
        Ok(found.map(|found| (found, heat)))
    }

    /// Compares two pictures; `save` is given what hands over the heat picture, where one is wanted.
    fn measure(
        &self,
        other: &Self,
        options: &CompareOptions,
        with_heat: bool,
        save: impl FnOnce(&mut dyn FnMut(Sink) -> Result<(), Error>) -> Result<(), Error>,
    ) -> Result<Option<Comparison>, Error> {
        if self.size() != other.size() {
            return Ok(None);
        }
        let pair = Pair::new(self, other, with_heat, options.isa);
        let mut total = Total::default();
        save(&mut |sink| total.measure(&pair, options, sink))?;
        Ok(Some(total.comparison(self, other, &pair)))
    }
}

/// What has been found in all tiles.
#[derive(Default)]
struct Total {
    tally: Tally,
    flip: f64,
    ssim: f64,
}

impl Total {
    /// Measures all tiles and hands over the heat picture, where one is wanted. The tiles are added
    /// up in their order, whatever the threads.
    fn measure(&mut self, pair: &Pair, options: &CompareOptions, sink: Sink) -> Result<(), Error> {
        let pool = Pool::new(options.threads);
        let width = pair.sides.0;
        let mut rows = Vec::new();
        let take = |measured: Measured| {
            options.cancel.check()?;
            self.tally.merge(&measured.tally);
            self.flip += measured.flip;
            self.ssim += measured.ssim;
            let tile = measured.tile;
            if measured.heat.is_empty() {
                return Ok(());
            }
            rows.resize(width * tile.height() * 3, 0);
            let lines = rows.chunks_exact_mut(width * 3);
            for (line, heat) in lines.zip(measured.heat.chunks_exact(tile.width() * 3)) {
                line[tile.left * 3..tile.right * 3].copy_from_slice(heat);
            }
            if tile.right == width {
                sink(&rows)
            } else {
                Ok(())
            }
        };
        let ahead = 4 * pool.threads();
        pool.in_order(pair.tiles(), ahead, |tile| pair.measure(tile), take)
    }

    fn comparison(self, a: &Picture, b: &Picture, pair: &Pair) -> Comparison {
        let size = a.size();
        let channels = pair.form.channels() as f64;
        let samples = size.pixels() as f64 * channels;
        let tally = self.tally;
        let psnr = 10.0 * libm::log10(WHITE * WHITE * samples / tally.squares);
        // A side has at most a million pixels.
        let small = |side: usize| side as u32;
        Comparison {
            size,
            is_linear: pair.form.is_linear,
            different: tally.different,
            not_finite: tally.not_finite,
            first: tally.first.map(|(row, column)| [column, row].map(small)),
            bounds: tally.bounds.map(|bounds| {
                let (width, height) = (bounds.width(), bounds.height());
                [bounds.left, bounds.top, width, height].map(small)
            }),
            max_delta: tally.largest,
            mean_delta: tally.sum / samples,
            psnr,
            ssim: self.ssim / (pair.windows.total() as f64 * channels),
            flip: self.flip / size.pixels() as f64,
            has_colors: a.has_colors || b.has_colors,
            layers: a.compare_layers(b),
        }
    }
}
