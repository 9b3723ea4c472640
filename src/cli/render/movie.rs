//! Many frames of a scene in one file.

use std::{
    io::{self, IsTerminal},
    path::{Path, PathBuf},
    time::Instant,
};

use strahl::{
    Cancel, FrameSink, Image, MovieFormat, RenderOptions, Scene, Size, Timings, in_order,
};

use super::{
    Args, Drawing,
    one::{check_sources, file, sources},
};
use crate::cli::{
    Failure, STDOUT, paths,
    progress::{Progress, When},
    scene::{self, SceneArgs},
    timings::{self, Work},
};

/// How many frames are drawn or wait to be written, for each thread.
const AHEAD: usize = 2;

/// Whether a command is for a movie, and of which format.
pub(super) fn format(args: &Args) -> Option<MovieFormat> {
    match (&args.output, args.image_format) {
        (Some(path), _) if MovieFormat::of_path(path).is_some() => MovieFormat::of_path(path),
        (_, Drawing::Movie(format)) => Some(format),
        _ => None,
    }
}

pub(super) fn run(
    args: &Args,
    format: MovieFormat,
    start: Instant,
    cancel: &Cancel,
) -> Result<(), Failure> {
    let source = SceneArgs {
        scene: single(args)?.to_owned(),
        input_format: args.input_format,
    };
    let output = output(args, format, &source.scene)?;
    let options = args.set.of(args.tables.options().threads(args.threads()));
    let document = source.read(options)?;
    scene::report(&document, args.quiet)?;
    if let Some(path) = &output {
        check_sources(path, &sources(&document, &source.scene))?;
    }
    let scene = args.cameras.of(Scene::try_from(document)?)?;
    let Some(animation) = scene.animation() else {
        let message = "a movie needs a scene with an animation";
        return Err(Failure::Usage(format!(
            "{}: {message}",
            source.scene.display()
        )));
    };
    let all = || (0..animation.frames()).collect();
    let numbers: Vec<u32> = args
        .frames
        .as_ref()
        .map_or_else(all, |frames| frames.0.clone());
    // What cannot be is refused before anything is drawn.
    numbers
        .iter()
        .max()
        .map_or(Ok(()), |last| scene.frame(*last).map(drop))?;
    let timings = scene.timings().clone();
    let options = args
        .picture
        .options()
        .isa(args.simd)
        .cancel(cancel.clone())
        .timings(timings.clone())
        .threads(1);
    let pixels = args.picture.pixels(scene.size()) * numbers.len() as u64;
    let when = if args.quiet {
        When::Never
    } else {
        args.progress
    };
    let progress = Progress::new(pixels, when);
    let reel = strahl::Reel {
        size: size(args, &scene),
        fps: animation.fps(),
        frames: numbers.len() as u32,
    };
    let options = options.on_progress(progress.sink());
    let draw = |sink: FrameSink| draw(args, &scene, &numbers, &options, sink);
    match &output {
        Some(path) => format
            .save(path, reel, cancel, draw)
            .map_err(|failure| named(failure, path))?,
        None => format
            .write(io::stdout().lock(), reel, draw)
            .map_err(|failure| named(failure, Path::new(STDOUT)))?,
    }
    drop(progress);
    report(args, &timings, start, (pixels, &scene));
    Ok(())
}

/// Draws the frames, each by one thread, and hands them over in their order.
fn draw(
    args: &Args,
    scene: &Scene,
    numbers: &[u32],
    options: &RenderOptions,
    sink: FrameSink,
) -> Result<(), Failure> {
    let threads = RenderOptions::new().threads(args.threads()).thread_count();
    let draw = |number: &u32| scene.frame(*number)?.render_with(options);
    let take = |image: Result<Image, strahl::Error>| Ok(sink(&image?)?);
    in_order(numbers, args.threads(), AHEAD * threads, draw, take)
}

fn single(args: &Args) -> Result<&Path, Failure> {
    let other = [
        (args.params.is_some(), "--params"),
        (args.shard.is_some(), "--shard"),
        (args.resume, "--resume"),
        (args.report.is_some(), "--report"),
        (args.cameras.is_all(), "--all-cameras"),
    ];
    if let Some((_, option)) = other.iter().find(|(is_given, _)| *is_given) {
        let message = format!("{option} is for files of one picture, and a movie is one file");
        return Err(Failure::Usage(message));
    }
    args.picture.check_movie()?;
    args.paths.single().ok_or_else(|| {
        let message = "a movie is made of one scene, and several were named";
        Failure::Usage(message.to_owned())
    })
}

fn output(args: &Args, format: MovieFormat, scene: &Path) -> Result<Option<PathBuf>, Failure> {
    match args.output.as_deref() {
        Some(path) if paths::is_stdin(path) => {
            if io::stdout().is_terminal() {
                let message = "a movie is not written to a terminal; name a file with -o";
                return Err(Failure::Usage(message.to_owned()));
            }
            Ok(None)
        }
        Some(path) => file(Some(path), scene, args.cameras.one().name()).map(Some),
        None => {
            let picture = file(None, scene, None)?;
            Ok(Some(picture.with_extension(format.name())))
        }
    }
}

/// The size of each picture.
fn size(args: &Args, scene: &Scene) -> Size {
    args.picture.size(scene.size())
}

fn named(failure: Failure, path: &Path) -> Failure {
    match failure {
        Failure::Library(error) if error.path().is_none() => Failure::Library(error.of_file(path)),
        failure => failure,
    }
}

fn report(args: &Args, timings: &Timings, start: Instant, (pixels, scene): (u64, &Scene)) {
    if let Some(format) = args.timings {
        let samples = args.picture.samples(scene.samples()).count();
        let work = Work {
            start,
            rays: pixels * u64::from(samples),
            geometries: scene.world().geometries().len(),
            threads: RenderOptions::new().threads(args.threads()).thread_count(),
        };
        timings::print(format, timings, &work);
    }
}
