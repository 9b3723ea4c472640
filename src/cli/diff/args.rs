//! The arguments of `strahl diff`.

use std::path::PathBuf;

use clap::ValueEnum;
use strahl::compare::PictureOptions;

use super::{super::scene::ThreadArgs, limits::Limits};

/// Compare two pictures, or the pictures of two folders
///
/// Pictures of folders are paired by name; a picture that is missing on either side is a failure.
/// By default, every difference is a failure, with exit status 1. With limits, only the limits
/// decide. Pictures of different sizes always fail.
#[derive(clap::Args)]
#[group(skip)]
pub(crate) struct Args {
    /// The golden picture: PNG, JPEG, BMP, TIFF, PPM, PFM, QOI, WebP, HDR, EXR, NPY or NPZ; or a
    /// folder of pictures
    pub(super) a: PathBuf,
    /// The new picture, in the same format or another; or a folder
    pub(super) b: PathBuf,
    /// Write a heat picture: the brighter, the more visible the difference. For folders, a folder
    /// with one heat picture per failure
    #[arg(short, long, value_name = "HEAT")]
    pub(super) output: Option<PathBuf>,
    /// Write an HTML page of the failures: golden, new and heat picture side by side
    #[arg(long, value_name = "FILE")]
    pub(super) html: Option<PathBuf>,
    /// Accept failures: copy new pictures over the golden ones. Golden pictures without a new one
    /// are kept
    #[arg(long)]
    pub(super) update: bool,
    #[command(flatten)]
    pub(super) limits: Limits,
    /// Maximum number of pixels that a file may declare; default: 268435456
    #[arg(long, value_name = "N")]
    pub(super) max_pixels: Option<u64>,
    #[command(flatten)]
    pub(super) threads: ThreadArgs,
    /// Output format
    #[arg(long, value_name = "FORMAT", default_value = "human")]
    pub(super) output_format: Format,
}

/// The output format of the result.
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(super) enum Format {
    /// Human-readable text
    Human,
    /// One JSON object
    Json,
    /// JUnit XML, with one test per picture
    Junit,
}

impl Args {
    pub(super) fn reading(&self) -> PictureOptions {
        let reading = PictureOptions::new();
        self.max_pixels
            .map_or(reading, |most| reading.max_pixels(most))
    }
}
