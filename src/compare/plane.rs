//! Values of a rectangle of pixels, and weighted sums of neighbors.

use crate::simd::{F64x8, Kernel, LANES, Simd, isa::Isa};

/// The maximum number of neighbors on each side that a filter uses.
pub(super) const REACH: usize = 10;

const MOST_TAPS: usize = 2 * REACH + 1;

/// A range of columns and rows in a picture, from the top left; the ends are exclusive.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Region {
    pub(super) left: usize,
    pub(super) top: usize,
    pub(super) right: usize,
    pub(super) bottom: usize,
}

impl Region {
    pub(super) fn width(self) -> usize {
        self.right.saturating_sub(self.left)
    }

    pub(super) fn height(self) -> usize {
        self.bottom.saturating_sub(self.top)
    }

    /// Returns the region extended by the reach of the filters, within the picture.
    pub(super) fn with_neighbors(self, (width, height): (usize, usize)) -> Self {
        Self {
            left: self.left.saturating_sub(REACH),
            top: self.top.saturating_sub(REACH),
            right: (self.right + REACH).min(width),
            bottom: (self.bottom + REACH).min(height),
        }
    }
}

/// A value for each pixel of a region.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Plane {
    region: Region,
    /// The distance between rows, in whole vectors.
    stride: usize,
    values: Vec<f64>,
}

impl Plane {
    pub(super) fn new(region: Region) -> Self {
        let stride = region.width().next_multiple_of(LANES);
        Self {
            region,
            stride,
            values: vec![0.0; stride * region.height()],
        }
    }

    /// Creates planes from others by calling `of` for each pixel.
    pub(super) fn from_planes<const N: usize, const M: usize>(
        planes: [&Self; N],
        of: impl Fn([f64; N]) -> [f64; M],
    ) -> [Self; M] {
        let mut made = [(); M].map(|()| Self::new(planes[0].region));
        for at in 0..planes[0].values.len() {
            let values = of(planes.map(|plane| plane.values[at]));
            for (made, value) in made.iter_mut().zip(values) {
                made.values[at] = value;
            }
        }
        made
    }

    pub(super) fn region(&self) -> Region {
        self.region
    }

    /// Returns a row of the picture, from the left of the region.
    pub(super) fn row(&self, y: usize) -> &[f64] {
        &self.values[(y - self.region.top) * self.stride..][..self.region.width()]
    }

    /// Returns a row of the picture, from a column.
    pub(super) fn row_from(&self, left: usize, y: usize) -> &[f64] {
        &self.row(y)[left - self.region.left..]
    }

    /// Returns true if every pixel has this value.
    pub(super) fn is_all(&self, number: f64) -> bool {
        let mut rows = self.region.top..self.region.bottom;
        rows.all(|y| self.row(y).iter().all(|value| *value == number))
    }

    pub(super) fn row_mut(&mut self, y: usize) -> &mut [f64] {
        &mut self.values[(y - self.region.top) * self.stride..][..self.region.width()]
    }

    /// Returns all values, including the padding of rows.
    pub(super) fn values_mut(&mut self) -> &mut [f64] {
        &mut self.values
    }
}

/// The weights of a pixel and its neighbors along a line, with the pixel in the middle.
#[derive(Clone, Debug)]
pub(super) struct Taps(Vec<f64>);

impl Taps {
    /// Creates weights by distance for `reach` neighbors on each side, at most [`REACH`].
    pub(super) fn new(reach: usize, weight: impl Fn(f64) -> f64) -> Self {
        let reach = reach.min(REACH);
        let distances = (0..=2 * reach).map(|at| at as f64 - reach as f64);
        Self(distances.map(weight).collect())
    }

    /// Returns the weights of a mean: their sum is 1.
    pub(super) fn normalized(self) -> Self {
        let sum = self.sum();
        self.scaled(1.0 / sum)
    }

    /// Returns the weights of a difference: the positive ones sum to 1, the negative ones to -1.
    pub(super) fn balanced(self) -> Self {
        let positive: f64 = self.0.iter().map(|weight| weight.max(0.0)).sum();
        let negative: f64 = self.0.iter().map(|weight| weight.min(0.0)).sum();
        let balance = |weight: f64| weight / if weight > 0.0 { positive } else { -negative };
        Self(self.0.into_iter().map(balance).collect())
    }

    /// Returns all weights times a number.
    pub(super) fn scaled(self, by: f64) -> Self {
        Self(self.0.into_iter().map(|weight| weight * by).collect())
    }

    pub(super) fn sum(&self) -> f64 {
        self.0.iter().sum()
    }

    fn reach(&self) -> usize {
        self.0.len() / 2
    }
}

/// A filter for the rows of a plane, first down the columns, then across. The outermost pixels of a
/// picture are repeated beyond its edges.
pub(super) struct Filter {
    isa: Isa,
    /// The current row, with room for neighbors on both sides.
    line: Vec<f64>,
    sums: Vec<f64>,
}

impl Filter {
    pub(super) fn new(isa: Isa) -> Self {
        Self {
            isa,
            line: Vec::new(),
            sums: Vec::new(),
        }
    }

    /// Filters row `y` of a plane: each pixel becomes a weighted sum over its column.
    pub(super) fn down(&mut self, plane: &Plane, y: usize, taps: &Taps) -> &mut Self {
        let region = plane.region;
        let last = region.bottom - 1;
        let mut offsets = [0; MOST_TAPS];
        for (at, offset) in offsets.iter_mut().enumerate().take(taps.0.len()) {
            let row = (y + at)
                .saturating_sub(taps.reach())
                .clamp(region.top, last);
            *offset = (row - region.top) * plane.stride;
        }
        let width = region.width();
        self.line.clear();
        self.line.resize(plane.stride + 2 * REACH + LANES, 0.0);
        self.isa.run(WeightedSums {
            source: &plane.values,
            offsets,
            weights: &taps.0,
            sums: &mut self.line[REACH..][..plane.stride],
        });
        let (left, right) = (self.line[REACH], self.line[REACH + width - 1]);
        self.line[..REACH].fill(left);
        self.line[REACH + width..].fill(right);
        self
    }

    /// Filters the row from [`Filter::down`]: each pixel becomes a weighted sum over the row.
    /// Returns `width` pixels, starting `from` columns from the left.
    pub(super) fn across(&mut self, from: usize, width: usize, taps: &Taps) -> &[f64] {
        let mut offsets = [0; MOST_TAPS];
        for (at, offset) in offsets.iter_mut().enumerate() {
            *offset = from + at + REACH - taps.reach();
        }
        self.sums.clear();
        self.sums.resize(width.next_multiple_of(LANES), 0.0);
        self.isa.run(WeightedSums {
            source: &self.line,
            offsets,
            weights: &taps.0,
            sums: &mut self.sums,
        });
        &self.sums[..width]
    }
}

/// Weighted sums: for each index, the sum of `source[offset + index]` over all offsets, each times
/// its weight.
struct WeightedSums<'a> {
    source: &'a [f64],
    offsets: [usize; MOST_TAPS],
    weights: &'a [f64],
    sums: &'a mut [f64],
}

impl Kernel for WeightedSums<'_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        for (at, sums) in self.sums.as_chunks_mut().0.iter_mut().enumerate() {
            let mut sum = simd.splat(0.0);
            for (offset, weight) in self.offsets.iter().zip(self.weights) {
                let values = &self.source[offset + at * LANES..];
                if let Some(values) = values.first_chunk() {
                    sum = sum + simd.load(values) * simd.splat(*weight);
                }
            }
            sum.store(sums);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_filter_sums_neighbors_and_extends_the_edge() {
        let region = Region {
            left: 5,
            top: 3,
            right: 18,
            bottom: 7,
        };
        let mut plane = Plane::new(region);
        let value = |x: usize, y: usize| (x * x + 31 * y % 7) as f64;
        for y in 3..7 {
            for (x, number) in plane.row_mut(y).iter_mut().enumerate() {
                *number = value(x + 5, y);
            }
        }
        let taps = Taps::new(2, |distance| 8.0 + distance);
        for isa in Isa::all() {
            let mut filter = Filter::new(isa);
            for y in 3..7 {
                let found = filter.down(&plane, y, &taps).across(1, 12, &taps);
                assert_eq!(found.len(), 12);
                for (x, found) in (6..).zip(found) {
                    let mut sum = 0.0;
                    for (down, across) in (0..5).flat_map(|i| (0..5).map(move |j| (i, j))) {
                        let at = |x: usize, d: usize, low, high| (x + d - 2).clamp(low, high);
                        let pixel = value(at(x, across, 5, 17), at(y, down, 3, 6));
                        sum += pixel * (6.0 + down as f64) * (6.0 + across as f64);
                    }
                    assert_eq!(*found, sum, "{isa} {x} {y}");
                }
            }
        }
    }

    #[test]
    fn neighbors_end_at_the_edge_of_the_picture() {
        let tile = Region {
            left: 4,
            top: 20,
            right: 12,
            bottom: 30,
        };
        let expected = Region {
            left: 0,
            top: 10,
            right: 15,
            bottom: 40,
        };
        assert_eq!(tile.with_neighbors((15, 100)), expected);
    }
}
