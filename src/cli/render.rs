//! `strahl render`: a picture of a scene.

use std::{
    fs,
    io::{self, IsTerminal},
    path::{Path, PathBuf},
    time::Instant,
};

use strahl::{Cancel, ImageFormat, Isa, Scene};

use super::{
    Failure, OutputFormat, STDOUT,
    cameras::{self, CamerasArgs},
    interrupt,
    picture::PictureArgs,
    progress::{Progress, When},
    report, scene,
    set::SetArgs,
    timings::{self, Work},
};

/// Draw a picture of a scene
#[derive(clap::Args)]
#[group(skip)]
pub(crate) struct Args {
    #[command(flatten)]
    scene: scene::SceneArgs,
    #[command(flatten)]
    tables: scene::TableArgs,
    #[command(flatten)]
    cameras: CamerasArgs,
    #[command(flatten)]
    set: SetArgs,
    /// The picture, whose ending tells its format; `-` is standard output. The default is the
    /// scene's name with .png, in the current folder
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// The format of a picture on standard output, or in a pipe or device without an ending
    #[arg(long, value_name = "NAME", value_parser = image_format, default_value = "png")]
    image_format: ImageFormat,
    #[command(flatten)]
    picture: PictureArgs,
    /// Write which geometry is seen where, by its id, to a JSON file; `-` is standard output. It
    /// traces once more. With --all-cameras `{camera}` in FILE stands for the name
    #[arg(long, value_name = "FILE")]
    report: Option<PathBuf>,
    /// How many threads read and draw; the default is one for each core. The picture is the same
    #[arg(long, value_name = "N", value_parser = scene::threads())]
    threads: Option<u16>,
    /// Show neither progress nor warnings
    #[arg(short, long)]
    quiet: bool,
    /// When to show a progress bar
    #[arg(long, value_name = "WHEN", value_enum, default_value_t)]
    progress: When,
    /// The instructions that draw: all give the same picture, and a test can say so
    #[arg(long, value_name = "NAME", hide = true, default_value_t)]
    simd: Isa,
    /// Show on standard error how long each stage took
    #[arg(
        long,
        value_name = "FORMAT",
        value_enum,
        num_args = 0..=1,
        require_equals = true,
        default_missing_value = "human"
    )]
    timings: Option<OutputFormat>,
}

fn image_format(name: &str) -> Result<ImageFormat, String> {
    ImageFormat::of_ending(name).ok_or_else(|| {
        let known: Vec<_> = ImageFormat::ALL
            .iter()
            .map(|format| format.name())
            .collect();
        format!("known are {}", known.join(", "))
    })
}

enum Output {
    Stdout,
    /// A file, or the pattern of the names of several.
    File(PathBuf),
}

impl Output {
    fn format(&self, args: &Args) -> Result<ImageFormat, Failure> {
        Ok(match self {
            Self::Stdout => args.image_format,
            Self::File(path) if is_device(path) => args.image_format,
            Self::File(path) => ImageFormat::of_path(path)?,
        })
    }

    /// Where the pictures of the cameras go; what cannot be is refused before anything is drawn.
    fn of_cameras(self, cameras: &[Option<String>], scene: &Path) -> Result<Vec<Self>, Failure> {
        let Self::File(pattern) = self else {
            return Ok(vec![self]);
        };
        let files = cameras.iter();
        let files = files.map(|camera| cameras::file_of(&pattern, camera.as_deref()));
        let files: Vec<_> = files.collect();
        cameras::check_files(&files)?;
        files.iter().try_for_each(|file| check_file(file, scene))?;
        Ok(files.into_iter().map(Self::File).collect())
    }
}

pub(crate) fn run(args: Args, start: Instant) -> Result<(), Failure> {
    let cancel = Cancel::new();
    interrupt::exit_on_signal(cancel.clone());
    let output = output(&args)?;
    args.picture.check(output.format(&args)?)?;
    check_report(&args, &output)?;
    let threads = args.threads.unwrap_or(0).into();
    let options = args.set.of(args.tables.options().threads(threads));
    let document = args.scene.read(options)?;
    scene::report(&document, args.quiet)?;
    let mut used: Vec<_> = document.table_paths().collect();
    used.push(args.scene.scene.clone());
    let sources = used.clone();
    let mut scene = Scene::try_from(document)?;
    let cameras = args.cameras.names(&scene)?;
    let outputs = output.of_cameras(&cameras, &args.scene.scene)?;

    let mut options = args
        .picture
        .options()
        .threads(threads)
        .isa(args.simd)
        .cancel(cancel.clone())
        .timings(scene.timings().clone());
    if let [Output::File(path)] = &*outputs
        && is_device(path)
    {
        options = options.format(args.image_format);
    }
    let mut files = 0;
    for output in &outputs {
        match output {
            Output::File(path) => {
                let pictures = options.files(path)?;
                for (picture, _) in &pictures {
                    check_sources(picture, &sources)?;
                }
                files += pictures.len() as u64;
                used.extend(pictures.into_iter().map(|(path, _)| path));
            }
            Output::Stdout => files += 1,
        }
    }
    let reports = args.report.iter().flat_map(|pattern| {
        let names = cameras.iter().map(Option::as_deref);
        names.map(|camera| cameras::file_of(pattern, camera))
    });
    let reports: Vec<_> = reports.collect();
    report::check(&reports, &used)?;
    let size = args.picture.pixels(scene.size());
    let pixels = size * files;
    let when = if args.quiet {
        When::Never
    } else {
        args.progress
    };
    let progress = Progress::new(pixels + size * reports.len() as u64, when);
    options = options.on_progress(progress.sink());
    let mut reports = reports.iter();
    for (camera, output) in cameras.iter().zip(outputs) {
        if let Some(name) = camera {
            scene = cameras::see_by(scene, name)?;
        }
        match output {
            Output::File(path) => scene.save_with(path, &options)?,
            Output::Stdout => scene
                .write_with(io::stdout().lock(), args.image_format, &options)
                .map_err(|error| error.of_file(STDOUT))?,
        }
        if let Some(path) = reports.next() {
            let image = args.picture.image(scene.size(), camera.as_deref());
            report::write(path, &scene, &image, &options, &cancel)?;
        }
    }
    drop(progress);
    if let Some(format) = args.timings {
        let work = Work {
            start,
            rays: pixels * u64::from(args.picture.samples(scene.samples()).count()),
            geometries: scene.world().geometries().len(),
            threads: options.thread_count(),
        };
        timings::print(format, scene.timings(), &work);
    }
    Ok(())
}

/// Where the picture goes; what cannot be is refused before anything is read.
fn output(args: &Args) -> Result<Output, Failure> {
    let path = match &args.output {
        Some(path) if path == Path::new("-") => {
            if io::stdout().is_terminal() {
                let message = "a picture is not written to a terminal; name a file with -o";
                return Err(Failure::Usage(message.to_owned()));
            }
            args.cameras.check(path)?;
            return Ok(Output::Stdout);
        }
        Some(path) => path.clone(),
        None if args.scene.is_stdin() => {
            let message = "a scene from standard input needs -o FILE";
            return Err(Failure::Usage(message.to_owned()));
        }
        None => {
            let Some(name) = args.scene.scene.file_stem() else {
                return Err(Failure::Usage(format!(
                    "{}: is a folder, not a file",
                    args.scene.scene.display()
                )));
            };
            let mut name = name.to_owned();
            name.push(args.cameras.default_ending());
            name.into()
        }
    };
    args.cameras.check(&path)?;
    check_file(&path, &args.scene.scene)?;
    Ok(Output::File(path))
}

/// Refuses a report that cannot be, before anything is read.
fn check_report(args: &Args, output: &Output) -> Result<(), Failure> {
    let Some(path) = &args.report else {
        return Ok(());
    };
    args.cameras.check(path)?;
    if report::is_stdout(path) && matches!(output, Output::Stdout) {
        let message = "picture and report cannot both go to standard output";
        return Err(Failure::Usage(message.to_owned()));
    }
    Ok(())
}

/// Refuses a file that cannot be a picture of the scene.
fn check_file(path: &Path, scene: &Path) -> Result<(), Failure> {
    if path.is_dir() {
        let message = format!("{}: is a folder, not a file", path.display());
        return Err(Failure::Usage(message));
    }
    if is_device(path) {
        return Ok(());
    }
    ImageFormat::of_path(path)?;
    check_sources(path, &[scene.to_owned()])
}

/// Refuses a picture in the place of a file that it is made of.
fn check_sources(path: &Path, sources: &[PathBuf]) -> Result<(), Failure> {
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

/// Whether two paths lead to one file that exists.
pub(super) fn is_same_file(one: &Path, other: &Path) -> bool {
    match (one.canonicalize(), other.canonicalize()) {
        (Ok(one), Ok(other)) => one == other,
        _ => false,
    }
}
