//! Where the branches meet: a scene file becomes a picture.

use std::{cell::LazyCell, fmt, io, path::Path, sync::Arc};

use crate::{
    accel::first_hits::Work,
    colors::{self, ColorTable},
    diagnostic::Diagnostic,
    error::Error,
    film::{Film, Image, Samples, Size},
    image_file::{self, Compression, Encoding, ImageFormat, Palette},
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
        let size = options.size.unwrap_or(self.size);
        let mut pixels = image_file::buffer(size)?;
        let watch = options.timings.watch();
        let table = self.color_table(&watch);
        self.draw(options, &watch, |film| {
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
    /// An unknown ending, a size that the format does not have, and a file that cannot be
    /// written.
    pub fn save(&self, path: impl AsRef<Path>) -> Result<(), Error> {
        self.save_with(path, &RenderOptions::new())
    }

    /// Draws the picture as `options` say and writes it to a file, as [`Scene::save`] does.
    ///
    /// # Errors
    ///
    /// Those of [`Scene::save`], and a cancelled picture.
    pub fn save_with(&self, path: impl AsRef<Path>, options: &RenderOptions) -> Result<(), Error> {
        let path = path.as_ref();
        let format = ImageFormat::of_path(path)?;
        let size = options.size.unwrap_or(self.size);
        format.check(size).map_err(|error| error.at(path))?;
        let watch = options.timings.watch();
        let mut target = watch.time(Stage::Write, || Target::create(path, &options.cancel))?;
        let written = self.encode(format, target.writer(), options);
        written.map_err(|error| error.at(path))?;
        watch.time(Stage::Write, || target.finish())
    }

    /// Draws the picture as `options` say and writes it to `writer`, such as standard output.
    ///
    /// # Errors
    ///
    /// A size that the format does not have, what the writer returns, and a cancelled picture.
    pub fn write_with(
        &self,
        writer: impl io::Write,
        format: ImageFormat,
        options: &RenderOptions,
    ) -> Result<(), Error> {
        format.check(options.size.unwrap_or(self.size))?;
        self.encode(format, writer, options)
    }

    fn encode(
        &self,
        format: ImageFormat,
        writer: impl io::Write,
        options: &RenderOptions,
    ) -> Result<(), Error> {
        let size = options.size.unwrap_or(self.size);
        let watch = options.timings.watch();
        let table = self.color_table(&watch);
        let palette = match options.palette {
            Palette::Auto if format == ImageFormat::Png => colors::Palette::of(&table),
            _ => None,
        };
        let encoding = Encoding {
            compression: options.compression,
            palette: palette.as_ref().map(|palette| &*palette.colors),
        };
        let mut bytes = Vec::new();
        let draw = |sink: image_file::Sink| {
            self.draw(options, &watch, |film| {
                bytes.clear();
                match &palette {
                    Some(palette) => film.append(&palette.places, &mut bytes),
                    None => film.append(&table, &mut bytes),
                }
                sink(&bytes)
            })
        };
        let writer = watch.writer(writer);
        watch.time(Stage::Encode, || {
            format.encode(writer, size, encoding, draw)
        })
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
        mut each: impl FnMut(Film) -> Result<(), Error>,
    ) -> Result<(), Error> {
        let size = options.size.unwrap_or(self.size);
        let tracer = RayTracer::with_size(&self.camera, &self.world, size).isa(options.isa);
        let work = Work {
            pool: &Pool::new(options.threads)?,
            cancel: &options.cancel,
            progress: options.progress.as_ref(),
            watch: &options.timings.shared_watch(Stage::Trace),
        };
        let take = |film| watch.time(Stage::Encode, || each(film));
        watch.wait(|| tracer.draw_bands(work, take))
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

/// How a scene is rendered, where that differs from what it says itself.
#[derive(Clone, Default)]
pub struct RenderOptions {
    size: Option<Size>,
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

    /// Another size than that of the scene.
    #[must_use]
    pub fn size(mut self, size: Size) -> Self {
        self.size = Some(size);
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
        let path = path.as_ref();
        let format = ImageFormat::of_path(path)?;
        format.check(self.size()).map_err(|error| error.at(path))?;
        let cancel = Cancel::new();
        let mut target = Target::create(path, &cancel)?;
        let written = format.encode(target.writer(), self.size(), Encoding::default(), |sink| {
            sink(self.pixels())
        });
        written.map_err(|error| error.at(path))?;
        target.finish()
    }
}
