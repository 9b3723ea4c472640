//! Comparison of pictures: the differences and their places.

mod exr;
mod flip;
mod heat;
pub(crate) mod layers;
pub(crate) mod limit;
mod numpy;
mod pfm;
pub(crate) mod picture;
mod plane;
mod preview;
pub(crate) mod profile;
mod read;
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
    diagnostic::{error::Error, setters::setters},
    film::size::Size,
    image_file::{
        self,
        output::Sink,
        pixel::{Pixel, Sample},
    },
    parallel::{Cancel, Pool},
    simd::isa::Isa,
};

/// The differences between two pictures of the same size.
///
/// They are in steps of an 8-bit channel: 255 is black against white. For files of integers they
/// are between display values (sRGB), for two files of floats between linear light.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Comparison {
    /// The size of both pictures.
    #[serde(skip)]
    pub size: Size,
    /// True if linear light was compared, as in two files of floats; false for display values.
    #[serde(skip)]
    pub is_linear: bool,
    /// Number of pixels that differ.
    pub different: u64,
    /// Number of these pixels that are infinite or NaN in one picture and something else in the
    /// other.
    pub not_finite: u64,
    /// The column and row of the first pixel that differs, from 0 at the top left.
    pub first: Option<[u32; 2]>,
    /// The smallest rectangle that contains all pixels that differ: its first column and row, its
    /// width and height.
    pub bounds: Option<[u32; 4]>,
    /// The largest difference of a channel; infinite if a difference is not finite.
    pub max_delta: f64,
    /// The mean difference over all channels of all pixels; infinite if the largest is.
    pub mean_delta: f64,
    /// The peak signal-to-noise ratio in decibels: infinite for equal pictures, negative infinity
    /// if a difference is not finite.
    pub psnr: f64,
    /// The mean structural similarity: 1 for equal pictures.
    pub ssim: f64,
    /// The mean FLIP error: 0 for equal pictures, at most 1.
    pub flip: f64,
    /// True if there are colors. If false, all of the fields above are those of equal pictures.
    pub has_colors: bool,
    /// The differences of named values other than colors, if the formats of both files support
    /// them: EXR, NPY and NPZ.
    pub layers: Vec<LayerComparison>,
}

impl Comparison {
    /// Returns true if no pixel differs in any value.
    pub fn is_equal(&self) -> bool {
        self.different == 0 && self.layers.iter().all(LayerComparison::is_equal)
    }
}

/// The options for comparing pictures.
#[derive(Clone, Debug, Default)]
pub struct CompareOptions {
    threads: Option<usize>,
    cancel: Cancel,
    heat: Option<PathBuf>,
    isa: Isa,
}

impl CompareOptions {
    /// Creates the default options: all cores, no heat picture.
    pub fn new() -> Self {
        Self::default()
    }

    setters! {
        /// Sets the number of threads; 0 means one per core, the default. The results are the same.
        threads(threads: usize) => threads = (threads > 0).then_some(threads);

        /// Sets the handle that can cancel the work.
        cancel(cancel: Cancel) => cancel = cancel;

        /// Writes a heat picture of the differences to a file, whose extension determines the format.
        /// Brighter pixels have a larger FLIP error; any pixel that differs is brighter than those that
        /// do not.
        heat(path: impl AsRef<Path>) => heat = Some(path.as_ref().to_owned());
    }
}

impl Picture {
    /// Compares two pictures. Returns `None`, and writes no heat picture, if their sizes differ.
    ///
    /// # Errors
    ///
    /// Fails if the heat picture cannot be written or the comparison is cancelled.
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

    /// Compares two pictures and returns the heat picture, the one [`CompareOptions::heat`] would
    /// write, as a PNG file.
    ///
    /// # Errors
    ///
    /// Fails if the comparison is cancelled.
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

    /// Compares two pictures. `save` gets the function that produces the heat picture, if one is
    /// wanted.
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

/// The sums over all tiles.
#[derive(Default)]
struct Total {
    tally: Tally,
    flip: f64,
    ssim: f64,
}

impl Total {
    /// Measures all tiles and passes on the heat picture, if one is wanted. Tiles are added up in
    /// order, whatever the threads.
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
        // A side has at most a million pixels, so it fits.
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
