//! Reading a picture, whatever its format.

use std::{fs, io::Cursor, path::Path};

use image::{DynamicImage, ImageDecoder, ImageFormat, ImageReader};

use crate::{
    compare::pfm,
    error::{Error, ErrorKind},
    film::Size,
};

/// A picture as it stands in its file: PNG, JPEG, BMP, TIFF, PPM, PFM, QOI, WebP, HDR or EXR.
///
/// # Examples
///
/// ```no_run
/// use strahl::{CompareOptions, Picture};
///
/// let (golden, new) = (Picture::read("golden.png")?, Picture::read("new.png")?);
/// match golden.compare(&new, &CompareOptions::new())? {
///     Some(found) => println!("{} pixels differ", found.different),
///     None => println!("{} is not {}", golden.size(), new.size()),
/// }
/// # Ok::<(), strahl::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct Picture {
    size: Size,
    pub(super) samples: Samples,
    /// Gray; gray and alpha; red, green and blue; these and alpha.
    pub(super) channels: usize,
    /// Whether colors have been multiplied by alpha.
    pub(super) premultiplied: bool,
}

/// The samples of a picture, pixel by pixel from the top left.
#[derive(Clone, Debug)]
pub(super) enum Samples {
    /// Display values (sRGB), 255 is white.
    Bytes(Vec<u8>),
    /// Display values (sRGB), 65535 is white.
    Words(Vec<u16>),
    /// Linear light, 1 is white.
    Floats(Vec<f32>),
}

impl Picture {
    /// Reads a file; its first bytes tell the format.
    ///
    /// # Errors
    ///
    /// A file that cannot be read, that is no picture, that is broken, or that does not fit into
    /// memory.
    pub fn read(path: impl AsRef<Path>) -> Result<Self, Error> {
        let path = path.as_ref();
        let file = fs::read(path).map_err(|error| Error::unreadable(path, error))?;
        Self::decode(&file).map_err(|error| error.at(path))
    }

    /// The width and height.
    pub fn size(&self) -> Size {
        self.size
    }

    pub(super) fn new(
        size: Size,
        channels: usize,
        samples: Samples,
        premultiplied: bool,
    ) -> Result<Self, Error> {
        let expected = size.pixels() * channels as u64;
        let found = match &samples {
            Samples::Bytes(bytes) => bytes.len(),
            Samples::Words(words) => words.len(),
            Samples::Floats(floats) => floats.len(),
        };
        if found as u64 != expected {
            let message = format!("broken: expected {expected} samples, found {found}");
            return Err(Error::new(ErrorKind::Unreadable, message));
        }
        Ok(Self {
            size,
            samples,
            channels,
            premultiplied,
        })
    }

    pub(super) fn has_alpha(&self) -> bool {
        self.channels.is_multiple_of(2)
    }

    fn decode(file: &[u8]) -> Result<Self, Error> {
        if pfm::is_pfm(file) {
            return pfm::decode(file);
        }
        let format = image::guess_format(file).ok();
        let format = format
            .filter(|format| FORMATS.contains(format))
            .ok_or_else(|| {
                let message = "is not a picture: known are PNG, JPEG, BMP, TIFF, PPM, PFM, QOI, \
                               WebP, HDR and EXR";
                Error::new(ErrorKind::Unreadable, message)
            })?;
        let broken = |error: String| {
            let name = format.extensions_str()[0];
            Error::new(
                ErrorKind::Unreadable,
                format!("broken {name} file: {error}"),
            )
        };
        // Its decoder fills up with gray what a file that was cut off does not hold.
        if format == ImageFormat::Jpeg && !file.windows(2).any(|two| two == END_OF_JPEG) {
            return Err(broken("it has no end".to_owned()));
        }
        let mut reader = ImageReader::with_format(Cursor::new(file), format);
        reader.no_limits();
        let decoder = reader.into_decoder();
        let decoder = decoder.map_err(|error| broken(error.to_string()))?;
        let (width, height) = decoder.dimensions();
        let size = Size::new(width, height).map_err(|error| broken(error.to_string()))?;
        check_memory(size, decoder.total_bytes())?;
        let image = DynamicImage::from_decoder(decoder);
        let (channels, samples) = samples(image.map_err(|error| broken(error.to_string()))?);
        Self::new(size, channels, samples, format == ImageFormat::OpenExr)
    }
}

const END_OF_JPEG: [u8; 2] = [0xff, 0xd9];

const FORMATS: [ImageFormat; 9] = [
    ImageFormat::Png,
    ImageFormat::Jpeg,
    ImageFormat::Bmp,
    ImageFormat::Tiff,
    ImageFormat::Pnm,
    ImageFormat::Qoi,
    ImageFormat::WebP,
    ImageFormat::Hdr,
    ImageFormat::OpenExr,
];

/// Refuses what a broken header may ask for before somebody tries and ends the program.
pub(super) fn check_memory(size: Size, bytes: u64) -> Result<(), Error> {
    let bytes = usize::try_from(bytes).unwrap_or(usize::MAX);
    Vec::<u8>::new().try_reserve_exact(bytes).map_err(|error| {
        let message = format!("a picture of {size} does not fit into memory");
        Error::new(ErrorKind::Unavailable, message).caused_by(error)
    })
}

fn samples(image: DynamicImage) -> (usize, Samples) {
    match image {
        DynamicImage::ImageLuma8(image) => (1, Samples::Bytes(image.into_raw())),
        DynamicImage::ImageLumaA8(image) => (2, Samples::Bytes(image.into_raw())),
        DynamicImage::ImageRgb8(image) => (3, Samples::Bytes(image.into_raw())),
        DynamicImage::ImageRgba8(image) => (4, Samples::Bytes(image.into_raw())),
        DynamicImage::ImageLuma16(image) => (1, Samples::Words(image.into_raw())),
        DynamicImage::ImageLumaA16(image) => (2, Samples::Words(image.into_raw())),
        DynamicImage::ImageRgb16(image) => (3, Samples::Words(image.into_raw())),
        DynamicImage::ImageRgba16(image) => (4, Samples::Words(image.into_raw())),
        DynamicImage::ImageRgb32F(image) => (3, Samples::Floats(image.into_raw())),
        image => (4, Samples::Floats(image.into_rgba32f().into_raw())),
    }
}
