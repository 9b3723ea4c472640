//! Statistics of each visible geometry: number of pixels, bounds and distance.

use crate::{
    film::{Film, colors::NOTHING, crop::Crop},
    parallel::Pool,
};

/// The part of a picture that shows one geometry, by the rays through the centers of its pixels.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Seen {
    /// The index of the geometry in the world, as in the id layer.
    pub id: usize,
    /// The number of pixels that show the geometry.
    pub pixels: u64,
    /// The bounding rectangle of these pixels, from the top left of the whole picture: first
    /// column, first row, width and height.
    pub bounds: [u32; 4],
    /// The smallest distance along a ray.
    pub nearest: f64,
    /// The largest distance along a ray.
    pub farthest: f64,
}

impl Seen {
    /// Merges other pixels of the same geometry.
    fn merge(&mut self, other: &Self) {
        let ([x, y, width, height], [left, top, across, down]) = (self.bounds, other.bounds);
        let (right, bottom) = ((x + width).max(left + across), (y + height).max(top + down));
        let (left, top) = (x.min(left), y.min(top));
        self.pixels += other.pixels;
        self.bounds = [left, top, right - left, bottom - top];
        self.nearest = self.nearest.min(other.nearest);
        self.farthest = self.farthest.max(other.farthest);
    }
}

/// Accumulates the hits of the bands of a picture, from the top.
#[derive(Clone, Debug)]
pub(crate) struct Tally {
    /// The first column of the bands in the picture.
    left: u32,
    /// The first row of the next band in the picture.
    top: u32,
    /// The index in `seen` of each geometry, or [`NOTHING`].
    places: Vec<u32>,
    seen: Vec<Seen>,
}

impl Tally {
    /// Creates an empty tally for a part of a picture, for a world with this many geometries.
    pub(crate) fn new(geometries: usize, crop: Crop) -> Self {
        Self {
            left: crop.column(),
            top: crop.row(),
            places: vec![NOTHING; geometries],
            seen: Vec::new(),
        }
    }

    /// Adds the hits of a band.
    pub(crate) fn add(&mut self, film: &Film, pool: &Pool) {
        let (left, top) = (self.left, self.top);
        let rows = pool.map(0..film.height(), |row| row_of(film, row, left, top));
        rows.iter().flatten().for_each(|seen| self.merge(seen));
        self.top += film.height() as u32;
    }

    fn merge(&mut self, seen: &Seen) {
        let Some(place) = self.places.get_mut(seen.id) else {
            return;
        };
        match self.seen.get_mut(*place as usize) {
            Some(known) => known.merge(seen),
            None => {
                *place = self.seen.len() as u32;
                self.seen.push(seen.clone());
            }
        }
    }

    /// Returns all visible geometries, in the order of the world.
    pub(crate) fn finish(mut self) -> Vec<Seen> {
        self.seen.sort_unstable_by_key(|seen| seen.id);
        self.seen
    }
}

/// Returns the geometries in a row of a band, one entry per run of the same geometry.
fn row_of(film: &Film, row: usize, left: u32, top: u32) -> Vec<Seen> {
    let mut column = left;
    let mut runs = Vec::new();
    for run in film.row(row) {
        let mut t = run.t;
        for same in run.ids.chunk_by(|one, other| one == other) {
            let (here, rest) = t.split_at(same.len());
            t = rest;
            let width = same.len() as u32;
            if same[0] != NOTHING {
                runs.push(Seen {
                    id: same[0] as usize,
                    pixels: width.into(),
                    bounds: [column, top + row as u32, width, 1],
                    nearest: here.iter().copied().fold(f64::INFINITY, f64::min),
                    farthest: here.iter().copied().fold(0.0, f64::max),
                });
            }
            column += width;
        }
    }
    runs
}
