//! Image and movie formats and their options.

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
pub use target::{replace_file, write_file};

use crate::{
    diagnostic::{
        error::{Error, ErrorKind},
        named::named,
    },
    film::size::Size,
    image_file::{
        output::{Draw, Output, Sink},
        pixel::{Pixel, Sample},
        target::Target,
    },
    parallel::Cancel,
};

/// An image file format: one of [`ImageFormat::ALL`].
#[derive(Clone, Copy)]
pub struct ImageFormat(&'static Format);

impl ImageFormat {
    /// All formats.
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

/// The description of a format, stated in the file of the format and nowhere else.
struct Format {
    /// The file extensions. The first is the usual one and also the name.
    endings: &'static [&'static str],
    /// The content that the format is made for.
    content: Content,
    /// Returns true if the format supports the pixel type.
    holds: fn(Pixel) -> bool,
    /// Returns the limit that a picture exceeds, if any.
    exceeded: fn(Size, Pixel) -> Option<String>,
    /// The supported compressions; empty if there is no choice.
    compressions: &'static [Compression],
    /// True if floats may be negative.
    has_signs: bool,
    /// True if the format is lossy, with an adjustable quality.
    has_quality: bool,
    /// True if a file can hold metadata.
    has_metadata: bool,
    /// The decoder in the `image` crate; `None` if files are not read by it.
    decoder: Option<image::ImageFormat>,
    /// Writes a file that [`ImageFormat::check`] accepts.
    encode: fn(Output, Form, Draw) -> Result<(), Error>,
}

/// The content that a format is made for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Content {
    /// One layer, as integers.
    Integers,
    /// One layer: colors as integers, everything else as floats.
    Either,
    /// One layer, as floats.
    Floats,
    /// One layer, at its own precision.
    Array,
    /// All layers, each at its own precision.
    Arrays,
    /// All layers, under their conventional channel names.
    Channels,
}

named! {
    /// The compression of pixels, where the format leaves a choice. It is lossless.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
    #[non_exhaustive]
    pub enum Compression {
        /// Fast encoding.
        #[default]
        Fast = "fast",
        /// Small files, however long encoding takes.
        Small = "small",
        /// No compression.
        None = "none",
        /// Runs of equal bytes.
        Rle = "rle",
        /// Deflate, row by row.
        Zips = "zips",
        /// Deflate, 16 rows at a time.
        Zip = "zip",
    }
}

impl Compression {
    /// Returns a short description.
    pub const fn description(self) -> &'static str {
        match self {
            Self::Fast => "Speed",
            Self::Small => "A small file",
            Self::None => "No compression",
            Self::Rle => "Runs of equal bytes",
            Self::Zips => "Deflate, row by row",
            Self::Zip => "Deflate, 16 rows at once",
        }
    }
}

named! {
    /// The choice of indexed files, which have at most one byte per pixel and their colors in a
    /// palette.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
    #[non_exhaustive]
    pub enum Palette {
        /// Never: every file has RGB pixels, whatever the scene holds.
        #[default]
        Never = "never",
        /// If the background and the geometries, visible or not, have at most 256 8-bit colors. The
        /// palette holds each color once: the background first, then the geometries in file order.
        Auto = "auto",
    }
}

impl Palette {
    /// Returns a short description.
    pub const fn description(self) -> &'static str {
        match self {
            Self::Never => "Pixels of red, green and blue, whatever the scene holds",
            Self::Auto => "If background and geometries have at most 256 colors",
        }
    }
}

/// The encoding options of a file, where its format leaves a choice.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Encoding<'a> {
    /// The compression of the pixels.
    pub(crate) compression: Compression,
    /// JPEG quality, 1 to 100.
    pub(crate) quality: u8,
    /// True if the numbers are colors: their color space is stated if the format supports that.
    /// Depths and normals are not colors.
    pub(crate) colors: bool,
    /// The names and values of the metadata. In EXR they are attributes.
    pub(crate) metadata: &'a [(String, String)],
}

impl Default for Encoding<'_> {
    fn default() -> Self {
        Self {
            compression: Compression::default(),
            // At this quality flat colors stay clean and files are still small.
            quality: 90,
            colors: true,
            metadata: &[],
        }
    }
}

impl Encoding<'_> {
    /// Returns the metadata as lines, for formats that do not support named texts.
    fn lines(&self) -> impl Iterator<Item = String> {
        let lines = self.metadata.iter();
        lines.map(|(name, text)| {
            let line = format!("{name}: {text}");
            line.replace(char::is_control, " ")
        })
    }
}

/// The form of a file: its size, pixel type and encoding.
#[derive(Clone, Copy)]
pub(crate) struct Form<'a> {
    pub(crate) size: Size,
    pub(crate) pixel: Pixel<'a>,
    pub(crate) encoding: Encoding<'a>,
}

impl<'a> Form<'a> {
    /// Creates a form with the default encoding.
    pub(crate) fn new(size: Size, pixel: Pixel<'a>) -> Self {
        Self {
            size,
            pixel,
            encoding: Encoding::default(),
        }
    }
}

/// Writes a picture of 8-bit RGB to a file, whole or not at all. The file extension determines the
/// format.
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

/// Returns an empty buffer with room for all pixels of a picture, at `pixel` bytes each.
pub(crate) fn buffer(size: Size, pixel: usize) -> Result<Vec<u8>, Error> {
    let mut pixels = Vec::new();
    let bytes = size.pixels().saturating_mul(pixel as u64);
    let bytes = usize::try_from(bytes).unwrap_or(usize::MAX);
    let reserved = pixels.try_reserve_exact(bytes);
    reserved.map_err(|error| too_large(size).caused_by(error))?;
    Ok(pixels)
}

/// Checks that a picture that needs this many bytes fits into memory: a failed allocation would end
/// the program.
///
/// # Errors
///
/// Too little memory ([`ErrorKind::Unavailable`]).
pub(crate) fn check_memory(size: Size, bytes: u64) -> Result<(), Error> {
    let bytes = usize::try_from(bytes).unwrap_or(usize::MAX);
    let reserved = Vec::<u8>::new().try_reserve_exact(bytes);
    reserved.map_err(|error| too_large(size).caused_by(error))
}

/// Returns the error for a picture that is larger than the memory.
pub(crate) fn too_large(size: Size) -> Error {
    let message = format!("a picture of {size} does not fit into memory");
    Error::new(ErrorKind::Unavailable, message)
}
