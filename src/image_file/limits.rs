//! What the formats can hold.

use crate::{
    error::{Error, ErrorKind},
    film::size::Size,
    image_file::{
        Compression, Encoding, ImageFormat, exr, hdr, npy, npz, pfm,
        pixel::{Pixel, Sample},
        png, ppm, tiff, whole,
    },
};

impl ImageFormat {
    /// Refuses what the format cannot hold.
    pub(crate) fn check(self, size: Size, pixel: Pixel, encoding: Encoding) -> Result<(), Error> {
        if !self.holds(pixel) {
            return Err(cannot_hold_pixel(self, pixel));
        }
        let refuse = |message| Err(Error::new(ErrorKind::Usage, message));
        let name = self.name();
        if let Some(limit) = self.exceeded(size, pixel) {
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
                format!("{name} files have no such compression, those that have: {known}");
            return refuse(message);
        }
        if !encoding.metadata.is_empty() && !self.has_metadata() {
            let known = names(Self::has_metadata);
            let message =
                format!("{name} files have no place for metadata, those that have: {known}");
            return refuse(message);
        }
        Ok(())
    }

    /// Whether a file can have such pixels.
    pub(crate) fn holds(self, pixel: Pixel) -> bool {
        match self {
            Self::Png => png::layout(pixel).is_some(),
            Self::Tiff => tiff::layout(pixel).is_some(),
            Self::Ppm => ppm::layout(pixel).is_some(),
            Self::Pfm => pfm::layout(pixel).is_some(),
            Self::Hdr => hdr::layout(pixel).is_some(),
            Self::Exr => exr::layout(pixel).is_some(),
            Self::Npy => npy::layout(pixel).is_some(),
            Self::Npz => npz::layout(pixel).is_some(),
            Self::Jpeg | Self::Bmp | Self::Qoi | Self::WebP => whole::layout(self, pixel).is_some(),
        }
    }

    /// The limit that a picture goes beyond.
    fn exceeded(self, size: Size, pixel: Pixel) -> Option<String> {
        /// Room for headers in the files that may not reach 4 GiB.
        const HEADERS: u64 = 4096;
        let row = u64::from(size.width()) * pixel.bytes() as u64;
        let longest = |side: u32| {
            let fits = size.width() <= side && size.height() <= side;
            (fits, format!("sides of at most {side} pixels"))
        };
        let (fits, limit) = match self {
            Self::Png | Self::Ppm | Self::Pfm | Self::Hdr | Self::Npy | Self::Npz => return None,
            // The longest strip has one row, and its length has 32 bits.
            Self::Tiff => return None,
            Self::Exr => {
                let fits = row * exr::MOST_LINES as u64 <= i32::MAX as u64;
                (fits, "less than 2 GiB in 16 rows".to_owned())
            }
            Self::Jpeg => longest(65_535),
            Self::WebP => longest(16_383),
            Self::Bmp => {
                let bytes = row.next_multiple_of(4) * u64::from(size.height()) + HEADERS;
                let fits = bytes <= u64::from(u32::MAX);
                (fits, "less than 4 GiB of pixels".to_owned())
            }
            Self::Qoi => {
                let fits = size.pixels() <= 400_000_000;
                (fits, "at most 400000000 pixels".to_owned())
            }
        };
        (!fits).then_some(limit)
    }

    const fn compresses(self, compression: Compression) -> bool {
        match compression {
            Compression::Fast | Compression::Small => true,
            Compression::None => matches!(self, Self::Tiff | Self::Exr),
            Compression::Rle | Compression::Zips | Compression::Zip => matches!(self, Self::Exr),
        }
    }

    const fn has_metadata(self) -> bool {
        matches!(
            self,
            Self::Png | Self::Jpeg | Self::Tiff | Self::Hdr | Self::Exr
        )
    }
}

/// The error for pixels that a format does not know; it names those formats that do.
pub(super) fn cannot_hold_pixel(refused: ImageFormat, pixel: Pixel) -> Error {
    // Those that name what they hold take the same numbers under their names.
    let named = |format: ImageFormat| match (format, pixel.samples()) {
        (ImageFormat::Exr, Some((count, sample))) => match sample {
            Sample::F16 | Sample::F32 | Sample::F64 => true,
            Sample::U32 => count == 1,
            Sample::U8 | Sample::U16 => count > 1,
        },
        (ImageFormat::Npz, Some(_)) => format != refused,
        _ => false,
    };
    cannot_hold(refused, pixel, |format| {
        format.holds(pixel) || named(format)
    })
}

/// The error for pixels that a format does not know; it names those other formats that can do.
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
        format!("{message}, those that can: {known}")
    };
    Error::new(ErrorKind::Usage, message)
}

/// The names of some formats.
fn names(are: impl Fn(ImageFormat) -> bool) -> String {
    let all = ImageFormat::ALL.iter().filter(|format| are(**format));
    let names: Vec<_> = all.map(|format| format.name()).collect();
    names.join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image_file::pixel::{Channel, Sample};

    const RGB: Pixel = Pixel::Rgb(Sample::U8);

    fn refusal(format: ImageFormat, pixel: Pixel, encoding: Encoding) -> String {
        let size = Size::new(2, 2).unwrap();
        let error = format.check(size, pixel, encoding).unwrap_err();
        assert_eq!(error.kind(), ErrorKind::Usage);
        error.to_string()
    }

    #[test]
    fn formats_have_limits() {
        let fits = |format: ImageFormat, width, height| {
            let size = Size::new(width, height).unwrap();
            format.check(size, RGB, Encoding::default()).is_ok()
        };
        assert!(fits(ImageFormat::Png, 131_072, 131_072));
        assert!(fits(ImageFormat::Tiff, 131_072, 131_072));
        assert!(fits(ImageFormat::Jpeg, 65_535, 1) && !fits(ImageFormat::Jpeg, 65_536, 1));
        assert!(fits(ImageFormat::WebP, 1, 16_383) && !fits(ImageFormat::WebP, 1, 16_384));
        assert!(fits(ImageFormat::Qoi, 20_000, 20_000) && !fits(ImageFormat::Qoi, 20_001, 20_000));
        assert!(fits(ImageFormat::Bmp, 37_000, 37_000) && !fits(ImageFormat::Bmp, 38_000, 38_000));
    }

    #[test]
    fn the_manual_names_the_formats_that_have_limits() {
        let manual = include_str!("../../docs/scene-format.md");
        let (_, sizes) = manual.split_once("## Sizes").unwrap();
        let (sizes, _) = sizes.split_once("\n## ").unwrap();
        let sizes = sizes.to_lowercase();
        for format in ImageFormat::ALL {
            let size = Size::new(131_072, 131_072).unwrap();
            let is_limited = format.exceeded(size, RGB).is_some();
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
            ImageFormat::Exr.check(size, Pixel::Channels(&channels(count)), Encoding::default())
        };
        assert!(checked(33).is_ok());
        let refused = checked(34).unwrap_err().to_string();
        assert!(refused.contains("less than 2 GiB in 16 rows"), "{refused}");
    }

    #[test]
    fn a_refusal_names_the_formats_that_can() {
        let encoding = Encoding::default();
        assert_eq!(
            refusal(ImageFormat::Jpeg, Pixel::Rgb(Sample::U16), encoding),
            "jpg files cannot hold 16-bit RGB, those that can: png, tiff, ppm, exr, npy, npz"
        );
        assert_eq!(
            refusal(ImageFormat::Bmp, Pixel::Rgba(Sample::U8), encoding),
            "bmp files cannot hold 8-bit RGBA, those that can: png, tiff, qoi, webp, exr, npy, npz"
        );
        assert_eq!(
            refusal(ImageFormat::Png, Pixel::Gray(Sample::F32), encoding),
            "png files cannot hold 32-bit float gray, those that can: tiff, pfm, exr, npy, npz"
        );
        assert_eq!(
            refusal(ImageFormat::Hdr, Pixel::Indexed(&[[0; 3]]), encoding),
            "hdr files cannot hold a palette, those that can: png"
        );
        let metadata = [("Software".to_owned(), "strahl".to_owned())];
        let metadata = Encoding {
            metadata: &metadata,
            ..encoding
        };
        assert_eq!(
            refusal(ImageFormat::WebP, RGB, metadata),
            "webp files have no place for metadata, those that have: png, jpg, tiff, hdr, exr"
        );
        let rle = Encoding {
            compression: Compression::Rle,
            ..encoding
        };
        assert_eq!(
            refusal(ImageFormat::Tiff, RGB, rle),
            "tiff files have no such compression, those that have: exr"
        );
        for quality in [0, 101] {
            let quality = Encoding {
                quality,
                ..encoding
            };
            let refused = refusal(ImageFormat::Jpeg, RGB, quality);
            assert!(refused.ends_with("expected 1 to 100"), "{refused}");
        }
    }
}
