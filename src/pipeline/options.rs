//! How a scene is rendered.

use std::{
    fmt,
    path::{Path, PathBuf},
    sync::Arc,
};

use crate::{
    diagnostic::error::{Error, ErrorKind},
    film::{crop::Crop, samples::Samples, size::Size},
    image_file::{Compression, Encoding, ImageFormat, Palette},
    parallel::{self, Cancel, OnProgress, timings::Timings},
    render::layers::{
        Layer,
        layout::{Layout, Settings},
    },
    simd::Isa,
};

/// How a scene is rendered, where that differs from what it says itself.
#[derive(Clone, Default)]
pub struct RenderOptions {
    pub(super) format: Option<ImageFormat>,
    pub(super) size: Option<Size>,
    pub(super) crop: Option<Crop>,
    pub(super) samples: Option<Samples>,
    pub(super) layers: Vec<Layer>,
    pub(super) settings: Settings,
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
    /// The size of the scene, on all cores.
    pub fn new() -> Self {
        Self::default()
    }

    /// How the file is encoded.
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

    /// All that changes a picture of a scene of this size and number of samples, and all that
    /// changes only its file, in words. The format of the file stands apart.
    pub(super) fn in_words(&self, size: Size, samples: Samples) -> (String, String) {
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
            // These change no byte.
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

    /// The format of a file: that of its ending, unless [`RenderOptions::format`] says another.
    pub(super) fn format_of(&self, path: &Path) -> Result<ImageFormat, Error> {
        self.format.map_or_else(|| ImageFormat::of_path(path), Ok)
    }

    /// A format for files, whatever their ending, such as a device that has none.
    #[must_use]
    pub fn format(mut self, format: ImageFormat) -> Self {
        self.format = Some(format);
        self
    }

    /// The files that [`Scene::save_with`](crate::Scene::save_with) writes for a path: with layers in
    /// a format that holds one alone, `out.png` becomes `out.depth.png` and so on.
    ///
    /// # Errors
    ///
    /// An unknown ending.
    pub fn files(&self, path: &Path) -> Result<Vec<(PathBuf, Vec<Layer>)>, Error> {
        let format = self.format_of(path)?;
        if format.has_layers() || self.layers.is_empty() {
            return Ok(vec![(path.to_owned(), self.layers.clone())]);
        }
        // A device or a pipe has no ending, and is written through.
        let Some(ending) = path.extension().map(|ending| ending.to_string_lossy()) else {
            return match &*self.layers {
                [_] => Ok(vec![(path.to_owned(), self.layers.clone())]),
                _ => {
                    let message = "one place cannot take the files of several layers";
                    Err(Error::new(ErrorKind::Usage, message).at(path))
                }
            };
        };
        let file = |layer: &Layer| {
            let path = path.with_extension(format!("{layer}.{ending}"));
            (path, vec![*layer])
        };
        Ok(self.layers.iter().map(file).collect())
    }

    /// Which layers are drawn; the default is the color alone.
    #[must_use]
    pub fn layers(mut self, layers: impl IntoIterator<Item = Layer>) -> Self {
        self.layers = layers.into_iter().collect();
        self.layers.sort_unstable();
        self.layers.dedup();
        self
    }

    /// Whether a picture has alpha, the part of each pixel that geometries cover, instead of the
    /// background.
    #[must_use]
    pub fn transparent(mut self, is_transparent: bool) -> Self {
        self.settings.is_transparent = is_transparent;
        self
    }

    /// The bits of each number, 8, 16 or 32, where a format leaves a choice. 32 are floats, which
    /// hold linear light.
    #[must_use]
    pub fn bits(mut self, bits: u8) -> Self {
        self.settings.bits = Some(bits);
        self
    }

    /// Which depths become 0 and the largest integer where depths are integers.
    #[must_use]
    pub fn depth_range(mut self, near: f64, far: f64) -> Self {
        self.settings.depth_range = Some((near, far));
        self
    }

    /// How much a file keeps, from 1 to 100, in formats that lose something; the default is 90.
    #[must_use]
    pub fn quality(mut self, quality: u8) -> Self {
        self.quality = Some(quality);
        self
    }

    /// Whether the file says what it was made of and with what.
    #[must_use]
    pub fn metadata(mut self, metadata: bool) -> Self {
        self.metadata = metadata;
        self
    }

    /// Another size than that of the scene.
    #[must_use]
    pub fn size(mut self, size: Size) -> Self {
        self.size = Some(size);
        self
    }

    /// A part of the picture instead of all of it; its pixels are those of the whole.
    #[must_use]
    pub fn crop(mut self, crop: Crop) -> Self {
        self.crop = Some(crop);
        self
    }

    /// So many samples in each pixel, instead of those of the scene.
    #[must_use]
    pub fn samples(mut self, samples: Samples) -> Self {
        self.samples = Some(samples);
        self
    }

    /// So many threads instead of one for each core; the picture is the same. 0 means one for
    /// each core.
    #[must_use]
    pub fn threads(mut self, threads: usize) -> Self {
        self.threads = (threads > 0).then_some(threads);
        self
    }

    /// With other instructions than the best that the processor has; the picture is the same.
    #[doc(hidden)]
    #[must_use]
    pub fn isa(mut self, isa: Isa) -> Self {
        self.isa = isa;
        self
    }

    /// How many threads will draw.
    pub fn thread_count(&self) -> usize {
        parallel::thread_count(self.threads)
    }

    /// How the pixels are compressed, in formats that leave [a choice](ImageFormat::compressions).
    #[must_use]
    pub fn compression(mut self, compression: Compression) -> Self {
        self.compression = compression;
        self
    }

    /// Whether a file is indexed, in formats that [have palettes](ImageFormat::has_palette).
    #[must_use]
    pub fn palette(mut self, palette: Palette) -> Self {
        self.palette = palette;
        self
    }

    /// Sets the handle that can cancel the work.
    #[must_use]
    pub fn cancel(mut self, cancel: Cancel) -> Self {
        self.cancel = cancel;
        self
    }

    /// Is told, from any thread, how many pixels have just been drawn.
    #[must_use]
    pub fn on_progress(mut self, progress: impl Fn(u64) + Send + Sync + 'static) -> Self {
        self.progress = Some(Arc::new(progress));
        self
    }

    /// What takes the times of the stages, such as [`Scene::timings`](crate::Scene::timings).
    #[must_use]
    pub fn timings(mut self, timings: Timings) -> Self {
        self.timings = timings;
        self
    }
}

impl fmt::Debug for RenderOptions {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("RenderOptions")
            .field("format", &self.format)
            .field("size", &self.size)
            .field("crop", &self.crop)
            .field("samples", &self.samples)
            .field("layers", &self.layers)
            .field("settings", &self.settings)
            .field("quality", &self.quality)
            .field("metadata", &self.metadata)
            .field("threads", &self.threads)
            .field("compression", &self.compression)
            .field("palette", &self.palette)
            .field("cancel", &self.cancel)
            .field("progress", &self.progress.is_some())
            .field("timings", &self.timings)
            .field("isa", &self.isa)
            .finish()
    }
}
