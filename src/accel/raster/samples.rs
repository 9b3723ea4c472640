//! The geometries that the samples of a pixel see: certainly the same for all, or one for each ray.
//!
//! For each pixel and each sphere, the range of t in which the rays of the pixel meet the sphere is
//! known: from the ray through the center and from the largest distance of the others from it. A
//! pixel belongs to a geometry that all of its rays meet before they can meet any other. Of shapes
//! other than spheres and planes only the smallest t is known; the samples of the pixels that they
//! may cover are tested.

use crate::{
    accel::{
        lanes::bits,
        raster::{
            bins::pixels,
            grouping::{ACROSS, GROUPS, HIGH, TILE, WIDE},
            plane_bounds::PlaneBounds,
            planes::NumberedPlane,
            rays::{Parallel, Pinhole, Rays},
            tile::{Draw, Groups, PATIENCE, Tile, covered, lanes_of, number, show, sort_nearest},
            view::HUGE,
        },
    },
    film::colors::NOTHING,
    simd::{F64x8, Kernel, LANES, Mask, Simd},
    tracer::{camera::Camera, shape::sphere::Sphere},
};

/// Number of samples that are drawn at once.
const BATCH: usize = GROUPS * LANES;

/// The kernel that draws some tiles of a tile row with several samples per pixel.
pub(super) struct DrawSamples<'a> {
    pub(super) draw: Draw<'a>,
    /// The geometries seen by the samples of each pixel that sees several. The pixel itself holds
    /// its number among these, counted on from the number of geometries.
    pub(super) seen: &'a mut Vec<u32>,
}

impl Kernel for DrawSamples<'_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        match self.draw.view.camera {
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

/// The bounds on t for each pixel of a tile.
struct Bounds {
    /// The smallest t at which anything may be hit.
    first: Groups,
    /// The largest t by which all rays have hit that; infinite if some may miss it.
    passed: Groups,
    /// The smallest t at which anything else may be hit.
    second: Groups,
}

/// A pixel whose samples may see several things.
struct Pixel {
    column: usize,
    row: usize,
    /// The depth by which all rays have hit something.
    depth: u64,
}

/// Bounds for a sphere and the rays of a pixel, in terms of `gap = r² - p²`, where p is the
/// distance of the ray through the pixel's center from the center of the sphere.
#[derive(Clone, Copy)]
struct Margin {
    /// The gap below which no ray meets the sphere: p exceeds r by more than it can change.
    missed: f64,
    /// The gap from which on all rays meet it.
    met: f64,
    /// The largest decrease of the gap within the pixel.
    loss: f64,
    /// The largest error of t.
    slack: f64,
    /// The range of t in which all rays meet the sphere, if the eye is inside of it.
    around: Option<[f64; 2]>,
}

impl Draw<'_> {
    fn margin(&self, sphere: &Sphere, spread: f64) -> Margin {
        let (eye, radius) = (self.view.camera.eye(), sphere.radius());
        let reach = self.view.reach();
        let distance = (sphere.center() - eye).length();
        let far = distance + reach;
        // Rounding errors are less than a millionth of that.
        let slack = 1e-7 * (far + radius);
        let (change, is_one_eye) = match self.view.camera {
            Camera::Perspective(_) => (far * spread, true),
            Camera::Orthographic(_) => (spread, false),
        };
        let change = change * (1.0 + 1e-6) + slack;
        let sane = 1.0 / HUGE < far + radius && far + radius < HUGE;
        let by = if sane { change } else { f64::INFINITY };
        let met = 2.0 * radius * by + by * by;
        let is_around = sane && is_one_eye && spread < 1.0 && distance < radius * (1.0 - 1e-6);
        Margin {
            missed: -met,
            met,
            loss: met,
            slack,
            around: is_around.then_some([radius - distance - slack, radius + distance + slack]),
        }
    }
}

impl DrawSamples<'_> {
    #[inline(always)]
    fn draw<S: Simd, R: Rays<S> + PlaneBounds<S>>(self, simd: S, rays: &R) {
        let Self { mut draw, seen } = self;
        let spread = draw.view.spread();
        let (mut tile, mut batch) = (Tile::new(), Tile::new());
        let (mut entries, mut planes, mut mixed) = (Vec::new(), Vec::new(), Vec::new());
        let height = draw.rows.len();
        let top = (draw.down * TILE) as usize;
        let rows = lanes_of(&draw.grid.rows[top..top + height]);
        let bins = draw.bins.row(draw.down);
        for across in draw.across.clone() {
            let left = (across * TILE) as usize;
            let from = left - (draw.across.start * TILE) as usize;
            let width = (draw.rows[0].len() - from).min(TILE as usize);

            let simple = draw.planes_of(rays, [left, top], [width, height], &mut planes);
            let behind = planes.first().map_or(NOTHING, |plane| plane.id);
            bins.read(across, &mut entries);
            if simple && entries.is_empty() {
                for row in &mut draw.rows {
                    row[from..from + width].fill(behind);
                }
                continue;
            }
            let touched = tile.touched(simple.then_some(behind), &entries, height);
            draw.begin(simd, rays, &mut tile, touched, &[], &rows, left);
            let mut bounds = Bounds::NONE;
            draw.note_planes(simd, rays, &mut tile, &mut bounds, touched, &planes);
            let (mut sorted, mut rest) = (0, &mut entries[..]);
            loop {
                let (near, far) = sort_nearest(rest);
                sorted += near.len();
                let all =
                    draw.sweep_bounds(simd, rays, &mut tile, &mut bounds, touched, near, spread);
                let is_hidden = |next: &u64| draw.hides(simd, &tile, touched, *next);
                if !all || far.first().is_none_or(is_hidden) {
                    break;
                }
                rest = far;
            }

            show(&tile.seen, &mut draw.rows, from, width, |seen| {
                seen.to_bits() as u32
            });
            draw.find_mixed(simd, &tile, &bounds, touched, [width, height], &mut mixed);
            let start = seen.len();
            draw.sample(
                simd,
                rays,
                &mut batch,
                [left, top],
                &mixed,
                &entries[..sorted],
                &planes,
                seen,
            );
            draw.show_mixed(from, &mixed, start, seen);
        }
    }
}

impl Bounds {
    /// The bounds of pixels that see nothing yet.
    const NONE: Self = Self {
        first: [[f64::INFINITY; LANES]; GROUPS],
        passed: [[f64::INFINITY; LANES]; GROUPS],
        second: [[f64::INFINITY; LANES]; GROUPS],
    };

    /// Returns the pixels of a group that may see several things.
    #[inline(always)]
    fn unclear<S: Simd>(&self, simd: S, group: usize) -> u8 {
        let first = simd.load(&self.first[group]);
        let passed = simd.load(&self.passed[group]);
        let second = simd.load(&self.second[group]);
        (first.lt(simd.splat(f64::INFINITY)) & !passed.lt(second)).bits()
    }

    /// Records that in a group a geometry may be hit from `near` on, and that all rays have hit it
    /// at `far`.
    #[inline(always)]
    fn note<S: Simd>(
        &mut self,
        simd: S,
        tile: &mut Tile,
        group: usize,
        near: S::F64,
        far: S::F64,
        index: S::F64,
    ) {
        let first = simd.load(&self.first[group]);
        let is_first = near.lt(first);
        let other = S::F64::select(is_first, first, near);
        other
            .min(simd.load(&self.second[group]))
            .store(&mut self.second[group]);
        S::F64::select(is_first, near, first).store(&mut self.first[group]);
        let passed = simd.load(&self.passed[group]);
        S::F64::select(is_first, far, passed).store(&mut self.passed[group]);
        let seen = simd.load(&tile.seen[group]);
        S::F64::select(is_first, index, seen).store(&mut tile.seen[group]);
        far.min(simd.load(&tile.t[group])).store(&mut tile.t[group]);
    }
}

impl Draw<'_> {
    /// Writes to `planes` those that matter to the samples of a tile, and returns the result of
    /// [`relevant`].
    #[inline(always)]
    fn planes_of<S: Simd, R: Rays<S>>(
        &self,
        rays: &R,
        [left, top]: [usize; 2],
        [width, height]: [usize; 2],
        planes: &mut Vec<NumberedPlane>,
    ) -> bool {
        let column = |column: usize| f64::from(self.bins.region.column) + column as f64;
        let [first, last] = [
            self.view.column(column(left) - 0.5),
            self.view.column(column(left + width - 1) + 0.5),
        ];
        let y = |row: usize| self.view.y(self.bins.region.row + row as u32);
        let [upper, lower] = [
            self.view.row(y(top) + 0.5),
            self.view.row(y(top + height - 1) - 0.5),
        ];
        let corners = [first + upper, last + upper, first + lower, last + lower];
        self.planes_between(rays, corners, planes)
    }

    /// Records where the rays of each pixel hit the planes.
    #[inline(always)]
    fn note_planes<S: Simd, R: PlaneBounds<S>>(
        &self,
        simd: S,
        rays: &R,
        tile: &mut Tile,
        bounds: &mut Bounds,
        touched: u32,
        planes: &[NumberedPlane],
    ) {
        for plane in planes {
            let terms = rays.plane_terms(simd, plane, self.view);
            let index = simd.splat(number(plane.id));
            for group in bits(touched) {
                let [near, far] = match terms {
                    Some(terms) => R::plane_bounds(simd, terms, tile.point(simd, group)),
                    None => [0.0, f64::INFINITY].map(|t| simd.splat(t)),
                };
                bounds.note(simd, tile, group, near, far, index);
            }
        }
    }

    /// Writes to `mixed` the pixels of a tile that may see several things.
    #[inline(always)]
    fn find_mixed<S: Simd>(
        &self,
        simd: S,
        tile: &Tile,
        bounds: &Bounds,
        touched: u32,
        [width, height]: [usize; 2],
        mixed: &mut Vec<Pixel>,
    ) {
        mixed.clear();
        for group in bits(touched) {
            for lane in bits(bounds.unclear(simd, group)) {
                let column = group % ACROSS * WIDE + lane % WIDE;
                let row = group / ACROSS * HIGH + lane / WIDE;
                let far = tile.t[group][lane] * (1.0 + 1e-6);
                let depth = self.bins.layout.depth(far as f32 + f32::MIN_POSITIVE);
                if column < width && row < height {
                    mixed.push(Pixel { column, row, depth });
                }
            }
        }
    }

    /// Shows what the samples of the mixed pixels see, from `start` on in `seen`. A pixel whose
    /// samples all turn out to see one geometry gets its index, and is taken out of `seen`.
    #[inline(always)]
    fn show_mixed(&mut self, from: usize, mixed: &[Pixel], start: usize, seen: &mut Vec<u32>) {
        let count = self.view.samples.count() as usize;
        let (mut next, geometries) = (start, self.world.ids());
        for (number, pixel) in mixed.iter().enumerate() {
            let found = start + number * count..start + (number + 1) * count;
            let index = seen[found.start];
            let place = &mut self.rows[pixel.row][from + pixel.column];
            if seen[found.clone()].iter().all(|other| *other == index) {
                *place = index;
            } else {
                *place = (geometries + next / count) as u32;
                seen.copy_within(found, next);
                next += count;
            }
        }
        seen.truncate(next);
    }

    /// Same as [`Draw::sweep`], but for the bounds of a pixel's rays.
    #[inline(always)]
    #[allow(
        clippy::too_many_arguments,
        reason = "all of it is the state of one loop"
    )]
    fn sweep_bounds<S: Simd, R: Rays<S>>(
        &self,
        simd: S,
        rays: &R,
        tile: &mut Tile,
        bounds: &mut Bounds,
        touched: u32,
        entries: &[u64],
        spread: f64,
    ) -> bool {
        let (zero, infinity) = (simd.splat(0.0), simd.splat(f64::INFINITY));
        let layout = self.bins.layout;
        for (place, entry) in entries.iter().enumerate() {
            if place % PATIENCE == PATIENCE - 1 && self.hides(simd, tile, touched, *entry) {
                return false;
            }
            let index = layout.index(*entry);
            let shape = self.world.geometries()[index].shape();
            let bound = simd.splat(layout.bound(layout.depth_of(*entry)));
            let index = simd.splat(number(self.world.id_of(index, 0) as u32));
            let Some(sphere) = shape.sphere() else {
                // Some rays of a pixel may hit it, others not.
                for group in bits(covered(*entry)) {
                    bounds.note(simd, tile, group, bound, infinity, index);
                }
                continue;
            };
            let margin = self.margin(sphere, spread);
            let sphere = rays.sphere(simd, sphere);
            let [missed, met, loss, slack] =
                [margin.missed, margin.met, margin.loss, margin.slack].map(|x| simd.splat(x));
            for group in bits(covered(*entry)) {
                // The sphere is behind a geometry that all rays have hit.
                if bound.le(simd.load(&tile.t[group])).bits() == 0 {
                    continue;
                }
                if let Some([near, far]) = margin.around {
                    let [near, far] = [near, far].map(|t| simd.splat(t));
                    bounds.note(simd, tile, group, near, far, index);
                    continue;
                }
                let (b, c) = R::terms(sphere, tile.point(simd, group));
                let along = b * simd.splat(-0.5);
                let gap = along * along - c;
                let may_meet = !gap.lt(missed);
                if may_meet.bits() == 0 {
                    continue;
                }
                // t(p) is even and convex: towards the middle of the sphere it decreases by no more
                // than it increases on the other side.
                let root = gap.max(zero).sqrt();
                let least = (gap - loss).max(zero).sqrt();
                let far = along - least + slack;
                let near = (along - root) - (root - least) - slack;
                let all_meet = met.le(gap) & zero.lt(near);
                let near = S::F64::select(all_meet, near, bound);
                let near = S::F64::select(may_meet, near, infinity);
                let far = S::F64::select(all_meet, far, infinity);
                bounds.note(simd, tile, group, near, far, index);
            }
        }
        true
    }

    /// Appends to `seen` the geometry of each sample of some pixels: pixel by pixel, in rows from
    /// the bottom.
    #[inline(always)]
    #[allow(
        clippy::too_many_arguments,
        reason = "all of it is the state of one loop"
    )]
    fn sample<S: Simd, R: Rays<S>>(
        &self,
        simd: S,
        rays: &R,
        batch: &mut Tile,
        [left, top]: [usize; 2],
        mixed: &[Pixel],
        entries: &[u64],
        planes: &[NumberedPlane],
        seen: &mut Vec<u32>,
    ) {
        let count = self.view.samples.count() as usize;
        let mut points = [const { Vec::new() }; 3];
        for pixels in mixed.chunks((BATCH / count).max(1)) {
            let all = pixels.len() * count;
            for start in (0..all).step_by(BATCH) {
                let end = all.min(start + BATCH);
                let mut sums = [[[0.0; LANES]; GROUPS]; 3];
                for (number, pixel) in pixels.iter().enumerate() {
                    let (column, row) = (left + pixel.column, top + pixel.row);
                    self.grid.points_of(column, row, &mut points);
                    let within = start.max(number * count)..end.min((number + 1) * count);
                    let first = within.start - number * count;
                    for (sums, points) in sums.iter_mut().zip(&points) {
                        let sums = &mut sums.as_flattened_mut()[within.start - start..];
                        sums[..within.len()].copy_from_slice(&points[first..][..within.len()]);
                    }
                }
                let groups = (end - start).div_ceil(LANES);
                let touched = u32::MAX >> (GROUPS - groups);
                for group in bits(touched) {
                    let [x, y, z] = &sums;
                    let sum = [
                        simd.load(&x[group]),
                        simd.load(&y[group]),
                        simd.load(&z[group]),
                    ];
                    batch.begin(simd, rays, group, sum, planes);
                }
                self.sweep_samples(simd, rays, batch, touched, pixels, start..end, entries);
                let found = batch.seen.as_flattened()[..end - start].iter();
                seen.extend(found.map(|seen| seen.to_bits() as u32));
            }
        }
    }

    /// Tests the shapes of a tile against the samples of some pixels.
    #[inline(always)]
    #[allow(
        clippy::too_many_arguments,
        reason = "all of it is the state of one loop"
    )]
    fn sweep_samples<S: Simd, R: Rays<S>>(
        &self,
        simd: S,
        rays: &R,
        batch: &mut Tile,
        touched: u32,
        pixels_of: &[Pixel],
        samples: std::ops::Range<usize>,
        entries: &[u64],
    ) {
        let count = self.view.samples.count() as usize;
        let layout = self.bins.layout;
        for (place, entry) in entries.iter().enumerate() {
            if place % PATIENCE == PATIENCE - 1 && self.hides(simd, batch, touched, *entry) {
                return;
            }
            let [left, right, top, bottom] = pixels(*entry);
            let depth = layout.depth_of(*entry);
            let mut groups = 0;
            for (number, pixel) in pixels_of.iter().enumerate() {
                let is_inside = left <= pixel.column && pixel.column <= right;
                if is_inside && top <= pixel.row && pixel.row <= bottom && depth <= pixel.depth {
                    let first = (number * count).max(samples.start) - samples.start;
                    let last = ((number + 1) * count).min(samples.end) - samples.start - 1;
                    groups |=
                        (u32::MAX >> (GROUPS - 1 - last / LANES)) & (u32::MAX << (first / LANES));
                }
            }
            if groups == 0 {
                continue;
            }
            let index = layout.index(*entry);
            let shape = self.world.geometries()[index].shape();
            let id = self.world.id_of(index, 0) as u32;
            batch.meet(simd, rays, groups, shape, layout.bound(depth), id);
        }
    }
}
