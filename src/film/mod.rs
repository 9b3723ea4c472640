//! The parts of a picture: sizes, samples, pixels.

pub(crate) mod colors;
pub(crate) mod crop;
pub(crate) mod light;
pub(crate) mod outlines;
pub(crate) mod parts;
pub(crate) mod resolve;
pub(crate) mod samples;
pub(crate) mod size;

use std::{
    mem,
    sync::{Mutex, PoisonError},
};

pub use crop::Crop;
pub use outlines::Outlines;
pub use samples::{SampleCount, Samples, SamplesError};
pub use size::SizeError;

use crate::film::{
    colors::{ColorTable, NOTHING},
    light::{LightPlanes, LightRun},
    resolve::Resolved,
    size::Size,
};
use crate::tracer::tone::Tone;

/// The data that a film keeps of the ray through the center of each pixel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Centers {
    /// Nothing, unless that ray is the only sample.
    #[default]
    Unneeded,
    /// The geometry that the ray hits.
    Ids,
    /// The geometry and the t of the hit.
    Hits,
}

/// The light that a film keeps of each pixel of a lit picture, or of one with outlines.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) enum Wanted {
    /// None: the hits of center rays are all that is needed.
    Hits,
    /// The bytes of its color.
    Bytes(Tone),
    /// Its light.
    #[default]
    Light,
    /// Its light, even of a flat picture.
    Parts,
}

/// The pixels of a piece of a lit picture, or of one with outlines.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Lit {
    /// The bytes of their colors, if these are all that is needed.
    Bytes(Vec<[u8; 3]>),
    Light(Box<LightPlanes>),
}

/// A band of a picture: some of its rows, as pieces from left to right, each rendered by one
/// thread.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Film {
    pieces: Vec<Piece>,
}

/// Some columns of a band, in planes of one number per pixel.
///
/// A pixel holds the index of the geometry that it shows, which determines its color. If its
/// samples show several, it holds the number of a resolved pixel. These numbers start after the
/// last index.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Piece {
    width: usize,
    pixels: Plane<u32>,
    /// The number of geometries, which is also the number of the first entry of `resolved`.
    geometries: u32,
    resolved: Vec<Resolved>,
    /// The geometry that the center ray of each pixel hits, if pixels have several samples.
    centers: Option<Plane<u32>>,
    /// The t of the hits of these rays, infinite for a miss. Empty unless requested.
    t: Plane<f64>,
    /// The light of each pixel, unless the picture is flat.
    lit: Option<Lit>,
}

/// A run of neighboring pixels in a row.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Run<'a> {
    piece: &'a Piece,
    /// The index of the geometry that each pixel shows, [`NOTHING`], or the number of a
    /// resolved pixel.
    pub(crate) pixels: &'a [u32],
    /// The geometry that the center ray of each pixel hits, if requested.
    pub(crate) ids: &'a [u32],
    /// The t of these hits, if requested.
    pub(crate) t: &'a [f64],
    /// The light of each pixel, unless the picture is flat or only its bytes are known.
    pub(crate) light: Option<LightRun<'a>>,
    /// The bytes of each pixel, if they are known.
    bytes: &'a [[u8; 3]],
}

impl<'a> Run<'a> {
    /// Returns the resolved pixel with this number.
    pub(crate) fn resolved(&self, number: u32) -> Option<&'a Resolved> {
        let place = number.checked_sub(self.piece.geometries)?;
        self.piece.resolved.get(place as usize)
    }
}

/// One number for each pixel of a piece.
#[derive(Clone, Debug, PartialEq)]
struct Plane<T: Pooled>(Vec<T>);

/// Numbers whose memory is kept when a piece is dropped, and reused for new ones of any picture.
/// Memory that one thread allocates and another frees returns to the system, and requesting it again
/// takes a noticeable part of the render time.
trait Pooled: Copy + 'static {
    fn pool() -> &'static Mutex<Vec<Vec<Self>>>;
}

impl Pooled for u32 {
    fn pool() -> &'static Mutex<Vec<Vec<Self>>> {
        static POOL: Mutex<Vec<Vec<u32>>> = Mutex::new(Vec::new());
        &POOL
    }
}

impl Pooled for f64 {
    fn pool() -> &'static Mutex<Vec<Vec<Self>>> {
        static POOL: Mutex<Vec<Vec<f64>>> = Mutex::new(Vec::new());
        &POOL
    }
}

/// The maximum number of pooled planes of a kind: at most eight megabytes in total.
const MOST_POOLED: usize = 32;

impl<T: Pooled> Plane<T> {
    /// Creates a plane of equal numbers.
    fn new(count: usize, number: T) -> Self {
        let mut pool = T::pool().lock().unwrap_or_else(PoisonError::into_inner);
        let mut plane = pool.pop().unwrap_or_default();
        drop(pool);
        plane.clear();
        plane.resize(count, number);
        Self(plane)
    }
}

impl<T: Pooled> Drop for Plane<T> {
    fn drop(&mut self) {
        let mut pool = T::pool().lock().unwrap_or_else(PoisonError::into_inner);
        if pool.len() < MOST_POOLED && self.0.capacity() > 0 {
            pool.push(mem::take(&mut self.0));
        }
    }
}

impl Piece {
    /// Creates a piece that shows nothing yet, for a world with this many geometries.
    pub(crate) fn new(width: u32, height: u32, geometries: usize) -> Self {
        let width = width as usize;
        Self {
            width,
            pixels: Plane::new(width * height as usize, NOTHING),
            geometries: u32::try_from(geometries).unwrap_or(NOTHING),
            resolved: Vec::new(),
            centers: None,
            t: Plane(Vec::new()),
            lit: None,
        }
    }

    /// Sets the light of each pixel.
    pub(crate) fn light(&mut self, lit: Lit) {
        self.lit = Some(lit);
    }

    /// Appends resolved pixels. Their numbers follow the indices of the geometries, in that order.
    pub(crate) fn resolve(&mut self, resolved: impl Iterator<Item = Resolved>) {
        self.resolved.extend(resolved);
    }

    /// The rows of pixels, from the top.
    pub(crate) fn rows_mut(&mut self) -> Vec<&mut [u32]> {
        self.pixels.0.chunks_exact_mut(self.width).collect()
    }

    /// Returns the rows of the geometries hit by center rays and, if `centers` requests them, of
    /// the t of these hits, both from the top. If the center is the only sample of a pixel, the former
    /// are the rows of pixels.
    pub(crate) fn hits_mut(
        &mut self,
        only_centers: bool,
        centers: Centers,
    ) -> (Vec<&mut [u32]>, Vec<&mut [f64]>) {
        let count = self.pixels();
        let ids = match only_centers {
            true => &mut self.pixels,
            false => self.centers.insert(Plane::new(count, NOTHING)),
        };
        if centers == Centers::Hits {
            self.t = Plane::new(count, f64::INFINITY);
        }
        (
            ids.0.chunks_exact_mut(self.width).collect(),
            self.t.0.chunks_exact_mut(self.width).collect(),
        )
    }

    /// The number of pixels.
    pub(crate) fn pixels(&self) -> usize {
        self.pixels.0.len()
    }

    fn row(&self, row: usize) -> Run<'_> {
        let pixels = row * self.width..(row + 1) * self.width;
        let (bytes, light) = match &self.lit {
            None => Default::default(),
            Some(Lit::Bytes(bytes)) => (&bytes[pixels.clone()], None),
            Some(Lit::Light(light)) => (&[][..], Some(light.run(pixels.clone()))),
        };
        Run {
            piece: self,
            light,
            bytes,
            ids: &self.centers.as_ref().unwrap_or(&self.pixels).0[pixels.clone()],
            t: self.t.0.get(pixels.clone()).unwrap_or_default(),
            pixels: &self.pixels.0[pixels],
        }
    }
}

impl Film {
    /// Appends a piece of the same height on the right.
    pub(crate) fn push(&mut self, piece: Piece) {
        self.pieces.push(piece);
    }

    /// Appends the pieces of another film on the right.
    pub(crate) fn extend(&mut self, other: Self) {
        self.pieces.extend(other.pieces);
    }

    /// The number of columns.
    pub(crate) fn width(&self) -> usize {
        self.pieces.iter().map(|piece| piece.width).sum()
    }

    /// The number of rows.
    pub(crate) fn height(&self) -> usize {
        let height = |piece: &Piece| piece.pixels() / piece.width;
        self.pieces.first().map_or(0, height)
    }

    /// Returns the pixels of a row, from the left, in runs that are contiguous in memory.
    pub(crate) fn row(&self, row: usize) -> impl Iterator<Item = Run<'_>> {
        self.pieces.iter().map(move |piece| piece.row(row))
    }

    /// Returns the pixels row by row from the top left, in runs that are contiguous in memory.
    pub(crate) fn runs(&self) -> impl Iterator<Item = Run<'_>> {
        (0..self.height()).flat_map(|row| self.row(row))
    }

    /// Appends the bytes of each pixel of a lit picture to `out`, if they are known.
    pub(crate) fn append_lit(&self, out: &mut Vec<u8>) {
        for run in self.runs() {
            out.extend_from_slice(run.bytes.as_flattened());
        }
    }

    /// Appends the bytes in `table` of each pixel to `out`.
    pub(crate) fn append<const N: usize>(&self, table: &ColorTable<N>, out: &mut Vec<u8>) {
        /// The number of pixels that are compared at once, without a branch for each.
        const GROUP: usize = 16;
        // A flat picture is mostly groups of one color, usually the color of the previous group.
        let (mut last, mut pattern) = (NOTHING, [table.of(NOTHING); GROUP]);
        for run in self.runs() {
            let of = |index: u32| match run.resolved(index) {
                Some(resolved) => table.resolved(resolved),
                None => table.of(index),
            };
            out.reserve(run.pixels.len() * N);
            let mut groups = run.pixels.chunks_exact(GROUP);
            for group in &mut groups {
                let first = group[0];
                if group.iter().fold(0, |other, index| other | (index ^ first)) != 0 {
                    let mut bytes = [[0; N]; GROUP];
                    for (bytes, index) in bytes.iter_mut().zip(group) {
                        *bytes = of(*index);
                    }
                    out.extend_from_slice(bytes.as_flattened());
                    continue;
                }
                if first != last {
                    (last, pattern) = (first, [table.of(first); GROUP]);
                }
                out.extend_from_slice(pattern.as_flattened());
            }
            for &index in groups.remainder() {
                out.extend_from_slice(&of(index));
            }
        }
    }
}

/// A finished picture: red, green and blue bytes, row by row from the top left.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Image {
    size: Size,
    pixels: Vec<u8>,
}

impl Image {
    pub(crate) fn new(size: Size, pixels: Vec<u8>) -> Self {
        Self { size, pixels }
    }

    /// The number of columns.
    pub fn width(&self) -> u32 {
        self.size.width()
    }

    /// The number of rows.
    pub fn height(&self) -> u32 {
        self.size.height()
    }

    /// Returns the width and height.
    pub fn size(&self) -> Size {
        self.size
    }

    /// The red, green and blue bytes of every pixel, row by row from the top left: `3 * width *
    /// height` bytes.
    pub fn pixels(&self) -> &[u8] {
        &self.pixels
    }

    /// Returns the red, green and blue bytes of a pixel, or `None` outside the picture; `row` is
    /// counted from the top.
    pub fn pixel(&self, column: u32, row: u32) -> Option<[u8; 3]> {
        if column >= self.size.width() {
            return None;
        }
        let start = (row as usize * self.size.width() as usize + column as usize) * 3;
        let pixel = self.pixels.get(start..start + 3)?;
        pixel.try_into().ok()
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::tracer::{color::Color, geometry::Geometry, shape::sphere::Sphere, world::World};

    #[test]
    fn every_pixel_has_the_bytes_of_its_geometry() {
        // Runs of 1 to 40 pixels, so that groups hold one color or several.
        let mut run = (0, 0);
        let mut see = || {
            if run.1 == 0 {
                run = (run.0 + 1, run.0 * 7 % 40 + 1);
            }
            run.1 -= 1;
            if run.0 % 3 == 0 {
                NOTHING
            } else {
                run.0 % 3 - 1
            }
        };
        let mut pieces = [70, 31].map(|width| Piece::new(width, 3, 2));
        let mut seen = Vec::new();
        let [left, right] = &mut pieces;
        for (left, right) in left.rows_mut().into_iter().zip(right.rows_mut()) {
            for index in left.iter_mut().chain(right) {
                *index = see();
                seen.push(*index);
            }
        }
        let mut film = Film::default();
        pieces.into_iter().for_each(|piece| film.push(piece));
        assert!(film.width() == 101 && film.runs().flat_map(|run| run.pixels).eq(&seen));
        let color = |r: f64, g: f64, b: f64| Color::new(r / 255.0, g / 255.0, b / 255.0);
        let ball = Sphere::new(DVec3::ZERO, 1.0).unwrap();
        let colors = [color(1.0, 2.0, 3.0), color(4.0, 5.0, 6.0)];
        let geometries = colors.map(|color| Geometry::new(ball, color)).to_vec();
        let table = ColorTable::rgb8(&World::new(geometries, color(9.0, 9.0, 9.0)));
        let mut bytes = vec![7];
        film.append(&table, &mut bytes);
        let expected = seen.iter().flat_map(|&index| match index {
            NOTHING => [9, 9, 9],
            0 => [1, 2, 3],
            _ => [4, 5, 6],
        });
        assert!(bytes[1..].iter().copied().eq(expected));
        assert_eq!(bytes[0], 7);
    }

    #[test]
    fn a_new_piece_shows_nothing() {
        for size in [40, 7, 50] {
            let mut piece = Piece::new(size, 3, 2);
            for row in piece.rows_mut() {
                assert_eq!(row, vec![NOTHING; size as usize]);
                row.fill(1);
            }
            assert_eq!(piece.pixels(), 3 * size as usize);
        }
    }

    #[test]
    fn an_image_returns_its_pixels_from_the_top_left() {
        let image = Image::new(Size::new(2, 1).unwrap(), vec![1, 2, 3, 4, 5, 6]);
        assert_eq!(image.pixel(1, 0), Some([4, 5, 6]));
        assert_eq!(image.pixel(2, 0), None);
        assert_eq!(image.pixel(0, 1), None);
    }
}
