//! Counts of pixels that differ.

use crate::compare::{plane::Region, values::Channels};

/// The count of pixels that differ, and their differences.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Tally {
    pub(super) different: u64,
    /// Number of these that are not finite in one of the pictures.
    pub(super) not_finite: u64,
    /// The row and column of the first in reading order.
    pub(super) first: Option<(usize, usize)>,
    /// The smallest region that contains all of them.
    pub(super) bounds: Option<Region>,
    /// The largest difference, in steps of a channel, as are the sums over all channels.
    pub(super) largest: f64,
    pub(super) sum: f64,
    pub(super) squares: f64,
}

impl Tally {
    /// Counts the pixels of a region by the differences of their channels.
    pub(super) fn of(deltas: &Channels, region: Region) -> Self {
        let mut tally = Self::default();
        for y in region.top..region.bottom {
            let rows = deltas
                .each_ref()
                .map(|plane| plane.row_from(region.left, y));
            for x in 0..region.width() {
                tally.add(region.left + x, y, rows.map(|row| row[x]));
            }
        }
        tally
    }

    fn add(&mut self, x: usize, y: usize, deltas: [f64; 4]) {
        let largest = deltas.into_iter().fold(0.0, f64::max);
        if largest == 0.0 {
            return;
        }
        let pixel = Region {
            left: x,
            top: y,
            right: x + 1,
            bottom: y + 1,
        };
        self.merge(&Self {
            different: 1,
            not_finite: u64::from(largest == f64::INFINITY),
            first: Some((y, x)),
            bounds: Some(pixel),
            largest,
            sum: deltas.iter().sum(),
            squares: deltas.iter().map(|delta| delta * delta).sum(),
        });
    }

    /// Adds the counts of another region.
    pub(super) fn merge(&mut self, other: &Self) {
        self.different += other.different;
        self.not_finite += other.not_finite;
        self.first = self.first.into_iter().chain(other.first).min();
        let bounds = self.bounds.into_iter().chain(other.bounds);
        self.bounds = bounds.reduce(|one, other| Region {
            left: one.left.min(other.left),
            top: one.top.min(other.top),
            right: one.right.max(other.right),
            bottom: one.bottom.max(other.bottom),
        });
        self.largest = self.largest.max(other.largest);
        self.sum += other.sum;
        self.squares += other.squares;
    }
}
