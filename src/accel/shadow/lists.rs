//! The shapes that may shadow a point, by the tile that the light sees the point in.

use std::{mem, ops::Range};

use crate::{
    accel::{
        runs::{count, pieces},
        shadow::{
            casters::Casters,
            frame::{Frame, ball, is_ordinary},
        },
    },
    parallel::Pool,
    simd::{F64x8, Kernel, LANES, Mask, Simd, isa::Isa},
    tracer::{geometry::Geometry, world::World},
};

/// Number of geometries that a thread projects at once.
const CHUNK: usize = 1 << 13;
/// Number of tiles whose shapes a thread collects at once.
const TOGETHER: usize = 1 << 10;
/// Number of entries by which prefetching is ahead.
const PREFETCHED: usize = 24;
/// The number of depths by which shapes are sorted.
const DEPTHS: usize = 256;

/// The shapes of each tile, roughly from near to far.
#[derive(Debug)]
pub(super) struct Lists {
    pub(super) frame: Frame,
    /// The start of each tile's shapes, and the end of the last.
    starts: Vec<u32>,
    eights: Vec<Eight>,
}

/// Up to eight shapes of a tile.
#[derive(Clone, Debug)]
pub(super) struct Eight {
    /// No point at a smaller depth is shadowed by these shapes or the rest of the tile's.
    pub(super) least: f32,
    /// No point at a smaller depth is shadowed, by shapes; infinite for none.
    pub(super) near: [f32; LANES],
    /// The bounds on the face, in tiles.
    pub(super) low: [[f32; LANES]; 2],
    pub(super) high: [[f32; LANES]; 2],
    pub(super) index: [u32; LANES],
}

impl Eight {
    const NONE: Self = Self {
        least: f32::INFINITY,
        near: [f32::INFINITY; LANES],
        low: [[f32::INFINITY; LANES]; 2],
        high: [[f32::NEG_INFINITY; LANES]; 2],
        index: [0; LANES],
    };

    #[inline(always)]
    fn set(&mut self, lane: usize, blocker: &Blocker) {
        self.near[lane] = blocker.near;
        for axis in 0..2 {
            self.low[axis][lane] = blocker.low[axis];
            self.high[axis][lane] = blocker.high[axis];
        }
        self.index[lane] = blocker.index;
    }
}

/// A shape that may shadow points of a face.
#[derive(Clone, Copy, Debug)]
struct Blocker {
    index: u32,
    /// No point at a smaller depth is shadowed.
    near: f32,
    /// The bounds on the face, in tiles: the lower ones, then the upper ones.
    low: [f32; 2],
    high: [f32; 2],
    face: u8,
}

impl Lists {
    /// Sorts some shapes of a world by tile; `None` if that would take too much memory, so that
    /// larger tiles are needed.
    pub(super) fn new(
        world: &World,
        runs: &[Range<usize>],
        casters: Casters,
        frame: Frame,
        pool: &Pool,
        isa: Isa,
    ) -> Option<Self> {
        let geometries = world.geometries();
        let most = 5 * count(runs) + (1 << 16);
        let parts = pool.map(pieces(runs, CHUNK), |piece| {
            isa.run(Project {
                frame: &frame,
                casters,
                first: piece.start as u32,
                geometries: &geometries[piece],
                most,
            })
        });
        let entries: usize = parts.iter().map(|(_, entries)| entries).sum();
        if entries > most {
            return None;
        }
        let parts: Vec<_> = parts.into_iter().map(|(blockers, _)| blockers).collect();
        let blockers = sort_by_depth(&parts);
        drop(parts);

        let (starts, entries) = sort_by_tile(&frame, &blockers);
        let eight = LANES as u32;
        let mut firsts = vec![0];
        firsts.extend(starts.windows(2).scan(0, |total, tile| {
            *total += (tile[1] - tile[0]).div_ceil(eight);
            Some(*total)
        }));
        let mut eights = vec![Eight::NONE; firsts[frame.tiles] as usize];
        let mut rest = &mut eights[..];
        let parts: Vec<_> = (0..frame.tiles)
            .step_by(TOGETHER)
            .map(|tile| {
                let tiles = tile..frame.tiles.min(tile + TOGETHER);
                let count = (firsts[tiles.end] - firsts[tile]) as usize;
                let (part, others) = mem::take(&mut rest).split_at_mut(count);
                rest = others;
                (tiles, part)
            })
            .collect();
        pool.map(parts, |(tiles, eights)| {
            isa.run(Fill {
                starts: &starts[tiles.start..=tiles.end],
                entries: &entries,
                blockers: &blockers,
                eights,
            });
        });
        let starts = firsts;
        Some(Self {
            frame,
            starts,
            eights,
        })
    }

    /// Returns the shapes that may shadow points of a tile.
    #[inline(always)]
    pub(super) fn of(&self, tile: usize) -> &[Eight] {
        &self.eights[self.starts[tile] as usize..self.starts[tile + 1] as usize]
    }

    /// Returns true if there are no shapes at all.
    pub(super) fn is_empty(&self) -> bool {
        self.eights.is_empty()
    }

    /// The length of the longest list.
    pub(super) fn longest(&self) -> usize {
        let lengths = self.starts.windows(2).map(|tile| tile[1] - tile[0]);
        lengths.max().unwrap_or(0) as usize
    }
}

/// Sorts shapes by tile (counting sort); returns the start of each tile, and their numbers.
fn sort_by_tile(frame: &Frame, blockers: &[Blocker]) -> (Vec<u32>, Vec<u32>) {
    let mut starts = vec![0_u32; frame.tiles + 2];
    for blocker in blockers {
        each_tile(frame, blocker, |tile| starts[tile + 2] += 1);
    }
    let mut total = 0;
    for start in &mut starts {
        total += *start;
        *start = total;
    }
    let mut entries = vec![0; total as usize];
    for (number, blocker) in (0..).zip(blockers) {
        each_tile(frame, blocker, |tile| {
            let next = &mut starts[tile + 1];
            entries[*next as usize] = number;
            *next += 1;
        });
    }
    starts.pop();
    (starts, entries)
}

/// The kernel that sets the shapes of some tiles.
struct Fill<'a> {
    /// The start of each tile's entries, and the end of the last.
    starts: &'a [u32],
    entries: &'a [u32],
    blockers: &'a [Blocker],
    eights: &'a mut [Eight],
}

impl Kernel for Fill<'_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(mut self, simd: S) {
        for tile in self.starts.windows(2) {
            let tile = tile[0] as usize..tile[1] as usize;
            let count = tile.len().div_ceil(LANES);
            let (list, rest) = mem::take(&mut self.eights).split_at_mut(count);
            self.eights = rest;
            for (place, entry) in tile.enumerate() {
                if let Some(later) = self.entries.get(entry + PREFETCHED) {
                    simd.prefetch(&self.blockers[*later as usize]);
                }
                let blocker = &self.blockers[self.entries[entry] as usize];
                list[place / LANES].set(place % LANES, blocker);
            }
            let mut least = f32::INFINITY;
            for eight in list.iter_mut().rev() {
                least = eight
                    .near
                    .iter()
                    .fold(least, |least, near| least.min(*near));
                eight.least = least;
            }
        }
    }
}

/// Sorts shapes roughly from near to far (counting sort).
fn sort_by_depth(parts: &[Vec<Blocker>]) -> Vec<Blocker> {
    let all = || parts.iter().flatten();
    let (low, high) = all().fold((f32::INFINITY, 0.0_f32), |(low, high), blocker| {
        (low.min(blocker.near), high.max(blocker.near))
    });
    let low = low.max(0.0);
    let scale = (DEPTHS - 1) as f32 / (high - low).max(f32::MIN_POSITIVE);
    // A cast of a negative number is 0.
    let depth = |blocker: &Blocker| (((blocker.near - low) * scale) as usize).min(DEPTHS - 1);
    let mut next = [0_u32; DEPTHS + 1];
    for blocker in all() {
        next[depth(blocker) + 1] += 1;
    }
    for depth in 1..=DEPTHS {
        next[depth] += next[depth - 1];
    }
    let nothing = Blocker {
        index: 0,
        near: 0.0,
        low: [0.0; 2],
        high: [0.0; 2],
        face: 0,
    };
    let mut sorted = vec![nothing; next[DEPTHS] as usize];
    for blocker in all() {
        let next = &mut next[depth(blocker)];
        sorted[*next as usize] = *blocker;
        *next += 1;
    }
    sorted
}

/// Returns the tiles that a blocker may shadow, in both directions.
#[inline(always)]
fn tiles_of(frame: &Frame, blocker: &Blocker) -> [Range<usize>; 2] {
    let count = frame.grids[usize::from(blocker.face)].count;
    std::array::from_fn(|axis| {
        // A cast of a negative number is 0.
        let first = blocker.low[axis] as usize;
        let last = blocker.high[axis].min(count[axis] as f32 - 1.0);
        first..if last < 0.0 { 0 } else { last as usize + 1 }
    })
}

/// Calls `see` for each tile with points that a blocker may shadow.
#[inline(always)]
fn each_tile(frame: &Frame, blocker: &Blocker, mut see: impl FnMut(usize)) {
    let [across, along] = tiles_of(frame, blocker);
    let grid = &frame.grids[usize::from(blocker.face)];
    for row in along {
        let first = grid.first + row * grid.count[0] as usize;
        (first + across.start..first + across.end).for_each(&mut see);
    }
}

/// Returns a lower bound as an f32.
#[inline(always)]
fn below(x: f64) -> f32 {
    (x - x.abs() * 1e-6) as f32
}

/// The kernel that finds the geometries which may cast a shadow, and the number of tiles that these
/// cover.
struct Project<'a> {
    frame: &'a Frame,
    casters: Casters,
    geometries: &'a [Geometry],
    /// The index of the first geometry.
    first: u32,
    /// The largest number of tiles that are looked at.
    most: usize,
}

impl Kernel for Project<'_> {
    type Output = (Vec<Blocker>, usize);

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> (Vec<Blocker>, usize) {
        let (mut blockers, mut entries) = (Vec::new(), 0);
        for (chunk, geometries) in self.geometries.chunks(LANES).enumerate() {
            let (mut center, mut radius) = ([[0.0; LANES]; 3], [0.0; LANES]);
            let mut present = 0_u8;
            for (lane, geometry) in geometries.iter().enumerate() {
                let Some((c, r)) = ball(geometry) else {
                    continue;
                };
                if !self.casters.hold(geometry) {
                    continue;
                }
                for (axis, center) in center.iter_mut().enumerate() {
                    center[lane] = c[axis];
                }
                radius[lane] = r;
                present |= u8::from(is_ordinary(c, r)) << lane;
            }
            if present == 0 {
                continue;
            }
            let center = [
                simd.load(&center[0]),
                simd.load(&center[1]),
                simd.load(&center[2]),
            ];
            let balls = (center, simd.load(&radius));
            for face in 0..6 {
                if self.frame.grids[face].count[0] > 0.0 {
                    let first = self.first + (chunk * LANES) as u32;
                    self.project(
                        simd,
                        balls,
                        (face, present, first),
                        &mut blockers,
                        &mut entries,
                    );
                }
            }
            if entries > self.most {
                // Larger tiles are needed.
                break;
            }
        }
        (blockers, entries)
    }
}

impl Project<'_> {
    #[inline(always)]
    fn project<S: Simd>(
        &self,
        simd: S,
        balls: ([S::F64; 3], S::F64),
        (face, present, first): (usize, u8, u32),
        blockers: &mut Vec<Blocker>,
        entries: &mut usize,
    ) {
        let bounds = self.frame.bounds(simd, face, balls);
        let count = self.frame.grids[face].count;
        let zero = simd.splat(0.0);
        let inside = bounds.seen
            & zero.le(bounds.high[0])
            & zero.le(bounds.high[1])
            & bounds.low[0].lt(simd.splat(count[0]))
            & bounds.low[1].lt(simd.splat(count[1]));
        let mut inside = inside.bits() & present;
        if inside == 0 {
            return;
        }
        let (mut low, mut high) = ([[0.0; LANES]; 2], [[0.0; LANES]; 2]);
        let mut near = [0.0; LANES];
        for axis in 0..2 {
            let least = simd.splat(-1.0);
            let most = simd.splat(count[axis] + 1.0);
            bounds.low[axis].max(least).store(&mut low[axis]);
            bounds.high[axis].min(most).store(&mut high[axis]);
        }
        bounds.near.store(&mut near);
        while inside != 0 {
            let lane = inside.trailing_zeros() as usize;
            inside &= inside - 1;
            let blocker = Blocker {
                index: first + lane as u32,
                near: below(near[lane]),
                low: [low[0][lane] as f32, low[1][lane] as f32],
                high: [high[0][lane] as f32, high[1][lane] as f32],
                face: face as u8,
            };
            let [across, along] = tiles_of(self.frame, &blocker);
            let tiles = across.len() * along.len();
            if tiles > 0 {
                *entries += tiles;
                blockers.push(blocker);
            }
        }
    }
}
