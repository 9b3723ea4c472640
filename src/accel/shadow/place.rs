//! The tile of each point.

use crate::{
    accel::shadow::{Points, frame::Frame},
    simd::{F64x8, Kernel, LANES, Mask, Simd},
};

/// The tiles of some points.
pub(super) struct Placed {
    /// The place of the first point.
    pub(super) first: u32,
    /// The tile of each point; [`NOWHERE`] for one without bounds or not asked for.
    pub(super) tiles: Vec<u32>,
    pub(super) counts: Vec<u32>,
    /// The largest depth in each tile, rounded up.
    pub(super) far: Vec<f32>,
    pub(super) faces: [bool; 6],
    /// The largest distance of all.
    pub(super) farthest: f64,
    pub(super) open: Vec<u32>,
}

const NOWHERE: u32 = u32::MAX;

/// The kernel that finds the tile of each point.
pub(super) struct Place<'a> {
    pub(super) frame: &'a Frame,
    pub(super) points: Points<'a>,
    /// The place of the first point.
    pub(super) first: u32,
}

impl Kernel for Place<'_> {
    type Output = Placed;

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> Placed {
        let count = self.points.own.len();
        let mut placed = Placed {
            first: self.first,
            tiles: vec![NOWHERE; count],
            counts: vec![0; self.frame.tiles + 1],
            far: vec![f32::NEG_INFINITY; self.frame.tiles + 1],
            faces: [false; 6],
            farthest: 0.0,
            open: Vec::new(),
        };
        let mut run = Run::of(0);
        for start in (0..count).step_by(LANES) {
            let width = LANES.min(count - start);
            let own = &self.points.own[start..start + width];
            let mut at = [[0.0; LANES]; 3];
            for (to, from) in at.iter_mut().zip(self.points.at) {
                match from[start..].first_chunk() {
                    Some(from) => *to = *from,
                    None => to[..width].copy_from_slice(&from[start..]),
                }
            }
            let point = [simd.load(&at[0]), simd.load(&at[1]), simd.load(&at[2])];
            self.place(simd, point, start, own, &mut placed, &mut run);
        }
        placed.add(run);
        placed
    }
}

impl Place<'_> {
    #[inline(always)]
    fn place<S: Simd>(
        &self,
        simd: S,
        point: [S::F64; 3],
        start: usize,
        own: &[u32],
        placed: &mut Placed,
        run: &mut Run,
    ) {
        let frame = self.frame;
        let seen = frame.see(simd, point);
        let bounded = seen.has_bounds.bits();
        let outside = simd.splat(frame.tiles as f64);
        let mut tile = outside;
        let face = seen.face.truncate();
        let mut faces = 0_u32;
        for face in face {
            faces |= 1 << face;
        }
        while faces != 0 {
            let number = faces.trailing_zeros() as usize;
            faces &= faces - 1;
            let grid = &frame.grids[number];
            if grid.count[0] == 0.0 {
                continue;
            }
            placed.faces[number] = true;
            let [x, y] = frame.in_tiles(simd, &seen, number);
            let zero = simd.splat(0.0);
            let [across, along] = [simd.splat(grid.count[0]), simd.splat(grid.count[1])];
            let inside = zero.le(x)
                & x.lt(across)
                & zero.le(y)
                & y.lt(along)
                & seen.face.eq(simd.splat(number as f64));
            let x = floor(simd, S::F64::select(inside, x, zero));
            let y = floor(simd, S::F64::select(inside, y, zero));
            let found = simd.splat(grid.first as f64) + (y * across + x);
            tile = S::F64::select(inside, found, tile);
        }
        let tiles = tile.truncate();
        let (mut depths, mut distances) = ([0.0; LANES], [0.0; LANES]);
        seen.depth.store(&mut depths);
        seen.distance.store(&mut distances);
        for (lane, own) in own.iter().enumerate() {
            if *own == NOWHERE {
                continue;
            }
            if bounded >> lane & 1 == 0 {
                placed.open.push(self.first + (start + lane) as u32);
                continue;
            }
            let tile = tiles[lane] as u32;
            placed.tiles[start + lane] = tile;
            if run.tile != tile {
                placed.add(*run);
                *run = Run::of(tile);
            }
            run.count += 1;
            run.depth = larger(run.depth, depths[lane]);
            run.distance = larger(run.distance, distances[lane]);
        }
    }
}

/// Consecutive points in the same tile.
#[derive(Clone, Copy)]
struct Run {
    tile: u32,
    count: u32,
    /// The largest depth.
    depth: f64,
    /// The largest distance.
    distance: f64,
}

impl Run {
    const fn of(tile: u32) -> Self {
        Self {
            tile,
            count: 0,
            depth: f64::NEG_INFINITY,
            distance: 0.0,
        }
    }
}

impl Placed {
    #[inline(always)]
    fn add(&mut self, run: Run) {
        let tile = run.tile as usize;
        self.counts[tile] += run.count;
        self.far[tile] = self.far[tile].max(above(run.depth));
        self.farthest = larger(self.farthest, run.distance);
    }
}

/// Returns the larger of two numbers that are not NaN.
#[inline(always)]
pub(super) fn larger(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

/// Returns the integral parts of numbers that are not negative.
#[inline(always)]
fn floor<S: Simd>(simd: S, x: S::F64) -> S::F64 {
    let mut lanes = [0.0; LANES];
    for (lane, x) in lanes.iter_mut().zip(x.truncate()) {
        *lane = f64::from(x);
    }
    simd.load(&lanes)
}

/// Returns an upper bound as an f32.
#[inline(always)]
pub(super) fn above(x: f64) -> f32 {
    (x + x.abs() * 1e-6) as f32
}
