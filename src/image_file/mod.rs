//! From bands of pixels to image files, one file per format.

pub(crate) mod cryptomatte;
mod deflate;
mod exr;
mod hdr;
pub(crate) mod limits;
mod npy;
mod npz;
pub(crate) mod part;
mod pfm;
pub(crate) mod pixel;
mod png;
mod ppm;
mod runs;
#[cfg(test)]
mod tests;
mod tiff;
mod whole;

use std::{io::Write, path::Path};

use crate::{
    error::{Error, ErrorKind},
    film::size::Size,
    image_file::pixel::{Pixel, Sample},
    output::Output,
    parallel::Cancel,
    target::Target,
};

/// A format of image files.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum ImageFormat {
    /// Portable Network Graphics, lossless.
    Png,
    /// JPEG: the only format here that loses something.
    Jpeg,
    /// Windows bitmap, without compression.
    Bmp,
    /// Tagged Image File Format, lossless; `BigTIFF` where it may pass 4 GiB.
    Tiff,
    /// Portable pixmap, binary, without compression.
    Ppm,
    /// Portable float map, without compression.
    Pfm,
    /// The Quite OK Image Format, lossless.
    Qoi,
    /// WebP, lossless.
    WebP,
    /// Radiance: floats with a common exponent, 8 bits each.
    Hdr,
    /// `OpenEXR`, lossless: named channels of one picture.
    Exr,
    /// An array of `NumPy`.
    Npy,
    /// Named arrays of `NumPy`.
    Npz,
}

impl ImageFormat {
    /// Every format.
    pub const ALL: &'static [Self] = &[
        Self::Png,
        Self::Jpeg,
        Self::Bmp,
        Self::Tiff,
        Self::Ppm,
        Self::Pfm,
        Self::Qoi,
        Self::WebP,
        Self::Hdr,
        Self::Exr,
        Self::Npy,
        Self::Npz,
    ];

    /// The name: the usual ending of a file.
    pub const fn name(self) -> &'static str {
        self.endings()[0]
    }

    /// The endings of files, the usual one first.
    pub const fn endings(self) -> &'static [&'static str] {
        match self {
            Self::Png => &["png"],
            Self::Jpeg => &["jpg", "jpeg"],
            Self::Bmp => &["bmp"],
            Self::Tiff => &["tiff", "tif"],
            Self::Ppm => &["ppm"],
            Self::Pfm => &["pfm"],
            Self::Qoi => &["qoi"],
            Self::WebP => &["webp"],
            Self::Hdr => &["hdr"],
            Self::Exr => &["exr"],
            Self::Npy => &["npy"],
            Self::Npz => &["npz"],
        }
    }

    /// The format of a file by its ending, in either case.
    ///
    /// # Errors
    ///
    /// An ending that is unknown; the message lists those that are known.
    pub fn of_path(path: impl AsRef<Path>) -> Result<Self, Error> {
        let path = path.as_ref();
        let ending = path.extension().map(|ending| ending.to_string_lossy());
        let known = ending.as_deref().and_then(Self::of_ending);
        known.ok_or_else(|| {
            let what = match ending {
                Some(ending) => format!("unknown image format `.{ending}`"),
                None => "the name has no ending that tells the image format".to_owned(),
            };
            let endings = Self::ALL.iter().flat_map(|format| format.endings());
            let known: Vec<_> = endings.map(|ending| format!(".{ending}")).collect();
            let message = format!("{what}, known are {}", known.join(", "));
            Error::new(ErrorKind::Usage, message).at(path)
        })
    }

    /// The format with an ending, in either case.
    pub fn of_ending(ending: &str) -> Option<Self> {
        let is_it = |known: &&str| known.eq_ignore_ascii_case(ending);
        let mut all = Self::ALL.iter().copied();
        all.find(|format| format.endings().iter().any(is_it))
    }

    /// Writes a file of this format, unless [`ImageFormat::check`] refuses it: `draw` hands the
    /// picture to what it is given, in whole rows from the top, the numbers in the byte order of
    /// this machine.
    pub(crate) fn encode(
        self,
        output: Output,
        size: Size,
        pixel: Pixel,
        encoding: Encoding,
        draw: impl FnOnce(Sink) -> Result<(), Error>,
    ) -> Result<(), Error> {
        self.check(size, pixel, encoding)?;
        match self {
            Self::Png => png::encode(output, size, pixel, encoding, draw),
            Self::Tiff => tiff::encode(output, size, pixel, encoding, draw),
            Self::Ppm => ppm::encode(output, size, pixel, draw),
            Self::Pfm => pfm::encode(output, size, pixel, draw),
            Self::Hdr => hdr::encode(output, size, pixel, encoding, draw),
            Self::Exr => exr::encode(output, size, pixel, encoding, draw),
            Self::Npy => npy::encode(output, size, pixel, draw),
            Self::Npz => npz::encode(output, size, pixel, draw),
            Self::Jpeg | Self::Bmp | Self::Qoi | Self::WebP => {
                whole::encode(self, output, size, pixel, encoding, draw)
            }
        }
    }
}

/// How the pixels of a file are compressed, where its format leaves a choice. They are the same
/// afterwards.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Compression {
    /// To be done soon.
    #[default]
    Fast,
    /// To be small, whatever time that takes.
    Small,
    /// Not at all: TIFF and EXR.
    None,
    /// Runs of equal bytes: EXR.
    Rle,
    /// Deflate, row by row: EXR.
    Zips,
    /// Deflate, 16 rows at once, as [`Compression::Fast`] is too: EXR.
    Zip,
}

/// Whether a PNG file is indexed: one byte a pixel or less, and the colors in a palette.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Palette {
    /// Never: each file has pixels of red, green and blue, whatever the scene holds.
    #[default]
    Never,
    /// If the background and the geometries, seen or not, have at most 256 colors as bytes. The
    /// palette holds each once: the background first, then the geometries in the order of the
    /// file.
    Auto,
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

/// Takes a picture in whole rows of bytes.
pub(crate) type Sink<'a> = &'a mut dyn FnMut(&[u8]) -> Result<(), Error>;

/// Writes a picture of bytes of red, green and blue to a file, whose ending tells the format: whole
/// or not at all.
pub(crate) fn save(
    path: &Path,
    size: Size,
    cancel: &Cancel,
    draw: impl FnOnce(Sink) -> Result<(), Error>,
) -> Result<(), Error> {
    let format = ImageFormat::of_path(path)?;
    let (pixel, encoding) = (Pixel::Rgb(Sample::U8), Encoding::default());
    let checked = format.check(size, pixel, encoding);
    checked.map_err(|error| error.at(path))?;
    let mut target = Target::create(path, cancel)?;
    let written = format.encode(target.output(), size, pixel, encoding, draw);
    written.map_err(|error| error.at(path))?;
    target.finish()
}

/// Writes a PNG file.
pub(crate) fn to_png(
    mut writer: impl Write,
    size: Size,
    pixel: Pixel,
    draw: impl FnOnce(Sink) -> Result<(), Error>,
) -> Result<(), Error> {
    let output = Output::Stream(&mut writer);
    ImageFormat::Png.encode(output, size, pixel, Encoding::default(), draw)
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
