//! Points sorted by tile, and the shapes that may shadow a point of a tile.

use std::ops::Range;

use crate::{
    accel::shadow::{
        Casters, Casting, Points,
        frame::{Frame, ball, is_ordinary},
        place::{Place, Placed},
    },
    parallel::Pool,
    simd::{F64x8, Isa, Kernel, LANES, Mask, Simd},
    tracer::geometry::Geometry,
};

/// Number of geometries that a thread projects at once.
const CHUNK: usize = 1 << 13;
/// The least number of points that a thread sorts.
const PORTION: usize = 1 << 16;
/// Number of points that a thread tests at once.
const TASK: usize = 1 << 14;

/// Points and shapes by tile. The last tile holds the points that no bounded shape can shadow.
pub(super) struct Bins {
    pub(super) frame: Frame,
    /// The points, in several portions.
    portions: Vec<Portion>,
    pub(super) blockers: Vec<Blocker>,
    /// The start of each tile's entries, and the end of the last.
    starts: Vec<u32>,
    /// The blockers of each tile.
    entries: Vec<u32>,
    /// The points without bounds.
    pub(super) open: Vec<u32>,
}

/// A shape that may shadow points.
#[derive(Clone, Copy, Debug)]
pub(super) struct Blocker {
    pub(super) index: u32,
    /// No point at a smaller depth is shadowed.
    pub(super) near: f32,
    /// The bounds on the face, in tiles: the lower ones, then the upper ones.
    pub(super) low: [f32; 2],
    pub(super) high: [f32; 2],
    face: u8,
}

/// A part of the points, by tile.
struct Portion {
    /// The start of each tile's points, and the end of the last.
    starts: Vec<u32>,
    places: Vec<u32>,
}

/// Tiles whose points are tested by one thread.
#[derive(Clone, Debug)]
pub(super) struct Task {
    pub(super) tiles: Range<usize>,
    /// The portions of the points.
    pub(super) portions: Range<usize>,
}

impl Bins {
    /// Sorts points and shapes; `None` if there would be too many entries, so that larger tiles are
    /// needed.
    pub(super) fn new(
        casting: &Casting,
        frame: Frame,
        points: Points,
        pool: &Pool,
        isa: Isa,
    ) -> Option<Self> {
        let count = points.own.len();
        let portion = count.div_ceil(pool.threads()).max(PORTION);
        let starts = (0..count).step_by(portion);
        let placed = pool.map(starts, |start| {
            let range = start..count.min(start + portion);
            isa.run(Place {
                frame: &frame,
                points: Points {
                    at: points.at.map(|axis| &axis[range.clone()]),
                    own: &points.own[range.clone()],
                },
                first: start as u32,
            })
        });
        let mut far = vec![f32::NEG_INFINITY; frame.tiles];
        let (mut faces, mut farthest, mut open) = ([false; 6], 0.0_f64, Vec::new());
        for part in &placed {
            for (far, part) in far.iter_mut().zip(&part.far) {
                *far = far.max(*part);
            }
            for (face, part) in faces.iter_mut().zip(part.faces) {
                *face |= part;
            }
            farthest = farthest.max(part.farthest);
            open.extend_from_slice(&part.open);
        }
        let geometries = casting.world.geometries();
        let most = 16 * (geometries.len() + frame.tiles) + (1 << 16);
        let blockers = pool.map(geometries.chunks(CHUNK).enumerate(), |(chunk, some)| {
            isa.run(Project {
                frame: &frame,
                casters: casting.casters,
                geometries: some,
                first: (chunk * CHUNK) as u32,
                faces,
                // No point is farther away than the corner of a cube.
                farthest: 2.0 * farthest,
                far: &far,
                most,
            })
        });
        if blockers.iter().map(|(_, entries)| entries).sum::<usize>() > most {
            return None;
        }
        let blockers = match <[_; 1]>::try_from(blockers) {
            Ok([(blockers, _)]) => blockers,
            Err(parts) => parts.into_iter().flat_map(|(part, _)| part).collect(),
        };
        let (starts, entries) = sort(&frame, &blockers, &far);
        let portions = pool.map(placed, Portion::sort);
        Some(Self {
            frame,
            portions,
            blockers,
            starts,
            entries,
            open,
        })
    }

    /// Returns the blockers of a tile.
    pub(super) fn blockers(&self, tile: usize) -> &[u32] {
        match self.starts.get(tile..tile + 2) {
            Some([start, end]) => &self.entries[*start as usize..*end as usize],
            _ => &[],
        }
    }

    /// Returns the points of a tile in a portion.
    pub(super) fn places(&self, portion: usize, tile: usize) -> &[u32] {
        let Portion { starts, places } = &self.portions[portion];
        &places[starts[tile] as usize..starts[tile + 1] as usize]
    }

    /// Returns work of about equal size: tiles that together have enough points, and the portions of
    /// single tiles that have many.
    pub(super) fn tasks(&self, threads: usize) -> Vec<Task> {
        let all = 0..self.portions.len();
        if threads == 1 {
            return vec![Task {
                tiles: 0..self.frame.tiles + 1,
                portions: all,
            }];
        }
        let mut tasks = Vec::new();
        let (mut first, mut count) = (0, 0);
        for tile in 0..=self.frame.tiles {
            let portions = all.clone();
            let points: usize = portions.map(|part| self.places(part, tile).len()).sum();
            if points > TASK {
                tasks.push(Task {
                    tiles: first..tile,
                    portions: all.clone(),
                });
                tasks.extend(all.clone().map(|portion| Task {
                    tiles: tile..tile + 1,
                    portions: portion..portion + 1,
                }));
                (first, count) = (tile + 1, 0);
                continue;
            }
            count += points;
            if count > TASK || tile == self.frame.tiles {
                tasks.push(Task {
                    tiles: first..tile + 1,
                    portions: all.clone(),
                });
                (first, count) = (tile + 1, 0);
            }
        }
        tasks
    }

    /// Returns the number of the tile's face.
    pub(super) fn face(&self, tile: usize) -> usize {
        let mut faces = (0..6).rev();
        let grids = &self.frame.grids;
        let holds = |face: &usize| grids[*face].count[0] > 0.0 && grids[*face].first <= tile;
        faces.find(holds).unwrap_or(0)
    }
}

impl Portion {
    /// Sorts points by tile (counting sort).
    fn sort(placed: Placed) -> Self {
        let mut starts = placed.counts;
        let mut total = 0;
        for start in &mut starts {
            let count = *start;
            *start = total;
            total += count;
        }
        let mut places = vec![0; total as usize];
        for (tile, place) in placed.tiles.iter().zip(placed.first..) {
            if let Some(next) = starts.get_mut(*tile as usize) {
                places[*next as usize] = place;
                *next += 1;
            }
        }
        // Each start has become the end: that of the next.
        starts.insert(0, 0);
        Self { starts, places }
    }
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

/// Calls `see` for each tile that has points which a blocker may shadow.
#[inline(always)]
fn each_tile(frame: &Frame, blocker: &Blocker, far: &[f32], mut see: impl FnMut(usize)) {
    let [across, along] = tiles_of(frame, blocker);
    let grid = &frame.grids[usize::from(blocker.face)];
    for row in along {
        let first = grid.first + row * grid.count[0] as usize;
        let tiles = first + across.start..first + across.end.max(across.start);
        for (tile, far) in tiles.clone().zip(&far[tiles]) {
            if blocker.near <= *far {
                see(tile);
            }
        }
    }
}

/// Sorts blockers by tile; returns the start of each tile, and the entries.
fn sort(frame: &Frame, blockers: &[Blocker], far: &[f32]) -> (Vec<u32>, Vec<u32>) {
    let mut starts = vec![0_u32; frame.tiles + 2];
    for blocker in blockers {
        each_tile(frame, blocker, far, |tile| starts[tile + 2] += 1);
    }
    let mut total = 0;
    for start in &mut starts {
        total += *start;
        *start = total;
    }
    let mut entries = vec![0; total as usize];
    for (number, blocker) in (0..).zip(blockers) {
        each_tile(frame, blocker, far, |tile| {
            let next = &mut starts[tile + 1];
            entries[*next as usize] = number;
            *next += 1;
        });
    }
    starts.pop();
    (starts, entries)
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
    /// The faces that have points.
    faces: [bool; 6],
    farthest: f64,
    /// The largest depth in each tile.
    far: &'a [f32],
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
                if self.faces[face] {
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
        let bounds = self.frame.bounds(simd, face, balls, self.farthest);
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
            *entries += across.len() * along.len();
            let mut blocks = false;
            each_tile(self.frame, &blocker, self.far, |_| blocks = true);
            if blocks {
                blockers.push(blocker);
            }
        }
    }
}
