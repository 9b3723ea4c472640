//! The geometry that each pixel of a tile sees: planes are tested first, then all other shapes from
//! near to far.

use std::ops::Range;

use glam::DVec3;

use crate::{
    accel::{
        first_of_each,
        lanes::{bits, first_root},
        prefetch_inside,
        raster::{
            binned::Binned,
            bins::pixels,
            grouping::{ACROSS, GROUPS, HIGH, TILE, WIDE},
            planes::{NumberedPlane, relevant},
            rays::{Parallel, Pinhole, Rays},
            view::{Grid, RasterView},
        },
    },
    film::colors::NOTHING,
    simd::{F64x8, Kernel, LANES, Mask, Simd},
    tracer::{
        camera::Camera,
        shape::{
            Shape,
            face::{Crossing, Leaving},
        },
        world::World,
    },
};

/// Number of shapes between two checks that the rest is hidden.
pub(super) const PATIENCE: usize = 8;
/// The largest number of shapes that are sorted at once; longer lists are sorted in parts. Tests
/// use less.
const MANY: usize = if cfg!(test) { 8 } else { 256 };
/// Number of shapes by which prefetching is ahead.
const AHEAD: usize = 10;

/// A number for each pixel of a tile, by groups.
pub(super) type Groups = [[f64; LANES]; GROUPS];

/// The kernel that draws some tiles of a tile row.
pub(super) struct Draw<'a> {
    pub(super) view: &'a RasterView<'a>,
    pub(super) world: &'a World,
    pub(super) planes: &'a [NumberedPlane],
    pub(super) grid: &'a Grid,
    pub(super) bins: &'a Binned,
    /// The index of the tile row.
    pub(super) down: u32,
    /// The tiles of that row.
    pub(super) across: Range<u32>,
    /// The pixels of these tiles: the geometry that each sees.
    pub(super) rows: Vec<&'a mut [u32]>,
    /// The t of these hits, initially infinite; empty if not requested.
    pub(super) t: Vec<&'a mut [f64]>,
}

impl Kernel for Draw<'_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        match self.view.camera {
            Camera::Perspective(camera) => {
                let eye = camera.basis.eye;
                self.draw(simd, &Pinhole { eye });
            }
            Camera::Orthographic(camera) => {
                self.draw(simd, &Parallel::new(-camera.basis.w));
            }
        }
    }
}

/// x, y and z of the pixel rows, for each row of groups in a tile.
pub(super) type Rows = [[[f64; LANES]; 3]; GROUPS / ACROSS];

/// Returns the lanes of at most a tile's pixel rows; a single row in a group is repeated.
pub(super) fn lanes_of(rows: &[DVec3]) -> Rows {
    let mut lanes = [[[0.0; LANES]; 3]; GROUPS / ACROSS];
    for (lanes, rows) in lanes.iter_mut().zip(rows.chunks(HIGH)) {
        for (axis, lanes) in lanes.iter_mut().enumerate() {
            for (lanes, row) in lanes.chunks_mut(WIDE).zip(rows.iter().chain(rows)) {
                lanes.fill(row[axis]);
            }
        }
    }
    lanes
}

/// The state of the current tile.
pub(super) struct Tile {
    points: [Groups; 3],
    /// A of the quadratic equation.
    a: Groups,
    /// The nearest hit so far.
    pub(super) t: Groups,
    /// The geometry of that hit; see [`number`].
    pub(super) seen: Groups,
}

/// Returns an f64 whose low bits are the index of a geometry.
#[inline(always)]
pub(super) fn number(index: u32) -> f64 {
    f64::from_bits(EXACT | u64::from(index))
}

/// The bits of 2⁵²; the floats above it are integers.
const EXACT: u64 = 0x4330_0000_0000_0000;

impl Draw<'_> {
    #[inline(always)]
    fn draw<S: Simd, R: Rays<S>>(mut self, simd: S, rays: &R) {
        let mut tile = Tile::new();
        let (mut entries, mut planes) = (Vec::new(), Vec::new());
        let height = self.rows.len();
        let top = (self.down * TILE) as usize;
        let rows = &self.grid.rows[top..top + height];
        let (upper, lower) = (rows[0], rows[height - 1]);
        let rows = lanes_of(rows);
        let bins = self.bins.row(self.down);
        for across in self.across.clone() {
            let left = (across * TILE) as usize;
            let from = left - (self.across.start * TILE) as usize;
            let width = (self.rows[0].len() - from).min(TILE as usize);

            // Planes.
            let [first, last] = [left, left + width - 1].map(|column| self.grid.column(column));
            let corners = [first + upper, last + upper, first + lower, last + lower];
            let simple = self.planes_between(rays, corners, &mut planes);
            let behind = planes.first().map_or(NOTHING, |plane| plane.id);
            bins.read(across, &mut entries);
            // The t of a plane is computed from its rays.
            let simple = simple && (behind == NOTHING || self.t.is_empty());
            if simple && entries.is_empty() {
                for row in &mut self.rows {
                    row[from..from + width].fill(behind);
                }
                continue;
            }
            let touched = tile.touched(simple.then_some(behind), &entries, height);
            let (mut near, mut far) = sort_nearest(&mut entries);
            // Memory is fetched while the rays are computed.
            for entry in near.iter().take(AHEAD) {
                simd.prefetch(self.world.geometries()[self.bins.layout.index(*entry)].shape());
            }
            self.begin(simd, rays, &mut tile, touched, &planes, &rows, left);
            loop {
                let all = self.sweep(simd, rays, &mut tile, touched, near);
                // The first of the remaining entries is the nearest of them.
                let is_hidden = |next: &u64| self.hides(simd, &tile, touched, *next);
                if !all || far.first().is_none_or(is_hidden) {
                    break;
                }
                (near, far) = sort_nearest(far);
            }

            show(&tile.seen, &mut self.rows, from, width, |seen| {
                seen.to_bits() as u32
            });
            show(&tile.t, &mut self.t, from, width, |t| t);
        }
    }

    /// Writes to `planes` those that matter between the sums of four corners. As [`relevant`],
    /// returns true if there is one that all rays hit, or none.
    #[inline(always)]
    pub(super) fn planes_between<S: Simd, R: Rays<S>>(
        &self,
        rays: &R,
        corners: [DVec3; 4],
        planes: &mut Vec<NumberedPlane>,
    ) -> bool {
        if self.view.screen.is_some() {
            return relevant(self.planes, &rays.corners(corners), planes);
        }
        planes.clear();
        planes.extend_from_slice(self.planes);
        planes.is_empty()
    }

    /// Computes the rays of some groups and their nearest hits on planes.
    #[inline(always)]
    #[allow(
        clippy::too_many_arguments,
        reason = "all of it is the state of one loop"
    )]
    pub(super) fn begin<S: Simd, R: Rays<S>>(
        &self,
        simd: S,
        rays: &R,
        tile: &mut Tile,
        touched: u32,
        planes: &[NumberedPlane],
        rows: &Rows,
        left: usize,
    ) {
        for group in bits(touched) {
            let columns = &self.grid.columns[left / WIDE + group % ACROSS];
            let rows = &rows[group / ACROSS];
            let sum = [
                simd.load_twice(&columns[0]) + simd.load(&rows[0]),
                simd.load_twice(&columns[1]) + simd.load(&rows[1]),
                simd.load_twice(&columns[2]) + simd.load(&rows[2]),
            ];
            tile.begin(simd, rays, group, sum, planes);
        }
    }

    /// Returns true if a shape is certainly hidden by the hits so far.
    #[inline(always)]
    pub(super) fn hides<S: Simd>(&self, simd: S, tile: &Tile, touched: u32, entry: u64) -> bool {
        let layout = self.bins.layout;
        layout.depth(farthest(simd, tile, touched)) < layout.depth_of(entry)
    }

    /// Tests shapes from near to far, until the next is certainly hidden; returns true if all have
    /// been tested.
    #[inline(always)]
    fn sweep<S: Simd, R: Rays<S>>(
        &self,
        simd: S,
        rays: &R,
        tile: &mut Tile,
        touched: u32,
        entries: &[u64],
    ) -> bool {
        let geometries = self.world.geometries();
        let layout = self.bins.layout;
        for (place, entry) in entries.iter().enumerate() {
            if let Some(next) = entries.get(place + AHEAD) {
                simd.prefetch(geometries[layout.index(*next)].shape());
            }
            if let Some(next) = entries.get(place + AHEAD / 2) {
                prefetch_inside(simd, geometries[layout.index(*next)].shape());
            }
            if place % PATIENCE == PATIENCE - 1 && self.hides(simd, tile, touched, *entry) {
                return false;
            }
            let index = layout.index(*entry);
            let shape = geometries[index].shape();
            let bound = layout.bound(layout.depth_of(*entry));
            let id = self.world.id_of(index, 0) as u32;
            tile.meet(simd, rays, covered(*entry), shape, bound, id);
        }
        true
    }
}

impl Tile {
    pub(super) fn new() -> Self {
        Self {
            points: [[[0.0; LANES]; GROUPS]; 3],
            a: [[0.0; LANES]; GROUPS],
            t: [[0.0; LANES]; GROUPS],
            seen: [[0.0; LANES]; GROUPS],
        }
    }

    /// Returns the groups to draw in this many pixel rows. If everything else sees `behind`,
    /// records that and returns only the groups that a shape may cover.
    #[inline(always)]
    pub(super) fn touched(&mut self, behind: Option<u32>, entries: &[u64], height: usize) -> u32 {
        let touched = behind.map_or(u32::MAX, |behind| {
            self.seen = [[number(behind); LANES]; GROUPS];
            self.t = [[f64::INFINITY; LANES]; GROUPS];
            let all = entries.iter();
            all.fold(0, |groups, entry| groups | covered(*entry))
        });
        touched & (u32::MAX >> (32 - height.div_ceil(HIGH) * ACROSS))
    }

    /// Computes the rays of a group from the sums that the camera defines, and their nearest hits
    /// on planes.
    #[inline(always)]
    pub(super) fn begin<S: Simd, R: Rays<S>>(
        &mut self,
        simd: S,
        rays: &R,
        group: usize,
        sum: [S::F64; 3],
        planes: &[NumberedPlane],
    ) {
        let (point, a) = rays.points(simd, sum);
        let mut t = simd.splat(f64::INFINITY);
        let mut seen = simd.splat(number(NOTHING));
        for plane in planes {
            let found = R::meets(rays.plane(simd, plane), point);
            // Planes are in the order of the world: at an equal t the first wins.
            let nearer = simd.splat(0.0).lt(found) & found.lt(t);
            t = S::F64::select(nearer, found, t);
            seen = S::F64::select(nearer, simd.splat(number(plane.id)), seen);
        }
        for (axis, x) in self.points.iter_mut().zip(point) {
            x.store(&mut axis[group]);
        }
        a.store(&mut self.a[group]);
        t.store(&mut self.t[group]);
        seen.store(&mut self.seen[group]);
    }

    /// Returns the points of a group.
    #[inline(always)]
    pub(super) fn point<S: Simd>(&self, simd: S, group: usize) -> [S::F64; 3] {
        [
            simd.load(&self.points[0][group]),
            simd.load(&self.points[1][group]),
            simd.load(&self.points[2][group]),
        ]
    }

    /// Tests a shape that no ray hits at a smaller t than `bound` against some groups; `id` is that of
    /// its geometry, or of the first of its copies. A sphere has a fast path; any other shape is tested
    /// ray by ray.
    #[inline(always)]
    pub(super) fn meet<S: Simd, R: Rays<S>>(
        &mut self,
        simd: S,
        rays: &R,
        groups: u32,
        shape: &Shape,
        bound: f64,
        id: u32,
    ) {
        let Some(sphere) = shape.sphere() else {
            for group in bits(groups) {
                self.meet_each(simd, rays, group, shape, bound, id);
            }
            return;
        };
        let sphere = rays.sphere(simd, sphere);
        let (bound, index) = (simd.splat(bound), simd.splat(number(id)));
        for group in bits(groups) {
            self.meet_sphere(simd, rays, group % GROUPS, sphere, bound, index);
        }
    }

    /// Tests a shape against each ray of a group, as the plain loop does.
    #[inline(never)]
    fn meet_each<S: Simd, R: Rays<S>>(
        &mut self,
        simd: S,
        rays: &R,
        group: usize,
        shape: &Shape,
        bound: f64,
        id: u32,
    ) {
        let (t, seen) = (&mut self.t[group], &mut self.seen[group]);
        // At an equal t the lower id may still win.
        // In place: `map` of an array is a call.
        let mut t_max = *t;
        for t in &mut t_max {
            *t = if *t < bound { 0.0 } else { t.next_up() };
        }
        if t_max == [0.0; LANES] {
            return;
        }
        let [x, y, z] = &self.points;
        let points = [x[group], y[group], z[group]];
        let bundle = rays.bundle(points, t_max);
        let found = first_of_each(simd, shape, &bundle, &[Leaving::NOTHING; LANES]);
        let id_of = |crossing: &Crossing| match shape.copies() {
            Some(copies) => number(id + copies.copy_of(crossing.face) as u32),
            None => number(id),
        };
        for lane in 0..LANES {
            let Some(crossing) = &found[lane] else {
                continue;
            };
            let id = id_of(crossing);
            if crossing.t < t[lane] || id < seen[lane] {
                (t[lane], seen[lane]) = (crossing.t, id);
            }
        }
    }

    /// Tests a sphere that no ray hits at a smaller t than `bound`.
    #[inline(always)]
    fn meet_sphere<S: Simd, R: Rays<S>>(
        &mut self,
        simd: S,
        rays: &R,
        group: usize,
        sphere: R::Sphere,
        bound: S::F64,
        index: S::F64,
    ) {
        let t = simd.load(&self.t[group]);
        if bound.le(t).bits() == 0 {
            return;
        }
        let a = simd.load(&self.a[group]);
        let terms = R::terms(sphere, self.point(simd, group));
        let Some((found, counts)) = first_root(simd, rays, a, terms, simd.splat(0.0)) else {
            return;
        };
        let seen = simd.load(&self.seen[group]);
        let wins = counts & (found.lt(t) | (found.eq(t) & index.lt(seen)));
        S::F64::select(wins, found, t).store(&mut self.t[group]);
        S::F64::select(wins, index, seen).store(&mut self.seen[group]);
    }
}

/// Writes a number for each pixel of a tile to this many columns of the rows.
#[inline(always)]
pub(super) fn show<T: Copy + Default>(
    groups: &Groups,
    rows: &mut [&mut [T]],
    from: usize,
    width: usize,
    convert: impl Fn(f64) -> T + Copy,
) {
    for (rows, groups) in rows.chunks_mut(HIGH).zip(groups.as_chunks::<ACROSS>().0) {
        let mut shown = [[T::default(); TILE as usize]; HIGH];
        for (group, first) in groups.iter().zip((0..).step_by(WIDE)) {
            let pixels = group.map(convert);
            for (row, pixels) in shown.iter_mut().zip(pixels.as_chunks::<WIDE>().0) {
                row[first..first + WIDE].copy_from_slice(pixels);
            }
        }
        for (row, shown) in rows.iter_mut().zip(shown) {
            let row = &mut row[from..from + width];
            // A full row is copied without a call.
            match row.first_chunk_mut() {
                Some(row) => *row = shown,
                None => row.copy_from_slice(&shown[..width]),
            }
        }
    }
}

/// Splits entries into the nearest, sorted, which are to be tested next, and the rest: if many
/// shapes are behind one another, most are never tested.
pub(super) fn sort_nearest(entries: &mut [u64]) -> (&mut [u64], &mut [u64]) {
    let count = entries.len();
    let portion = if count > MANY { count / 4 } else { count };
    if portion < count {
        entries.select_nth_unstable(portion);
    }
    let (near, far) = entries.split_at_mut(portion);
    near.sort_unstable();
    (near, far)
}

/// Returns the groups of a tile that an entry's pixels are in: bit i is group i.
#[inline(always)]
pub(super) fn covered(entry: u64) -> u32 {
    let [left, right, top, bottom] = pixels(entry);
    let columns: u32 = (2 << (right / WIDE)) - (1 << (left / WIDE));
    // Repeated for each row of groups.
    let columns = columns * (u32::MAX / ((1 << ACROSS) - 1));
    let (top, bottom) = (top / HIGH, bottom / HIGH);
    let rows = u32::MAX >> (32 - ACROSS * (bottom - top + 1));
    columns & rows << (ACROSS * top)
}

/// Returns an upper bound of the nearest hits of all pixels in a tile.
#[inline(always)]
pub(super) fn farthest<S: Simd>(simd: S, tile: &Tile, touched: u32) -> f32 {
    let mut farthest = simd.splat(0.0);
    for group in bits(touched) {
        farthest = simd.load(&tile.t[group]).max(farthest);
    }
    let mut lanes = [0.0; LANES];
    farthest.store(&mut lanes);
    let farthest = lanes.into_iter().fold(0.0, f64::max);
    // The rounding error of an f32 is at most 2⁻²⁴ of it, or the smallest f32.
    (farthest * (1.0 + 1.0 / f64::from(1 << 22))) as f32 + f32::MIN_POSITIVE
}
