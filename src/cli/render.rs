//! `strahl render`: a picture of a scene.

use std::{
    io::{self, IsTerminal},
    path::{Path, PathBuf},
    time::Instant,
};

use clap::ValueEnum;
use strahl::{Cancel, Crop, ImageFormat, Isa, Layer, RenderOptions, Samples, Scene, Size};

use super::{
    Failure, OutputFormat, STDOUT, interrupt,
    progress::{Progress, When},
    scene,
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
    /// The picture, whose ending tells its format; `-` is standard output. The default is the
    /// scene's name with .png, in the current folder
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// The format of a picture on standard output
    #[arg(long, value_name = "NAME", value_parser = image_format, default_value = "png")]
    image_format: ImageFormat,
    /// The size of the picture in pixels, instead of that of the scene
    #[arg(long, value_name = "WxH", value_parser = scene::size)]
    size: Option<Size>,
    /// A part of the picture: column and row of its top left pixel, width and height
    #[arg(long, value_name = "X,Y,W,H", value_parser = crop)]
    crop: Option<Crop>,
    /// How many rays go through each pixel: a square, 1, 4, 9, 16 and so on
    #[arg(long, value_name = "N", value_parser = samples)]
    samples: Option<Samples>,
    /// What to draw of each pixel: color, depth, z, position, normal, id, coverage. An .exr or .npz
    /// file holds all of them; with other formats out.png becomes out.depth.png and so on
    #[arg(long, value_name = "NAMES", value_delimiter = ',', value_parser = layer)]
    layers: Vec<Layer>,
    /// Write alpha, which is 0 where nothing was hit, instead of the background
    #[arg(long)]
    transparent: bool,
    /// The bits of each number: 8, 16, or 32 for floats, which hold linear light
    #[arg(long, value_name = "BITS", value_parser = bits)]
    bits: Option<u8>,
    /// The depths that become 0 and the largest integer where depths are written as integers
    #[arg(long, value_name = "NEAR,FAR", value_parser = depth_range, allow_hyphen_values = true)]
    depth_range: Option<(f64, f64)>,
    /// What a JPEG file keeps, from 1 to 100; the default is 90
    #[arg(long, value_name = "QUALITY", value_parser = clap::value_parser!(u8).range(1..=100))]
    quality: Option<u8>,
    /// Write version, scene hash and camera into the file
    #[arg(long)]
    metadata: bool,
    /// How many threads read and draw; the default is one for each core. The picture is the same
    #[arg(long, value_name = "N", value_parser = scene::threads())]
    threads: Option<u16>,
    /// What matters most: to be done soon (fast, the default) or the size of the file (small); for
    /// EXR also a method. The pixels are the same
    #[arg(long, value_name = "GOAL", value_enum)]
    compression: Option<Compression>,
    /// Whether a PNG file is indexed: never, or if background and geometries have at most 256
    /// colors
    #[arg(long, value_name = "WHEN", value_enum, default_value_t)]
    palette: Palette,
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

#[derive(Clone, Copy, ValueEnum)]
enum Compression {
    /// To be done soon
    Fast,
    /// A small file
    Small,
    /// None at all: TIFF and EXR
    None,
    /// Runs of equal bytes: EXR
    Rle,
    /// Deflate, row by row: EXR
    Zips,
    /// Deflate, 16 rows at once: EXR
    Zip,
}

impl From<Compression> for strahl::Compression {
    fn from(compression: Compression) -> Self {
        match compression {
            Compression::Fast => Self::Fast,
            Compression::Small => Self::Small,
            Compression::None => Self::None,
            Compression::Rle => Self::Rle,
            Compression::Zips => Self::Zips,
            Compression::Zip => Self::Zip,
        }
    }
}

#[derive(Clone, Copy, Default, PartialEq, Eq, ValueEnum)]
enum Palette {
    /// Pixels of red, green and blue, whatever the scene holds
    #[default]
    Never,
    /// If background and geometries have at most 256 colors
    Auto,
}

impl From<Palette> for strahl::Palette {
    fn from(palette: Palette) -> Self {
        match palette {
            Palette::Never => Self::Never,
            Palette::Auto => Self::Auto,
        }
    }
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

fn crop(text: &str) -> Result<Crop, String> {
    text.parse()
        .map_err(|error: strahl::SizeError| error.to_string())
}

fn layer(text: &str) -> Result<Layer, String> {
    text.parse()
        .map_err(|error: strahl::UnknownLayer| error.to_string())
}

fn bits(text: &str) -> Result<u8, String> {
    match text {
        "8" => Ok(8),
        "16" => Ok(16),
        "32" => Ok(32),
        _ => Err("expected 8, 16 or 32".to_owned()),
    }
}

fn depth_range(text: &str) -> Result<(f64, f64), String> {
    let numbers = text.split_once(',');
    let numbers = numbers.and_then(|(near, far)| Some((near.parse().ok()?, far.parse().ok()?)));
    match numbers {
        Some((near, far)) if near < far && f64::is_finite(far - near) => Ok((near, far)),
        _ => Err("expected two numbers, the smaller one first, such as 0.5,20".to_owned()),
    }
}

fn samples(text: &str) -> Result<Samples, String> {
    text.parse()
        .map_err(|error: strahl::SamplesError| error.to_string())
}

enum Output {
    Stdout,
    File(PathBuf),
}

pub(crate) fn run(args: Args, start: Instant) -> Result<(), Failure> {
    let cancel = Cancel::new();
    interrupt::exit_on_signal(cancel.clone());
    let output = output(&args)?;
    check_format(&args, &output)?;
    let threads = args.threads.unwrap_or(0).into();
    let document = args.scene.read(args.tables.options().threads(threads))?;
    scene::report(&document, args.quiet)?;
    let scene = Scene::try_from(document)?;

    let size = args.size.unwrap_or(scene.size());
    let pixels = args.crop.map_or(size, Crop::size).pixels();
    let samples = args.samples.unwrap_or(scene.samples());
    let when = if args.quiet {
        When::Never
    } else {
        args.progress
    };
    let progress = Progress::new(pixels, when);
    let mut options = RenderOptions::new()
        .size(size)
        .samples(samples)
        .layers(args.layers)
        .transparent(args.transparent)
        .metadata(args.metadata)
        .threads(threads)
        .isa(args.simd)
        .compression(args.compression.map_or_else(Default::default, Into::into))
        .palette(args.palette.into())
        .cancel(cancel)
        .on_progress(progress.sink())
        .timings(scene.timings().clone());
    if let Some(crop) = args.crop {
        options = options.crop(crop);
    }
    if let Some(bits) = args.bits {
        options = options.bits(bits);
    }
    if let Some((near, far)) = args.depth_range {
        options = options.depth_range(near, far);
    }
    if let Some(quality) = args.quality {
        options = options.quality(quality);
    }
    match output {
        Output::File(path) => scene.save_with(path, &options)?,
        Output::Stdout => scene
            .write_with(io::stdout().lock(), args.image_format, &options)
            .map_err(|error| error.of_file(STDOUT))?,
    }
    drop(progress);
    if let Some(format) = args.timings {
        let work = Work {
            start,
            rays: pixels * u64::from(samples.count()),
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
            name.push(".png");
            name.into()
        }
    };
    if path.is_dir() {
        let message = format!("{}: is a folder, not a file", path.display());
        return Err(Failure::Usage(message));
    }
    ImageFormat::of_path(&path)?;
    if is_same_file(&path, &args.scene.scene) {
        let message = format!("{}: the picture would overwrite its scene", path.display());
        return Err(Failure::Usage(message));
    }
    Ok(Output::File(path))
}

/// Refuses options that say nothing about a picture of the format.
fn check_format(args: &Args, output: &Output) -> Result<(), Failure> {
    let format = match output {
        Output::Stdout => args.image_format,
        Output::File(path) => ImageFormat::of_path(path)?,
    };
    let compresses = matches!(
        format,
        ImageFormat::Png | ImageFormat::Tiff | ImageFormat::Exr
    );
    let refused = [
        (
            args.compression.is_some() && !compresses,
            "--compression is for png, tiff and exr files",
        ),
        (
            args.palette == Palette::Auto && format != ImageFormat::Png,
            "--palette auto is for png files",
        ),
        (
            args.quality.is_some() && format != ImageFormat::Jpeg,
            "--quality is for jpg files",
        ),
    ];
    for (is_wrong, message) in refused {
        if is_wrong {
            let name = format.name();
            let message = format!("{message}, and this picture is to be a {name} file");
            return Err(Failure::Usage(message));
        }
    }
    Ok(())
}

/// Whether two paths lead to one file that exists.
pub(super) fn is_same_file(one: &Path, other: &Path) -> bool {
    match (one.canonicalize(), other.canonicalize()) {
        (Ok(one), Ok(other)) => one == other,
        _ => false,
    }
}
