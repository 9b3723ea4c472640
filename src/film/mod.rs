//! What a picture is made of: sizes, samples, pixels.

pub(crate) mod colors;
pub(crate) mod crop;
pub(crate) mod samples;
pub(crate) mod size;

use std::{
    mem,
    sync::{Mutex, MutexGuard, PoisonError},
};

pub use crop::Crop;
pub use samples::{Samples, SamplesError};
pub use size::SizeError;

use crate::film::{
    colors::{ColorTable, Mixed, NOTHING},
    size::Size,
};

/// A band of a picture: some rows of it, from the top, with what each pixel sees.
///
/// A pixel holds the index of the geometry that it sees; its color derives from that. Where its
/// samples see several, it holds the number of what became of them, which follow on the indices.
/// A band comes in pieces, from left to right, as each is the work of one thread.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Film {
    pieces: Vec<Piece>,
}

/// Some columns of a band.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Piece {
    width: usize,
    indices: Vec<u32>,
    /// How many geometries there are: the number of the first of `mixed`.
    geometries: u32,
    mixed: Vec<Mixed>,
}

/// Memory of pieces that are gone, for the next ones, of this picture or another: what one thread
/// allocates and another frees goes back to the system, and to get it anew takes a part of the
/// time that drawing does.
static SPARE: Mutex<Vec<Vec<u32>>> = Mutex::new(Vec::new());
/// How many are kept: four megabytes, if there ever are as many.
const MOST_SPARE: usize = 32;

fn spare() -> MutexGuard<'static, Vec<Vec<u32>>> {
    SPARE.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Drop for Piece {
    fn drop(&mut self) {
        let mut spare = spare();
        if spare.len() < MOST_SPARE {
            spare.push(mem::take(&mut self.indices));
        }
    }
}

impl Piece {
    /// Columns of a band in which nothing is seen yet, of a world of so many geometries.
    pub(crate) fn new(width: u32, height: u32, geometries: usize) -> Self {
        let width = width as usize;
        let mut indices = spare().pop().unwrap_or_default();
        indices.clear();
        indices.resize(width * height as usize, NOTHING);
        Self {
            width,
            indices,
            geometries: u32::try_from(geometries).unwrap_or(NOTHING),
            mixed: Vec::new(),
        }
    }

    /// Adds what the pixels are whose numbers follow on the indices of geometries, in that order.
    pub(crate) fn mix(&mut self, mixed: impl Iterator<Item = Mixed>) {
        self.mixed.extend(mixed);
    }

    /// What the ray through the center of a pixel sees that holds a number.
    pub(crate) fn center(&self, number: u32) -> u32 {
        self.mixed(number).map_or(number, |mixed| mixed.center)
    }

    /// What a pixel is that holds such a number.
    pub(crate) fn mixed(&self, number: u32) -> Option<&Mixed> {
        self.mixed
            .get(number.checked_sub(self.geometries)? as usize)
    }

    /// The rows, from the top: the index of the geometry that each pixel sees.
    pub(crate) fn rows_mut(&mut self) -> impl ExactSizeIterator<Item = &mut [u32]> {
        self.indices.chunks_exact_mut(self.width)
    }

    /// How many pixels it has.
    pub(crate) fn pixels(&self) -> usize {
        self.indices.len()
    }
}

impl Film {
    /// Adds what lies to the right, which is as high.
    pub(crate) fn push(&mut self, piece: Piece) {
        self.pieces.push(piece);
    }

    /// Adds all that another one has, to the right.
    pub(crate) fn extend(&mut self, other: Self) {
        self.pieces.extend(other.pieces);
    }

    /// How many columns there are.
    pub(crate) fn width(&self) -> usize {
        self.pieces.iter().map(|piece| piece.width).sum()
    }

    /// The number of rows.
    pub(crate) fn height(&self) -> usize {
        let height = |piece: &Piece| piece.indices.len() / piece.width;
        self.pieces.first().map_or(0, height)
    }

    /// What each pixel of a row sees, from the left, in runs that lie together in memory.
    pub(crate) fn row(&self, row: usize) -> impl Iterator<Item = (&Piece, &[u32])> {
        let pieces = self.pieces.iter();
        pieces.map(move |piece| (piece, &piece.indices[row * piece.width..][..piece.width]))
    }

    /// What each pixel sees, row by row from the top left, in runs that lie together in memory.
    pub(crate) fn runs(&self) -> impl Iterator<Item = (&Piece, &[u32])> {
        (0..self.height()).flat_map(|row| self.row(row))
    }

    /// Writes what `table` holds for each pixel behind what stands in `out`.
    pub(crate) fn append<const N: usize>(&self, table: &ColorTable<N>, out: &mut Vec<u8>) {
        /// Pixels that are compared at once, without a branch for each.
        const GROUP: usize = 16;
        // What a flat picture mostly is: a group of one color, most often that of the last.
        let (mut last, mut pattern) = (NOTHING, [table.of(NOTHING); GROUP]);
        for (piece, run) in self.runs() {
            let of = |index: u32| match piece.mixed(index) {
                Some(mixed) => table.mixed(mixed),
                None => table.of(index),
            };
            out.reserve(run.len() * N);
            let mut groups = run.chunks_exact(GROUP);
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

/// A finished picture: bytes of red, green and blue, row by row from the top left.
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

    /// The width and height.
    pub fn size(&self) -> Size {
        self.size
    }

    /// Red, green and blue of every pixel, row by row from the top left: `3 * width * height`
    /// bytes.
    pub fn pixels(&self) -> &[u8] {
        &self.pixels
    }

    /// Red, green and blue of a pixel, `row` counted from the top; `None` outside of the
    /// picture.
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
        for (left, right) in left.rows_mut().zip(right.rows_mut()) {
            for index in left.iter_mut().chain(right) {
                *index = see();
                seen.push(*index);
            }
        }
        let mut film = Film::default();
        pieces.into_iter().for_each(|piece| film.push(piece));
        assert!(film.width() == 101 && film.runs().flat_map(|(_, run)| run).eq(&seen));
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
    fn memory_of_another_piece_shows_nothing_of_it() {
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
    fn an_image_gives_its_pixels_from_the_top_left() {
        let image = Image::new(Size::new(2, 1).unwrap(), vec![1, 2, 3, 4, 5, 6]);
        assert_eq!(image.pixel(1, 0), Some([4, 5, 6]));
        assert_eq!(image.pixel(2, 0), None);
        assert_eq!(image.pixel(0, 1), None);
    }
}
