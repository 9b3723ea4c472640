//! Drawing one file: a picture of a scene, a band of it, or a movie.

use std::{
    fs,
    io::{self, IsTerminal},
    iter,
    path::{Path, PathBuf},
    time::Instant,
};

use strahl::{
    Document, ImageFormat, RenderOptions, Scene, image_file::MovieFormat, parallel::Cancel,
};

use super::{
    Args, Drawing,
    draw::make_folder,
    format_of,
    movie::{self, Movie},
    pattern::Pattern,
};
use crate::cli::{Failure, STDOUT, depfile, paths, report, scene};

/// A scene to draw into one file.
struct Job<'a> {
    args: &'a Args,
    cancel: &'a Cancel,
    source: &'a Path,
    /// The source files of the scene.
    used: Vec<PathBuf>,
    scene: Scene,
    /// The file; `None` for standard output.
    output: Option<PathBuf>,
    report: Option<PathBuf>,
    options: RenderOptions,
}

pub(super) fn run(args: &Args, start: Instant, cancel: &Cancel) -> Result<(), Failure> {
    let source = args.paths.single().unwrap_or(Path::new("-"));
    let movie = movie::format(args);
    let output = output(args, source, movie)?;
    let drawing = match (movie, &output) {
        (Some(format), _) => Drawing::Movie(format),
        (None, Some(path)) if !is_device(path) => Drawing::Image(format_of(path)?),
        _ => args.image_format(),
    };
    check(args, drawing, output.as_deref())?;
    let report = report(args, source, output.as_deref())?;
    if args.depfile.is_some() && output.is_none() {
        let message = "--depfile needs a picture that is a file: name one with -o";
        return Err(Failure::usage(message));
    }
    let document = args.read(source, &args.config.configs(), args.threads())?;
    scene::report(&document, args.quiet)?;
    let used = sources(&document, source);
    if let Some(depfile) = &args.depfile {
        let written: Vec<_> = used.iter().chain(&output).cloned().collect();
        report::check(depfile, &written)?;
    }
    let scene = args.cameras.of(Scene::try_from(document)?)?;
    let options = args.options(cancel).threads(args.threads());
    let job = Job {
        args,
        cancel,
        source,
        used,
        options: options.timings(scene.timings().clone()),
        scene,
        output,
        report,
    };
    let pixels = match drawing {
        Drawing::Image(format) => job.draw_picture(format)?,
        Drawing::Movie(format) => job.draw_movie(format)?,
    };
    job.write_depfile()?;
    let rays = pixels * job.samples();
    let geometries = job.scene.world().geometries().len();
    args.print_timings(start, job.scene.timings(), rays, geometries);
    Ok(())
}

impl Job<'_> {
    /// Returns the number of samples per pixel.
    fn samples(&self) -> u64 {
        let samples = self.args.picture.samples(self.scene.samples());
        samples.count().into()
    }

    /// Draws the picture and its report, and returns the number of pixels.
    fn draw_picture(&self, format: ImageFormat) -> Result<u64, Failure> {
        let (args, scene) = (self.args, &self.scene);
        let options = self.options.clone().format(format);
        let files = match &self.output {
            Some(path) => check_pictures(path, &self.used, &options)?,
            None => Vec::new(),
        };
        let used = [&*self.used, &*files].concat();
        if let Some(report) = &self.report {
            report::check(report, &used)?;
        }
        let count = files.len().max(1) as u64;
        let parts = args.shard.map_or(1, |shard| shard.count());
        let pixels = args.picture.pixels(scene.size()) / u64::from(parts);
        // Several samples take longer than the single one of a report, roughly by the side of their
        // square.
        let weight = self.samples().isqrt();
        let traces = u64::from(self.report.is_some());
        let progress = args.progress(pixels * (count * weight + traces));
        let sink = progress.sink();
        let traced = options.clone().on_progress(progress.sink());
        let options = options.on_progress(move |pixels| sink(pixels * weight));
        self.make_folder()?;
        if let Some(why) = scene.unindexed(&options).filter(|_| !args.quiet) {
            scene::print_warning(&format!("the picture is not indexed: {why}"));
        }
        match (&self.output, args.shard) {
            (Some(path), Some(shard)) => {
                scene.save_band(path, shard, &options, !args.resume)?;
            }
            (Some(path), None) => scene.save_with(path, &options)?,
            (None, _) => scene
                .write_with(io::stdout().lock(), format, &options)
                .map_err(|error| error.of_file(STDOUT))?,
        }
        if let Some(path) = &self.report {
            let image = args.picture.image(scene.size(), args.cameras.one().name());
            report::write(path, scene, &image, &traced, self.cancel)?;
        }
        drop(progress);
        let size = args.picture.size(scene.size());
        // With `--shard`, a band was written instead.
        let is_written = |file: &&PathBuf| args.shard.is_none() && !is_device(file);
        for file in files.iter().filter(is_written) {
            scene::report_written(file, format_args!(" ({size})"), args.quiet);
        }
        Ok(pixels * count)
    }

    /// Writes the files that the picture depends on, if requested.
    fn write_depfile(&self) -> Result<(), Failure> {
        match (&self.args.depfile, &self.output) {
            (Some(depfile), Some(output)) => {
                let sources = self.used.iter().filter(|source| !paths::is_dash(source));
                let sources: Vec<_> = sources.cloned().collect();
                depfile::write(depfile, output, &sources, self.cancel)
            }
            _ => Ok(()),
        }
    }

    /// Draws the movie, and returns the number of pixels.
    fn draw_movie(&self, format: MovieFormat) -> Result<u64, Failure> {
        if let Some(path) = &self.output {
            check_sources(path, &self.used)?;
        }
        let movie = Movie::of(self.args, format, &self.scene);
        let movie = movie.map_err(|failure| movie::named(failure, self.source))?;
        let pixels = movie.pixels(self.args);
        let progress = self.args.progress(pixels);
        let options = self.options.clone().on_progress(progress.sink());
        self.make_folder()?;
        match &self.output {
            Some(path) => movie.save(path, &options, self.cancel)?,
            None => movie.write(io::stdout().lock(), &options)?,
        }
        drop(progress);
        if let Some(path) = &self.output {
            scene::report_written(path, format_args!(" ({})", movie.extent()), self.args.quiet);
        }
        Ok(pixels)
    }

    /// Creates the folder of a file that is named by a pattern.
    fn make_folder(&self) -> Result<(), Failure> {
        match self.output.as_deref().and_then(Path::parent) {
            Some(folder) if self.output != self.args.output => make_folder(folder),
            _ => Ok(()),
        }
    }
}

/// Returns the file to draw; rejects an impossible one before anything is read.
fn output(
    args: &Args,
    scene: &Path,
    movie: Option<MovieFormat>,
) -> Result<Option<PathBuf>, Failure> {
    let path = args.output.as_deref();
    if path.is_some_and(paths::is_dash) {
        let what = movie.map_or("picture", |_| "movie");
        if io::stdout().is_terminal() {
            let message = format!("a {what} is not written to a terminal; name a file with -o");
            return Err(Failure::usage(message));
        }
        if is_closed() {
            let message = format!("{STDOUT}: is closed, so the {what} would be lost");
            return Err(Failure::usage(message));
        }
        return Ok(None);
    }
    let ending = movie.map_or(ImageFormat::PNG.name(), MovieFormat::name);
    let path = file(path, scene, args.cameras.one().name(), ending)?;
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
fn check(args: &Args, drawing: Drawing, output: Option<&Path>) -> Result<(), Failure> {
    let (is_band, has_report) = (args.shard.is_some(), args.report.is_some());
    match drawing {
        Drawing::Movie(_) if is_band || has_report => {
            let option = if is_band { "--shard" } else { "--report" };
            Err(Failure::usage(format!(
                "{option} is for pictures or several movies, not for one movie"
            )))
        }
        Drawing::Movie(_) => args.picture.check_movie(),
        Drawing::Image(format) => {
            args.picture.check(format)?;
            if is_band && output.is_none_or(is_device) {
                let message = "a band is written next to its picture; name the picture with -o";
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
fn report(args: &Args, scene: &Path, output: Option<&Path>) -> Result<Option<PathBuf>, Failure> {
    let Some(path) = &args.report else {
        return Ok(None);
    };
    if paths::is_dash(path) && output.is_none() {
        let message = "picture and report cannot both go to standard output";
        return Err(Failure::usage(message));
    }
    file(Some(path), scene, args.cameras.one().name(), "").map(Some)
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
    let Ok(about) = fs::read_to_string("/proc/self/fdinfo/1") else {
        return false;
    };
    let flags = about.lines().find_map(|line| line.strip_prefix("flags:"));
    let flags = flags.and_then(|flags| u32::from_str_radix(flags.trim(), 8).ok());
    let is_for_both = flags.is_some_and(|flags| flags & 0b11 == 0b10);
    let place = fs::read_link("/proc/self/fd/1");
    is_for_both && place.is_ok_and(|place| place == Path::new("/dev/null"))
}
