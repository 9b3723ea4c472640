//! Splitting a run of items in two by the surface area heuristic over bins (I. Wald, On fast
//! construction of SAH-based bounding volume hierarchies, 2007).

use zerocopy::{FromBytes, Immutable, IntoBytes, KnownLayout};

use crate::simd::{F32x8, Kernel, LANES, Simd};

/// Number of bins along each axis, one more than the splits that are tried.
const BINS: usize = 16;

/// 2²³: adding it to an f32 rounds that to an integer, which the lowest bits then hold.
const INTEGER: f32 = 8_388_608.0;

/// A shape during the build: its box as in [`Bounds`], and the bits of its index in the world in
/// the last lane.
#[derive(Clone, Copy, Debug, FromBytes, Immutable, IntoBytes, KnownLayout)]
#[repr(C, align(32))]
pub(crate) struct Item([f32; LANES]);

/// A box: its lower corner from lane 0, its negated upper corner from lane 4. The minimum of two
/// boxes is thus the box around both. The other lanes are unused.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(32))]
pub(super) struct Bounds([f32; LANES]);

impl Item {
    /// The largest index whose bits are a finite f32: these are preserved.
    pub(crate) const LAST: usize = 0x7f7f_ffff;

    /// Creates an item from the center of its box, half its size and its index.
    pub(crate) fn new([x, y, z]: [f32; 3], [a, b, c]: [f32; 3], index: u32) -> Self {
        let index = f32::from_bits(index);
        Self([x - a, y - b, z - c, 0.0, -x - a, -y - b, -z - c, index])
    }

    pub(crate) const fn index(&self) -> u32 {
        self.0[7].to_bits()
    }

    #[inline(always)]
    fn bounds<S: Simd>(&self, simd: S) -> S::F32 {
        simd.load_f32(&self.0)
    }

    /// Returns twice the center of the box, from lane 0, and negated from lane 4.
    #[inline(always)]
    fn center<S: Simd>(&self, simd: S) -> S::F32 {
        let [a, b, c, _, d, e, f, _] = self.0;
        simd.load_f32(&[a - d, b - e, c - f, 0.0, d - a, e - b, f - c, 0.0])
    }
}

impl Bounds {
    const EMPTY: Self = Self([f32::INFINITY; LANES]);

    pub(super) const fn low(&self) -> [f32; 3] {
        [self.0[0], self.0[1], self.0[2]]
    }

    pub(super) const fn high(&self) -> [f32; 3] {
        [-self.0[4], -self.0[5], -self.0[6]]
    }

    /// Returns half the surface area.
    #[inline(always)]
    pub(super) fn half_area(&self) -> f32 {
        let [x, y, z] = [
            -self.0[4] - self.0[0],
            -self.0[5] - self.0[1],
            -self.0[6] - self.0[2],
        ];
        x * y + y * z + z * x
    }
}

/// The kernel that computes the bounding box of items.
pub(super) struct Surround<'a>(pub(super) &'a [Item]);

impl Kernel for Surround<'_> {
    type Output = Bounds;

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> Bounds {
        let mut bounds = simd.load_f32(&Bounds::EMPTY.0);
        for item in self.0 {
            bounds = bounds.min(item.bounds(simd));
        }
        stored::<S>(bounds)
    }
}

/// Two runs of items: the length of the first, and their boxes.
pub(super) struct Halves {
    pub(super) middle: usize,
    pub(super) bounds: [Bounds; 2],
}

/// The kernel that reorders items for the split that is cheapest for rays; `None` if no split
/// between bins separates them.
pub(super) struct Split<'a>(pub(super) &'a mut [Item]);

impl Kernel for Split<'_> {
    type Output = Option<Halves>;

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> Option<Halves> {
        let items = self.0;
        let grid = Grid::over(simd, items);
        let mut bins = [[Bin::EMPTY; BINS]; 3];
        let low = simd.load_f32(&grid.low);
        let scale = simd.load_f32(&grid.scale);
        let integer = simd.splat_f32(INTEGER);
        for item in items.iter() {
            let mut place = [0.0; LANES];
            ((item.center(simd) - low) * scale + integer).store(&mut place);
            let bounds = item.bounds(simd);
            for axis in 0..3 {
                let bin = &mut bins[axis][place[axis].to_bits() as usize % BINS];
                simd.load_f32(&bin.bounds.0)
                    .min(bounds)
                    .store(&mut bin.bounds.0);
                bin.count += 1;
            }
        }
        let mut best: Option<Cut> = None;
        for (axis, bins) in bins.iter().enumerate() {
            cheapest(simd, axis, bins, &mut best);
        }
        let cut = best?;
        Some(Halves {
            middle: grid.part(items, cut.axis, cut.bin),
            bounds: cut.bounds,
        })
    }
}

/// The bins along each axis, between the outermost centers.
struct Grid {
    low: [f32; LANES],
    scale: [f32; LANES],
}

impl Grid {
    #[inline(always)]
    fn over<S: Simd>(simd: S, items: &[Item]) -> Self {
        let mut centers = simd.load_f32(&Bounds::EMPTY.0);
        for item in items {
            centers = centers.min(item.center(simd));
        }
        let mut low = [0.0; LANES];
        centers.store(&mut low);
        let mut scale = [0.0; LANES];
        for axis in 0..3 {
            let extent = -low[axis + 4] - low[axis];
            // With rounding to the nearest integer, the last center falls into the last bin.
            let fit = (BINS - 1) as f32 / extent;
            scale[axis] = if fit.is_finite() { fit } else { 0.0 };
        }
        Self { low, scale }
    }

    /// Returns the bin of an item along an axis.
    #[inline(always)]
    fn bin(&self, item: &Item, axis: usize) -> usize {
        let center = item.0[axis] - item.0[axis + 4];
        let place = (center - self.low[axis]) * self.scale[axis] + INTEGER;
        place.to_bits() as usize % BINS
    }

    /// Moves the items of the bins below `bin` to the front and returns their number.
    #[inline(always)]
    fn part(&self, items: &mut [Item], axis: usize, bin: usize) -> usize {
        // Without a branch on the side of an item: half of them would be mispredicted.
        let mut middle = 0;
        for at in 0..items.len() {
            let first = self.bin(&items[at], axis) < bin;
            items.swap(at, middle);
            middle += usize::from(first);
        }
        middle
    }
}

#[derive(Clone, Copy)]
struct Bin {
    bounds: Bounds,
    count: u32,
}

impl Bin {
    const EMPTY: Self = Self {
        bounds: Bounds::EMPTY,
        count: 0,
    };
}

/// A split in front of a bin.
struct Cut {
    axis: usize,
    bin: usize,
    cost: f32,
    bounds: [Bounds; 2],
}

/// Runs of bins, by the bin that each ends before or begins with. Number by number, so that the costs
/// of all cuts are computed in lanes.
struct Runs {
    bounds: [Bounds; BINS],
    /// The size of the box along each axis.
    sizes: [[f32; BINS]; 3],
    leaves: [f32; BINS],
}

impl Runs {
    const EMPTY: Self = Self {
        bounds: [Bounds::EMPTY; BINS],
        sizes: [[0.0; BINS]; 3],
        leaves: [0.0; BINS],
    };

    #[inline(always)]
    fn set<S: Simd>(&mut self, at: usize, bounds: S::F32, count: u32) {
        let bounds = stored::<S>(bounds);
        for (axis, sizes) in self.sizes.iter_mut().enumerate() {
            sizes[at] = -bounds.0[axis + 4] - bounds.0[axis];
        }
        self.bounds[at] = bounds;
        self.leaves[at] = leaves(count);
    }

    /// Returns the cost of a run; NaN if it is empty, for its box is infinite.
    #[inline(always)]
    fn cost(&self, at: usize) -> f32 {
        let [x, y, z] = &self.sizes;
        (x[at] * y[at] + y[at] * z[at] + z[at] * x[at]) * self.leaves[at]
    }
}

/// Replaces `best` by the cheapest split along an axis, if that is cheaper.
#[inline(always)]
fn cheapest<S: Simd>(simd: S, axis: usize, bins: &[Bin; BINS], best: &mut Option<Cut>) {
    let (mut before, mut after) = (Runs::EMPTY, Runs::EMPTY);
    let mut bounds = simd.load_f32(&Bounds::EMPTY.0);
    let mut count = 0;
    for (at, bin) in bins.iter().enumerate().rev() {
        bounds = bounds.min(simd.load_f32(&bin.bounds.0));
        count += bin.count;
        after.set::<S>(at, bounds, count);
    }
    bounds = simd.load_f32(&Bounds::EMPTY.0);
    count = 0;
    for (at, bin) in bins.iter().enumerate() {
        before.set::<S>(at, bounds, count);
        bounds = bounds.min(simd.load_f32(&bin.bounds.0));
        count += bin.count;
    }
    let mut costs = [0.0; BINS];
    for (at, cost) in costs.iter_mut().enumerate() {
        *cost = before.cost(at) + after.cost(at);
    }
    let lowest = best.as_ref().map_or(f32::INFINITY, |best| best.cost);
    let (bin, cost) = (0..BINS).fold((0, lowest), |(bin, lowest), at| match costs[at] < lowest {
        true => (at, costs[at]),
        false => (bin, lowest),
    });
    if cost < lowest {
        *best = Some(Cut {
            axis,
            bin,
            cost,
            bounds: [before.bounds[bin], after.bounds[bin]],
        });
    }
}

/// Returns the number of leaves for this many shapes: their cost for a ray.
#[inline(always)]
fn leaves(count: u32) -> f32 {
    count.div_ceil(LANES as u32) as f32
}

#[inline(always)]
fn stored<S: Simd>(bounds: S::F32) -> Bounds {
    let mut lanes = Bounds::EMPTY;
    bounds.store(&mut lanes.0);
    lanes
}
