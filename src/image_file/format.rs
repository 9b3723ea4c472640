//! Properties and checks derived from the description of each format.

use std::{
    fmt,
    hash::{Hash, Hasher},
    path::Path,
};

use crate::{
    diagnostic::error::Error,
    film::size::Size,
    image_file::{
        Compression, Content, Form, Format, ImageFormat,
        output::{Draw, Output},
        pixel::{Pixel, Sample},
    },
};

impl Format {
    /// A format of 8-bit colors, without limits or options.
    pub(super) const PLAIN: Self = Self {
        endings: &[],
        content: Content::Integers,
        holds: |pixel| pixel == Pixel::Rgb(Sample::U8),
        exceeded: |_, _| None,
        compressions: &[],
        has_signs: true,
        has_quality: false,
        has_metadata: false,
        decoder: None,
        encode: |_, _, _| Ok(()),
    };
}

impl ImageFormat {
    /// Returns the name, which is the usual file extension.
    pub const fn name(self) -> &'static str {
        self.0.endings[0]
    }

    /// Returns the file extensions, the usual one first.
    pub const fn endings(self) -> &'static [&'static str] {
        self.0.endings
    }

    /// Returns the supported compressions; empty if there is no choice.
    pub const fn compressions(self) -> &'static [Compression] {
        self.0.compressions
    }

    /// Returns true if a file may be indexed, with its colors in a palette.
    pub fn has_palette(self) -> bool {
        self.holds(Pixel::Indexed(&[[0; 3]]))
    }

    /// True if the format is lossy, with an adjustable quality.
    pub const fn has_quality(self) -> bool {
        self.0.has_quality
    }

    /// Returns true if files hold 8-bit RGB, which an [`Image`](crate::Image) consists of.
    pub fn has_rgb8(self) -> bool {
        self.holds(Pixel::Rgb(Sample::U8))
    }

    /// Returns true if one file holds several layers.
    pub const fn has_layers(self) -> bool {
        matches!(self.0.content, Content::Arrays | Content::Channels)
    }

    /// The content that the format is made for.
    pub(crate) const fn content(self) -> Content {
        self.0.content
    }

    /// True if floats may be negative.
    pub(crate) const fn has_signs(self) -> bool {
        self.0.has_signs
    }

    /// Returns the format of a file by its extension, in either case.
    ///
    /// # Errors
    ///
    /// Fails if the extension is unknown; the message lists the known ones.
    pub fn of_path(path: impl AsRef<Path>) -> Result<Self, Error> {
        let path = path.as_ref();
        let ending = path.extension().map(|ending| ending.to_string_lossy());
        let known = ending.as_deref().and_then(Self::of_ending);
        known.ok_or_else(|| {
            let what = match ending {
                Some(ending) => format!("unknown image format `.{ending}`"),
                None => "the name has no extension that determines the image format".to_owned(),
            };
            let endings = Self::ALL.iter().flat_map(|format| format.endings());
            let known: Vec<_> = endings.map(|ending| format!(".{ending}")).collect();
            let message = format!("{what}; supported formats: {}", known.join(", "));
            Error::refused(message).at(path)
        })
    }

    /// Returns the format for a file extension, in either case.
    pub fn of_ending(ending: &str) -> Option<Self> {
        let is_it = |known: &&str| known.eq_ignore_ascii_case(ending);
        let mut all = Self::ALL.iter().copied();
        all.find(|format| format.endings().iter().any(is_it))
    }

    /// Returns the names of the selected formats as a list for a sentence: `png, tiff and exr`.
    pub fn list(are: impl Fn(Self) -> bool) -> String {
        let names = names(are);
        match names.rsplit_once(", ") {
            Some((first, last)) => format!("{first} and {last}"),
            None => names,
        }
    }

    /// Writes a file of this format, unless [`ImageFormat::check`] rejects it.
    pub(crate) fn encode(self, output: Output, form: Form, draw: Draw) -> Result<(), Error> {
        self.check(form)?;
        (self.0.encode)(output, form, draw)
    }

    /// Returns true if the format supports the pixel type.
    pub(crate) fn holds(self, pixel: Pixel) -> bool {
        (self.0.holds)(pixel)
    }

    /// Rejects a form that the format does not support.
    pub(crate) fn check(self, form: Form) -> Result<(), Error> {
        let Form {
            size,
            pixel,
            encoding,
        } = form;
        if !self.holds(pixel) {
            return Err(cannot_hold_pixel(self, pixel));
        }
        let refuse = |message| Err(Error::refused(message));
        let name = self.name();
        if let Some(limit) = (self.0.exceeded)(size, pixel) {
            let message = format!("a picture of {size} does not fit: {name} files have {limit}");
            return refuse(message);
        }
        if !(1..=100).contains(&encoding.quality) {
            let quality = encoding.quality;
            return refuse(format!("the quality is {quality}, expected 1 to 100"));
        }
        if !self.compresses(encoding.compression) {
            let known = names(|format| format.compresses(encoding.compression));
            let message =
                format!("{name} files do not support this compression; supported by {known}");
            return refuse(message);
        }
        if !encoding.metadata.is_empty() && !self.0.has_metadata {
            let known = names(|format| format.0.has_metadata);
            let message = format!("{name} files do not support metadata; supported by {known}");
            return refuse(message);
        }
        Ok(())
    }

    /// Returns true if the compression is accepted. Fast and small are hints: a format without a
    /// choice may ignore them.
    fn compresses(self, compression: Compression) -> bool {
        matches!(compression, Compression::Fast | Compression::Small)
            || self.compressions().contains(&compression)
    }
}

impl PartialEq for ImageFormat {
    fn eq(&self, other: &Self) -> bool {
        self.name() == other.name()
    }
}

impl Eq for ImageFormat {}

impl Hash for ImageFormat {
    fn hash<H: Hasher>(&self, state: &mut H) {
        self.name().hash(state);
    }
}

impl fmt::Debug for ImageFormat {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "ImageFormat({})", self.name())
    }
}

/// Returns true if files of this format of the `image` crate can be read.
pub(crate) fn is_decoded(decoder: image::ImageFormat) -> bool {
    let mut all = ImageFormat::ALL.iter();
    all.any(|format| format.0.decoder == Some(decoder))
}

/// Returns the limit of the sides if a picture exceeds it.
pub(super) fn longest(side: u32, size: Size) -> Option<String> {
    let fits = size.width() <= side && size.height() <= side;
    (!fits).then(|| format!("sides of at most {side} pixels"))
}

/// Returns the error for pixels that a format does not support; it names the formats that do.
pub(super) fn cannot_hold_pixel(refused: ImageFormat, pixel: Pixel) -> Error {
    // Formats with named contents hold the same numbers as channels or arrays.
    let named = |format: ImageFormat| match (format.content(), pixel.samples()) {
        (Content::Channels, Some((count, sample))) => match sample {
            Sample::F16 | Sample::F32 | Sample::F64 => true,
            Sample::U32 => count == 1,
            Sample::U8 | Sample::U16 => count > 1,
        },
        (Content::Arrays, Some(_)) => format != refused,
        _ => false,
    };
    cannot_hold(refused, pixel, |format| {
        format.holds(pixel) || named(format)
    })
}

/// Returns the error for pixels that a format does not support; it names the other formats that do.
pub(crate) fn cannot_hold(
    refused: ImageFormat,
    pixel: Pixel,
    can: impl Fn(ImageFormat) -> bool,
) -> Error {
    let known = names(|format| format != refused && can(format));
    let name = refused.name();
    let message = format!("{name} files cannot hold {pixel}");
    let message = if known.is_empty() {
        message
    } else {
        format!("{message}; supported by {known}")
    };
    Error::refused(message)
}

/// Returns the names of the selected formats.
fn names(are: impl Fn(ImageFormat) -> bool) -> String {
    let all = ImageFormat::ALL.iter().filter(|format| are(**format));
    let names: Vec<_> = all.map(|format| format.name()).collect();
    names.join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        diagnostic::error::ErrorKind,
        image_file::{Encoding, pixel::Channel},
    };

    const RGB: Pixel = Pixel::Rgb(Sample::U8);

    fn refusal(format: ImageFormat, pixel: Pixel, encoding: Encoding) -> String {
        let size = Size::new(2, 2).unwrap();
        let error = format
            .check(Form {
                size,
                pixel,
                encoding,
            })
            .unwrap_err();
        assert_eq!(error.kind(), ErrorKind::Usage);
        error.to_string()
    }

    #[test]
    fn formats_have_limits() {
        let fits = |format: ImageFormat, width, height| {
            let size = Size::new(width, height).unwrap();
            format.check(Form::new(size, RGB)).is_ok()
        };
        assert!(fits(ImageFormat::PNG, 131_072, 131_072));
        assert!(fits(ImageFormat::TIFF, 131_072, 131_072));
        assert!(fits(ImageFormat::JPEG, 65_535, 1) && !fits(ImageFormat::JPEG, 65_536, 1));
        assert!(fits(ImageFormat::WEBP, 1, 16_383) && !fits(ImageFormat::WEBP, 1, 16_384));
        assert!(fits(ImageFormat::QOI, 20_000, 20_000) && !fits(ImageFormat::QOI, 20_001, 20_000));
        assert!(fits(ImageFormat::BMP, 37_000, 37_000) && !fits(ImageFormat::BMP, 38_000, 38_000));
    }

    #[test]
    fn the_manual_names_the_formats_that_have_limits() {
        let manual = include_str!("../../docs/scene-format.md");
        let (_, sizes) = manual.split_once("## Sizes").unwrap();
        let (sizes, _) = sizes.split_once("\n## ").unwrap();
        let sizes = sizes.to_lowercase();
        for format in ImageFormat::ALL {
            let size = Size::new(131_072, 131_072).unwrap();
            let is_limited = (format.0.exceeded)(size, RGB).is_some();
            let is_named = format.endings().iter().any(|name| sizes.contains(name));
            assert_eq!(is_named, is_limited, "{}", format.name());
        }
    }

    #[test]
    fn a_block_of_an_exr_file_has_a_limit() {
        let channels = |count: usize| {
            let channels = (0..count).map(|count| Channel {
                name: count.to_string(),
                sample: Sample::F32,
            });
            channels.collect::<Vec<_>>()
        };
        let checked = |count| {
            let size = Size::new(1_000_000, 1).unwrap();
            ImageFormat::EXR.check(Form::new(size, Pixel::Channels(&channels(count))))
        };
        assert!(checked(33).is_ok());
        let refused = checked(34).unwrap_err().to_string();
        assert!(refused.contains("less than 2 GiB in 16 rows"), "{refused}");
    }

    #[test]
    fn an_error_names_the_formats_with_support() {
        let encoding = Encoding::default();
        assert_eq!(
            refusal(ImageFormat::JPEG, Pixel::Rgb(Sample::U16), encoding),
            "jpg files cannot hold 16-bit RGB; supported by png, tiff, ppm, exr, npy, npz"
        );
        assert_eq!(
            refusal(ImageFormat::BMP, Pixel::Rgba(Sample::U8), encoding),
            "bmp files cannot hold 8-bit RGBA; supported by png, tiff, qoi, webp, exr, npy, npz"
        );
        assert_eq!(
            refusal(ImageFormat::PNG, Pixel::Gray(Sample::F32), encoding),
            "png files cannot hold 32-bit float gray; supported by tiff, pfm, exr, npy, npz"
        );
        assert_eq!(
            refusal(ImageFormat::HDR, Pixel::Indexed(&[[0; 3]]), encoding),
            "hdr files cannot hold a palette; supported by png"
        );
        let metadata = [("Software".to_owned(), "strahl".to_owned())];
        let metadata = Encoding {
            metadata: &metadata,
            ..encoding
        };
        assert_eq!(
            refusal(ImageFormat::WEBP, RGB, metadata),
            "webp files do not support metadata; supported by png, jpg, tiff, hdr, exr"
        );
        let rle = Encoding {
            compression: Compression::Rle,
            ..encoding
        };
        assert_eq!(
            refusal(ImageFormat::TIFF, RGB, rle),
            "tiff files do not support this compression; supported by exr"
        );
        for quality in [0, 101] {
            let quality = Encoding {
                quality,
                ..encoding
            };
            let refused = refusal(ImageFormat::JPEG, RGB, quality);
            assert!(refused.ends_with("expected 1 to 100"), "{refused}");
        }
    }
}
