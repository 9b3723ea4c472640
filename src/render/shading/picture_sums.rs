//! The sums of all pixels of a picture whose light follows paths, to which rounds add samples.

use std::ops::Range;

use super::pixel_sums::PixelSums;
use crate::{diagnostic::error::Error, film::size::Size, image_file::too_large};

/// Columns and rows of a picture, counted from the top left.
pub(crate) type PixelArea = (Range<u32>, Range<u32>);

/// The sums of the pixels of a picture whose light follows paths, or of a part of it.
///
/// Samples can be added at any time: the picture is always that of all samples at once.
#[derive(Clone, Debug, PartialEq)]
pub struct PictureSums {
    /// The hash of what the samples depend on.
    hash: String,
    /// The columns and rows, counted from the top left. Blocks of pixels that end together are whole.
    area: PixelArea,
    /// Row by row.
    pixels: Vec<PixelSums>,
}

impl PictureSums {
    /// The largest number of pixels: two gigabytes.
    pub const MOST_PIXELS: u64 = 1 << 24;

    /// Creates the sums of no samples.
    ///
    /// # Errors
    ///
    /// More pixels than [`PictureSums::MOST_PIXELS`], and too little memory.
    pub(crate) fn new(area: PixelArea, size: Size) -> Result<Self, Error> {
        let count = area.0.len() as u64 * area.1.len() as u64;
        if count > Self::MOST_PIXELS {
            return Err(Error::refused(format!(
                "a picture of {count} pixels is too large to keep the sums of its samples; at most {} \
                 pixels are possible",
                Self::MOST_PIXELS
            )));
        }
        let mut pixels = Vec::new();
        pixels
            .try_reserve_exact(count as usize)
            .map_err(|error| too_large(size).caused_by(error))?;
        pixels.resize(count as usize, PixelSums::default());
        Ok(Self {
            hash: String::new(),
            area,
            pixels,
        })
    }

    /// Creates the sums of a small part of a picture: those that are known, and no samples elsewhere.
    pub(super) fn within(area: PixelArea, known: Option<&Self>) -> Self {
        let mut pixels = Vec::new();
        for row in area.1.clone() {
            match known.and_then(|known| known.row(row, &area.0)) {
                Some(known) => pixels.extend_from_slice(known),
                None => pixels.resize(pixels.len() + area.0.len(), PixelSums::default()),
            }
        }
        Self {
            hash: String::new(),
            area,
            pixels,
        }
    }

    /// Sets the hash of what the samples depend on.
    pub(crate) fn with_hash(self, hash: String) -> Self {
        Self { hash, ..self }
    }

    /// The hash of what the samples depend on.
    pub(crate) fn hash(&self) -> &str {
        &self.hash
    }

    /// The largest number of samples of a pixel.
    pub fn samples(&self) -> u32 {
        let counts = self.pixels.iter().map(|sums| sums.count);
        counts.max().unwrap_or_default()
    }

    pub(super) const fn columns(&self) -> &Range<u32> {
        &self.area.0
    }

    /// Returns some pixels of a row, if all of them are known.
    pub(super) fn row(&self, row: u32, columns: &Range<u32>) -> Option<&[PixelSums]> {
        let (all, rows) = &self.area;
        let line = row.checked_sub(rows.start)? as usize;
        let first = columns.start.checked_sub(all.start)? as usize;
        let last = columns.end.checked_sub(all.start)? as usize;
        let mut lines = self.pixels.chunks_exact(all.len());
        lines.nth(line)?.get(first..last)
    }

    /// Returns the pixels of parts of the rows; `end_of` returns the end of the part that a row is in.
    pub(super) fn parts(
        &mut self,
        end_of: impl Fn(u32) -> u32,
    ) -> Vec<(Range<u32>, &mut [PixelSums])> {
        let (columns, rows) = &self.area;
        let (mut parts, mut rest, mut row) = (Vec::new(), &mut self.pixels[..], rows.start);
        while row < rows.end {
            let end = end_of(row).clamp(row + 1, rows.end);
            let (part, others) = rest.split_at_mut((end - row) as usize * columns.len());
            parts.push((row..end, part));
            (rest, row) = (others, end);
        }
        parts
    }

    /// Passes on the bytes of the rows.
    pub(crate) fn each_row(
        &self,
        mut each: impl FnMut(&[u8]) -> Result<(), Error>,
    ) -> Result<(), Error> {
        self.pixels.chunks(self.area.0.len()).try_for_each(|row| {
            let bytes: Vec<_> = row.iter().map(PixelSums::bytes).collect();
            each(bytes.as_flattened())
        })
    }

    /// The number of bytes of all rows.
    pub(crate) fn bytes(&self) -> usize {
        self.pixels.len() * PixelSums::BYTES
    }

    /// Takes over pixels from the bytes of rows, beginning at this byte of all.
    pub(crate) fn set_bytes(&mut self, first: usize, bytes: &[u8]) {
        let pixels = self.pixels.iter_mut().skip(first / PixelSums::BYTES);
        for (sums, bytes) in pixels.zip(bytes.as_chunks().0) {
            *sums = PixelSums::of_bytes(bytes);
        }
    }
}
