//! The pixels that a shape may cover, and a lower bound of its distance.

use std::iter;

use glam::DVec3;

use crate::{
    accel::{
        lanes::{bits, dot, splat3, sub},
        raster::{
            grouping::TILE,
            view::{HUGE, Lens, Screen},
        },
        rounding,
    },
    simd::{F64x8, Kernel, LANES, Mask, Simd},
    tracer::{
        geometry::Geometry,
        shape::{Extent, around::GROWTH},
    },
};

/// A rectangle of pixels, counted from the top left of the picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Region {
    pub(crate) column: u32,
    pub(crate) row: u32,
    /// At most [`Region::MAX_SIDE`].
    pub(crate) width: u32,
    /// At most [`Region::MAX_SIDE`].
    pub(crate) height: u32,
}

impl Region {
    /// The largest side that fits into the numbers of a [`Footprint`].
    pub(crate) const MAX_SIDE: u32 = 1 << 15;
}

/// The pixels of a region that a shape may cover, counted from its top left, ends included.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Footprint {
    pub(super) left: u16,
    pub(super) right: u16,
    pub(super) top: u16,
    pub(super) bottom: u16,
    /// A lower bound: no ray hits the shape at a smaller t.
    pub(super) bound: f32,
    /// The index of the geometry in the world.
    pub(super) index: u32,
}

/// The footprints of some geometries in a region of the picture, by groups of its rows.
#[derive(Debug)]
pub(super) struct Projected {
    /// The geometries that are planes.
    pub(super) planes: Vec<u32>,
    /// The geometries that are indexed.
    pub(super) indexed: Vec<u32>,
    /// Total number of tiles over all footprints.
    pub(super) tiles: u64,
    /// The footprints in each group; a footprint in two groups is in both.
    groups: Vec<Vec<Footprint>>,
    /// The footprints in more than two groups.
    tall: Vec<Footprint>,
    /// A group has 2^`shift` rows.
    shift: u32,
}

impl Projected {
    /// Creates a set for at most this many geometries and this many groups of 2^`shift` rows.
    fn new(geometries: usize, groups: usize, shift: u32) -> Self {
        // Nearly always enough if the spheres are about evenly distributed.
        let expected = geometries / groups * 5 / 4;
        Self {
            planes: Vec::new(),
            indexed: Vec::new(),
            tiles: 0,
            groups: iter::repeat_with(|| Vec::with_capacity(expected))
                .take(groups)
                .collect(),
            tall: Vec::new(),
            shift,
        }
    }

    #[inline(always)]
    fn push(&mut self, footprint: Footprint) {
        let tiles = |from: u16, to: u16| (u32::from(to) / TILE - u32::from(from) / TILE + 1) as u64;
        let down = tiles(footprint.top, footprint.bottom);
        self.tiles += tiles(footprint.left, footprint.right) * down;
        let [first, last] =
            [footprint.top, footprint.bottom].map(|row| usize::from(row >> self.shift));
        if last > first + 1 {
            self.tall.push(footprint);
            return;
        }
        self.groups[first].push(footprint);
        if last > first {
            self.groups[last].push(footprint);
        }
    }

    /// Returns the footprints of a group, and occasionally some outside of it.
    pub(super) fn group(&self, group: usize) -> impl Iterator<Item = &Footprint> {
        self.groups[group].iter().chain(&self.tall)
    }
}

/// The kernel that finds the footprints of geometries; `first` is the index of the first in the
/// world.
pub(super) struct Project<'a> {
    /// The screen; `None` if no bounds are known, so that all shapes cover all pixels.
    pub(super) screen: Option<&'a Screen>,
    pub(super) region: Region,
    pub(super) geometries: &'a [Geometry],
    pub(super) first: u32,
    /// Number of groups of rows in the region.
    pub(super) groups: usize,
    /// A group has 2^`shift` rows.
    pub(super) shift: u32,
}

impl Kernel for Project<'_> {
    type Output = Projected;

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> Projected {
        let mut found = Projected::new(self.geometries.len(), self.groups, self.shift);
        for (chunk, geometries) in self.geometries.chunks(LANES).enumerate() {
            let first = self.first + (chunk * LANES) as u32;
            let mut balls = Balls::default();
            for (lane, geometry) in geometries.iter().enumerate() {
                match geometry.shape().extent() {
                    Extent::Ball(center, radius) => {
                        let grown = match geometry.shape().sphere() {
                            Some(_) => radius,
                            None => {
                                if geometry.shape().is_indexed() {
                                    found.indexed.push(first + lane as u32);
                                }
                                // Crossings count this far outside of the box and the ball.
                                let away = self.screen.map_or(0.0, |screen| screen.away(center));
                                let slack = 1.001 * GROWTH * away.max(radius);
                                radius + slack + rounding(center.abs() + radius)
                            }
                        };
                        balls.set(lane, center.into(), grown);
                    }
                    Extent::Plane(_) => found.planes.push(first + lane as u32),
                }
            }
            match self.screen {
                Some(screen) => {
                    let bounds = balls.bounds(simd, screen, self.region);
                    bounds.append(first, &mut found);
                }
                None => balls.append_everywhere(first, self.region, &mut found),
            }
        }
        found
    }
}

/// Up to eight spheres, or balls around other shapes.
#[derive(Default)]
struct Balls {
    center: [[f64; LANES]; 3],
    radius: [f64; LANES],
    /// The lanes in use: bit i is lane i.
    present: u8,
}

/// The screen bounds of eight balls, in pixels from the top left of the region.
struct Bounds {
    left: [i32; LANES],
    right: [i32; LANES],
    top: [i32; LANES],
    bottom: [i32; LANES],
    depth: [f64; LANES],
    /// The lanes that are in the picture: bit i is lane i.
    seen: u8,
}

impl Balls {
    #[inline(always)]
    fn set(&mut self, lane: usize, center: [f64; 3], radius: f64) {
        for (axis, x) in self.center.iter_mut().zip(center) {
            axis[lane] = x;
        }
        self.radius[lane] = radius;
        self.present |= 1 << lane;
    }

    /// Returns the vectors from a point to the centers.
    #[inline(always)]
    fn centers_from<S: Simd>(&self, simd: S, point: DVec3) -> [S::F64; 3] {
        // Written out: the closure of a `map` would not be compiled for the instruction set.
        let [x, y, z] = &self.center;
        let centers = [simd.load(x), simd.load(y), simd.load(z)];
        sub(centers, splat3(simd, point))
    }

    #[inline(always)]
    fn bounds<S: Simd>(&self, simd: S, screen: &Screen, region: Region) -> Bounds {
        let splat = |x: f64| simd.splat(x);
        let zero = splat(0.0);
        let center = self.centers_from(simd, screen.eye);
        let x = dot(center, splat3(simd, screen.u));
        let y = dot(center, splat3(simd, screen.v));
        let z = dot(center, splat3(simd, screen.forward));
        let radius = simd.load(&self.radius);
        let squared = dot(center, center);

        let (columns, rows, depth, seen, scale) = match screen.lens {
            Lens::Perspective { distance } => {
                let scale = squared.max(radius * radius);
                let grown = radius * radius + splat(screen.inflation) * scale;
                let r = grown.sqrt();
                let depth = squared.sqrt() - r - splat(1e-13) * scale.sqrt();
                let columns = slopes(simd, x, z, r, grown);
                let rows = slopes(simd, y, z, r, grown);
                let zoom = splat(distance);
                let columns = columns.map(|slope| slope * zoom);
                let rows = rows.map(|slope| slope * zoom);
                (columns, rows, depth, !(z + r).lt(zero), scale)
            }
            Lens::Orthographic { zoom, reach } => {
                let far = squared.sqrt() + splat(reach);
                let scale = (far * far).max(radius * radius);
                let grown = radius * radius + splat(screen.inflation) * scale;
                let r = grown.sqrt() + splat(screen.blur);
                let depth = z - r - splat(1e-13) * scale.sqrt();
                let [across, along] = zoom.map(splat);
                let columns = [(x - r) * across, (x + r) * across];
                let rows = [(y - r) * along, (y + r) * along];
                (columns, rows, depth, !(z + r).lt(zero), scale)
            }
        };

        // From the middle of the picture to the region. Rows are counted downwards, while y points
        // up.
        let across = splat(screen.middle[0] - f64::from(region.column));
        let down = splat(screen.middle[1] - f64::from(region.row));
        let slack = splat(screen.slack);
        let one = splat(1.0);
        let (last_column, last_row) = (
            splat(f64::from(region.width) - 1.0),
            splat(f64::from(region.height) - 1.0),
        );
        let left = across + columns[0] - slack;
        let right = across + columns[1] + slack;
        let top = down - rows[1] - slack;
        let bottom = down - rows[0] + slack;
        let outside = right.lt(zero) | last_column.lt(left) | bottom.lt(zero) | last_row.lt(top);

        // Numbers that overflow or lose their last bits give no bounds.
        let sane = splat(1.0 / (HUGE * HUGE)).lt(scale) & scale.lt(splat(HUGE * HUGE));
        let seen = (seen & !outside) | !sane;
        let everywhere = |edge: S::F64, all: S::F64| S::F64::select(sane, edge, all);

        let mut depths = [0.0; LANES];
        everywhere(depth, zero).store(&mut depths);
        // The first whole number inside of an edge that lies too far outside, by the slack. For a
        // NaN, min and max return the other operand: the whole side.
        Bounds {
            left: everywhere((left + one).max(zero), zero)
                .min(last_column + one)
                .truncate(),
            right: everywhere(right.min(last_column), last_column)
                .max(zero)
                .truncate(),
            top: everywhere((top + one).max(zero), zero)
                .min(last_row + one)
                .truncate(),
            bottom: everywhere(bottom.min(last_row), last_row)
                .max(zero)
                .truncate(),
            depth: depths,
            seen: seen.bits() & self.present,
        }
    }

    fn append_everywhere(&self, first: u32, region: Region, found: &mut Projected) {
        for lane in bits(self.present) {
            found.push(Footprint {
                left: 0,
                right: (region.width - 1) as u16,
                top: 0,
                bottom: (region.height - 1) as u16,
                bound: 0.0,
                index: first + lane as u32,
            });
        }
    }
}

/// Returns the lowest and the highest slope `x/z` of the rays in front of the eye that meet a
/// circle around (x, z) with the radius r, whose square is `squared`.
///
/// With the tangent's length `l = √(x² + z² - r²)` the tangents point along `(x·l ∓ z·r, z·l ±
/// x·r)`. A side is unbounded if its tangent points backwards, or if the eye is in the circle or so
/// near to it that l has lost its digits.
#[inline(always)]
fn slopes<S: Simd>(simd: S, x: S::F64, z: S::F64, r: S::F64, squared: S::F64) -> [S::F64; 2] {
    let zero = simd.splat(0.0);
    let far = x * x + z * z;
    let apart = far - squared;
    let outside = (far * simd.splat(1e-6)).lt(apart);
    let l = apart.sqrt();
    let (low, before_low) = (x * l - z * r, z * l + x * r);
    let (high, before_high) = (x * l + z * r, z * l - x * r);
    // If the center is behind the eye, the tangent on its side may have turned past the back.
    let behind = z.lt(zero);
    let has_low = outside & zero.lt(before_low) & !(behind & x.lt(zero));
    let has_high = outside & zero.lt(before_high) & !(behind & zero.lt(x));
    [
        S::F64::select(has_low, low / before_low, simd.splat(f64::NEG_INFINITY)),
        S::F64::select(has_high, high / before_high, simd.splat(f64::INFINITY)),
    ]
}

impl Bounds {
    #[inline(always)]
    fn append(&self, first: u32, found: &mut Projected) {
        for lane in bits(self.seen) {
            let (left, right) = (self.left[lane], self.right[lane]);
            let (top, bottom) = (self.top[lane], self.bottom[lane]);
            // The shape lies between two pixel centers.
            if right < left || bottom < top {
                continue;
            }
            found.push(Footprint {
                left: left as u16,
                right: right as u16,
                top: top as u16,
                bottom: bottom as u16,
                bound: below(self.depth[lane]),
                index: first + lane as u32,
            });
        }
    }
}

/// Returns a lower bound of `x` as an f32, neither negative nor NaN.
#[inline(always)]
fn below(x: f64) -> f32 {
    // The relative rounding error of an f32 is at most 2⁻²⁴.
    let x = x.min(f64::from(f32::MAX)) * (1.0 - 1.0 / f64::from(1 << 22));
    if x > 0.0 { x as f32 } else { 0.0 }
}
