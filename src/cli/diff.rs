//! `strahl diff`: are two pictures the same, and where not.

use std::{
    fmt::Write as _,
    path::{Path, PathBuf},
};

use serde::Serialize;
use strahl::{Cancel, CompareOptions, Comparison, ImageFormat, Picture, PictureOptions, Stamp};

use super::{Failure, OutputFormat, interrupt, render::is_same_file, scene};

/// Tell whether two pictures are the same, and where not
///
/// Without a limit, every difference is a failure: exit status 1. With limits, only what they say
/// is. Pictures of different sizes always fail.
#[derive(clap::Args)]
#[group(skip)]
pub(crate) struct Args {
    /// A picture: PNG, JPEG, BMP, TIFF, PPM, PFM, QOI, WebP, HDR or EXR
    a: PathBuf,
    /// Another one, in the same format or not
    b: PathBuf,
    /// Write a picture of where they differ: the brighter, the more visible the difference
    #[arg(short, long, value_name = "HEAT")]
    output: Option<PathBuf>,
    #[command(flatten)]
    limits: Limits,
    /// Refuse a picture whose file declares more pixels, before it is read; default: 268435456
    #[arg(long, value_name = "N")]
    max_pixels: Option<u64>,
    /// How many threads compare; the default is one for each core. The numbers are the same
    #[arg(long, value_name = "N", value_parser = scene::threads())]
    threads: Option<u16>,
    /// How to print it
    #[arg(long, value_name = "FORMAT", default_value = "human")]
    output_format: OutputFormat,
}

/// How much pictures may differ.
#[derive(clap::Args)]
#[group(skip)]
struct Limits {
    /// Allow so many pixels to differ
    #[arg(long, value_name = "N")]
    max_different: Option<u64>,
    /// Allow each channel to differ by so much, in steps of 8 bits: 255 is black against white
    #[arg(long, value_name = "STEPS", value_parser = at_least_0)]
    max_delta: Option<f64>,
    /// Demand a peak signal-to-noise ratio of so many decibels
    #[arg(long, value_name = "DB", value_parser = at_least_0)]
    min_psnr: Option<f64>,
    /// Demand a mean structural similarity, from 0 to 1
    #[arg(long, value_name = "SSIM", value_parser = part_of_1)]
    min_ssim: Option<f64>,
    /// Allow a mean FLIP error, from 0 to 1
    #[arg(long, value_name = "FLIP", value_parser = part_of_1)]
    max_flip: Option<f64>,
}

fn at_least_0(text: &str) -> Result<f64, String> {
    let number = text.parse().ok();
    let number = number.filter(|number: &f64| number.is_finite() && *number >= 0.0);
    number.ok_or_else(|| "expected a number of 0 or more".to_owned())
}

fn part_of_1(text: &str) -> Result<f64, String> {
    let number = text.parse().ok();
    let number = number.filter(|number| (0.0..=1.0).contains(number));
    number.ok_or_else(|| "expected a number from 0 to 1".to_owned())
}

impl Limits {
    /// Each limit that was given: its name, and whether the pictures keep to it.
    fn check(&self, found: &Comparison) -> Vec<(&'static str, bool)> {
        let most = |name, most: Option<f64>, found: f64| most.map(|most| (name, found <= most));
        let least = |name, least: Option<f64>, found| least.map(|least| (name, least <= found));
        let different = self.max_different;
        let limits = [
            different.map(|most| ("max_different", found.different <= most)),
            most("max_delta", self.max_delta, found.max_delta),
            least("min_psnr", self.min_psnr, found.psnr),
            least("min_ssim", self.min_ssim, found.ssim),
            most("max_flip", self.max_flip, found.flip),
        ];
        limits.into_iter().flatten().collect()
    }

    /// The names of those that the pictures do not keep to; without any limit that is `equal`.
    fn broken(&self, found: &Comparison) -> Vec<&'static str> {
        let mut checked = self.check(found);
        if checked.is_empty() {
            checked.push(("equal", found.is_equal()));
        }
        let broken = checked.into_iter().filter(|(_, kept)| !kept);
        broken.map(|(name, _)| name).collect()
    }
}

pub(crate) fn run(args: Args) -> Result<(), Failure> {
    let cancel = Cancel::new();
    interrupt::exit_on_signal(cancel.clone());
    let mut options = CompareOptions::new()
        .threads(args.threads.unwrap_or(0).into())
        .cancel(cancel);
    if let Some(heat) = &args.output {
        check_output(heat, &args)?;
        options = options.heat(heat);
    }
    let reading = PictureOptions::new();
    let reading = args
        .max_pixels
        .map_or(reading, |most| reading.max_pixels(most));
    let read = |path| Picture::read_with(path, &reading);
    let (a, b) = (read(&args.a)?, read(&args.b)?);
    let found = a.compare(&b, &options)?;
    let report = Report {
        format: 1,
        a: Side::new(&args.a, &a),
        b: Side::new(&args.b, &b),
        failed: match &found {
            Some(found) => args.limits.broken(found),
            None => vec!["size"],
        },
        found: found.as_ref().map(Found::new),
    };
    let printed = super::print(&match args.output_format {
        OutputFormat::Human => report.to_text(),
        OutputFormat::Json => super::json(Stamp::Diff, &report)?,
    });
    match printed {
        // Who has seen enough of the report may still want to know how it ended.
        Ok(()) | Err(Failure::Closed) if !report.failed.is_empty() => Err(Failure::Different),
        printed => printed,
    }
}

/// Refuses a heat picture that cannot be, before anything is read.
fn check_output(heat: &Path, args: &Args) -> Result<(), Failure> {
    if heat.is_dir() {
        let message = format!("{}: is a folder, not a file", heat.display());
        return Err(Failure::Usage(message));
    }
    ImageFormat::of_path(heat)?;
    if [&args.a, &args.b]
        .iter()
        .any(|side| is_same_file(heat, side))
    {
        let message = format!(
            "{}: the heat picture would overwrite a picture that it is made of",
            heat.display()
        );
        return Err(Failure::Usage(message));
    }
    Ok(())
}

#[derive(Serialize)]
struct Report {
    format: u32,
    a: Side,
    b: Side,
    /// The limits that were not kept, or `equal` or `size`.
    failed: Vec<&'static str>,
    /// What there is to say of pictures of one size.
    found: Option<Found>,
}

#[derive(Serialize)]
struct Side {
    file: String,
    width: u32,
    height: u32,
}

impl Side {
    fn new(path: &Path, picture: &Picture) -> Self {
        Self {
            file: path.to_string_lossy().into_owned(),
            width: picture.size().width(),
            height: picture.size().height(),
        }
    }
}

/// Numbers that are not finite become null.
#[derive(Serialize)]
struct Found {
    equal: bool,
    values: &'static str,
    pixels: u64,
    different: u64,
    not_finite: u64,
    first: Option<[u32; 2]>,
    bounds: Option<[u32; 4]>,
    max_delta: f64,
    mean_delta: f64,
    psnr: f64,
    ssim: f64,
    flip: f64,
}

impl Found {
    fn new(found: &Comparison) -> Self {
        Self {
            equal: found.is_equal(),
            values: if found.is_linear { "linear" } else { "display" },
            pixels: found.size.pixels(),
            different: found.different,
            not_finite: found.not_finite,
            first: found.first,
            bounds: found.bounds,
            max_delta: found.max_delta,
            mean_delta: found.mean_delta,
            psnr: found.psnr,
            ssim: found.ssim,
            flip: found.flip,
        }
    }

    fn write(&self, text: &mut String) {
        let percent = self.different as f64 / self.pixels as f64 * 100.0;
        let share = if self.different > 0 && percent < 0.01 {
            "less than 0.01 %".to_owned()
        } else {
            format!("{percent:.2} %")
        };
        let mut line = |name: &str, value: String| {
            let _ = writeln!(text, "{name:<11} {value}");
        };
        line("values", format!("{}, 0 to 255", self.values));
        line(
            "different",
            format!("{} of {} pixels, {share}", self.different, self.pixels),
        );
        if self.not_finite > 0 {
            line("not finite", format!("{} of these", self.not_finite));
        }
        if let Some([column, row]) = self.first {
            line(
                "first",
                format!("{column},{row} (column and row from the top left)"),
            );
        }
        if let Some([x, y, width, height]) = self.bounds {
            line(
                "within",
                format!("{x},{y},{width},{height} (X,Y,W,H from the top left)"),
            );
        }
        line("largest", amount(self.max_delta));
        line("mean", amount(self.mean_delta));
        line("PSNR", format!("{} dB", amount(self.psnr)));
        line("SSIM", amount(self.ssim));
        line("FLIP", amount(self.flip));
    }
}

/// A number for people.
fn amount(number: f64) -> String {
    if number == f64::INFINITY {
        "infinite".to_owned()
    } else if number == f64::NEG_INFINITY {
        "-infinite".to_owned()
    } else {
        number.to_string()
    }
}

impl Report {
    fn to_text(&self) -> String {
        let mut text = String::new();
        let [a, b] = [&self.a, &self.b].map(|side| format!("{}x{}", side.width, side.height));
        let Some(found) = &self.found else {
            return format!(
                "size        {a} and {b}\n\nthe sizes differ, so nothing else is compared\n"
            );
        };
        let _ = writeln!(text, "size        {a}");
        found.write(&mut text);
        let verdict = match (found.equal, &*self.failed) {
            (true, _) => "equal".to_owned(),
            (false, []) => "different, within the limits".to_owned(),
            (false, ["equal"]) => "different".to_owned(),
            (false, failed) => {
                let names = failed
                    .iter()
                    .map(|name| format!("--{}", name.replace('_', "-")));
                let names: Vec<_> = names.collect();
                format!("different, beyond {}", names.join(", "))
            }
        };
        let _ = writeln!(text, "\n{verdict}");
        text
    }
}
