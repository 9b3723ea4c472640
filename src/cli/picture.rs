//! Options for drawing and saving a picture.

use clap::builder::PossibleValue;
use strahl::{
    ImageFormat, RenderOptions, Size,
    film::{Crop, SampleCount},
    image_file::{Compression, Palette},
    render::Layer,
};

use super::{failure::Failure, report::ImageTerms, words::one_of};

/// The options for drawing and saving a picture.
#[derive(clap::Args)]
#[group(skip)]
#[command(next_help_heading = "Picture")]
pub(super) struct PictureArgs {
    /// Size of the picture in pixels, instead of the scene's
    #[arg(long, value_name = "WxH")]
    size: Option<Size>,
    /// Render a part of the picture: column and row of its top left pixel, width and height
    #[arg(long, value_name = "X,Y,W,H")]
    crop: Option<Crop>,
    /// Samples per pixel: a square number such as 1, 4, 9 or 16, or any number of paths
    #[arg(long, value_name = "N")]
    samples: Option<SampleCount>,
    #[arg(
        long,
        help = layers_help(),
        value_name = "NAMES",
        value_delimiter = ',',
        value_parser = one_of(Layer::ALL.iter().copied(), |layer| layer.name().into()),
        hide_possible_values = true
    )]
    layers: Vec<Layer>,
    /// Write alpha instead of the background; it is 0 without a hit
    #[arg(long)]
    transparent: bool,
    /// Bits per channel: 8, 16, or 32 for floats in linear light
    #[arg(long, value_name = "BITS", value_parser = bits)]
    bits: Option<u8>,
    /// Depths that map to 0 and to the largest integer, for integer formats
    #[arg(long, value_name = "NEAR,FAR", value_parser = depth_range, allow_hyphen_values = true)]
    depth_range: Option<(f64, f64)>,
    /// JPEG quality, 1 to 100; default: 90
    #[arg(long, value_name = "QUALITY", value_parser = clap::value_parser!(u8).range(1..=100))]
    quality: Option<u8>,
    /// Write the version, the scene hash and the camera into the file
    #[arg(long)]
    metadata: bool,
    /// Optimize for speed (fast, the default) or file size (small); EXR also takes a method. The
    /// pixels stay the same
    #[arg(long, value_name = "GOAL", value_parser = one_of(Compression::ALL.iter().copied(), compression))]
    compression: Option<Compression>,
    /// Write indexed PNG files: never, or if background and geometries have at most 256 colors
    #[arg(
        long,
        value_name = "WHEN",
        value_parser = one_of(Palette::ALL.iter().copied(), palette),
        default_value = Palette::default().name()
    )]
    palette: Palette,
}

impl PictureArgs {
    pub(super) fn options(&self) -> RenderOptions {
        let options = RenderOptions::new()
            .layers(self.layers.iter().copied())
            .transparent(self.transparent)
            .metadata(self.metadata)
            .palette(self.palette);
        let options = with(options, self.size, RenderOptions::size);
        let options = with(options, self.crop, RenderOptions::crop);
        let options = with(options, self.samples, RenderOptions::samples);
        let options = with(options, self.compression, RenderOptions::compression);
        let options = with(options, self.bits, RenderOptions::bits);
        let options = with(options, self.quality, RenderOptions::quality);
        with(options, self.depth_range, |options, (near, far)| {
            options.depth_range(near, far)
        })
    }

    /// Returns the number of pixels to draw for a scene with this size.
    pub(super) fn pixels(&self, size: Size) -> u64 {
        self.size(size).pixels()
    }

    /// Returns the description of the picture for a report, for a scene with this size.
    pub(super) fn image<'a>(&self, size: Size, camera: Option<&'a str>) -> ImageTerms<'a> {
        ImageTerms::new(self.whole(size), self.crop, camera)
    }

    /// Returns the size of the whole picture for a scene with this size.
    pub(super) fn whole(&self, size: Size) -> Size {
        self.size.unwrap_or(size)
    }

    /// Returns the size to draw for a scene with this size.
    pub(super) fn size(&self, size: Size) -> Size {
        self.crop.map_or(self.whole(size), Crop::size)
    }

    /// Returns the samples per pixel, for a scene with this number.
    pub(super) fn samples(&self, samples: SampleCount) -> SampleCount {
        self.samples.unwrap_or(samples)
    }

    /// Rejects options that do not apply to movies.
    pub(super) fn check_movie(&self) -> Result<(), Failure> {
        let refused = [
            (!self.layers.is_empty(), "--layers"),
            (self.transparent, "--transparent"),
            (self.bits.is_some(), "--bits"),
            (self.quality.is_some(), "--quality"),
            (self.metadata, "--metadata"),
            (self.compression.is_some(), "--compression"),
            (self.palette == Palette::Auto, "--palette auto"),
        ];
        match refused.iter().find(|(is_given, _)| *is_given) {
            Some((_, option)) => Err(Failure::usage(format!(
                "{option} is not for movies, whose pictures have 8 bits of red, green and blue"
            ))),
            None => Ok(()),
        }
    }

    /// Rejects options that do not apply to pictures of the format.
    pub(super) fn check(&self, format: ImageFormat) -> Result<(), Failure> {
        let refuse = |option: &str, what: &str| {
            let name = format.name();
            let message = format!("{option} is for {what}, but this picture is a {name} file");
            Err(Failure::usage(message))
        };
        let only = |option: &str, is_given: bool, has_it: fn(ImageFormat) -> bool| {
            if is_given && !has_it(format) {
                return refuse(option, &format!("{} files", ImageFormat::list(has_it)));
            }
            Ok(())
        };
        let is_indexed = self.palette == Palette::Auto;
        only("--compression", self.compression.is_some(), compresses)?;
        only("--palette auto", is_indexed, ImageFormat::has_palette)?;
        only(
            "--quality",
            self.quality.is_some(),
            ImageFormat::has_quality,
        )?;
        let has_depths = |layer: &Layer| matches!(layer, Layer::Depth | Layer::Z);
        if self.depth_range.is_some() && !self.layers.iter().any(has_depths) {
            return refuse("--depth-range", "the layers depth and z");
        }
        Ok(())
    }
}

/// Sets a value, if one was given.
fn with<T>(
    options: RenderOptions,
    value: Option<T>,
    set: impl FnOnce(RenderOptions, T) -> RenderOptions,
) -> RenderOptions {
    match value {
        Some(value) => set(options, value),
        None => options,
    }
}

/// Returns a compression with its description and, if only some of the compressing formats have it,
/// those.
fn compression(compression: Compression) -> PossibleValue {
    let has_it = |format: ImageFormat| format.compressions().contains(&compression);
    let formats = ImageFormat::list(has_it);
    let help = compression.description().to_owned();
    PossibleValue::new(compression.name()).help(if formats == ImageFormat::list(compresses) {
        help
    } else {
        format!("{help}: {}", formats)
    })
}

fn compresses(format: ImageFormat) -> bool {
    !format.compressions().is_empty()
}

fn palette(palette: Palette) -> PossibleValue {
    PossibleValue::new(palette.name()).help(palette.description())
}

fn layers_help() -> String {
    let names: Vec<_> = Layer::ALL.iter().map(|layer| layer.name()).collect();
    format!(
        "Layers to write: {}. One file holds all of them in the formats {}; with others out.png \
         becomes out.depth.png and so on",
        names.join(", "),
        ImageFormat::list(ImageFormat::has_layers)
    )
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
