//! Drawing one file: a picture of a scene, a band of it, or a movie.

use std::{
    fs,
    io::{self, IsTerminal},
    iter,
    path::{Path, PathBuf},
    time::Instant,
};

use strahl::{
    Document, ImageFormat, RenderOptions, Scene,
    diagnostic::read_text,
    image_file::MovieFormat,
    jobs::Shard,
    parallel::{Cancel, Timings},
};

use super::{
    draw::make_folder,
    frames::Frames,
    movie::{self, Movie},
    pattern::Pattern,
};
use crate::cli::{
    depfile,
    failure::{Failure, STDOUT},
    paths,
    render::{
        args::{Args, DrawArgs},
        output::{Drawing, format_of},
        sampling::SamplingArgs,
    },
    report, scene,
};

/// A file to draw from one scene, as a command asks for it.
pub(crate) struct Order<'a> {
    pub(crate) draw: &'a DrawArgs,
    pub(crate) source: &'a Path,
    /// The file as it was named.
    pub(crate) output: Option<&'a Path>,
    pub(crate) image_format: Option<Drawing>,
    /// The name of the camera, if one is chosen.
    pub(crate) camera: Option<&'a str>,
    /// The frames of a movie, if not all.
    pub(crate) frames: Option<&'a Frames>,
    /// The band to draw, if not the whole picture.
    pub(crate) shard: Option<Shard>,
    pub(crate) resume: bool,
    pub(crate) sampling: SamplingArgs,
    pub(crate) report: Option<&'a Path>,
    /// The file for the names of those that the picture depends on.
    pub(crate) depfile: Option<&'a Path>,
}

/// An order that is possible as far as is known before the scene is read.
pub(crate) struct Plan<'a> {
    order: Order<'a>,
    drawing: Drawing,
    /// The file; `None` for standard output.
    output: Option<PathBuf>,
    report: Option<PathBuf>,
}

/// A file that was drawn.
pub(crate) struct Drawn {
    /// The written files: one for each layer, or none on standard output.
    pub(crate) files: Vec<PathBuf>,
    /// The size, and the number of frames of a movie.
    pub(crate) extent: String,
    timings: Timings,
    rays: u64,
    geometries: usize,
}

impl Drawn {
    /// Prints the time of each stage, if requested.
    pub(crate) fn print_timings(&self, args: &DrawArgs, start: Instant) {
        args.print_timings(start, &self.timings, self.rays, self.geometries);
    }
}

pub(super) fn run(args: &Args, start: Instant, cancel: &Cancel) -> Result<(), Failure> {
    let source = args.paths.single().unwrap_or(Path::new("-"));
    let plan = Plan::new(Order {
        draw: &args.draw,
        source,
        output: args.output.as_deref(),
        image_format: args.image_format,
        camera: args.cameras.one().name(),
        frames: args.frames(),
        shard: args.shard,
        resume: args.resume,
        sampling: args.sampling,
        report: args.report.as_deref(),
        depfile: args.depfile.as_deref(),
    })?;
    let document = args.read(source, &args.draw.config.configs(), args.draw.threads())?;
    scene::report(&document, args.draw.quiet)?;
    let drawn = plan.draw(document, |scene| args.cameras.of(scene), cancel)?;
    for file in &drawn.files {
        scene::report_written(file, format_args!(" ({})", drawn.extent), args.draw.quiet);
    }
    drawn.print_timings(&args.draw, start);
    Ok(())
}

impl<'a> Plan<'a> {
    /// Rejects what is impossible whatever the scene contains.
    pub(crate) fn new(order: Order<'a>) -> Result<Self, Failure> {
        let movie = movie::format(order.output, order.image_format);
        let output = output(&order, movie)?;
        let drawing = match (movie, &output) {
            (Some(format), _) => Drawing::Movie(format),
            (None, Some(path)) if !is_device(path) => Drawing::Image(format_of(path)?),
            _ => order.image_format.unwrap_or_default(),
        };
        check(&order, drawing, output.as_deref())?;
        let report = report(&order, output.as_deref())?;
        if order.depfile.is_some() && output.is_none() {
            let message = "--depfile needs a picture that is a file: name one with -o";
            return Err(Failure::usage(message));
        }
        Ok(Self {
            order,
            drawing,
            output,
            report,
        })
    }

    /// Returns true if the file is a movie.
    pub(crate) const fn is_movie(&self) -> bool {
        matches!(self.drawing, Drawing::Movie(_))
    }

    /// Draws the file. `view` selects the camera and the frame.
    pub(crate) fn draw(
        &self,
        document: Document,
        view: impl FnOnce(Scene) -> Result<Scene, Failure>,
        cancel: &Cancel,
    ) -> Result<Drawn, Failure> {
        let used = sources(&document, self.order.source);
        let scene = view(Scene::try_from(document)?)?;
        let args = self.order.draw;
        let options = args.options(cancel).threads(args.threads());
        let job = Job {
            plan: self,
            args,
            cancel,
            used,
            options: options.timings(scene.timings().clone()),
            scene,
        };
        match self.drawing {
            Drawing::Image(format) => job.draw_picture(format),
            Drawing::Movie(format) => job.draw_movie(format),
        }
    }
}

/// A scene to draw into one file.
struct Job<'a> {
    plan: &'a Plan<'a>,
    args: &'a DrawArgs,
    cancel: &'a Cancel,
    /// The source files of the scene.
    used: Vec<PathBuf>,
    scene: Scene,
    options: RenderOptions,
}

impl Job<'_> {
    /// Returns the number of samples per pixel.
    fn samples(&self) -> u64 {
        let samples = self.args.picture.samples(self.scene.samples());
        samples.count().into()
    }

    /// Draws the picture and its report.
    fn draw_picture(&self, format: ImageFormat) -> Result<Drawn, Failure> {
        let (args, scene) = (self.args, &self.scene);
        let Plan { order, output, .. } = self.plan;
        let options = self.options.clone().format(format);
        let mut files = match output {
            Some(path) => check_pictures(path, &self.used, &options)?,
            None => Vec::new(),
        };
        let used = [&*self.used, &*files].concat();
        if let Some(report) = &self.plan.report {
            report::check(report, &used)?;
        }
        let rule = self.rule(&files)?;
        let count = files.len().max(1) as u64;
        let parts = order.shard.map_or(1, |shard| shard.count());
        let pixels = args.picture.pixels(scene.size()) / u64::from(parts);
        // Several samples take longer than the single one of a report, roughly by the side of their
        // square.
        let weight = self.samples().isqrt();
        let traces = u64::from(self.plan.report.is_some());
        let progress = args.progress(pixels * (count * weight + traces));
        let sink = progress.sink();
        let traced = options.clone().on_progress(progress.sink());
        let options = options.on_progress(move |pixels| sink(pixels * weight));
        self.make_folder()?;
        if let Some(why) = scene.unindexed(&options).filter(|_| !args.quiet) {
            scene::print_warning(&format!("the picture is not indexed: {why}"));
        }
        let mut samples = scene.follows_paths().then(|| self.samples() as u32);
        match (output, order.shard) {
            (Some(path), Some(shard)) => {
                scene.save_band(path, shard, &options, !order.resume)?;
            }
            (path, _) => {
                let file = path.as_deref().filter(|path| !is_device(path));
                let quiet = (false, args.quiet);
                let sampled = order.sampling.sample(scene, file, options, quiet)?;
                match path {
                    Some(path) => scene.save_with(path, &sampled.options)?,
                    None => scene
                        .write_with(io::stdout().lock(), format, &sampled.options)
                        .map_err(|error| error.of_file(STDOUT))?,
                }
                sampled.finish();
                samples = sampled.samples.or(samples);
            }
        }
        let reported = self.plan.report.as_ref().map_or(Ok(()), |path| {
            let image = args.picture.image(scene.size(), order.camera);
            let image = image.by_paths(samples);
            report::write(path, scene, &image, &traced, self.cancel)
        });
        drop(progress);
        self.write_depfile(rule)?;
        reported?;
        // With `--shard`, a band was written instead.
        files.retain(|file| order.shard.is_none() && !is_device(file));
        let size = args.picture.size(scene.size());
        let extent = match samples.filter(|_| order.sampling.time_limit().is_some()) {
            Some(samples) => format!("{size}, {samples} samples per pixel"),
            None => size.to_string(),
        };
        Ok(self.drawn(files, extent, pixels * count))
    }

    /// Returns the rule that the written files depend on the sources, if requested. `files` are those of
    /// the whole picture or movie.
    fn rule(&self, files: &[PathBuf]) -> Result<Option<depfile::Rule>, Failure> {
        let Order { depfile, shard, .. } = self.plan.order;
        let Some(depfile) = depfile else {
            return Ok(None);
        };
        let written = files.iter().map(|file| match shard {
            Some(shard) => shard.file(file),
            None => file.clone(),
        });
        let written: Vec<_> = written.collect();
        report::check(depfile, &[&*self.used, files, &*written].concat())?;
        let sources = self.used.iter().filter(|source| !paths::is_dash(source));
        let sources: Vec<_> = sources.cloned().collect();
        depfile::Rule::new(&written, &sources).map(Some)
    }

    /// Writes the rule, if requested.
    fn write_depfile(&self, rule: Option<depfile::Rule>) -> Result<(), Failure> {
        match (self.plan.order.depfile, rule) {
            (Some(depfile), Some(rule)) => rule.write(depfile, self.cancel),
            _ => Ok(()),
        }
    }

    /// Draws the movie.
    fn draw_movie(&self, format: MovieFormat) -> Result<Drawn, Failure> {
        let Plan { order, output, .. } = self.plan;
        if let Some(path) = output {
            check_sources(path, &self.used)?;
        }
        let files: Vec<_> = output.iter().cloned().collect();
        let rule = self.rule(&files)?;
        let picture = &self.args.picture;
        let movie = Movie::of(order.frames, picture, format, &self.scene);
        let movie = movie.map_err(|failure| movie::named(failure, order.source))?;
        let pixels = movie.pixels(picture);
        let progress = self.args.progress(pixels);
        let options = self.options.clone().on_progress(progress.sink());
        self.make_folder()?;
        match output {
            Some(path) => movie.save(path, &options, self.cancel)?,
            None => movie.write(io::stdout().lock(), &options)?,
        }
        drop(progress);
        self.write_depfile(rule)?;
        Ok(self.drawn(files, movie.extent(), pixels))
    }

    fn drawn(&self, files: Vec<PathBuf>, extent: String, pixels: u64) -> Drawn {
        Drawn {
            files,
            extent,
            timings: self.scene.timings().clone(),
            rays: pixels * self.samples(),
            geometries: self.scene.world().ids(),
        }
    }

    /// Creates the folder of a file that is named by a pattern.
    fn make_folder(&self) -> Result<(), Failure> {
        let output = self.plan.output.as_deref();
        match output.and_then(Path::parent) {
            Some(folder) if output != self.plan.order.output => make_folder(folder),
            _ => Ok(()),
        }
    }
}

/// Returns the file to draw; rejects an impossible one before anything is read.
fn output(order: &Order, movie: Option<MovieFormat>) -> Result<Option<PathBuf>, Failure> {
    let (path, scene) = (order.output, order.source);
    if path.is_some_and(paths::is_dash) {
        check_stream(movie.map_or("picture", |_| "movie"))?;
        return Ok(None);
    }
    let ending = movie.map_or(ImageFormat::PNG.name(), MovieFormat::name);
    let path = file(path, scene, order.camera, ending)?;
    if movie.is_none() {
        check_file(&path, scene)?;
    }
    Ok(Some(path))
}

/// Returns the file of a scene: the one named by the command, otherwise one named after the scene.
pub(crate) fn file(
    path: Option<&Path>,
    scene: &Path,
    camera: Option<&str>,
    ending: &str,
) -> Result<PathBuf, Failure> {
    let stem = scene.file_stem().unwrap_or_default();
    match path {
        Some(path) => filled(path, &stem.to_string_lossy(), camera),
        None if paths::is_dash(scene) => {
            Err(Failure::usage("a scene from standard input needs -o FILE"))
        }
        None => {
            let mut name = stem.to_owned();
            name.push(".");
            name.push(ending);
            Ok(name.into())
        }
    }
}

/// Returns a path with the names of scene and camera in place of their placeholders.
fn filled(path: &Path, stem: &str, camera: Option<&str>) -> Result<PathBuf, Failure> {
    // A name that is not UTF-8 stays as it is.
    let Some(text) = path.to_str().filter(|text| text.contains(['{', '}'])) else {
        return Ok(path.to_owned());
    };
    let pattern = Pattern::parse(text)?;
    let value = |place: &str| match place {
        "scene" => Some(stem.to_owned()),
        "camera" => camera.map(str::to_owned),
        _ => None,
    };
    if let Some(place) = pattern.places().find(|place| value(place).is_none()) {
        return Err(Failure::usage(format!(
            "{text}: unknown placeholder {{{place}}}; {{{{ is a brace"
        )));
    }
    Ok(pattern.fill(value).into())
}

/// Rejects options that do not apply to such a file.
fn check(order: &Order, drawing: Drawing, output: Option<&Path>) -> Result<(), Failure> {
    let (is_band, has_report) = (order.shard.is_some(), order.report.is_some());
    match drawing {
        Drawing::Movie(_) if is_band || has_report => {
            let option = if is_band { "--shard" } else { "--report" };
            Err(Failure::usage(format!(
                "{option} is for pictures or several movies, not for one movie"
            )))
        }
        Drawing::Movie(_) => {
            order.sampling.check_movie()?;
            order.draw.picture.check_movie()
        }
        Drawing::Image(format) => {
            order.draw.picture.check(format)?;
            if is_band && output.is_none_or(is_device) {
                let message = "a band is written next to its picture; name the picture with -o";
                return Err(Failure::usage(message));
            }
            if let Some(option) = order.sampling.given().filter(|_| is_band) {
                let message = format!(
                    "{option} is for whole pictures: the bands of one picture have the same samples"
                );
                return Err(Failure::usage(message));
            }
            if is_band && has_report {
                let message = "--report needs a whole picture, so it cannot go with --shard";
                return Err(Failure::usage(message));
            }
            Ok(())
        }
    }
}

/// Returns the destination of the report; rejects an impossible one before anything is read.
fn report(order: &Order, output: Option<&Path>) -> Result<Option<PathBuf>, Failure> {
    let Some(path) = order.report else {
        return Ok(None);
    };
    if paths::is_dash(path) && output.is_none() {
        let message = "picture and report cannot both go to standard output";
        return Err(Failure::usage(message));
    }
    file(Some(path), order.source, order.camera, "").map(Some)
}

/// Returns the source files of a scene.
pub(crate) fn sources(document: &Document, scene: &Path) -> Vec<PathBuf> {
    let files = document.dependencies().into_iter();
    let files = files.map(|file| file.path.to_owned());
    iter::once(scene.to_owned()).chain(files).collect()
}

/// Returns the files of a picture, unless one of them would replace a source.
pub(crate) fn check_pictures(
    path: &Path,
    sources: &[PathBuf],
    options: &RenderOptions,
) -> Result<Vec<PathBuf>, Failure> {
    let files = options.files(path)?;
    let files: Vec<_> = files.into_iter().map(|(path, _)| path).collect();
    files
        .iter()
        .try_for_each(|file| check_sources(file, sources))?;
    Ok(files)
}

/// Rejects a standard output that no picture is written to.
pub(crate) fn check_stream(what: &str) -> Result<(), Failure> {
    if io::stdout().is_terminal() {
        let message = format!("a {what} is not written to a terminal; name a file with -o");
        return Err(Failure::usage(message));
    }
    if is_closed() {
        let message = format!("{STDOUT}: is closed, so the {what} would be lost");
        return Err(Failure::usage(message));
    }
    Ok(())
}

/// Rejects a file that cannot be a picture of the scene.
pub(crate) fn check_file(path: &Path, scene: &Path) -> Result<(), Failure> {
    if path.is_dir() {
        return Err(Failure::refused(path, "is a folder, not a file"));
    }
    if is_device(path) {
        return Ok(());
    }
    format_of(path)?;
    check_sources(path, &[scene.to_owned()])
}

/// Rejects a picture that would replace one of its sources.
pub(crate) fn check_sources(path: &Path, sources: &[PathBuf]) -> Result<(), Failure> {
    let is_source = |source: &&PathBuf| paths::is_same(path, source);
    sources.iter().find(is_source).map_or(Ok(()), |source| {
        let why = format!(
            "the picture would overwrite its scene, {}",
            source.display()
        );
        Err(Failure::refused(path, why))
    })
}

/// Returns true if a path without an extension leads to a device or a pipe, such as /dev/null.
fn is_device(path: &Path) -> bool {
    let is_special = || fs::metadata(path).is_ok_and(|found| !found.is_file() && !found.is_dir());
    path.extension().is_none() && is_special()
}

/// Returns true if standard output was closed when the program started. Rust replaces a closed one
/// with /dev/null and opens that for reading as well, unlike a shell that redirects to it.
fn is_closed() -> bool {
    let Ok(about) = read_text("/proc/self/fdinfo/1", 1 << 16) else {
        return false;
    };
    let flags = about.lines().find_map(|line| line.strip_prefix("flags:"));
    let flags = flags.and_then(|flags| u32::from_str_radix(flags.trim(), 8).ok());
    let is_for_both = flags.is_some_and(|flags| flags & 0b11 == 0b10);
    let place = fs::read_link("/proc/self/fd/1");
    is_for_both && place.is_ok_and(|place| place == Path::new("/dev/null"))
}
