//! Where the branches meet: a scene file becomes a picture.

mod contents;

use std::{
    cell::LazyCell,
    fmt, io,
    path::{Path, PathBuf},
    sync::Arc,
};

use crate::{
    accel::first_hits::Work,
    colors::{self, ColorTable, Mixer},
    diagnostic::Diagnostic,
    error::{Error, ErrorKind},
    film::{Crop, Film, Image, Samples, Size},
    fingerprint::Fingerprint,
    image_file::{
        self, Compression, Encoding, ImageFormat, Palette, cryptomatte,
        pixel::{Pixel, Sample},
    },
    layers::{
        Layer,
        layout::{Layout, MATTE, Settings},
        rows::Painter,
    },
    output::Output,
    parallel::{self, Cancel, OnProgress, Pool},
    render::RayTracer,
    scene::{
        build,
        document::Document,
        names::Names,
        origin::{Origin, Origins},
        syntax::Syntax,
        unknown,
    },
    simd::Isa,
    target::Target,
    timings::{Stage, Timings, Watch},
    tracer::{camera::Camera, world::World},
};

/// A scene without errors, ready to be rendered.
///
/// # Examples
///
/// ```no_run
/// strahl::Scene::from_path("scenes/gallery.ron")?.save("gallery.png")?;
/// # Ok::<(), strahl::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct Scene {
    camera: Camera,
    /// Whether that is the one without a name.
    has_camera: bool,
    cameras: Vec<(Box<str>, Camera)>,
    world: World,
    origins: Origins,
    names: Names,
    size: Size,
    samples: Samples,
    warnings: Vec<Diagnostic>,
    timings: Timings,
}

impl Scene {
    /// Reads a scene file; its ending, `.ron` or `.json`, tells the syntax.
    ///
    /// # Errors
    ///
    /// A file that cannot be read, and a scene with errors.
    pub fn from_path(path: impl AsRef<Path>) -> Result<Self, Error> {
        Document::from_path(path)?.try_into()
    }

    /// Reads a scene from text.
    ///
    /// # Errors
    ///
    /// A scene with errors.
    pub fn from_text(text: impl Into<String>, syntax: Syntax) -> Result<Self, Error> {
        Document::from_text("<text>", text, syntax).try_into()
    }

    /// Where the scene is seen from: its `camera`, or where it has none the first of its `cameras`,
    /// unless [`Scene::with_camera`] has chosen another one.
    pub const fn camera(&self) -> &Camera {
        &self.camera
    }

    /// Whether the scene has a `camera`, the one without a name.
    pub const fn has_camera(&self) -> bool {
        self.has_camera
    }

    /// The names of the scene's `cameras`, in the order of the file.
    pub fn cameras(&self) -> impl ExactSizeIterator<Item = &str> {
        self.cameras.iter().map(|(name, _)| &**name)
    }

    /// The same scene, seen by one of its `cameras`.
    ///
    /// # Errors
    ///
    /// A name that none of them has; [`Error::diagnostics`] says which one is near.
    ///
    /// # Examples
    ///
    /// ```
    /// use strahl::{Scene, Syntax};
    ///
    /// let text = r##"(
    ///     cameras: {
    ///         "front": Perspective(eye: (0, 0, 9), gaze: (0, 0, -1), fov: 60),
    ///         "top": Orthographic(eye: (0, 9, 0), gaze: (0, -1, 0), up: (0, 0, -1), scale: 4),
    ///     },
    ///     geometries: [Sphere(center: (0, 0, 0), radius: 1, color: "#ff0000")],
    /// )"##;
    /// let scene = Scene::from_text(text, Syntax::Ron)?;
    /// assert!(scene.cameras().eq(["front", "top"]));
    /// assert_eq!(scene.with_camera("top")?.camera().eye().y, 9.0);
    /// # Ok::<(), strahl::Error>(())
    /// ```
    pub fn with_camera(mut self, name: &str) -> Result<Self, Error> {
        let mut cameras = self.cameras.iter();
        let Some((_, camera)) = cameras.find(|(other, _)| **other == *name) else {
            let known: Vec<_> = self.cameras().collect();
            return Err(Error::usage(unknown::name("camera", name, &known)));
        };
        self.camera = *camera;
        Ok(self)
    }

    /// What is seen.
    pub const fn world(&self) -> &World {
        &self.world
    }

    /// Where in the scene a geometry of the world stands, by its index in the world: each row of a
    /// table is a geometry of its own.
    pub fn origin(&self, index: usize) -> Origin {
        self.origins.of(index)
    }

    /// What the scene calls a geometry of the world, by its index in the world; all rows of a table
    /// have the name of the table.
    ///
    /// # Examples
    ///
    /// ```
    /// use strahl::{Scene, Syntax};
    ///
    /// let text = r##"(
    ///     camera: Perspective(eye: (0, 0, 0), gaze: (0, 0, -1), fov: 90),
    ///     geometries: [
    ///         Sphere(center: (2, 0, -3), radius: 0.5, color: "#00ff00"),
    ///         Sphere(center: (0, 0, -3), radius: 0.5, color: "#ff0000", name: "ball"),
    ///     ],
    /// )"##;
    /// let scene = Scene::from_text(text, Syntax::Ron)?;
    /// assert_eq!([scene.name(0), scene.name(1)], [None, Some("ball")]);
    /// # Ok::<(), strahl::Error>(())
    /// ```
    pub fn name(&self, index: usize) -> Option<&str> {
        self.names.of(self.origin(index).geometry)
    }

    /// The size of the picture that the scene asks for.
    pub const fn size(&self) -> Size {
        self.size
    }

    /// How many samples of each pixel the scene asks for.
    pub const fn samples(&self) -> Samples {
        self.samples
    }

    /// What is probably not as it was meant, in the order of the file.
    pub fn warnings(&self) -> &[Diagnostic] {
        &self.warnings
    }

    /// How long it took to read, check and build the scene.
    pub const fn timings(&self) -> &Timings {
        &self.timings
    }

    /// Draws the picture on all cores.
    ///
    /// # Errors
    ///
    /// A picture that does not fit into memory.
    pub fn render(&self) -> Result<Image, Error> {
        self.render_with(&RenderOptions::new())
    }

    /// Draws the picture as `options` say.
    ///
    /// # Errors
    ///
    /// A picture that does not fit into memory, and a cancelled one.
    pub fn render_with(&self, options: &RenderOptions) -> Result<Image, Error> {
        let size = self.crop(options)?.size();
        let mut pixels = image_file::buffer(size, 3)?;
        let watch = options.timings.watch();
        let table = self.color_table(&watch);
        self.draw(options, &watch, Wanted::default(), |film| {
            film.append(&table, &mut pixels);
            Ok(())
        })?;
        Ok(Image::new(size, pixels))
    }

    /// Draws the picture on all cores and writes it to a file, whose ending tells the format.
    ///
    /// The file is written whole or not at all; an old one survives a failure.
    ///
    /// # Errors
    ///
    /// An unknown ending, what the format does not have, and a file that cannot be written.
    pub fn save(&self, path: impl AsRef<Path>) -> Result<(), Error> {
        self.save_with(path, &RenderOptions::new())
    }

    /// Draws the picture as `options` say and writes it to a file, as [`Scene::save`] does; or to
    /// one for each layer, see [`RenderOptions::files`].
    ///
    /// # Errors
    ///
    /// Those of [`Scene::save`], and a cancelled picture.
    pub fn save_with(&self, path: impl AsRef<Path>, options: &RenderOptions) -> Result<(), Error> {
        let path = path.as_ref();
        let format = ImageFormat::of_path(path)?;
        let files = options.files(path)?;
        for (path, layers) in &files {
            let checked = self.check(format, layers, options);
            checked.map_err(|error| error.at(path))?;
        }
        let watch = options.timings.watch();
        for (path, layers) in &files {
            let mut target = watch.time(Stage::Write, || Target::create(path, &options.cancel))?;
            let written = self.encode(format, layers, target.output(), options);
            written.map_err(|error| error.at(path))?;
            watch.time(Stage::Write, || target.finish())?;
        }
        Ok(())
    }

    /// Draws the picture as `options` say and writes it to `writer`, such as standard output.
    ///
    /// # Errors
    ///
    /// What the format does not have, what the writer returns, and a cancelled picture.
    pub fn write_with(
        &self,
        mut writer: impl io::Write,
        format: ImageFormat,
        options: &RenderOptions,
    ) -> Result<(), Error> {
        self.check(format, &options.layers, options)?;
        self.encode(
            format,
            &options.layers,
            Output::Stream(&mut writer),
            options,
        )
    }

    /// Refuses what cannot be drawn or what the format cannot hold.
    fn check(
        &self,
        format: ImageFormat,
        layers: &[Layer],
        options: &RenderOptions,
    ) -> Result<(), Error> {
        let size = self.crop(options)?.size();
        let layout = self.layout(format, layers, options)?;
        let metadata = self.metadata(&layout, options, &[]);
        format.check(size, layout.pixel(), options.encoding(&layout, &metadata))
    }

    fn layout(
        &self,
        format: ImageFormat,
        layers: &[Layer],
        options: &RenderOptions,
    ) -> Result<Layout, Error> {
        let layers = if layers.is_empty() {
            &[Layer::Color]
        } else {
            layers
        };
        Layout::new(
            format,
            layers,
            options.settings,
            self.world.geometries().len(),
        )
    }

    fn encode(
        &self,
        format: ImageFormat,
        layers: &[Layer],
        output: Output,
        options: &RenderOptions,
    ) -> Result<(), Error> {
        let crop = self.crop(options)?;
        let watch = options.timings.watch();
        let layout = self.layout(format, layers, options)?;
        let table = self.color_table(&watch);
        let samples = options.samples.unwrap_or(self.samples);
        let is_plain = layout.is_color && layout.pixel() == Pixel::Rgb(Sample::U8);
        let palette = match options.palette {
            Palette::Auto if format == ImageFormat::Png && is_plain && samples == Samples::ONE => {
                colors::Palette::of(&table)
            }
            _ => None,
        };
        let pixel = match &palette {
            Some(palette) => Pixel::Indexed(&palette.colors),
            None => layout.pixel(),
        };
        let names = if layout.has_mattes() {
            self.names()
        } else {
            Vec::new()
        };
        let mattes: Vec<f32> = names.iter().map(|name| cryptomatte::id(name)).collect();
        let metadata = self.metadata(&layout, options, &names);
        let painter = Painter {
            camera: &self.camera,
            world: &self.world,
            size: options.size.unwrap_or(self.size),
            background: (!options.settings.is_transparent).then(|| self.world.background()),
            layout: &layout,
            mattes: &mattes,
        };
        let wanted = Wanted {
            is_transparent: options.settings.is_transparent,
            centers: layers.iter().any(|layer| layer.is_of_center()),
            ranks: layout.has_mattes(),
        };
        let pool = Pool::new(options.threads)?;
        let mut bytes = Vec::new();
        let mut top = crop.rows().start;
        let draw = |sink: image_file::Sink| {
            self.draw(options, &watch, wanted, |film| {
                bytes.clear();
                match &palette {
                    Some(palette) => film.append(&palette.places, &mut bytes),
                    None if is_plain => film.append(&table, &mut bytes),
                    None => {
                        let rows = painter.rows(&film, crop.columns().start, top, &pool);
                        rows.iter().for_each(|row| bytes.extend_from_slice(row));
                    }
                }
                top += film.height() as u32;
                sink(&bytes)
            })
        };
        let encoding = options.encoding(&layout, &metadata);
        let encode = |output: Output| format.encode(output, crop.size(), pixel, encoding, draw);
        watch.time(Stage::Encode, || match output {
            Output::Stream(stream) => encode(Output::Stream(&mut watch.writer(stream))),
            Output::File(file) => encode(Output::File(&mut watch.writer(file))),
        })
    }

    /// What tells each geometry of the world apart: its name, else where it stands in the scene.
    fn names(&self) -> Vec<String> {
        let name = |index| {
            let origin = self.origin(index);
            match (self.name(index), origin.row) {
                (None, _) => origin.to_string(),
                (Some(name), None) => name.to_owned(),
                (Some(name), Some(row)) => format!("{name} row {row}"),
            }
        };
        (0..self.world.geometries().len()).map(name).collect()
    }

    /// What a file says of itself.
    fn metadata(
        &self,
        layout: &Layout,
        options: &RenderOptions,
        names: &[String],
    ) -> Vec<(String, String)> {
        let mut metadata = Vec::new();
        if layout.has_mattes() {
            let names = names.iter().map(String::as_str);
            metadata.extend(cryptomatte::metadata(MATTE, names));
        }
        if options.metadata {
            metadata.extend(self.about(options));
        }
        metadata
    }

    /// Version, camera and a hash of all that the picture shows.
    fn about(&self, options: &RenderOptions) -> Vec<(String, String)> {
        let entry = |name: &str, text: String| (name.to_owned(), text);
        vec![
            entry("Software", format!("strahl {}", env!("CARGO_PKG_VERSION"))),
            entry("Scene", self.fingerprint(options)),
            entry("Camera", format!("{:?}", self.camera)),
        ]
    }

    /// A hash of all that the pixels depend on.
    fn fingerprint(&self, options: &RenderOptions) -> String {
        let mut fingerprint = Fingerprint::default();
        fingerprint.text(env!("CARGO_PKG_VERSION"));
        let size = options.size.unwrap_or(self.size);
        let crop = options.crop.unwrap_or(Crop::whole(size));
        let samples = options.samples.unwrap_or(self.samples);
        fingerprint.text(&format!("{size} {crop} {samples}"));
        fingerprint.camera(&self.camera);
        fingerprint.world(&self.world);
        fingerprint.digits()
    }

    /// The part of the picture that is to be drawn.
    fn crop(&self, options: &RenderOptions) -> Result<Crop, Error> {
        let size = options.size.unwrap_or(self.size);
        let crop = options.crop.unwrap_or(Crop::whole(size));
        match crop.check(size) {
            Ok(()) => Ok(crop),
            Err(error) => Err(Error::new(ErrorKind::Usage, error.to_string())),
        }
    }

    /// The color of each geometry, made when it is first needed: while the first band is drawn.
    fn color_table<'a>(
        &'a self,
        watch: &'a Watch,
    ) -> LazyCell<ColorTable<3>, impl FnOnce() -> ColorTable<3> + use<'a>> {
        LazyCell::new(|| watch.time(Stage::Build, || ColorTable::rgb8(&self.world)))
    }

    /// Hands the picture over in bands from the top; with several threads, each while the next
    /// one is drawn.
    fn draw(
        &self,
        options: &RenderOptions,
        watch: &Watch,
        wanted: Wanted,
        mut each: impl FnMut(Film) -> Result<(), Error>,
    ) -> Result<(), Error> {
        let size = options.size.unwrap_or(self.size);
        let crop = self.crop(options)?;
        let tracer = RayTracer::with_size(&self.camera, &self.world, size)
            .samples(options.samples.unwrap_or(self.samples))
            .centers(wanted.centers)
            .isa(options.isa);
        let work = Work {
            pool: &Pool::new(options.threads)?,
            cancel: &options.cancel,
            progress: options.progress.as_ref(),
            watch: &options.timings.shared_watch(Stage::Trace),
            mixer: Mixer {
                world: &self.world,
                is_transparent: wanted.is_transparent,
                ranks: wanted.ranks,
            },
        };
        let take = |film| watch.time(Stage::Encode, || each(film));
        watch.wait(|| tracer.draw_bands(crop, work, take))
    }
}

impl TryFrom<Document> for Scene {
    type Error = Error;

    /// A scene, unless the document has errors; where it has not kept its tables, they are read
    /// again.
    fn try_from(document: Document) -> Result<Self, Error> {
        let name = document.name().to_owned();
        let timings = document.timings().clone();
        let (model, tables, warnings) = document.into_parts()?;
        // Validation has found nothing, so that neither of these fails.
        let refused = |error: &dyn fmt::Display| Error::scene(format!("{name}: {error}"), vec![]);
        let image = model.image.clone().unwrap_or_default();
        let (width, height) = image.sides();
        let samples = image.samples.map_or(Ok(Samples::ONE), Samples::new);
        let build = |camera| build::camera(camera).map_err(|error| refused(&error));
        let camera = model.camera.as_ref().map(build).transpose()?;
        let named = model
            .all_cameras()
            .filter_map(|(name, camera)| Some((name?, camera)));
        let named = named.map(|(name, camera)| Ok::<_, Error>((name.into(), build(camera)?)));
        let cameras: Vec<(Box<str>, _)> = named.collect::<Result<_, _>>()?;
        let first = || Some(cameras.first()?.1);
        let has_camera = camera.is_some();
        let camera = camera
            .or_else(first)
            .ok_or_else(|| refused(&"there is no camera"))?;
        let origins = Origins::new(&tables);
        let watch = timings.watch();
        let built = watch.time(Stage::Build, || build::world(model, tables));
        let (world, names) = built.map_err(|error| refused(&error))?;
        Ok(Self {
            camera,
            has_camera,
            cameras,
            world,
            origins,
            names,
            size: Size::new(width, height).map_err(|error| refused(&error))?,
            samples: samples.map_err(|error| refused(&error))?,
            warnings,
            timings,
        })
    }
}

/// What has to be known of pixels beside what their samples see.
#[derive(Clone, Copy, Debug, Default)]
struct Wanted {
    is_transparent: bool,
    centers: bool,
    ranks: bool,
}

/// How a scene is rendered, where that differs from what it says itself.
#[derive(Clone, Default)]
pub struct RenderOptions {
    size: Option<Size>,
    crop: Option<Crop>,
    samples: Option<Samples>,
    layers: Vec<Layer>,
    settings: Settings,
    quality: Option<u8>,
    metadata: bool,
    threads: Option<usize>,
    compression: Compression,
    palette: Palette,
    cancel: Cancel,
    progress: Option<OnProgress>,
    timings: Timings,
    isa: Isa,
}

impl RenderOptions {
    /// The size of the scene, on all cores.
    pub fn new() -> Self {
        Self::default()
    }

    /// How the file is encoded.
    fn encoding<'a>(&self, layout: &Layout, metadata: &'a [(String, String)]) -> Encoding<'a> {
        Encoding {
            compression: self.compression,
            quality: self.quality.unwrap_or(Encoding::default().quality),
            colors: layout.is_color,
            metadata,
        }
    }

    /// The files that [`Scene::save_with`] writes for a path: with layers in a format that holds one
    /// alone, `out.png` becomes `out.depth.png` and so on.
    ///
    /// # Errors
    ///
    /// An unknown ending.
    pub fn files(&self, path: &Path) -> Result<Vec<(PathBuf, Vec<Layer>)>, Error> {
        let format = ImageFormat::of_path(path)?;
        let holds_all = matches!(format, ImageFormat::Exr | ImageFormat::Npz);
        if holds_all || self.layers.is_empty() {
            return Ok(vec![(path.to_owned(), self.layers.clone())]);
        }
        let ending = path.extension().unwrap_or_default().to_string_lossy();
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

    /// What a JPEG file keeps, from 1 to 100; the default is 90.
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

    /// What matters most in a PNG file; other formats leave no choice.
    #[must_use]
    pub fn compression(mut self, compression: Compression) -> Self {
        self.compression = compression;
        self
    }

    /// Whether a PNG file is indexed; other formats never are.
    #[must_use]
    pub fn palette(mut self, palette: Palette) -> Self {
        self.palette = palette;
        self
    }

    /// What can cancel the work.
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

    /// What takes the times of the stages, such as [`Scene::timings`].
    #[must_use]
    pub fn timings(mut self, timings: Timings) -> Self {
        self.timings = timings;
        self
    }
}

impl fmt::Debug for RenderOptions {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("RenderOptions")
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

impl Image {
    /// Writes the picture to a file, whose ending tells the format: whole or not at all.
    ///
    /// # Errors
    ///
    /// An unknown ending, a size that the format does not have, and a file that cannot be
    /// written.
    pub fn save(&self, path: impl AsRef<Path>) -> Result<(), Error> {
        image_file::save(path.as_ref(), self.size(), &Cancel::new(), |sink| {
            sink(self.pixels())
        })
    }
}
