//! The extent of a table's rows: enough to skip a table if all of them are far away.

use glam::DVec3;

use crate::data::table::layout::Block;

/// The bounding box of the centers or ends, and the largest radius.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Extent {
    low: DVec3,
    high: DVec3,
    radius: f64,
}

impl Extent {
    /// The extent of no rows.
    pub(super) const NONE: Self = Self {
        low: DVec3::INFINITY,
        high: DVec3::NEG_INFINITY,
        radius: 0.0,
    };

    /// Adds rows; NaN is ignored.
    pub(super) fn add(&mut self, block: &Block) {
        let [x, y, z, to_x, to_y, to_z, radius, ..] = &block.columns;
        for (ends, low, high) in [
            ([x, to_x], &mut self.low.x, &mut self.high.x),
            ([y, to_y], &mut self.low.y, &mut self.high.y),
            ([z, to_z], &mut self.low.z, &mut self.high.z),
        ] {
            for numbers in ends {
                // Written to compile to one instruction.
                *low = fold(
                    numbers,
                    *low,
                    |low, number| if number < low { number } else { low },
                );
                *high = fold(numbers, *high, greater);
            }
        }
        self.radius = fold(radius, self.radius, greater);
    }

    /// Adds a radius.
    pub(super) fn add_radius(&mut self, radius: f64) {
        self.radius = greater(self.radius, radius);
    }

    /// Returns true if the distance of a point from a center may be less than the radius there. If
    /// not, `(point - center).length() < radius` is false as computed for each of the spheres: no
    /// step here gives more than the same step there, because rounding is monotone. For a cylinder,
    /// whose axis lies between its ends, this holds up to rounding.
    pub(super) fn may_enclose(&self, point: DVec3) -> bool {
        let outside = (self.low - point).max(point - self.high);
        outside.max(DVec3::ZERO).length() < self.radius
    }
}

fn greater(one: f64, number: f64) -> f64 {
    if number > one { number } else { one }
}

/// Folds all numbers into `first`, in eight independent lanes.
#[inline(always)]
fn fold(numbers: &[f64], first: f64, fold: impl Fn(f64, f64) -> f64) -> f64 {
    let (eights, rest) = numbers.as_chunks::<8>();
    let mut lanes = [first; 8];
    for eight in eights {
        for (lane, number) in lanes.iter_mut().zip(eight) {
            *lane = fold(*lane, *number);
        }
    }
    let all = lanes.iter().chain(rest);
    all.fold(first, |folded, number| fold(folded, *number))
}
