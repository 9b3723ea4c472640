//! What a picture shows of each geometry: how many pixels, where, and how far away.

use crate::{
    film::{Film, colors::NOTHING, crop::Crop},
    parallel::Pool,
};

/// What a picture shows of one geometry, by the rays through the centers of its pixels.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Seen {
    /// The index of the geometry in the world: its number in the layer of ids.
    pub id: usize,
    /// In how many pixels it is seen.
    pub pixels: u64,
    /// The least rectangle with all of them, in pixels from the top left of the whole picture: its
    /// first column and row, its width and height.
    pub bounds: [u32; 4],
    /// The smallest distance along a ray at which it is seen.
    pub nearest: f64,
    /// The largest one.
    pub farthest: f64,
}

impl Seen {
    /// Adds what is seen of the same geometry elsewhere.
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

/// Sums up the hits of the bands of a picture, from the top.
#[derive(Clone, Debug)]
pub(crate) struct Tally {
    /// The column of the picture that bands begin in.
    left: u32,
    /// The row of the picture that the next band begins in.
    top: u32,
    /// For each geometry its place in `seen`, or [`NOTHING`].
    places: Vec<u32>,
    seen: Vec<Seen>,
}

impl Tally {
    /// Creates the tally of a part of a picture, of a world of this many geometries.
    pub(crate) fn new(geometries: usize, crop: Crop) -> Self {
        Self {
            left: crop.column(),
            top: crop.row(),
            places: vec![NOTHING; geometries],
            seen: Vec::new(),
        }
    }

    /// Adds a band.
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

    /// Returns all geometries that are seen, in the order of the world.
    pub(crate) fn finish(mut self) -> Vec<Seen> {
        self.seen.sort_unstable_by_key(|seen| seen.id);
        self.seen
    }
}

/// The geometries in a row of a band, run by run of the same one.
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
