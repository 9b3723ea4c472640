//! The options of `strahl render`.

use std::{
    path::{Path, PathBuf},
    time::Instant,
};

use strahl::{
    Document, ImageFormat, ReadOptions, RenderOptions, Syntax,
    image_file::MovieFormat,
    jobs::{Configs, Shard},
    parallel::{Cancel, Timings},
    render::Isa,
};

use crate::cli::{
    additions::AdditionArgs,
    cameras::CamerasArgs,
    config::ConfigArgs,
    failure::Failure,
    fit::FitArgs,
    output::OutputFormat,
    paths::PathArgs,
    picture::PictureArgs,
    progress::{Progress, When},
    render::{
        frames::Frames,
        movie,
        output::{Drawing, drawing, drawings, is_folder},
        pattern::Pattern,
        sampling::SamplingArgs,
    },
    scene::{self, SceneArgs, StdinArgs, ThreadArgs},
    set::SetArgs,
    timings::{self, Work},
    words::one_of,
};

/// Two examples that cover what most people need.
const EXAMPLES: &str = "\
Examples:
  strahl render scene.ron -o picture.png --size 1920x1080 --samples 16
  strahl render scenes/ -o pictures/ --resume";

/// Render scenes to pictures
#[derive(clap::Args)]
#[group(skip)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Args {
    #[command(flatten)]
    pub(super) paths: PathArgs,
    #[command(flatten, next_help_heading = "Scene")]
    pub(super) cameras: CamerasArgs,
    /// Render one picture per row of a table, .csv or .jsonl; a column is a path, as for --set, or a
    /// name for a placeholder in FILE. A movie without such a placeholder has one frame per row
    #[arg(help_heading = "Scene", long, value_name = "TABLE")]
    pub(super) params: Option<PathBuf>,
    /// Render these frames of the scene's animation, such as 0-239 or 1-3,5,7-20:2, or `all`; default:
    /// all for a movie and for a FILE with {frame}, otherwise frame 0
    #[arg(help_heading = "Scene", long, value_name = "LIST")]
    pub(super) frames: Option<Frames>,
    /// Frame all rows of the table together, and color their values by one range: a `Fit` camera
    /// does not move from row to row
    #[arg(help_heading = "Scene", long, requires = "params")]
    pub(super) fit_all: bool,
    /// Frames per second of a movie with a frame per row of a table; default: 24
    #[arg(help_heading = "Scene", long, value_name = "N", value_parser = fps)]
    pub(super) fps: Option<f64>,
    /// The picture; the file extension selects the format, and `-` is standard output. Default: the
    /// scene's name with .png, in the current folder. For several pictures: a folder with `/` at
    /// its end, or a pattern with {scene}, {camera}, {frame:04}, {id} or a column of the table
    #[arg(help_heading = "Output", short, long, value_name = "FILE")]
    pub(super) output: Option<PathBuf>,
    /// Format of pictures on standard output, in a folder, or in a pipe or device without an
    /// extension
    #[arg(help_heading = "Output", long, value_name = "NAME", value_parser = one_of(drawings(), drawing), hide_possible_values = true, ignore_case = true)]
    pub(super) image_format: Option<Drawing>,
    /// Render only part I of N, from 0 to N-1: every Nth of several pictures, or a band of one, which
    /// `strahl merge` joins
    #[arg(help_heading = "Output", long, value_name = "I/N")]
    pub(super) shard: Option<Shard>,
    /// Keep pictures that were rendered from the same scene with the same options, and continue the
    /// samples of those by paths
    #[arg(help_heading = "Output", long)]
    pub(super) resume: bool,
    /// Write the ids and positions of visible geometries to a JSON file; `-` is standard output. For
    /// several pictures, write the result of each, unless FILE has placeholders
    #[arg(help_heading = "Output", long, value_name = "FILE")]
    pub(super) report: Option<PathBuf>,
    /// Write the files that the picture depends on to a file for make or ninja: the scene, its tables
    /// and its parts
    #[arg(help_heading = "Output", long, value_name = "FILE")]
    pub(super) depfile: Option<PathBuf>,
    #[command(flatten, next_help_heading = "Run")]
    pub(super) sampling: SamplingArgs,
    #[command(flatten)]
    pub(super) draw: DrawArgs,
}

/// The options of every picture: how its scene is read, and how it is drawn.
#[derive(clap::Args)]
#[group(skip)]
pub(crate) struct DrawArgs {
    /// Syntax of scenes with another extension; default for standard input: JSON if it begins with
    /// `{`, otherwise RON
    #[arg(help_heading = "Scene", long, value_name = "SYNTAX", value_parser = scene::syntaxes())]
    input_format: Option<Syntax>,
    #[command(flatten, next_help_heading = "Scene")]
    stdin: StdinArgs,
    #[command(flatten, next_help_heading = "Scene")]
    tables: scene::TableArgs,
    #[command(flatten, next_help_heading = "Scene")]
    pub(crate) config: ConfigArgs,
    #[command(flatten, next_help_heading = "Scene")]
    set: SetArgs,
    #[command(flatten, next_help_heading = "Scene")]
    additions: AdditionArgs,
    #[command(flatten, next_help_heading = "Scene")]
    fit: FitArgs,
    #[command(flatten)]
    pub(super) picture: PictureArgs,
    #[command(flatten, next_help_heading = "Run")]
    pub(super) threads: ThreadArgs,
    /// Do not print progress, warnings or the names of written files
    #[arg(help_heading = "Run", short, long)]
    pub(crate) quiet: bool,
    /// When to show a progress bar
    #[arg(
        help_heading = "Run",
        long,
        value_name = "WHEN",
        value_enum,
        default_value_t
    )]
    pub(super) progress: When,
    /// The instruction set for drawing: all give the same picture, as a test can verify
    #[arg(long, value_name = "NAME", hide = true, default_value_t)]
    simd: Isa,
    /// Print the time of each stage on standard error
    #[arg(
        help_heading = "Run",
        long,
        value_name = "FORMAT",
        value_enum,
        num_args = 0..=1,
        require_equals = true,
        default_missing_value = "human"
    )]
    pub(super) timings: Option<OutputFormat>,
}

impl DrawArgs {
    /// Reads and checks a scene. `with` completes the options for reading it.
    pub(crate) fn read(
        &self,
        scene: &Path,
        configs: &Configs,
        with: impl FnOnce(ReadOptions) -> ReadOptions,
    ) -> Result<Document, Failure> {
        let scene = SceneArgs {
            scene: scene.to_owned(),
            input_format: self.input_format,
            stdin: self.stdin.clone(),
        };
        let config = configs.of(scene.place())?;
        let options = self.tables.options(&config).threads(self.threads());
        let options = with(options.keep_text(false));
        let options = self.fit.of(self.additions.of(self.set.of(options)));
        let document = scene.read(options)?;
        self.additions.check(&scene.scene, &document)?;
        Ok(document)
    }

    /// Returns the number of threads, 0 for one per core.
    pub(super) fn threads(&self) -> usize {
        self.threads.count()
    }

    /// Returns the render options of a picture.
    pub(super) fn options(&self, cancel: &Cancel) -> RenderOptions {
        let options = self.picture.options().isa(self.simd);
        options.cancel(cancel.clone())
    }

    /// Creates a bar for `total` pixels, or steps of another kind.
    pub(super) fn progress(&self, total: u64) -> Progress {
        let when = match self.quiet {
            true => When::Never,
            false => self.progress,
        };
        Progress::new(total, when)
    }

    /// Prints the time of each stage, if requested.
    pub(super) fn print_timings(
        &self,
        start: Instant,
        timings: &Timings,
        rays: u64,
        geometries: usize,
    ) {
        if let Some(format) = self.timings {
            let work = Work {
                start,
                rays,
                geometries,
                threads: RenderOptions::new().threads(self.threads()).thread_count(),
            };
            timings::print(format, timings, &work);
        }
    }
}

impl Args {
    /// Reads and checks a scene with this many threads.
    pub(super) fn read(
        &self,
        scene: &Path,
        configs: &Configs,
        threads: usize,
    ) -> Result<Document, Failure> {
        // Faults of a row are shown at their place in the scene.
        let keep_text = self.params.is_some();
        self.draw.read(scene, configs, |options| {
            options.threads(threads).keep_text(keep_text)
        })
    }

    /// Returns the format of outputs without an extension.
    pub(super) fn image_format(&self) -> Drawing {
        self.image_format.unwrap_or_default()
    }

    /// Returns the format of movies, if each file is a movie.
    pub(super) fn movie(&self) -> Option<MovieFormat> {
        movie::format(self.output.as_deref(), self.image_format)
    }

    /// Rejects a format that contradicts the extension.
    pub(super) fn check_format(&self) -> Result<(), Failure> {
        let (Some(output), Some(format)) = (&self.output, self.image_format) else {
            return Ok(());
        };
        let movie = MovieFormat::of_path(output).map(Drawing::Movie);
        let ending = movie.or_else(|| ImageFormat::of_path(output).ok().map(Drawing::Image));
        match ending.filter(|ending| *ending != format && !is_folder(output)) {
            Some(ending) => Err(Failure::usage(format!(
                "{}: the extension selects {}, but --image-format {} differs; leave out one of them",
                output.display(),
                ending.name(),
                format.name()
            ))),
            None => Ok(()),
        }
    }

    /// Returns the frames to draw: those requested, or all if files are named by frame.
    pub(super) fn frames(&self) -> Option<&Frames> {
        let output = self.output.as_deref().and_then(Path::to_str);
        let pattern = output.and_then(|output| Pattern::parse(output).ok());
        let is_named = pattern.is_some_and(|pattern| pattern.has("frame"));
        let frames = self.frames.as_ref();
        frames.or_else(|| is_named.then_some(&Frames::All))
    }

    /// Returns true if there may be several files.
    pub(super) fn is_many(&self) -> bool {
        self.paths.single().is_none()
            || self.params.is_some()
            || self.fps.is_some()
            || (self.frames().is_some() && self.movie().is_none())
            || self.cameras.is_all()
            || (self.resume && self.shard.is_none())
            || self.output.as_ref().is_some_and(|path| is_folder(path))
    }
}

/// Returns a number of frames per second.
fn fps(text: &str) -> Result<f64, &'static str> {
    let fps = text.parse().ok();
    fps.filter(|fps: &f64| *fps > 0.0 && fps.is_finite())
        .ok_or("expected a finite number above 0, such as 12")
}
