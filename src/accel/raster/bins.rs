//! Sorting of shapes by the screen tiles in which they may be seen.

use std::{iter, ops::Range, sync::OnceLock};

use crate::{
    accel::{
        bvh::build::Builder,
        raster::{
            footprint::{Footprint, Project, Projected, Region},
            grouping::TILE,
            view::RasterView,
        },
        runs::pieces,
    },
    tracer::{geometry::Geometry, world::World},
};

/// Number of geometries that a thread projects per task.
const CHUNK: usize = 1 << 12;
/// Number of groups of tile rows per thread: more than one, so that a group stays in the cache of
/// the core that sorts it and no thread waits long for another.
const GROUPS_PER_THREAD: usize = 4;
/// Number of entries, beyond one for each geometry, above which a region is split in two: half a
/// gigabyte. Tests use less.
const ENTRIES: u64 = if cfg!(test) { 1 << 8 } else { 1 << 26 };

/// The shapes of a region of the picture, by tiles of [`TILE`] × [`TILE`] pixels. They are sorted
/// in groups of tile rows, each by the first thread that requests one of its rows.
#[derive(Debug)]
pub(crate) struct Bins {
    region: Region,
    layout: Layout,
    /// The geometries that are planes, which have no tile.
    pub(super) planes: Vec<u32>,
    /// The footprints of all groups.
    parts: Vec<Projected>,
    groups: Vec<OnceLock<Group>>,
    /// A group has 2^`shift` rows of tiles.
    shift: u32,
    /// Number of tile rows by which a group is sorted before it is drawn: while one thread does
    /// that, the others have enough to draw.
    ahead: u32,
}

impl Bins {
    /// Bins those of some runs of geometries that a region sees; `None` if that would take too much memory and
    /// smaller regions would take less.
    pub(crate) fn new(
        view: &RasterView,
        world: &World,
        runs: &[Range<usize>],
        region: Region,
        builder: Builder<'_>,
    ) -> Option<Self> {
        let Builder { isa, pool, .. } = builder;
        let geometries = world.geometries();
        let tiles_down = region.height.div_ceil(TILE);
        let wanted = (pool.threads() * GROUPS_PER_THREAD) as u32;
        let shift = (tiles_down / wanted).max(1).ilog2();
        let groups = (tiles_down.div_ceil(1 << shift)) as usize;
        let mut parts = pool.map(pieces(runs, CHUNK), |piece| {
            isa.run(Project {
                screen: view.screen.as_ref(),
                region,
                first: piece.start as u32,
                geometries: &geometries[piece],
                groups,
                shift: shift + TILE.ilog2(),
            })
        });
        let entries: u64 = parts.iter().map(|part| part.tiles).sum();
        if entries > ENTRIES + geometries.len() as u64 && region.width.max(region.height) > TILE {
            return None;
        }
        let planes = parts.iter_mut().flat_map(|part| part.planes.drain(..));
        Some(Self {
            region,
            layout: Layout::new(geometries.len()),
            planes: planes.collect(),
            parts,
            groups: iter::repeat_with(OnceLock::new).take(groups).collect(),
            shift,
            ahead: (pool.threads() as u32).max(1 << shift),
        })
    }

    /// Returns the geometries with an index that the region sees.
    pub(super) fn seen<'a>(&self, world: &'a World) -> impl Iterator<Item = &'a Geometry> {
        let indexed = self.parts.iter().flat_map(|part| &part.indexed);
        indexed.filter_map(|index| world.geometries().get(*index as usize))
    }

    /// Returns the number of tile rows.
    fn tiles_down(&self) -> u32 {
        self.region.height.div_ceil(TILE)
    }

    /// Sorts the group that begins with the row `ahead` of this one, if there is one: this one is
    /// about to be drawn, and once it is, no thread has to wait.
    pub(super) fn look_ahead(&self, down: u32) {
        let down = down + self.ahead;
        if down < self.tiles_down() && down & ((1 << self.shift) - 1) == 0 {
            self.row(down);
        }
    }

    /// Returns a row of tiles, counted from the top of the region.
    pub(super) fn row(&self, down: u32) -> TileRow<'_> {
        let group = (down >> self.shift) as usize;
        let first = (group << self.shift) as u32;
        let stride = stride(self.region);
        let group = self.groups[group].get_or_init(|| {
            let end = self.tiles_down().min(first + (1 << self.shift));
            let footprints = || self.parts.iter().flat_map(move |part| part.group(group));
            Group::sort(footprints, stride, &(first..end), self.layout)
        });
        let first = (down - first) as usize * stride;
        TileRow {
            starts: &group.starts[first..first + stride],
            entries: &group.entries,
        }
    }
}

/// Returns the distance between the starts of two tile rows: each row ends with an additional,
/// empty tile.
fn stride(region: Region) -> usize {
    region.width.div_ceil(TILE) as usize + 1
}

/// A row of tiles.
pub(super) struct TileRow<'a> {
    /// The start of each tile's entries, and the end of the last.
    starts: &'a [u32],
    entries: &'a [u64],
}

impl<'a> TileRow<'a> {
    /// Returns the entries of a tile, counted from the left of the region.
    pub(super) fn entries(&self, across: u32) -> &'a [u64] {
        let across = across as usize;
        &self.entries[self.starts[across] as usize..self.starts[across + 1] as usize]
    }
}

/// Consecutive rows of tiles.
#[derive(Debug)]
struct Group {
    /// The start of each tile's entries, and the end of the last.
    starts: Vec<u32>,
    entries: Vec<u64>,
}

impl Group {
    /// Sorts footprints by tile (counting sort).
    fn sort<'a, I: Iterator<Item = &'a Footprint>>(
        footprints: impl Fn() -> I,
        stride: usize,
        rows: &Range<u32>,
        layout: Layout,
    ) -> Self {
        let mut starts = starts(footprints(), stride, rows);
        let total = starts.pop().unwrap_or_default();
        // One more, for the entries of tiles that do not exist.
        let mut entries = vec![0; total as usize + 1];
        footprints().for_each(|footprint| {
            let tiles = Tiles::of(footprint, rows);
            let head = layout.head(footprint);
            let (left, top) = (tiles.left * TILE, (rows.start + tiles.top) * TILE);
            let columns = |right: u32| {
                let (first, last) = within(footprint.left, footprint.right, left + right * TILE);
                first | last << 8
            };
            let rows = |below: u32| {
                let (first, last) = within(footprint.top, footprint.bottom, top + below * TILE);
                first << 4 | last << 12
            };
            let first = tiles.top as usize * stride + tiles.left as usize;
            if tiles.are_few() {
                // Most shapes are small, and the number of tiles that one touches is unpredictable:
                // always writing four entries, some of them unused, is cheaper than a loop.
                let (right, below) = (tiles.across - 1, tiles.down - 1);
                let columns = [columns(0), columns(right)];
                let rows = [rows(0), rows(below)].map(|rows| head | rows);
                let (beside, under) = (right as usize, below as usize * stride);
                for (place, entry, is_real) in [
                    (first, rows[0] | columns[0], 1),
                    (first + beside, rows[0] | columns[1], right),
                    (first + under, rows[1] | columns[0], below),
                    (first + under + beside, rows[1] | columns[1], right & below),
                ] {
                    let next = &mut starts[place + 1];
                    let place = if is_real == 1 { *next } else { total };
                    entries[place as usize] = entry;
                    *next += is_real;
                }
            } else {
                for below in 0..tiles.down {
                    let first = first + below as usize * stride;
                    let head = head | rows(below);
                    for right in 0..tiles.across {
                        let next = &mut starts[first + right as usize + 1];
                        entries[*next as usize] = head | columns(right);
                        *next += 1;
                    }
                }
            }
        });
        Self { starts, entries }
    }
}

/// Returns the start of each tile's entries, for some tile rows. That of tile i is at i + 1, so
/// that it becomes its end in place. The last element is the number of entries.
fn starts<'a>(
    footprints: impl Iterator<Item = &'a Footprint>,
    stride: usize,
    rows: &Range<u32>,
) -> Vec<u32> {
    // At first, the difference of each tile's number of entries from that of the previous tile.
    let mut starts = vec![0_u32; stride * rows.len() + 2];
    footprints.for_each(|footprint| {
        let tiles = Tiles::of(footprint, rows);
        let first = tiles.top as usize * stride + tiles.left as usize + 1;
        let mut add_row = |first: usize, entries: u32| {
            let behind = first + tiles.across as usize;
            starts[first] = starts[first].wrapping_add(entries);
            starts[behind] = starts[behind].wrapping_sub(entries);
        };
        if tiles.down.wrapping_sub(1) < 2 {
            // One or two rows, which is unpredictable: without a loop.
            add_row(first, 1);
            let below = tiles.down - 1;
            add_row(first + below as usize * stride, below);
        } else {
            (0..tiles.down as usize).for_each(|row| add_row(first + row * stride, 1));
        }
    });
    let (mut count, mut sum) = (0_u32, 0);
    for start in &mut starts {
        count = count.wrapping_add(*start);
        *start = sum;
        sum += count;
    }
    starts
}

/// Returns the first and the last pixel of a footprint's side in a tile.
fn within(from: u16, to: u16, tile: u32) -> (u64, u64) {
    let (from, to) = (u32::from(from), u32::from(to));
    let first = from.saturating_sub(tile);
    let last = (to - tile).min(TILE - 1);
    (first.into(), last.into())
}

/// The tiles of a footprint in some tile rows.
struct Tiles {
    left: u32,
    /// The first row, counted within the tile rows.
    top: u32,
    across: u32,
    /// 0 if the footprint is in none of the rows.
    down: u32,
}

impl Tiles {
    #[inline(always)]
    fn of(footprint: &Footprint, rows: &Range<u32>) -> Self {
        let top = (u32::from(footprint.top) / TILE).max(rows.start);
        let end = (u32::from(footprint.bottom) / TILE + 1).min(rows.end);
        let left = u32::from(footprint.left) / TILE;
        Self {
            left,
            top: top - rows.start,
            across: u32::from(footprint.right) / TILE + 1 - left,
            down: end.saturating_sub(top),
        }
    }

    /// Returns true if there are one or two tiles in each direction.
    #[inline(always)]
    fn are_few(&self) -> bool {
        // 0 - 1 wraps to a large number.
        self.across <= 2 && self.down.wrapping_sub(1) < 2
    }
}

/// The bit layout of a tile's entry. From the highest bits: a lower bound of t, the index of the
/// geometry, and the pixels of the tile that the shape may cover (last row, last column, first row,
/// first column, four bits each). Entries thus sort from near to far.
#[derive(Clone, Copy, Debug)]
pub(super) struct Layout {
    /// Number of bits of an index.
    index: u32,
}

/// Number of bits of the pixels.
const PIXELS: u32 = 16;

impl Layout {
    pub(super) fn new(geometries: usize) -> Self {
        let index = usize::BITS - geometries.leading_zeros();
        Self {
            index: index.clamp(1, u32::BITS),
        }
    }

    /// Returns the part of an entry that is the same in all tiles.
    fn head(self, footprint: &Footprint) -> u64 {
        self.depth(footprint.bound) << (PIXELS + self.index) | u64::from(footprint.index) << PIXELS
    }

    /// Returns the leading bits of a number that is not negative, as many as fit; they are ordered
    /// as the numbers are.
    pub(super) fn depth(self, bound: f32) -> u64 {
        u64::from(bound.to_bits()) >> self.dropped()
    }

    /// Returns the number of bits of an f32 that do not fit.
    fn dropped(self) -> u32 {
        // The sign bit is always dropped.
        (u32::BITS - 1).saturating_sub(u64::BITS - PIXELS - self.index)
    }

    /// Returns the index of an entry's geometry.
    #[inline(always)]
    pub(super) fn index(self, entry: u64) -> usize {
        (entry >> PIXELS & ((1 << self.index) - 1)) as usize
    }

    /// Returns the depth of an entry; see [`Layout::depth`].
    #[inline(always)]
    pub(super) fn depth_of(self, entry: u64) -> u64 {
        entry >> (PIXELS + self.index)
    }

    /// Returns a lower bound of the number that a depth was computed from.
    #[inline(always)]
    pub(super) fn bound(self, depth: u64) -> f64 {
        f64::from(f32::from_bits((depth << self.dropped()) as u32))
    }
}

/// Returns the pixels of an entry: first and last column, first and last row.
#[inline(always)]
pub(super) fn pixels(entry: u64) -> [usize; 4] {
    [entry, entry >> 8, entry >> 4, entry >> 12].map(|side| (side & 15) as usize)
}
