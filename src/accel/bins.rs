//! Which spheres may be seen in which tile of the screen.

use std::ops::Range;

use crate::{
    accel::{
        footprint::{Footprint, Project, Region},
        view::View,
    },
    parallel::Pool,
    simd::Isa,
    tracer::world::World,
};

/// The side of a tile, in pixels.
pub(super) const TILE: u32 = 16;
/// How many geometries a thread projects before it looks for other work.
const CHUNK: usize = 1 << 14;
/// How many entries bins may have before a region is rather cut in two, above one for each
/// geometry: half a gigabyte.
const ENTRIES: u64 = 1 << 26;

/// The spheres of a region of the picture, by tiles of [`TILE`] times [`TILE`] pixels.
pub(crate) struct Bins {
    pub(super) region: Region,
    pub(super) layout: Layout,
    /// The geometries that are planes; they have no tile.
    pub(super) planes: Vec<u32>,
    /// Consecutive rows of tiles.
    groups: Vec<Group>,
    /// How many rows of tiles a group has.
    rows: u32,
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
        let mut projected = pool.map(
            geometries.chunks(CHUNK).enumerate(),
            |(chunk, geometries)| {
                isa.run(Project {
                    screen: view.screen.as_ref(),
                    region,
                    geometries,
                    first: (chunk * CHUNK) as u32,
                })
            },
        );
        let planes = projected.iter_mut().flat_map(|part| part.planes.drain(..));
        let planes = planes.collect();

        let tiles_down = region.height.div_ceil(TILE);
        let rows = tiles_down.div_ceil(pool.threads() as u32);
        let tops = (0..tiles_down).step_by(rows as usize);
        let parts: Vec<&[Footprint]> = projected.iter().map(|part| &part.footprints[..]).collect();
        let counted = pool.map(tops, |top| Counted::new(&parts, region, top..top + rows));
        let entries: u64 = counted.iter().map(|group| group.total).sum();
        if entries > ENTRIES + geometries.len() as u64 && region.width.max(region.height) > TILE {
            return None;
        }
        let layout = Layout::new(geometries.len());
        let groups = pool.map(counted, |group| group.sort(&parts, layout));
        Some(Self {
            region,
            layout,
            planes,
            groups,
            rows,
        })
    }

    /// The entries of a tile, which counts from the left and from the top of the region.
    pub(super) fn entries(&self, across: u32, down: u32) -> &[u64] {
        let group = &self.groups[(down / self.rows) as usize];
        let tile = (down % self.rows * self.region.width.div_ceil(TILE) + across) as usize;
        &group.entries[group.starts[tile] as usize..group.starts[tile + 1] as usize]
    }
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
    fn new(parts: &[&[Footprint]], region: Region, rows: Range<u32>) -> Self {
        let across = region.width.div_ceil(TILE) as usize;
        let mut counts = vec![0; across * rows.len() + 2];
        let mut total = 0;
        each_tile(parts, &rows, |_, down, tiles| {
            total += tiles.len() as u64;
            let first = down as usize * across + 2;
            for count in &mut counts[first + tiles.start as usize..first + tiles.end as usize] {
                *count += 1;
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
    fn sort(self, parts: &[&[Footprint]], layout: Layout) -> Group {
        let across = self.region.width.div_ceil(TILE) as usize;
        let mut starts = self.counts;
        let mut sum = 0;
        for start in &mut starts {
            sum += *start;
            *start = sum;
        }
        let mut entries = vec![0; self.total as usize];
        each_tile(parts, &self.rows, |footprint, down, tiles| {
            let top = (down + self.rows.start) * TILE;
            let rows = within(footprint.top, footprint.bottom, top);
            let head = layout.head(footprint) | rows.0 << 4 | rows.1 << 12;
            for tile in tiles {
                let columns = within(footprint.left, footprint.right, tile * TILE);
                let next = &mut starts[down as usize * across + tile as usize + 1];
                entries[*next as usize] = head | columns.0 | columns.1 << 8;
                *next += 1;
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

/// Calls `each` with the tiles of each row of tiles that a footprint lies in; the row counts
/// from the first of `rows`.
#[inline(always)]
fn each_tile(
    parts: &[&[Footprint]],
    rows: &Range<u32>,
    mut each: impl FnMut(&Footprint, u32, Range<u32>),
) {
    for footprint in parts.iter().copied().flatten() {
        let top = (u32::from(footprint.top) / TILE).max(rows.start);
        let bottom = (u32::from(footprint.bottom) / TILE).min(rows.end - 1);
        let tiles = u32::from(footprint.left) / TILE..u32::from(footprint.right) / TILE + 1;
        for down in top..bottom + 1 {
            each(footprint, down - rows.start, tiles.clone());
        }
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
