//! The neighbors of a sample.

use std::{mem, ops::Range};

use crate::render::outlines::runs::Run;

/// The number of samples side by side whose neighbors are found together. Tests use less.
pub(super) const PIECE: usize = if cfg!(test) { 4 } else { 64 };

/// Before the first place is noted.
const NO_PLACES: Range<usize> = Range {
    start: PIECE,
    end: 0,
};

/// Where a neighbor of a sample is. Those that are compared first are less: the nearest; at equal distances from the
/// top left.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(in crate::render) struct Neighbor {
    squared: u32,
    y: i16,
    x: i16,
}

impl Neighbor {
    /// Farther than any.
    const NONE: Self = Self {
        squared: u32::MAX,
        y: 0,
        x: 0,
    };

    /// Creates a neighbor from the columns and rows to it, at most 640.
    pub(super) const fn new([x, y]: [isize; 2]) -> Self {
        Self {
            squared: (x * x + y * y) as u32,
            y: y as i16,
            x: x as i16,
        }
    }

    /// Returns the columns and rows to it.
    pub(super) const fn apart(self) -> [isize; 2] {
        [self.x as isize, self.y as isize]
    }

    /// Returns the square of its distance.
    pub(super) fn squared(self) -> f64 {
        self.squared.into()
    }
}

/// The nearest neighbors, of some samples side by side, that see a geometry.
pub(super) struct NearestSamples {
    pub(super) id: u32,
    /// The samples that have one.
    places: Range<usize>,
    of_each: [Neighbor; PIECE],
}

impl Default for NearestSamples {
    fn default() -> Self {
        Self {
            id: 0,
            places: NO_PLACES,
            of_each: [Neighbor::NONE; PIECE],
        }
    }
}

impl NearestSamples {
    /// Notes a run in the row `y` below, for some columns, given the first one of all.
    pub(super) fn note(&mut self, columns: Range<usize>, run: &Run, y: isize, first: usize) {
        let places = columns.start - first..columns.end - first;
        self.places.start = self.places.start.min(places.start);
        self.places.end = self.places.end.max(places.end);
        let [start, last] = [run.columns().start, run.columns().end - 1];
        for (column, nearest) in columns.zip(&mut self.of_each[places]) {
            let x = column.clamp(start, last) as isize - column as isize;
            *nearest = Neighbor::new([x, y]).min(*nearest);
        }
    }

    /// Returns the samples and their neighbors, and forgets them.
    pub(super) fn take(&mut self) -> impl Iterator<Item = (usize, Neighbor)> {
        let places = mem::replace(&mut self.places, NO_PLACES);
        let all = places.clone().zip(&mut self.of_each[places]);
        let all = all.map(|(place, nearest)| (place, mem::replace(nearest, Neighbor::NONE)));
        all.filter(|(_, nearest)| *nearest != Neighbor::NONE)
    }
}
