//! One picture of one scene, or a band of it.

use std::{
    fs,
    io::{self, IsTerminal},
    path::{Path, PathBuf},
    time::Instant,
};

use strahl::{Document, RenderOptions, Scene, parallel::Cancel};

use super::{Args, draw::make_folder, format_of, is_same_file, pattern::Pattern};
use crate::cli::{
    Failure, STDOUT, paths,
    progress::{Progress, When},
    report, scene,
    timings::{self, Work},
};

/// Where a picture goes.
enum Output {
    Stdout,
    File(PathBuf),
}

pub(super) fn run(args: &Args, start: Instant, cancel: &Cancel) -> Result<(), Failure> {
    let source = args.paths.single().unwrap_or(Path::new("-"));
    let output = output(args, source)?;
    let format = match &output {
        Output::File(path) if !is_device(path) => format_of(path)?,
        _ => args.image_format().image()?,
    };
    args.picture.check(format)?;
    check_shard(args, &output)?;
    let report = report(args, source, &output)?;
    let configs = args.config.configs();
    let document = args.read(source, &configs, args.threads())?;
    scene::report(&document, args.quiet)?;
    let mut used = sources(&document, source);
    let scene = args.cameras.of(Scene::try_from(document)?)?;
    let options = args
        .picture
        .options()
        .threads(args.threads())
        .isa(args.simd)
        .cancel(cancel.clone())
        .timings(scene.timings().clone())
        .format(format);
    let files = match &output {
        Output::File(path) => check_pictures(path, &used, &options)?,
        Output::Stdout => Vec::new(),
    };
    let count = files.len().max(1) as u64;
    // What `--shard` writes is a band.
    let written = if args.shard.is_some() {
        Vec::new()
    } else {
        files.clone()
    };
    used.extend(files);
    report::check(report.as_slice(), &used)?;
    let pixels =
        args.picture.pixels(scene.size()) / u64::from(args.shard.map_or(1, |shard| shard.count()));
    let when = if args.quiet {
        When::Never
    } else {
        args.progress
    };
    // Several samples take longer than the one of a report, about as a side of their square does.
    let samples = args.picture.samples(scene.samples()).count();
    let weight = u64::from(samples.isqrt());
    let progress = Progress::new(
        pixels * (count * weight + u64::from(report.is_some())),
        when,
    );
    let sink = progress.sink();
    let traced = options.clone().on_progress(progress.sink());
    let options = options.on_progress(move |pixels| sink(pixels * weight));
    if let (Output::File(path), Some(pattern)) = (&output, &args.output)
        && path != pattern
        && let Some(folder) = path.parent()
    {
        // A pattern with places, whose folders are made.
        make_folder(folder)?;
    }
    if let Some(why) = scene.unindexed(&options).filter(|_| !args.quiet) {
        scene::print_warning(&format!("the picture is not indexed: {why}"));
    }
    match (&output, args.shard) {
        (Output::File(path), Some(shard)) => {
            scene.save_band(path, shard, &options, !args.resume)?;
        }
        (Output::File(path), None) => scene.save_with(path, &options)?,
        (Output::Stdout, _) => scene
            .write_with(io::stdout().lock(), format, &options)
            .map_err(|error| error.of_file(STDOUT))?,
    }
    if let Some(path) = &report {
        let image = args.picture.image(scene.size(), args.cameras.one().name());
        report::write(path, &scene, &image, &traced, cancel)?;
    }
    drop(progress);
    let size = args.picture.size(scene.size());
    for file in written.iter().filter(|file| !is_device(file)) {
        scene::tell_written(file, format_args!(" ({size})"), args.quiet);
    }
    if let Some(format) = args.timings {
        let work = Work {
            start,
            rays: pixels * count * u64::from(samples),
            geometries: scene.world().geometries().len(),
            threads: options.thread_count(),
        };
        timings::print(format, scene.timings(), &work);
    }
    Ok(())
}

/// Where the picture goes; what cannot be is refused before anything is read.
fn output(args: &Args, scene: &Path) -> Result<Output, Failure> {
    match &args.output {
        Some(path) if paths::is_stdin(path) => {
            if io::stdout().is_terminal() {
                let message = "a picture is not written to a terminal; name a file with -o";
                return Err(Failure::Usage(message.to_owned()));
            }
            if is_closed() {
                let message = format!("{STDOUT}: is closed, so that the picture would be lost");
                return Err(Failure::Usage(message));
            }
            Ok(Output::Stdout)
        }
        path => {
            let path = file(path.as_deref(), scene, args.cameras.one().name())?;
            check_file(&path, scene)?;
            Ok(Output::File(path))
        }
    }
}

/// The file of the picture of a scene, if the command names one or the scene does.
pub(crate) fn file(
    path: Option<&Path>,
    scene: &Path,
    camera: Option<&str>,
) -> Result<PathBuf, Failure> {
    let stem = scene
        .file_stem()
        .map(|stem| stem.to_string_lossy().into_owned());
    match path {
        Some(path) => filled(path, stem.as_deref(), camera),
        None if paths::is_stdin(scene) => {
            let message = "a scene from standard input needs -o FILE";
            Err(Failure::Usage(message.to_owned()))
        }
        None => {
            let mut name = scene.file_stem().unwrap_or_default().to_owned();
            name.push(".png");
            Ok(name.into())
        }
    }
}

/// A path with the names of scene and camera in their places.
fn filled(path: &Path, stem: Option<&str>, camera: Option<&str>) -> Result<PathBuf, Failure> {
    // A name that is not UTF-8 is as it is.
    let Some(text) = path.to_str().filter(|text| text.contains(['{', '}'])) else {
        return Ok(path.to_owned());
    };
    let pattern = Pattern::parse(text)?;
    let value = |place: &str| match place {
        "scene" => stem.map(str::to_owned),
        "camera" => camera.map(str::to_owned),
        _ => None,
    };
    if let Some(place) = pattern.places().find(|place| value(place).is_none()) {
        return Err(Failure::Usage(format!(
            "{text}: nothing here is called {{{place}}}; {{{{ is a brace"
        )));
    }
    Ok(pattern.fill(value).into())
}

/// Refuses a band that cannot be.
fn check_shard(args: &Args, output: &Output) -> Result<(), Failure> {
    let is_file = matches!(output, Output::File(path) if !is_device(path));
    if args.shard.is_some() && !is_file {
        let message = "a band of a picture is kept in a file beside it; name one with -o";
        return Err(Failure::Usage(message.to_owned()));
    }
    if args.shard.is_some() && args.report.is_some() {
        let message = "--report tells of a whole picture, and not with --shard of a band";
        return Err(Failure::Usage(message.to_owned()));
    }
    Ok(())
}

/// Where the report goes; what cannot be is refused before anything is read.
fn report(args: &Args, scene: &Path, output: &Output) -> Result<Option<PathBuf>, Failure> {
    let Some(path) = &args.report else {
        return Ok(None);
    };
    if report::is_stdout(path) && matches!(output, Output::Stdout) {
        let message = "picture and report cannot both go to standard output";
        return Err(Failure::Usage(message.to_owned()));
    }
    file(Some(path), scene, args.cameras.one().name()).map(Some)
}

/// The files that a scene is made of.
pub(crate) fn sources(document: &Document, scene: &Path) -> Vec<PathBuf> {
    document.table_paths().chain([scene.to_owned()]).collect()
}

/// The files of a picture, unless one of them is in the place of what it is made of.
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

/// Refuses a file that cannot be a picture of the scene.
pub(crate) fn check_file(path: &Path, scene: &Path) -> Result<(), Failure> {
    if path.is_dir() {
        let message = format!("{}: is a folder, not a file", path.display());
        return Err(Failure::Usage(message));
    }
    if is_device(path) {
        return Ok(());
    }
    format_of(path)?;
    check_sources(path, &[scene.to_owned()])
}

/// Refuses a picture in the place of a file that it is made of.
pub(crate) fn check_sources(path: &Path, sources: &[PathBuf]) -> Result<(), Failure> {
    let is_source = |source: &&PathBuf| is_same_file(path, source);
    sources.iter().find(is_source).map_or(Ok(()), |source| {
        let (path, source) = (path.display(), source.display());
        let message = format!("{path}: the picture would overwrite its scene, {source}");
        Err(Failure::Usage(message))
    })
}

/// Whether a path leads to a device or a pipe without an ending, such as /dev/null.
fn is_device(path: &Path) -> bool {
    let is_special = || fs::metadata(path).is_ok_and(|found| !found.is_file() && !found.is_dir());
    path.extension().is_none() && is_special()
}

/// Whether standard output was closed when the program began. Rust puts /dev/null in the place of
/// what is closed, and opens it for reading as well, unlike a shell that is told to.
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
