//! Limits for reading a picture: on the file, and on the size that it declares.
//!
//! A header of a few bytes may declare any size. It is checked against a limit before a decoder
//! allocates memory for it.

use std::{
    fmt,
    fs::Metadata,
    io::{self, Read},
    path::Path,
};

use image::Limits;

use crate::{
    diagnostic::{
        error::{Error, ErrorKind},
        reading::{is_pipe, open_file},
    },
    film::size::Size,
};

/// The default maximum number of pixels.
const MAX_PIXELS: u64 = 1 << 28;
/// The maximum number of bytes per pixel, in a file and in memory: four 32-bit channels.
const BYTES_PER_PIXEL: u64 = 16;
/// The bytes allowed for everything else: headers, color profiles, working rows.
const BESIDE_PIXELS: u64 = 64 << 20;
/// The maximum number of bytes read from a pipe, whose length is unknown.
const LONGEST_PIPE: u64 = 1 << 30;

/// The options for reading pictures.
///
/// # Examples
///
/// ```
/// use strahl::compare::{Picture, PictureOptions};
///
/// # let folder = tempfile::tempdir()?;
/// # let path = folder.path().join("small.ppm");
/// std::fs::write(&path, b"P6 2 2 255 rgbrgbrgbrgb")?;
/// assert!(Picture::read_with(&path, &PictureOptions::new().max_pixels(3)).is_err());
/// assert!(Picture::read_with(&path, &PictureOptions::new().max_pixels(4)).is_ok());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct PictureOptions {
    max_pixels: u64,
}

impl Default for PictureOptions {
    fn default() -> Self {
        Self {
            max_pixels: MAX_PIXELS,
        }
    }
}

impl PictureOptions {
    /// Creates the default options: at most 2²⁸ pixels.
    pub fn new() -> Self {
        Self::default()
    }

    /// Rejects files that declare more pixels, before memory is allocated for any. The memory for a
    /// picture is proportional to its pixels.
    #[must_use]
    pub fn max_pixels(mut self, pixels: u64) -> Self {
        self.max_pixels = pixels;
        self
    }

    /// Returns the size that a file declares, if it is valid and within the limit.
    pub(super) fn size(&self, width: u32, height: u32) -> Result<Size, Error> {
        let pixels = u64::from(width) * u64::from(height);
        if pixels > self.max_pixels {
            let most = self.max_pixels;
            let message = format!(
                "declares {width}x{height} pixels, more than the limit of {most}; `--max-pixels {pixels}` allows them"
            );
            return Err(Error::new(ErrorKind::Unreadable, message));
        }
        let size = Size::new(width, height);
        size.map_err(|error| Error::new(ErrorKind::Unreadable, error.to_string()))
    }

    /// Checks the number of values in all layers of a file: at most four for each pixel of the
    /// largest picture.
    pub(super) fn check_numbers(&self, numbers: u64) -> Result<(), Error> {
        let most = self.max_pixels.saturating_mul(4);
        if numbers <= most {
            return Ok(());
        }
        let message = format!(
            "declares {numbers} numbers, more than the limit of {most}, four a pixel; see `--max-pixels`"
        );
        Err(Error::new(ErrorKind::Unreadable, message))
    }

    /// Checks the sizes in a WebP file that its decoder does not report but allocates memory for.
    pub(super) fn check_webp(&self, file: &[u8]) -> Result<(), Error> {
        webp_frames(file)
            .into_iter()
            .try_for_each(|[width, height]| self.size(width, height).map(drop))
    }

    /// Returns the limits on a decoder's memory for this many pixels.
    pub(super) fn decoder_limits(pixels: u64) -> Limits {
        let mut limits = Limits::no_limits();
        // The decoded pixels, and once more as stored in the file.
        limits.max_alloc = Some(2 * BYTES_PER_PIXEL * pixels + BESIDE_PIXELS);
        limits
    }

    /// Returns the same limits for the TIFF decoder itself.
    pub(super) fn tiff_limits(size: Size) -> tiff::decoder::Limits {
        let most = Self::decoder_limits(size.pixels()).max_alloc;
        let most = most.and_then(|most| usize::try_from(most).ok());
        let mut limits = tiff::decoder::Limits::default();
        limits.decoding_buffer_size = most.unwrap_or(usize::MAX);
        limits
    }

    /// Returns the bytes of a file or a pipe.
    pub(super) fn bytes(&self, path: &Path) -> Result<Vec<u8>, Error> {
        let unreadable = |error| Error::unreadable(path, error);
        let file = open_file(path).map_err(unreadable)?;
        let about = file.metadata().map_err(unreadable)?;
        let most = self.longest(&about).map_err(unreadable)?;
        let mut bytes = Vec::new();
        if about.is_file() {
            let length = usize::try_from(about.len()).unwrap_or(usize::MAX);
            bytes
                .try_reserve_exact(length.saturating_add(1))
                .map_err(|error| unreadable(error.into()))?;
        }
        let read = file.take(most.saturating_add(1)).read_to_end(&mut bytes);
        read.map_err(unreadable)?;
        if bytes.len() as u64 > most {
            return Err(unreadable(longer_than(most)));
        }
        Ok(bytes)
    }

    /// Returns the maximum number of bytes for a file of this kind.
    fn longest(&self, about: &Metadata) -> io::Result<u64> {
        let most = BYTES_PER_PIXEL.saturating_mul(self.max_pixels);
        let most = most.saturating_add(BESIDE_PIXELS);
        if about.is_file() {
            return if about.len() <= most {
                Ok(most)
            } else {
                Err(longer_than(most))
            };
        }
        if is_pipe(about) {
            return Ok(most.min(LONGEST_PIPE));
        }
        Err(io::Error::other("is a device, not a file"))
    }
}

/// Returns the error for a file that is broken or does not follow its format.
pub(super) fn broken(format: &str, why: impl fmt::Display) -> Error {
    let message = format!("cannot be read as {format}: {why}");
    Error::new(ErrorKind::Unreadable, message)
}

fn longer_than(most: u64) -> io::Error {
    let message = format!(
        "is longer than {most} bytes, the most for a picture within the limit of pixels; see `--max-pixels`"
    );
    io::Error::new(io::ErrorKind::FileTooLarge, message)
}

/// Returns the sizes of the lossy frames in a WebP file, which may differ from that of its canvas.
fn webp_frames(file: &[u8]) -> Vec<[u32; 2]> {
    let mut sizes = Vec::new();
    let mut rest = file.get(12..).unwrap_or_default();
    while let Some((head, after)) = rest.split_first_chunk::<8>() {
        let [a, b, c, d, length @ ..] = *head;
        let length = u32::from_le_bytes(length) as usize;
        let (data, after) = after.split_at(length.min(after.len()));
        // A frame of an animation begins with 16 bytes of its own; chunks follow.
        if [a, b, c, d] == *b"ANMF" {
            sizes.extend(webp_frames(data.get(4..).unwrap_or_default()));
        }
        if [a, b, c, d] == *b"VP8 "
            && let Some([w0, w1, h0, h1]) = data.get(6..10)
        {
            let side = |low: &u8, high: &u8| u32::from(u16::from_le_bytes([*low, *high]) & 0x3fff);
            sizes.push([side(w0, w1), side(h0, h1)]);
        }
        rest = after.get(length % 2..).unwrap_or_default();
    }
    sizes
}
