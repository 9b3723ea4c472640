//! Structural similarity: Wang, Bovik, Sheikh and Simoncelli, "Image Quality Assessment: From
//! Error Visibility to Structural Similarity", IEEE Transactions on Image Processing 13 (4), 2004.

use crate::{
    compare::{
        plane::{Filter, Plane, Region, Taps},
        values::WHITE,
    },
    simd::isa::Isa,
};

/// The reach of their window of 11 by 11 pixels.
const REACH: usize = 5;
const SIGMA: f64 = 1.5;
const C1: f64 = (0.01 * WHITE) * (0.01 * WHITE);
const C2: f64 = (0.03 * WHITE) * (0.03 * WHITE);

/// The windows that lie entirely in a picture. If a side is shorter than 11 pixels, so is the
/// window.
#[derive(Clone, Debug)]
pub(super) struct Windows {
    across: Taps,
    down: Taps,
    /// The centers of the windows.
    middles: Region,
}

impl Windows {
    pub(super) fn new((width, height): (usize, usize)) -> Self {
        let reach = |side: usize| REACH.min((side - 1) / 2);
        let taps =
            |reach| Taps::new(reach, |x| libm::exp(-x * x / (2.0 * SIGMA * SIGMA))).normalized();
        let (across, down) = (reach(width), reach(height));
        Self {
            across: taps(across),
            down: taps(down),
            middles: Region {
                left: across,
                top: down,
                right: width - across,
                bottom: height - down,
            },
        }
    }

    /// Returns the centers that lie in a region.
    fn within(&self, region: Region) -> Region {
        Region {
            left: self.middles.left.max(region.left),
            top: self.middles.top.max(region.top),
            right: self.middles.right.min(region.right),
            bottom: self.middles.bottom.min(region.bottom),
        }
    }

    /// Returns the number of windows with their centers in a region.
    pub(super) fn count(&self, region: Region) -> u64 {
        let middles = self.within(region);
        middles.width() as u64 * middles.height() as u64
    }

    /// Returns the total number.
    pub(super) fn total(&self) -> u64 {
        self.count(self.middles)
    }

    /// Returns the sum of the similarities of two channels over all windows with their centers in a
    /// region.
    pub(super) fn sum(&self, a: &Plane, b: &Plane, region: Region, isa: Isa) -> f64 {
        let middles = self.within(region);
        let [squares, products] = Plane::from_planes([a, b], |[a, b]| [a * a + b * b, a * b]);
        let mut filters = [a, b, &squares, &products].map(|plane| (plane, Filter::new(isa)));
        let (from, width) = (middles.left - a.region().left, middles.width());
        let mut total = 0.0;
        for y in middles.top..middles.bottom {
            let [mean_a, mean_b, squares, products] = filters.each_mut().map(|(plane, filter)| {
                let lines = filter.down(plane, y, &self.down);
                lines.across(from, width, &self.across)
            });
            for x in 0..width {
                let (a, b) = (mean_a[x], mean_b[x]);
                let (means, product) = (a * a + b * b, a * b);
                let (variances, covariance) = (squares[x] - means, products[x] - product);
                total += (2.0 * product + C1) * (2.0 * covariance + C2)
                    / ((means + C1) * (variances + C2));
            }
        }
        total
    }
}
