//! The options for rendering a scene.

use std::{
    path::{Path, PathBuf},
    sync::Arc,
};

use crate::{
    diagnostic::{error::Error, setters::setters},
    film::{crop::Crop, samples::SampleCount, size::Size},
    image_file::{Compression, Encoding, ImageFormat, Palette},
    parallel::{self, Cancel, OnProgress, timings::Timings},
    pipeline::Scene,
    render::{
        layers::{
            Layer,
            layout::{Layout, Settings},
        },
        shading::picture_sums::PictureSums,
    },
    simd::isa::Isa,
};

/// Render options that override those of the scene.
#[derive(Clone, Debug, Default)]
pub struct RenderOptions {
    pub(super) format: Option<ImageFormat>,
    pub(super) size: Option<Size>,
    pub(super) crop: Option<Crop>,
    pub(super) samples: Option<SampleCount>,
    pub(super) sums: Option<Arc<PictureSums>>,
    pub(super) layers: Vec<Layer>,
    pub(crate) settings: Settings,
    pub(super) quality: Option<u8>,
    pub(super) metadata: bool,
    pub(super) threads: Option<usize>,
    pub(super) compression: Compression,
    pub(super) palette: Palette,
    pub(super) cancel: Cancel,
    pub(super) progress: Option<OnProgress>,
    pub(super) timings: Timings,
    pub(super) isa: Isa,
}

impl RenderOptions {
    /// Returns the defaults: the size given by the scene, on all cores.
    pub fn new() -> Self {
        Self::default()
    }

    /// Returns the encoding of the file.
    pub(super) fn encoding<'a>(
        &self,
        layout: &Layout,
        metadata: &'a [(String, String)],
    ) -> Encoding<'a> {
        Encoding {
            compression: self.compression,
            quality: self.quality.unwrap_or(Encoding::default().quality),
            colors: layout.is_color,
            metadata,
        }
    }

    /// Returns two texts for a scene of this size and number of samples: the options that change
    /// the picture, and those that change only its file. The format of the file is not included.
    pub(super) fn in_words(&self, size: Size, samples: SampleCount) -> (String, String) {
        let Self {
            size: other_size,
            crop,
            samples: other_samples,
            layers,
            settings,
            quality,
            metadata,
            compression,
            palette,
            format: _,
            // These do not change a byte.
            sums: _,
            threads: _,
            cancel: _,
            progress: _,
            timings: _,
            isa: _,
        } = self;
        let size = other_size.unwrap_or(size);
        let crop = crop.unwrap_or(Crop::whole(size));
        let samples = other_samples.unwrap_or(samples);
        (
            format!("{size} {crop} {samples}"),
            format!("{layers:?} {settings:?} {quality:?} {metadata} {compression:?} {palette:?}"),
        )
    }

    /// Returns the format of a file: [`RenderOptions::format`] if set, else the format of its
    /// extension.
    pub(super) fn format_of(&self, path: &Path) -> Result<ImageFormat, Error> {
        self.format.map_or_else(|| ImageFormat::of_path(path), Ok)
    }

    setters! {
        /// Sets the format of files regardless of their extension, such as for a device without one.
        format(format: ImageFormat) => format = Some(format);

        /// Gives the picture an alpha channel, the fraction of each pixel covered by geometries,
        /// instead of the background.
        transparent(is_transparent: bool) => settings.is_transparent = is_transparent;

        /// Sets the bits per number, 8, 16 or 32, in formats that offer a choice. 32 bits are floats in
        /// linear light.
        bits(bits: u8) => settings.bits = Some(bits);

        /// Sets the depths that map to 0 and to the largest integer, where depths are integers.
        depth_range(near: f64, far: f64) => settings.depth_range = Some((near, far));

        /// Sets the quality in lossy formats, from 1 to 100; the default is 90.
        quality(quality: u8) => quality = Some(quality);

        /// Adds metadata to the file: the program version, a hash of the picture's inputs, and the
        /// camera.
        metadata(metadata: bool) => metadata = metadata;

        /// Sets the size, instead of that of the scene.
        size(size: Size) => size = Some(size);

        /// Renders only a part of the picture; its pixels are the same as in the whole picture.
        crop(crop: Crop) => crop = Some(crop);

        /// Sets the samples per pixel, instead of those of the scene.
        samples(samples: impl Into<SampleCount>) => samples = Some(samples.into());

        /// Sets the sums of samples from [`Scene::add_samples`](crate::Scene::add_samples) with the same
        /// options; only samples that they lack are traced.
        sums(sums: impl Into<Arc<PictureSums>>) => sums = Some(sums.into());

        /// Sets the number of threads; 0, the default, means one per core. The picture is the same for
        /// every number.
        threads(threads: usize) => threads = (threads > 0).then_some(threads);

        /// Sets an instruction set other than the best one of the processor. The picture is the same
        /// for each.
        #[doc(hidden)]
        isa(isa: Isa) => isa = isa;

        /// Sets the compression of the pixels, in formats that offer [a
        /// choice](ImageFormat::compressions).
        compression(compression: Compression) => compression = compression;

        /// Sets when a file is indexed, in formats that [have palettes](ImageFormat::has_palette).
        palette(palette: Palette) => palette = palette;

        /// Sets the handle that can cancel the work.
        cancel(cancel: Cancel) => cancel = cancel;

        /// Sets a callback that receives the number of pixels just rendered. It is called from any
        /// thread.
        on_progress(progress: impl Fn(u64) + Send + Sync + 'static) => progress = Some(OnProgress::new(progress));

        /// Sets the timings that the stages are added to, such as
        /// [`Scene::timings`](crate::Scene::timings).
        timings(timings: Timings) => timings = timings;
    }

    /// Returns the files that [`Scene::save_with`](crate::Scene::save_with) writes for a path, with
    /// their layers. If the format holds one layer only, `out.png` becomes `out.depth.png` and so
    /// on.
    ///
    /// # Errors
    ///
    /// An unknown file extension, and several layers for a path without an extension.
    pub fn files(&self, path: &Path) -> Result<Vec<(PathBuf, Vec<Layer>)>, Error> {
        let format = self.format_of(path)?;
        if format.has_layers() || self.layers.is_empty() {
            return Ok(vec![(path.to_owned(), self.layers.clone())]);
        }
        // A device or a pipe has no extension and is written to directly.
        let Some(ending) = path.extension().map(|ending| ending.to_string_lossy()) else {
            return match &*self.layers {
                [_] => Ok(vec![(path.to_owned(), self.layers.clone())]),
                _ => {
                    let message = "one output cannot hold the files of several layers";
                    Err(Error::refused(message).at(path))
                }
            };
        };
        let file = |layer: &Layer| {
            let path = path.with_extension(format!("{layer}.{ending}"));
            (path, vec![*layer])
        };
        Ok(self.layers.iter().map(file).collect())
    }

    /// Sets the layers to render; the default is color only.
    #[must_use]
    pub fn layers(mut self, layers: impl IntoIterator<Item = Layer>) -> Self {
        self.layers = layers.into_iter().collect();
        self.layers.sort_unstable();
        self.layers.dedup();
        self
    }

    /// Returns the number of samples per pixel, for a scene.
    pub fn sample_count(&self, scene: &Scene) -> SampleCount {
        self.samples.unwrap_or_else(|| scene.samples())
    }

    /// Returns the number of threads that will render.
    pub fn thread_count(&self) -> usize {
        parallel::thread_count(self.threads)
    }
}
