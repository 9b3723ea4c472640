//! Rendering of a scene to memory or to a file.

use std::{
    cell::LazyCell,
    collections::HashSet,
    io, iter,
    path::{Path, PathBuf},
    sync::Mutex,
};

use crate::{
    accel::raster::first_hits::Work,
    diagnostic::error::Error,
    film::{
        Centers, Film, Image, Wanted, colors::ColorTable, crop::Crop, resolve::Resolver,
        samples::Samples,
    },
    image_file::{
        self, Form, ImageFormat, Palette, cryptomatte,
        format::cannot_hold,
        output::Output,
        pixel::{Pixel, Sample},
        target::Target,
    },
    parallel::{
        Cancel, Pool,
        timings::{Stage, Watch},
    },
    pipeline::{Scene, options::RenderOptions},
    render::{
        hits::Rays,
        layers::{
            Layer,
            layout::{Layout, MATTE, Settings},
            rows::Painter,
        },
        ray_tracer::RayTracer,
    },
    scene::origin::Origin,
    tracer::camera::Camera,
};

impl Scene {
    /// Renders the picture on all cores.
    ///
    /// # Errors
    ///
    /// A picture that does not fit into memory.
    pub fn render(&self) -> Result<Image, Error> {
        self.render_with(&RenderOptions::new())
    }

    /// Renders the picture with `options`.
    ///
    /// # Errors
    ///
    /// A picture that does not fit into memory, and a cancelled render.
    pub fn render_with(&self, options: &RenderOptions) -> Result<Image, Error> {
        let size = self.crop(options)?.size();
        let mut pixels = image_file::buffer(size, 3)?;
        let watch = options.timings.watch();
        let table = self.color_table(&watch);
        let aovs = Aovs {
            wanted: Wanted::Bytes(self.world.tone(self.tone)),
            ..Aovs::default()
        };
        let camera = self.camera_of(options)?;
        let is_shaded = self.tracer(&camera, options)?.is_shaded(aovs.wanted);
        self.draw(options, &watch, aovs, |film| {
            if is_shaded {
                film.append_lit(&mut pixels);
            } else {
                film.append(&table, &mut pixels);
            }
            Ok(())
        })?;
        Ok(Image::new(size, pixels))
    }

    /// Renders the picture on all cores and writes it to a file, in the format of its extension.
    ///
    /// The file is written completely or not at all; an existing file survives a failure.
    ///
    /// # Errors
    ///
    /// An unknown file extension, a feature that the format does not support, and a file that
    /// cannot be written.
    pub fn save(&self, path: impl AsRef<Path>) -> Result<(), Error> {
        self.save_with(path, &RenderOptions::new())
    }

    /// Renders the picture with `options` and writes it to a file, as [`Scene::save`] does, or to
    /// one file per layer, see [`RenderOptions::files`].
    ///
    /// # Errors
    ///
    /// Those of [`Scene::save`], and a cancelled render.
    pub fn save_with(&self, path: impl AsRef<Path>, options: &RenderOptions) -> Result<(), Error> {
        let format = options.format_of(path.as_ref())?;
        let files = self.checked_files(path.as_ref(), options)?;
        let watch = options.timings.watch();
        for (path, layers) in &files {
            let mut target = watch.time(Stage::Write, || Target::create(path, &options.cancel))?;
            let written = self.encode(format, layers, target.output(), options);
            written.map_err(|error| error.at(path))?;
            watch.time(Stage::Write, || target.finish())?;
        }
        Ok(())
    }

    /// Checks that [`Scene::save_with`] can write a picture, as far as is known before it is rendered.
    ///
    /// # Errors
    ///
    /// Those of [`Scene::save_with`] about the scene, the options and the format.
    pub fn check_picture(
        &self,
        path: impl AsRef<Path>,
        options: &RenderOptions,
    ) -> Result<(), Error> {
        self.checked_files(path.as_ref(), options).map(|_| ())
    }

    /// Returns the files of a picture with their layers, after checking that they can be written.
    pub(super) fn checked_files(
        &self,
        path: &Path,
        options: &RenderOptions,
    ) -> Result<Vec<(PathBuf, Vec<Layer>)>, Error> {
        let format = options.format_of(path)?;
        let files = options.files(path)?;
        for (path, layers) in &files {
            let checked = self.check(format, layers, options);
            checked.map_err(|error| error.at(path))?;
        }
        let layers = files.iter().map(|(_, layers)| &**layers);
        let checked = self.check_effects(format, layers, options);
        checked.map_err(|error| error.at(path))?;
        Ok(files)
    }

    /// Renders the picture with `options` and writes it to `writer`, such as standard output.
    ///
    /// # Errors
    ///
    /// A feature that the format does not support, an error of the writer, and a cancelled render.
    pub fn write_with(
        &self,
        mut writer: impl io::Write,
        format: ImageFormat,
        options: &RenderOptions,
    ) -> Result<(), Error> {
        self.check(format, &options.layers, options)?;
        self.check_effects(format, iter::once(&*options.layers), options)?;
        self.encode(
            format,
            &options.layers,
            Output::Stream(&mut writer),
            options,
        )
    }

    /// Rejects a picture that cannot be rendered or that the format cannot hold.
    fn check(
        &self,
        format: ImageFormat,
        layers: &[Layer],
        options: &RenderOptions,
    ) -> Result<(), Error> {
        let size = self.crop(options)?.size();
        let layout = self.layout(format, layers, options.settings)?;
        if !format.holds(layout.pixel()) {
            return Err(cannot_hold(format, layout.pixel(), |other| {
                let layout = self.layout(other, layers, options.settings);
                layout.is_ok_and(|layout| other.holds(layout.pixel()))
            }));
        }
        let metadata = self.metadata(&layout, options, &[])?;
        format.check(Form {
            size,
            pixel: layout.pixel(),
            encoding: options.encoding(&layout, &metadata),
        })
    }

    pub(crate) fn layout(
        &self,
        format: ImageFormat,
        layers: &[Layer],
        settings: Settings,
    ) -> Result<Layout, Error> {
        let layers = if layers.is_empty() {
            &[Layer::Color]
        } else {
            layers
        };
        Layout::new(format, layers, settings, &self.world)
    }

    fn encode(
        &self,
        format: ImageFormat,
        layers: &[Layer],
        output: Output,
        options: &RenderOptions,
    ) -> Result<(), Error> {
        let watch = options.timings.watch();
        self.with_rows(format, layers, options, &watch, |form, draw| {
            let mut encode = |output: Output| format.encode(output, form, draw);
            watch.time(Stage::Encode, || match output {
                Output::Stream(stream) => encode(Output::Stream(&mut watch.writer(stream))),
                Output::File(file) => encode(Output::File(&mut watch.writer(file))),
            })
        })
    }

    /// Calls `write` with the form of a file's rows and a function that renders them.
    pub(super) fn with_rows(
        &self,
        format: ImageFormat,
        layers: &[Layer],
        options: &RenderOptions,
        watch: &Watch,
        write: impl FnOnce(Form, image_file::output::Draw) -> Result<(), Error>,
    ) -> Result<(), Error> {
        let crop = self.crop(options)?;
        let layout = self.layout(format, layers, options.settings)?;
        let table = self.color_table(watch);
        let is_plain = layout.is_color && layout.pixel() == Pixel::Rgb(Sample::U8);
        let palette = match options.palette {
            Palette::Auto if format.has_palette() => {
                self.palette(&layout, options, || &*table).ok()
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
        let metadata = self.metadata(&layout, options, &names)?;
        let camera = self.camera_of(options)?;
        let size = options.size.unwrap_or(self.size);
        let pixels = [&crop.columns(), &crop.rows()];
        let painter = Painter {
            world: &self.world,
            rays: layout
                .has_places()
                .then(|| Rays::new(&camera, size, Samples::ONE, pixels)),
            tone: self.world.tone(self.tone),
            background: (!options.settings.is_transparent).then(|| self.world.background()),
            layout: &layout,
            mattes: &mattes,
            isa: options.isa,
            known: Mutex::default(),
        };
        let aovs = Aovs {
            is_transparent: options.settings.is_transparent,
            centers: layout.centers(),
            ranks: layout.has_mattes(),
            wanted: match () {
                () if layout.has_parts() => Wanted::Parts,
                () if is_plain => Wanted::Bytes(self.world.tone(self.tone)),
                () if layout.is_color => Wanted::Light,
                () => Wanted::Hits,
            },
        };
        let is_shaded = self.tracer(&camera, options)?.is_shaded(aovs.wanted);
        let pool = Pool::new(options.threads);
        let mut bytes = Vec::new();
        let mut top = 0;
        let mut draw = |sink: image_file::output::Sink| {
            self.draw(options, watch, aovs, |film| {
                bytes.clear();
                let start = top;
                top += film.height();
                match &palette {
                    Some(palette) => film.append(&palette.places, &mut bytes),
                    None if is_plain && is_shaded => film.append_lit(&mut bytes),
                    None if is_plain => film.append(&table, &mut bytes),
                    None => {
                        let rows = painter.rows(&film, start, &pool);
                        return rows.iter().try_for_each(|row| sink(row));
                    }
                }
                sink(&bytes)
            })
        };
        let encoding = options.encoding(&layout, &metadata);
        let size = crop.size();
        write(
            Form {
                size,
                pixel,
                encoding,
            },
            &mut draw,
        )
    }

    /// Returns a unique name for each geometry of the world: its name, else its position in the
    /// scene, after the names of its groups; in a part, those of the part and of the geometry in it,
    /// such as `tree/trunk`. If an earlier geometry has that name, the id is appended.
    fn names(&self) -> Vec<String> {
        let mut known = HashSet::new();
        let name_of = |groups: Vec<&str>, name: Option<&str>, origin: Origin| {
            let own = match (name, origin.row, origin.instance) {
                (None, ..) => origin.to_string(),
                (Some(name), Some(row), _) => format!("{name} row {row}"),
                (Some(name), _, Some(instance)) => format!("{name} instance {instance}"),
                (Some(name), None, None) => name.to_owned(),
            };
            groups
                .iter()
                .rfold(own, |name, group| format!("{group}/{name}"))
        };
        let name = |index| {
            let mut whole = name_of(self.groups(index), self.name(index), self.origin(index));
            for place in self.places_in_parts(index) {
                whole.push('/');
                whole.push_str(&name_of(place.groups, place.name, place.origin));
            }
            whole
        };
        let unique = |index| {
            let mut name = name(index);
            while !known.insert(name.clone()) {
                name = format!("{name} id {index}");
            }
            name
        };
        (0..self.world.ids()).map(unique).collect()
    }

    /// Returns the metadata of a file.
    fn metadata(
        &self,
        layout: &Layout,
        options: &RenderOptions,
        names: &[String],
    ) -> Result<Vec<(String, String)>, Error> {
        let mut metadata = Vec::new();
        if layout.has_mattes() {
            let names = names.iter().map(String::as_str);
            metadata.extend(cryptomatte::metadata(MATTE, names));
        }
        if options.metadata {
            metadata.extend(self.about(options)?);
        }
        Ok(metadata)
    }

    /// Returns the number of pixels to render.
    pub fn pixels(&self, options: &RenderOptions) -> u64 {
        let size = options.size.unwrap_or(self.size);
        options.crop.map_or(size, Crop::size).pixels()
    }

    /// Returns the part of the picture to render.
    pub(super) fn crop(&self, options: &RenderOptions) -> Result<Crop, Error> {
        let size = options.size.unwrap_or(self.size);
        let crop = options.crop.unwrap_or(Crop::whole(size));
        match crop.check(size) {
            Ok(()) => Ok(crop),
            Err(error) => Err(Error::refused(error.to_string())),
        }
    }

    /// Returns the color of each geometry, computed on first use: while the first band is rendered.
    fn color_table<'a>(
        &'a self,
        watch: &'a Watch,
    ) -> LazyCell<ColorTable<3>, impl FnOnce() -> ColorTable<3> + use<'a>> {
        let table = || {
            let whole = || ColorTable::rgb8(&self.world);
            let kept = self.kept.as_deref();
            let still = kept.and_then(|kept| kept.colors.get(((), ()), None, || Some(whole())));
            match kept.zip(still) {
                Some((kept, still)) => still.renewed(&self.world, kept.moved()),
                None => whole(),
            }
        };
        LazyCell::new(move || watch.time(Stage::Build, table))
    }

    /// Returns the camera of the picture.
    pub(super) fn camera_of(&self, options: &RenderOptions) -> Result<Camera, Error> {
        self.camera_for(options.size.unwrap_or(self.size))
    }

    /// Returns the renderer of the picture.
    pub(super) fn tracer<'a>(
        &'a self,
        camera: &'a Camera,
        options: &'a RenderOptions,
    ) -> Result<RayTracer<'a>, Error> {
        let size = options.size.unwrap_or(self.size);
        let follows_paths = self.world.paths().is_some();
        let grid = match options.samples.filter(|_| !follows_paths) {
            Some(count) => count
                .grid()
                .map_err(|error| Error::refused(error.to_string()))?,
            None => self.samples,
        };
        let hash = match &options.sums {
            Some(_) => self.hash_of_sums(options)?,
            None => String::new(),
        };
        let tracer = RayTracer::with_size(camera, &self.world, size)
            .samples(grid)
            .paths(options.samples.filter(|_| follows_paths))
            .known(options.sums.as_deref().filter(|sums| sums.hash() == hash))
            .tone(self.tone)
            .outlines(self.outlines)
            .isa(options.isa);
        Ok(tracer)
    }

    /// Passes on the picture in bands from the top; with several threads, each while the next one
    /// is rendered.
    pub(super) fn draw(
        &self,
        options: &RenderOptions,
        watch: &Watch,
        aovs: Aovs,
        mut each: impl FnMut(Film) -> Result<(), Error>,
    ) -> Result<(), Error> {
        let crop = self.crop(options)?;
        let camera = self.camera_of(options)?;
        let tracer = self.tracer(&camera, options)?;
        let take = |film| watch.time(Stage::Encode, || each(film));
        self.with_work(options, aovs, |work| {
            watch.wait(|| tracer.draw_bands(crop, work, take))
        })
    }

    /// Calls a function with the resources of a picture.
    pub(super) fn with_work<T>(
        &self,
        options: &RenderOptions,
        aovs: Aovs,
        draw: impl FnOnce(Work) -> T,
    ) -> T {
        draw(Work {
            pool: &Pool::new(options.threads),
            cancel: &options.cancel,
            progress: options.progress.as_ref(),
            watch: &options.timings.shared_watch(Stage::Trace),
            kept: self.kept.as_deref(),
            resolver: Resolver {
                world: &self.world,
                is_transparent: aovs.is_transparent,
                ranks: aovs.ranks,
            },
            centers: aovs.centers,
            wanted: aovs.wanted,
        })
    }
}

/// The outputs of each pixel beside the geometries that its samples see.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Aovs {
    pub(super) is_transparent: bool,
    pub(super) centers: Centers,
    pub(super) ranks: bool,
    pub(super) wanted: Wanted,
}

impl Image {
    /// Writes the picture to a file in the format of its extension, completely or not at all.
    ///
    /// # Errors
    ///
    /// An unknown file extension, a size that the format does not support, and a file that cannot
    /// be written.
    pub fn save(&self, path: impl AsRef<Path>) -> Result<(), Error> {
        image_file::save(path.as_ref(), self.size(), &Cancel::new(), |sink| {
            sink(self.pixels())
        })
    }

    /// Writes the picture as a file of a format.
    ///
    /// # Errors
    ///
    /// A size or 8-bit RGB that the format does not support, and a writer that fails.
    pub fn write(&self, mut writer: impl io::Write, format: ImageFormat) -> Result<(), Error> {
        let form = Form::new(self.size(), Pixel::Rgb(Sample::U8));
        format.encode(Output::Stream(&mut writer), form, &mut |sink| {
            sink(self.pixels())
        })
    }
}
