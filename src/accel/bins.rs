//! Which spheres may be seen in which tile of the screen.

use std::ops::Range;

use crate::{
    accel::{
        footprint::{Footprint, Project, Projected, Region},
        grouping::TILE,
        view::View,
    },
    parallel::Pool,
    simd::Isa,
    tracer::world::World,
};

/// How many geometries a thread projects before it looks for other work.
const CHUNK: usize = 1 << 12;
/// More entries than these are sorted by several threads. Fewer are sorted while one is woken.
const MANY: u64 = if cfg!(test) { 1 << 6 } else { 1 << 16 };
/// How many groups of rows of tiles each thread sorts: some, so that threads have as much to do
/// where spheres crowd, and what a group holds stays near the processor.
const GROUPS_PER_THREAD: usize = 4;
/// How many entries bins may have before a region is rather cut in two, above one for each
/// geometry: half a gigabyte. Tests are content with less.
const ENTRIES: u64 = if cfg!(test) { 1 << 8 } else { 1 << 26 };

/// The spheres of a region of the picture, by tiles of [`TILE`] times [`TILE`] pixels.
pub(crate) struct Bins {
    pub(super) region: Region,
    pub(super) layout: Layout,
    /// The geometries that are planes; they have no tile.
    pub(super) planes: Vec<u32>,
    /// Consecutive rows of tiles.
    groups: Vec<Group>,
    /// A group has 2^`shift` rows of tiles.
    shift: u32,
}

struct Group {
    /// Where each tile's entries begin, and the end of the last.
    starts: Vec<u32>,
    entries: Vec<u64>,
}

impl Bins {
    /// Sorts what a region sees of a world; `None` if that would take too much memory and
    /// smaller regions would take less.
    pub(crate) fn new(
        view: &View,
        world: &World,
        region: Region,
        pool: &Pool,
        isa: Isa,
    ) -> Option<Self> {
        let geometries = world.geometries();
        let tiles_down = region.height.div_ceil(TILE);
        let wanted = (pool.threads() * GROUPS_PER_THREAD) as u32;
        let shift = (tiles_down / wanted).max(1).ilog2();
        let groups = (tiles_down.div_ceil(1 << shift)) as usize;
        let mut parts = pool.map(
            geometries.chunks(CHUNK).enumerate(),
            |(chunk, geometries)| {
                isa.run(Project {
                    screen: view.screen.as_ref(),
                    region,
                    geometries,
                    first: (chunk * CHUNK) as u32,
                    groups,
                    shift: shift + TILE.ilog2(),
                })
            },
        );
        let planes = parts.iter_mut().flat_map(|part| part.planes.drain(..));
        let planes = planes.collect();

        let pool_for = |is_much: bool| if is_much { pool } else { &Pool::Calling };
        let counted = pool_for(geometries.len() > CHUNK).map(0..groups, |group| {
            let top = (group << shift) as u32;
            let rows = top..tiles_down.min(top + (1 << shift));
            Counted::new(footprints(&parts, group), region, rows)
        });
        let entries: u64 = counted.iter().map(|group| group.total).sum();
        if entries > ENTRIES + geometries.len() as u64 && region.width.max(region.height) > TILE {
            return None;
        }
        let layout = Layout::new(geometries.len());
        let groups = pool_for(entries > MANY)
            .map(counted.into_iter().enumerate(), |(group, counted)| {
                counted.sort(footprints(&parts, group), layout)
            });
        Some(Self {
            region,
            layout,
            planes,
            groups,
            shift,
        })
    }

    /// The entries of a tile, which counts from the left and from the top of the region.
    pub(super) fn entries(&self, across: u32, down: u32) -> &[u64] {
        let group = &self.groups[(down >> self.shift) as usize];
        let row = down & ((1 << self.shift) - 1);
        let tile = (row * self.region.width.div_ceil(TILE) + across) as usize;
        &group.entries[group.starts[tile] as usize..group.starts[tile + 1] as usize]
    }
}

/// What lies in a group, and now and then something that does not.
fn footprints(parts: &[Projected], group: usize) -> impl Iterator<Item = &Footprint> {
    parts.iter().flat_map(move |part| part.group(group))
}

/// How many entries the tiles of some rows will have.
struct Counted {
    region: Region,
    rows: Range<u32>,
    /// The count of tile i stands at i + 2, so that it becomes its start and then its end in
    /// place.
    counts: Vec<u32>,
    total: u64,
}

impl Counted {
    fn new<'a>(
        footprints: impl Iterator<Item = &'a Footprint>,
        region: Region,
        rows: Range<u32>,
    ) -> Self {
        let across = region.width.div_ceil(TILE) as usize;
        let mut counts = vec![0; across * rows.len() + 2];
        let mut total = 0;
        footprints.for_each(|footprint| {
            let tiles = Tiles::of(footprint, &rows);
            let first = tiles.top as usize * across + tiles.left as usize + 2;
            total += u64::from(tiles.across) * u64::from(tiles.down);
            if tiles.are_few() {
                // Most spheres are small, and no processor can foresee how many tiles one
                // touches: four additions, some of nothing, are cheaper than a loop.
                let (right, below) = (tiles.across - 1, tiles.down - 1);
                let next_row = if below == 0 { 0 } else { across };
                counts[first] += 1;
                counts[first + right as usize] += right;
                counts[first + next_row] += below;
                counts[first + next_row + right as usize] += right & below;
            } else {
                for row in 0..tiles.down as usize {
                    let first = first + row * across;
                    for count in &mut counts[first..first + tiles.across as usize] {
                        *count += 1;
                    }
                }
            }
        });
        Self {
            region,
            rows,
            counts,
            total,
        }
    }

    /// A counting sort.
    fn sort<'a>(self, footprints: impl Iterator<Item = &'a Footprint>, layout: Layout) -> Group {
        let across = self.region.width.div_ceil(TILE) as usize;
        let mut starts = self.counts;
        let mut sum = 0;
        for start in &mut starts {
            sum += *start;
            *start = sum;
        }
        // One more: what has no tile goes there.
        let mut entries = vec![0; self.total as usize + 1];
        footprints.for_each(|footprint| {
            let tiles = Tiles::of(footprint, &self.rows);
            let head = layout.head(footprint);
            let (left, top) = (tiles.left * TILE, (self.rows.start + tiles.top) * TILE);
            let columns = |right: u32| {
                let (first, last) = within(footprint.left, footprint.right, left + right * TILE);
                first | last << 8
            };
            let rows = |below: u32| {
                let (first, last) = within(footprint.top, footprint.bottom, top + below * TILE);
                first << 4 | last << 12
            };
            let first = tiles.top as usize * across + tiles.left as usize;
            if tiles.are_few() {
                let (right, below) = (tiles.across - 1, tiles.down - 1);
                let columns = [columns(0), columns(right)];
                let rows = [rows(0), rows(below)].map(|rows| head | rows);
                let (beside, under) = (right as usize, below as usize * across);
                for (place, entry, is_real) in [
                    (first, rows[0] | columns[0], 1),
                    (first + beside, rows[0] | columns[1], right),
                    (first + under, rows[1] | columns[0], below),
                    (first + under + beside, rows[1] | columns[1], right & below),
                ] {
                    let next = &mut starts[place + 1];
                    let place = if is_real == 1 { *next } else { sum };
                    entries[place as usize] = entry;
                    *next += is_real;
                }
            } else {
                for below in 0..tiles.down {
                    let first = first + below as usize * across;
                    let head = head | rows(below);
                    for right in 0..tiles.across {
                        let next = &mut starts[first + right as usize + 1];
                        entries[*next as usize] = head | columns(right);
                        *next += 1;
                    }
                }
            }
        });
        starts.pop();
        Group { starts, entries }
    }
}

/// The part of a side of a footprint that lies in a tile.
fn within(from: u16, to: u16, tile: u32) -> (u64, u64) {
    let (from, to) = (u32::from(from), u32::from(to));
    let first = from.saturating_sub(tile);
    let last = (to - tile).min(TILE - 1);
    (first.into(), last.into())
}

/// The tiles that a footprint lies in, in some rows of tiles.
struct Tiles {
    left: u32,
    /// From the first of the rows.
    top: u32,
    across: u32,
    /// 0 if it lies in none of the rows.
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

    /// Whether there are one or two, to each side.
    #[inline(always)]
    fn are_few(&self) -> bool {
        // 0 less 1 is large.
        self.across <= 2 && self.down.wrapping_sub(1) < 2
    }
}

/// How an entry of a tile is packed: from the top a lower bound of t, the index of the geometry,
/// and the pixels of the tile that the sphere may cover (last row, last column, first row, first
/// column, four bits each). So packed, entries sort from near to far.
#[derive(Clone, Copy, Debug)]
pub(super) struct Layout {
    /// How many bits an index takes.
    index: u32,
}

/// How many bits the pixels take.
const PIXELS: u32 = 16;

impl Layout {
    fn new(geometries: usize) -> Self {
        let index = usize::BITS - geometries.leading_zeros();
        Self {
            index: index.clamp(1, u32::BITS),
        }
    }

    /// The part of an entry that is the same in all tiles.
    fn head(self, footprint: &Footprint) -> u64 {
        self.depth(footprint.bound) << (PIXELS + self.index) | u64::from(footprint.index) << PIXELS
    }

    /// The leading bits of a number that is not negative, as many as there is room for: they
    /// are ordered as the numbers are.
    pub(super) fn depth(self, bound: f32) -> u64 {
        u64::from(bound.to_bits()) >> self.dropped()
    }

    /// How many bits of an f32 have no room.
    fn dropped(self) -> u32 {
        // The sign is not kept.
        (u32::BITS - 1).saturating_sub(u64::BITS - PIXELS - self.index)
    }

    /// The geometry of an entry.
    #[inline(always)]
    pub(super) fn index(self, entry: u64) -> usize {
        (entry >> PIXELS & ((1 << self.index) - 1)) as usize
    }

    /// The depth of an entry; see [`Layout::depth`].
    #[inline(always)]
    pub(super) fn depth_of(self, entry: u64) -> u64 {
        entry >> (PIXELS + self.index)
    }

    /// A number that is not above the bound that a depth was made of.
    #[inline(always)]
    pub(super) fn bound(self, depth: u64) -> f64 {
        f64::from(f32::from_bits((depth << self.dropped()) as u32))
    }
}

/// The pixels of an entry: first and last column, first and last row.
#[inline(always)]
pub(super) fn pixels(entry: u64) -> [usize; 4] {
    [entry, entry >> 8, entry >> 4, entry >> 12].map(|side| (side & 15) as usize)
}
