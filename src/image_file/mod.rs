//! From bands of pixels to image files, one file per format.

mod png;
mod ppm;
mod whole;

use std::{io::Write, path::Path};

use crate::{
    error::{Error, ErrorKind},
    film::Size,
    parallel::Cancel,
    target::Target,
};

/// A format of image files.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum ImageFormat {
    /// Portable Network Graphics, lossless.
    Png,
    /// JPEG at quality 90: the only format here that loses something.
    Jpeg,
    /// Windows bitmap, without compression.
    Bmp,
    /// Tagged Image File Format, without compression.
    Tiff,
    /// Portable pixmap, binary, without compression.
    Ppm,
    /// The Quite OK Image Format, lossless.
    Qoi,
    /// WebP, lossless.
    WebP,
}

impl ImageFormat {
    /// Every format.
    pub const ALL: &'static [Self] = &[
        Self::Png,
        Self::Jpeg,
        Self::Bmp,
        Self::Tiff,
        Self::Ppm,
        Self::Qoi,
        Self::WebP,
    ];

    /// The name: the usual ending of a file.
    pub const fn name(self) -> &'static str {
        self.endings()[0]
    }

    /// The endings of files, the usual one first.
    const fn endings(self) -> &'static [&'static str] {
        match self {
            Self::Png => &["png"],
            Self::Jpeg => &["jpg", "jpeg"],
            Self::Bmp => &["bmp"],
            Self::Tiff => &["tiff", "tif"],
            Self::Ppm => &["ppm"],
            Self::Qoi => &["qoi"],
            Self::WebP => &["webp"],
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

    /// Refuses a size that the format cannot hold.
    pub(crate) fn check(self, size: Size) -> Result<(), Error> {
        /// Room for headers in the files that may not reach 4 GiB.
        const HEADERS: u64 = 4096;
        let row = 3 * u64::from(size.width());
        let height = u64::from(size.height());
        let longest = |side: u32| {
            let fits = size.width() <= side && size.height() <= side;
            (fits, format!("sides of at most {side} pixels"))
        };
        let below_4_gib = |row: u64| {
            let fits = row * height + HEADERS <= u64::from(u32::MAX);
            (fits, "less than 4 GiB of pixels".to_owned())
        };
        let (fits, limit) = match self {
            Self::Png | Self::Ppm => return Ok(()),
            Self::Jpeg => longest(65_535),
            Self::WebP => longest(16_383),
            Self::Bmp => below_4_gib(row.next_multiple_of(4)),
            Self::Tiff => below_4_gib(row),
            Self::Qoi => {
                let fits = size.pixels() <= 400_000_000;
                (fits, "at most 400000000 pixels".to_owned())
            }
        };
        if fits {
            return Ok(());
        }
        let name = self.name();
        let message = format!("a picture of {size} does not fit: a {name} file has {limit}");
        Err(Error::new(ErrorKind::Usage, message))
    }

    /// Writes a file of this format: `draw` hands the picture to what it is given, in whole
    /// rows of bytes of red, green and blue, from the top; with a palette, which PNG alone has,
    /// in bytes that are places in it.
    pub(crate) fn encode(
        self,
        writer: impl Write,
        size: Size,
        encoding: Encoding,
        draw: impl FnOnce(Sink) -> Result<(), Error>,
    ) -> Result<(), Error> {
        match self {
            Self::Png => png::encode(writer, size, encoding, draw),
            Self::Ppm => ppm::encode(writer, size, draw),
            Self::Jpeg => whole::encode(writer, size, draw, whole::jpeg),
            Self::Bmp => whole::encode(writer, size, draw, whole::bmp),
            Self::Tiff => whole::encode(writer, size, draw, whole::tiff),
            Self::Qoi => whole::encode(writer, size, draw, whole::qoi),
            Self::WebP => whole::encode(writer, size, draw, whole::webp),
        }
    }
}

/// What matters most in a PNG file; other formats leave no choice. The pixels are the same.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Compression {
    /// To be done soon.
    #[default]
    Fast,
    /// To be small, whatever time that takes.
    Small,
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
#[derive(Clone, Copy, Default)]
pub(crate) struct Encoding<'a> {
    /// What matters most.
    pub(crate) compression: Compression,
    /// The 1 to 256 colors of an indexed picture.
    pub(crate) palette: Option<&'a [[u8; 3]]>,
}

/// Takes a picture in whole rows of bytes.
pub(crate) type Sink<'a> = &'a mut dyn FnMut(&[u8]) -> Result<(), Error>;

/// Writes a picture to a file, whose ending tells the format: whole or not at all.
pub(crate) fn save(
    path: &Path,
    size: Size,
    cancel: &Cancel,
    draw: impl FnOnce(Sink) -> Result<(), Error>,
) -> Result<(), Error> {
    let format = ImageFormat::of_path(path)?;
    format.check(size).map_err(|error| error.at(path))?;
    let mut target = Target::create(path, cancel)?;
    let written = format.encode(target.writer(), size, Encoding::default(), draw);
    written.map_err(|error| error.at(path))?;
    target.finish()
}

/// An empty buffer for all pixels of a picture.
pub(crate) fn buffer(size: Size) -> Result<Vec<u8>, Error> {
    let mut pixels = Vec::new();
    let bytes = usize::try_from(size.pixels() * 3).unwrap_or(usize::MAX);
    pixels.try_reserve_exact(bytes).map_err(|error| {
        let message = format!("a picture of {size} does not fit into memory");
        Error::new(ErrorKind::Unavailable, message).caused_by(error)
    })?;
    Ok(pixels)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn endings_are_known_in_either_case() {
        assert_eq!(ImageFormat::of_path("a.PNG").unwrap(), ImageFormat::Png);
        assert_eq!(ImageFormat::of_path("a.b.jpeg").unwrap(), ImageFormat::Jpeg);
        for format in ImageFormat::ALL {
            assert_eq!(ImageFormat::of_ending(format.name()), Some(*format));
        }
    }

    #[test]
    fn an_unknown_ending_lists_the_known_ones() {
        let error = ImageFormat::of_path("a.gif").unwrap_err();
        assert_eq!(error.kind(), ErrorKind::Usage);
        let expected = "a.gif: unknown image format `.gif`, known are \
                        .png, .jpg, .jpeg, .bmp, .tiff, .tif, .ppm, .qoi, .webp";
        assert_eq!(error.to_string(), expected);
        assert!(ImageFormat::of_path("png").is_err());
    }

    #[test]
    fn formats_have_limits() {
        let fits = |format: ImageFormat, width, height| {
            format.check(Size::new(width, height).unwrap()).is_ok()
        };
        assert!(fits(ImageFormat::Png, 131_072, 131_072));
        assert!(fits(ImageFormat::Jpeg, 65_535, 1) && !fits(ImageFormat::Jpeg, 65_536, 1));
        assert!(fits(ImageFormat::WebP, 1, 16_383) && !fits(ImageFormat::WebP, 1, 16_384));
        assert!(fits(ImageFormat::Qoi, 20_000, 20_000) && !fits(ImageFormat::Qoi, 20_001, 20_000));
        assert!(fits(ImageFormat::Bmp, 37_000, 37_000) && !fits(ImageFormat::Bmp, 38_000, 38_000));
        assert!(!fits(ImageFormat::Tiff, 38_000, 38_000));
    }
}
