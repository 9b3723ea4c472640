//! Image files and movies: the formats, and the options that some of them have.

mod bmp;
pub(crate) mod cryptomatte;
mod deflate;
mod exr;
pub(crate) mod format;
mod hdr;
mod jpeg;
pub(crate) mod movie;
mod npy;
mod npz;
pub(crate) mod output;
pub(crate) mod part;
mod pfm;
pub(crate) mod pixel;
mod png;
mod ppm;
mod qoi;
mod runs;
pub(crate) mod target;
#[cfg(test)]
mod tests;
mod tiff;
mod webp;
mod whole;

use std::{io::Write, path::Path};

pub use movie::{FrameSink, MovieFormat, Reel};
pub use target::write_file;

use crate::{
    diagnostic::{
        error::{Error, ErrorKind},
        named::named,
    },
    film::size::Size,
    image_file::{
        output::Output,
        pixel::{Pixel, Sample},
        target::Target,
    },
    parallel::Cancel,
};

/// A format of image files: one of [`ImageFormat::ALL`].
#[derive(Clone, Copy)]
pub struct ImageFormat(&'static Format);

impl ImageFormat {
    /// Every format.
    pub const ALL: &'static [Self] = &[
        Self::PNG,
        Self::JPEG,
        Self::BMP,
        Self::TIFF,
        Self::PPM,
        Self::PFM,
        Self::QOI,
        Self::WEBP,
        Self::HDR,
        Self::EXR,
        Self::NPY,
        Self::NPZ,
    ];
}

/// What there is to know of a format. Its file states it, and nothing else does.
struct Format {
    /// The endings of files, the usual one first, which is the name too.
    endings: &'static [&'static str],
    /// What its files are made for.
    content: Content,
    /// Whether a file can have such pixels.
    holds: fn(Pixel) -> bool,
    /// The limit that a picture goes beyond.
    exceeded: fn(Size, Pixel) -> Option<String>,
    /// How its pixels may be compressed, where there is a choice.
    compressions: &'static [Compression],
    /// Whether floats may be below zero.
    has_signs: bool,
    /// Whether something may be lost, and how much.
    has_quality: bool,
    /// Whether there is a place for metadata.
    has_metadata: bool,
    /// What reads it, unless that is code of this crate.
    decoder: Option<image::ImageFormat>,
    /// Writes a file that [`ImageFormat::check`] does not refuse.
    encode: fn(Output, Form, Draw) -> Result<(), Error>,
}

/// What the files of a format are made for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Content {
    /// One layer, in integers.
    Integers,
    /// One layer: colors in integers, all else in floats.
    Either,
    /// One layer, in floats.
    Floats,
    /// One layer, as exact as it is.
    Array,
    /// All layers, each as exact as it is.
    Arrays,
    /// All layers, under the names that the field knows.
    Channels,
}

named! {
    /// How the pixels of a file are compressed, where its format leaves a choice. They are the same
    /// afterwards.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
    #[non_exhaustive]
    pub enum Compression {
        /// To be done soon.
        #[default]
        Fast = "fast",
        /// To be small, whatever time that takes.
        Small = "small",
        /// Not at all.
        None = "none",
        /// Runs of equal bytes.
        Rle = "rle",
        /// Deflate, row by row.
        Zips = "zips",
        /// Deflate, 16 rows at once, as [`Compression::Fast`] is too.
        Zip = "zip",
    }
}

impl Compression {
    /// What it is, in a few words.
    pub const fn description(self) -> &'static str {
        match self {
            Self::Fast => "Speed",
            Self::Small => "A small file",
            Self::None => "None at all",
            Self::Rle => "Runs of equal bytes",
            Self::Zips => "Deflate, row by row",
            Self::Zip => "Deflate, 16 rows at once",
        }
    }
}

named! {
    /// Whether a file is indexed: one byte a pixel or less, and the colors in a palette.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
    #[non_exhaustive]
    pub enum Palette {
        /// Never: each file has pixels of red, green and blue, whatever the scene holds.
        #[default]
        Never = "never",
        /// If the background and the geometries, seen or not, have at most 256 colors as bytes. The
        /// palette holds each once: the background first, then the geometries in the order of the
        /// file.
        Auto = "auto",
    }
}

impl Palette {
    /// What it is, in a few words.
    pub const fn description(self) -> &'static str {
        match self {
            Self::Never => "Pixels of red, green and blue, whatever the scene holds",
            Self::Auto => "If background and geometries have at most 256 colors",
        }
    }
}

/// How a file is encoded, where its format leaves a choice.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Encoding<'a> {
    /// How the pixels are compressed.
    pub(crate) compression: Compression,
    /// What a JPEG file keeps, from 1 to 100.
    pub(crate) quality: u8,
    /// Whether the numbers are colors, so that their space is stated where the format knows how;
    /// depths and normals are not.
    pub(crate) colors: bool,
    /// Names and texts to be kept in the file. In EXR they are attributes.
    pub(crate) metadata: &'a [(String, String)],
}

impl Default for Encoding<'_> {
    fn default() -> Self {
        Self {
            compression: Compression::default(),
            // Where flat colors stay clean and files are still small.
            quality: 90,
            colors: true,
            metadata: &[],
        }
    }
}

impl Encoding<'_> {
    /// The metadata as lines, for formats that do not know names of texts.
    fn lines(&self) -> impl Iterator<Item = String> {
        let lines = self.metadata.iter();
        lines.map(|(name, text)| {
            let line = format!("{name}: {text}");
            line.replace(char::is_control, " ")
        })
    }
}

/// What the rows of a file are.
#[derive(Clone, Copy)]
pub(crate) struct Form<'a> {
    pub(crate) size: Size,
    pub(crate) pixel: Pixel<'a>,
    pub(crate) encoding: Encoding<'a>,
}

impl<'a> Form<'a> {
    /// Rows without choices.
    pub(crate) fn new(size: Size, pixel: Pixel<'a>) -> Self {
        Self {
            size,
            pixel,
            encoding: Encoding::default(),
        }
    }
}

/// Takes a picture in whole rows of bytes.
pub(crate) type Sink<'a> = &'a mut dyn FnMut(&[u8]) -> Result<(), Error>;

/// Hands a picture to what it is given, in whole rows from the top, the numbers in the byte order of
/// this machine.
pub(crate) type Draw<'a> = &'a mut dyn FnMut(Sink) -> Result<(), Error>;

/// Writes a picture of bytes of red, green and blue to a file, whose ending tells the format: whole
/// or not at all.
pub(crate) fn save(
    path: &Path,
    size: Size,
    cancel: &Cancel,
    mut draw: impl FnMut(Sink) -> Result<(), Error>,
) -> Result<(), Error> {
    let format = ImageFormat::of_path(path)?;
    let form = Form::new(size, Pixel::Rgb(Sample::U8));
    let checked = format.check(form);
    checked.map_err(|error| error.at(path))?;
    let mut target = Target::create(path, cancel)?;
    let written = format.encode(target.output(), form, &mut draw);
    written.map_err(|error| error.at(path))?;
    target.finish()
}

/// Writes a PNG file.
pub(crate) fn to_png(
    mut writer: impl Write,
    size: Size,
    pixel: Pixel,
    mut draw: impl FnMut(Sink) -> Result<(), Error>,
) -> Result<(), Error> {
    let output = Output::Stream(&mut writer);
    ImageFormat::PNG.encode(output, Form::new(size, pixel), &mut draw)
}

/// An empty buffer for all pixels of a picture, of so many bytes each.
pub(crate) fn buffer(size: Size, pixel: usize) -> Result<Vec<u8>, Error> {
    let mut pixels = Vec::new();
    let bytes = size.pixels().saturating_mul(pixel as u64);
    let bytes = usize::try_from(bytes).unwrap_or(usize::MAX);
    pixels.try_reserve_exact(bytes).map_err(|error| {
        let message = format!("a picture of {size} does not fit into memory");
        Error::new(ErrorKind::Unavailable, message).caused_by(error)
    })?;
    Ok(pixels)
}
