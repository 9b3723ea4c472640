//! Movies: many frames of a scene in one file.

use std::{
    io::{self, IsTerminal},
    path::{Path, PathBuf},
    time::Instant,
};

use sha2::{Digest, Sha256};
use strahl::{
    Image, RenderOptions, Scene,
    image_file::{FrameSink, MovieFormat, Reel},
    parallel::{Cancel, Timings, in_order},
};

use super::{
    Args, Drawing,
    frames::Frames,
    one::{check_sources, file, sources},
};
use crate::cli::{
    Failure, STDOUT, paths,
    progress::{Progress, When},
    scene,
    timings::{self, Work},
};

/// How many frames are drawn or wait to be written, for each thread.
const AHEAD: usize = 2;

/// Whether a command is for a movie, and of which format.
pub(super) fn format(args: &Args) -> Option<MovieFormat> {
    match (&args.output, args.image_format()) {
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
    let source = single(args)?;
    let output = output(args, format, source)?;
    let configs = args.config.configs();
    let document = args.read(source, &configs, args.threads())?;
    scene::report(&document, args.quiet)?;
    if let Some(path) = &output {
        check_sources(path, &sources(&document, source))?;
    }
    let scene = args.cameras.of(Scene::try_from(document)?)?;
    let movie = Movie::of(args, format, &scene).map_err(|failure| named(failure, source))?;
    let timings = scene.timings().clone();
    let options = args
        .picture
        .options()
        .isa(args.simd)
        .cancel(cancel.clone())
        .timings(timings.clone());
    let pixels = movie.pixels(args);
    let when = if args.quiet {
        When::Never
    } else {
        args.progress
    };
    let progress = Progress::new(pixels, when);
    let options = options.on_progress(progress.sink());
    match &output {
        Some(path) => movie.save(path, &options, args.threads(), cancel)?,
        None => format
            .write(io::stdout().lock(), movie.reel, |sink| {
                movie.draw(&options, args.threads(), sink)
            })
            .map_err(|failure| named(failure, Path::new(STDOUT)))?,
    }
    drop(progress);
    if let Some(path) = &output {
        let Reel { size, frames, .. } = movie.reel;
        scene::tell_written(path, format_args!(" ({size}, {frames} frames)"), args.quiet);
    }
    report(args, &timings, start, (pixels, &scene));
    Ok(())
}

/// The frames of a scene that become one file.
pub(super) struct Movie<'s> {
    scene: &'s Scene,
    format: MovieFormat,
    numbers: Vec<u32>,
    reel: Reel,
}

impl<'s> Movie<'s> {
    /// That of a scene; what cannot be is refused before anything is drawn.
    pub(super) fn of(args: &Args, format: MovieFormat, scene: &'s Scene) -> Result<Self, Failure> {
        let Some(animation) = scene.animation() else {
            let message = "a movie needs a scene with an animation";
            return Err(Failure::Usage(message.to_owned()));
        };
        let numbers: Vec<u32> = match args.frames() {
            Some(Frames::Named(numbers)) => numbers.clone(),
            Some(Frames::All) | None => (0..animation.frames()).collect(),
        };
        if let Some(last) = numbers.iter().max()
            && *last >= animation.frames()
        {
            scene.frame(*last)?;
        }
        let reel = Reel {
            size: args.picture.size(scene.size()),
            fps: animation.fps(),
            frames: numbers.len() as u32,
        };
        Ok(Self {
            scene,
            format,
            numbers,
            reel,
        })
    }

    /// The number of pixels of all frames.
    pub(super) fn pixels(&self, args: &Args) -> u64 {
        args.picture.pixels(self.scene.size()) * self.numbers.len() as u64
    }

    /// A hash of all that the file depends on.
    pub(super) fn hash(&self, options: &RenderOptions) -> Result<String, Failure> {
        let mut sum = Sha256::new();
        sum.update(format!("{} {:?}", self.format.name(), self.reel.fps));
        for number in &self.numbers {
            let frame = self.scene.frame(*number)?;
            sum.update(frame.hash("frame.png", options)?);
        }
        let sum = sum.finalize();
        Ok(sum.iter().map(|byte| format!("{byte:02x}")).collect())
    }

    /// Writes the file.
    pub(super) fn save(
        &self,
        path: &Path,
        options: &RenderOptions,
        threads: usize,
        cancel: &Cancel,
    ) -> Result<(), Failure> {
        let draw = |sink: FrameSink| self.draw(options, threads, sink);
        let saved = self.format.save(path, self.reel, cancel, draw);
        saved.map_err(|failure| named(failure, path))
    }

    /// Draws the frames, each by one thread, and hands them over in their order.
    fn draw(
        &self,
        options: &RenderOptions,
        threads: usize,
        sink: FrameSink,
    ) -> Result<(), Failure> {
        let ahead = AHEAD * options.clone().threads(threads).thread_count();
        let options = options.clone().threads(1);
        let draw = |number: &u32| self.scene.frame(*number)?.render_with(&options);
        let take = |image: Result<Image, strahl::Error>| Ok(sink(&image?)?);
        in_order(&self.numbers, threads, ahead, draw, take)
    }
}

fn single(args: &Args) -> Result<&Path, Failure> {
    let other = [
        (args.shard.is_some(), "--shard"),
        (args.report.is_some(), "--report"),
    ];
    if let Some((_, option)) = other.iter().find(|(is_given, _)| *is_given) {
        let message = format!("{option} is for pictures or several movies, not for one movie");
        return Err(Failure::Usage(message));
    }
    args.picture.check_movie()?;
    Ok(args.paths.single().unwrap_or(Path::new("-")))
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

fn named(failure: Failure, path: &Path) -> Failure {
    match failure {
        Failure::Library(error) if error.path().is_none() => Failure::Library(error.of_file(path)),
        Failure::Usage(message) => Failure::Usage(format!("{}: {message}", path.display())),
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
