//! The world as a light sees it, and the tiles of that picture.
//!
//! A point light sees the six faces of a cube around it, parallel light a plane. A shape is
//! represented by a ball, and its bounds hold for every ray that the equations of the format, in
//! f64, find to hit it: as `bvh/frame.rs` derives, the point of a ray at a computed `t` lies within
//! `r + 1.42e-7 · M` of the center of a sphere, M being the larger of r and of the distance from the
//! ray's origin to the center. Here that distance is at most the distance of the origin from the
//! light (or the middle of the world) plus that of the center. Points that are farther away than
//! [`FAR`] times all balls have no bounds.
//!
//! The directions of the rays and the coordinates in this picture round by some u = 2⁻⁵³ of the same
//! distances, which is thousands of times less than that.

use std::ops::Range;

use glam::DVec3;

use crate::{
    accel::{
        lanes::{abs, dot, splat3, sub},
        rounding,
        runs::{count, pieces},
        shadow::casters::{Casters, Toward},
    },
    parallel::Pool,
    simd::{F64x8, Simd},
    tracer::{geometry::Geometry, shape::Extent, world::World},
};

/// The range of lengths of which products of four neither overflow nor lose digits at the lower
/// end.
const ORDINARY: std::ops::RangeInclusive<f64> = 1e-50..=1e50;
/// The growth of balls as a part of the distances; see above.
const GROWTH: f64 = 1.5e-7;
/// The farthest points, as a multiple of the size of the world.
const FAR: f64 = 64.0;
/// The farthest eye from which the rounding errors of a point are much less than the growth of balls.
const NEAR: f64 = 256.0;
/// The largest number of tiles side by side.
const MOST: f64 = 512.0;
/// The least such limit, which grows with the number of balls.
const LEAST: f64 = 16.0;
/// The side of a tile, in typical diameters of balls.
const SIDE: f64 = 2.0;
/// The number of balls from which the typical diameter is found.
const TYPICAL: usize = 1024;
/// Number of geometries that a thread looks at at once.
const TOGETHER: usize = 1 << 14;

/// Returns the ball around a shape that is not a plane.
#[inline(always)]
pub(super) fn ball(geometry: &Geometry) -> Option<(DVec3, f64)> {
    match geometry.shape().extent() {
        Extent::Plane(_) => None,
        Extent::Ball(center, radius) => match geometry.shape().sphere() {
            Some(_) => Some((center, radius)),
            None => Some((center, radius + rounding(center.abs() + radius))),
        },
    }
}

/// Returns true if a ball has bounds.
#[inline(always)]
pub(super) fn is_ordinary(center: DVec3, radius: f64) -> bool {
    ORDINARY.contains(&radius) && center.abs().max_element() <= *ORDINARY.end()
}

/// What casts shadows among some geometries of a world.
pub(super) struct Survey {
    pub(super) planes: Vec<u32>,
    pub(super) odd: Vec<u32>,
    /// The corners of the box around all ordinary balls.
    pub(super) corners: [DVec3; 2],
    /// Their number.
    balls: usize,
    /// Some of these balls.
    typical: Vec<(DVec3, f64)>,
}

impl Survey {
    pub(super) fn new(world: &World, runs: &[Range<usize>], casters: Casters, pool: &Pool) -> Self {
        let geometries = world.geometries();
        let step = count(runs) / TYPICAL + 1;
        let parts = pool.map(pieces(runs, TOGETHER), |piece| {
            let mut part = Self::nothing();
            for (index, geometry) in piece.clone().zip(&geometries[piece]) {
                if casters.hold(geometry) {
                    part.see(index, geometry, index % step == 0);
                }
            }
            part
        });
        parts.into_iter().fold(Self::nothing(), Self::and)
    }

    /// Returns true if nothing casts shadows.
    pub(super) fn is_empty(&self) -> bool {
        self.planes.is_empty() && self.odd.is_empty() && !self.has_balls()
    }

    fn has_balls(&self) -> bool {
        self.balls > 0
    }

    const fn nothing() -> Self {
        Self {
            planes: Vec::new(),
            odd: Vec::new(),
            corners: [DVec3::INFINITY, DVec3::NEG_INFINITY],
            balls: 0,
            typical: Vec::new(),
        }
    }

    #[inline]
    fn see(&mut self, index: usize, geometry: &Geometry, is_typical: bool) {
        match ball(geometry) {
            Some((center, radius)) if is_ordinary(center, radius) => {
                let [low, high] = self.corners;
                self.corners = [low.min(center - radius), high.max(center + radius)];
                self.balls += 1;
                if is_typical {
                    self.typical.push((center, radius));
                }
            }
            Some(_) => self.odd.push(index as u32),
            None => self.planes.push(index as u32),
        }
    }

    fn and(mut self, other: Self) -> Self {
        self.planes.extend(other.planes);
        self.odd.extend(other.odd);
        self.typical.extend(other.typical);
        self.balls += other.balls;
        self.reach(other.corners);
        self
    }

    /// Grows the box around all ordinary balls by another one.
    pub(super) fn reach(&mut self, other: [DVec3; 2]) {
        self.corners = both(self.corners, other);
    }
}

/// Returns the corners of the box around two others.
pub(super) fn both([low, high]: [DVec3; 2], [lower, higher]: [DVec3; 2]) -> [DVec3; 2] {
    [low.min(lower), high.max(higher)]
}

/// The tiles of a face.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Grid {
    /// The lower end of the first tile in each direction.
    pub(super) low: [f64; 2],
    /// The number of tiles in each direction.
    pub(super) count: [f64; 2],
    /// The number of the first tile.
    pub(super) first: usize,
}

/// The picture that a light sees.
#[derive(Clone, Copy, Debug)]
pub(super) struct Frame {
    toward: Toward,
    /// The light, or the middle of the world.
    origin: DVec3,
    /// For parallel light: two axes of the picture, and the direction that the light travels in.
    axes: [DVec3; 3],
    /// The size of the world from the origin.
    reach: f64,
    /// The corners of the box around all balls, from the origin.
    corners: [DVec3; 2],
    /// The side of a tile.
    side: f64,
    /// The largest number of tiles side by side.
    most: f64,
    pub(super) grids: [Grid; 6],
    /// The number of tiles of all faces.
    pub(super) tiles: usize,
}

/// Eight points as the light sees them.
pub(super) struct Seen<S: Simd> {
    /// Their coordinates on the faces.
    pub(super) at: [S::F64; 2],
    /// Their distance along the axis of the face.
    pub(super) depth: S::F64,
    /// The numbers of the faces.
    pub(super) face: S::F64,
    /// True for points that have bounds.
    pub(super) has_bounds: S::Mask,
}

/// Eight balls as a face sees them.
pub(super) struct Bounds<S: Simd> {
    /// The tiles from and to which they may cast shadows, in both directions.
    pub(super) low: [S::F64; 2],
    pub(super) high: [S::F64; 2],
    /// No point at a smaller depth is shadowed.
    pub(super) near: S::F64,
    /// True for balls in front of the light.
    pub(super) seen: S::Mask,
}

impl Frame {
    /// Returns the picture, with bounds for points that are far from some box; `None` if there are no bounds.
    pub(super) fn new(toward: Toward, survey: &Survey, whole: [DVec3; 2]) -> Option<Self> {
        let [low, high] = survey.corners;
        let is_empty = !survey.has_balls();
        let middle = if is_empty {
            DVec3::ZERO
        } else {
            (low + high) * 0.5
        };
        let (origin, axes) = match toward {
            Toward::Point(light) => (light, [DVec3::X, DVec3::Y, DVec3::Z]),
            Toward::Direction(direction) => {
                if !ORDINARY.contains(&direction.length()) {
                    return None;
                }
                let along = -direction / direction.length();
                let (u, v) = along.any_orthonormal_pair();
                (middle, [u, v, along])
            }
        };
        let corners = [low - origin, high - origin];
        let [lower, higher] = whole.map(|corner| (corner - origin).abs());
        let reach = lower.max(higher).length();
        let has_bounds = is_empty || ORDINARY.contains(&reach);
        if !has_bounds || origin.abs().max_element() > *ORDINARY.end() {
            return None;
        }
        let mut frame = Self {
            toward,
            origin,
            axes,
            reach: if is_empty {
                *ORDINARY.end() / FAR
            } else {
                reach
            },
            corners,
            side: 0.0,
            most: (4.0 * (survey.balls as f64).sqrt()).clamp(LEAST, MOST),
            grids: [Grid::default(); 6],
            tiles: 0,
        };
        if !is_empty {
            let diameter = frame.diameter(&survey.typical);
            frame.divide(SIDE * diameter);
        }
        Some(frame)
    }

    /// Returns the median of the diameters of balls, as the light sees them.
    fn diameter(&self, balls: &[(DVec3, f64)]) -> f64 {
        let diameter = |(center, radius): &(DVec3, f64)| match self.toward {
            Toward::Direction(_) => 2.0 * radius,
            Toward::Point(light) => 2.0 * radius / (*center - light).length().max(*radius),
        };
        let mut all: Vec<_> = balls.iter().map(diameter).collect();
        all.sort_unstable_by(f64::total_cmp);
        all.get(all.len() / 2).copied().unwrap_or(1.0)
    }

    /// Returns the same picture with tiles that are larger, each step twice as much.
    pub(super) fn coarser(&self, step: i32) -> Self {
        let mut frame = *self;
        if step > 0 && self.tiles > 0 {
            frame.divide(self.side * libm::ldexp(1.0, step));
        }
        frame
    }

    /// Returns the rays from whose origins points are seen so exactly that the lists hold all shapes that they
    /// lie on.
    #[inline(always)]
    pub(super) fn is_near<S: Simd>(&self, simd: S, origin: [S::F64; 3]) -> S::Mask {
        let [x, y, z] = sub(origin, splat3(simd, self.origin));
        let away = abs(x).max(abs(y)).max(abs(z));
        away.le(simd.splat(NEAR * self.reach))
    }

    /// Returns true if there are bounds for all points that are no farther than `distance` from
    /// `eye`.
    pub(super) fn reaches(&self, eye: DVec3, distance: f64) -> bool {
        (eye - self.origin).length() + distance < 0.9 * FAR * self.reach
    }

    /// Divides the faces into tiles of about this side.
    fn divide(&mut self, side: f64) {
        let mut areas = [None; 6];
        for (face, area) in areas.iter_mut().enumerate() {
            *area = self.area(face);
        }
        let longest = areas.iter().flatten().flatten();
        let longest = longest.fold(0.0_f64, |most, [low, high]| most.max(high - low));
        // The last is thousands of times the rounding errors.
        self.side = side
            .max(longest / (self.most - 4.0))
            .max(1e3 * self.slack());
        self.tiles = 0;
        for (grid, area) in self.grids.iter_mut().zip(areas) {
            let Some(area) = area else {
                *grid = Grid::default();
                continue;
            };
            // One more on each side, for rounding errors.
            let count = area.map(|[low, high]| ((high - low) / self.side).ceil() + 2.0);
            *grid = Grid {
                low: area.map(|[low, _]| low - self.side),
                count,
                first: self.tiles,
            };
            self.tiles += (count[0] * count[1]) as usize;
        }
    }

    /// Returns the part of a face that balls may cover.
    fn area(&self, face: usize) -> Option<[[f64; 2]; 2]> {
        let growth = DVec3::splat(3.0 * FAR * GROWTH * self.reach);
        let [low, high] = [self.corners[0] - growth, self.corners[1] + growth];
        let corner = |number: usize| {
            let bit = |axis: usize| number >> axis & 1 == 1;
            let pick = |axis| if bit(axis) { high[axis] } else { low[axis] };
            DVec3::new(pick(0), pick(1), pick(2))
        };
        let mut area = [[f64::INFINITY, f64::NEG_INFINITY]; 2];
        let mut include = |at: [f64; 2]| {
            for ([low, high], at) in area.iter_mut().zip(at) {
                (*low, *high) = (low.min(at), high.max(at));
            }
        };
        match self.toward {
            Toward::Direction(_) => {
                if face > 0 {
                    return None;
                }
                let [u, v, _] = self.axes;
                (0..8).for_each(|number| include([corner(number).dot(u), corner(number).dot(v)]));
            }
            Toward::Point(_) => {
                let (m, a, b) = (face % 3, (face + 1) % 3, (face + 2) % 3);
                let sign = if face < 3 { 1.0 } else { -1.0 };
                let depths = [low[m] * sign, high[m] * sign];
                if depths[0].max(depths[1]) <= 0.0 {
                    return None;
                }
                if depths[0].min(depths[1]) <= 1e-9 * self.reach {
                    return Some([[-1.0, 1.0]; 2]);
                }
                (0..8).for_each(|number| {
                    let corner = corner(number);
                    let depth = corner[m].abs();
                    include([corner[a] / depth, corner[b] / depth].map(|x| x.clamp(-1.0, 1.0)));
                });
            }
        }
        Some(area)
    }

    /// The rounding errors of coordinates on a face.
    fn slack(&self) -> f64 {
        match self.toward {
            Toward::Point(_) => 1e-11,
            Toward::Direction(_) => 1e-11 * self.reach,
        }
    }

    /// Returns the factor from coordinates to tiles.
    pub(super) fn scale(&self) -> f64 {
        1.0 / self.side
    }

    /// Returns eight points as the light sees them.
    #[inline(always)]
    pub(super) fn see<S: Simd>(&self, simd: S, point: [S::F64; 3]) -> Seen<S> {
        let q = sub(point, splat3(simd, self.origin));
        let [x, y, z] = [q[0].max(-q[0]), q[1].max(-q[1]), q[2].max(-q[2])];
        let most = x.max(y).max(z);
        let far = simd.splat(FAR * self.reach);
        let has_bounds = x.le(far) & y.le(far) & z.le(far);
        let least = simd.splat(*ORDINARY.start());
        match self.toward {
            Toward::Direction(_) => {
                let at = [
                    dot(q, splat3(simd, self.axes[0])),
                    dot(q, splat3(simd, self.axes[1])),
                ];
                Seen {
                    at,
                    depth: dot(q, splat3(simd, self.axes[2])),
                    face: simd.splat(0.0),
                    has_bounds,
                }
            }
            Toward::Point(_) => {
                let (is_x, is_y) = (x.eq(most), y.eq(most));
                let a = S::F64::select(is_x, q[1], S::F64::select(is_y, q[2], q[0]));
                let b = S::F64::select(is_x, q[2], S::F64::select(is_y, q[0], q[1]));
                let m = S::F64::select(is_x, q[0], S::F64::select(is_y, q[1], q[2]));
                let (zero, one) = (simd.splat(0.0), simd.splat(1.0));
                let axis = S::F64::select(is_x, zero, S::F64::select(is_y, one, one + one));
                let is_behind = m.lt(zero);
                let three = simd.splat(3.0);
                // A multiple of the rounding errors of this is allowed for.
                let inverse = one / most;
                Seen {
                    at: [a * inverse, b * inverse],
                    depth: most,
                    face: axis + S::F64::select(is_behind, three, zero),
                    has_bounds: has_bounds & least.le(most),
                }
            }
        }
    }

    /// Returns the coordinates of points on a face in tiles.
    #[inline(always)]
    pub(super) fn in_tiles<S: Simd>(&self, simd: S, seen: &Seen<S>, face: usize) -> [S::F64; 2] {
        let (grid, scale) = (&self.grids[face], simd.splat(self.scale()));
        [
            (seen.at[0] - simd.splat(grid.low[0])) * scale,
            (seen.at[1] - simd.splat(grid.low[1])) * scale,
        ]
    }

    /// Returns eight balls as a face sees them.
    #[inline(always)]
    pub(super) fn bounds<S: Simd>(
        &self,
        simd: S,
        face: usize,
        (center, radius): ([S::F64; 3], S::F64),
    ) -> Bounds<S> {
        let s = sub(center, splat3(simd, self.origin));
        let distance = dot(s, s).sqrt();
        // No point is farther away than the corner of a cube.
        let farthest = simd.splat(2.0 * FAR * self.reach);
        let grown = simd.splat(GROWTH) * (distance + farthest + radius);
        let r = radius + grown;
        let (depth, across, along) = match self.toward {
            Toward::Direction(_) => {
                let u = dot(s, splat3(simd, self.axes[0]));
                let v = dot(s, splat3(simd, self.axes[1]));
                let depth = dot(s, splat3(simd, self.axes[2]));
                (depth, [u - r, u + r], [v - r, v + r])
            }
            Toward::Point(_) => {
                let depth = if face < 3 { s[face % 3] } else { -s[face % 3] };
                let across = slopes(simd, s[(face + 1) % 3], depth, r);
                let along = slopes(simd, s[(face + 2) % 3], depth, r);
                (depth, across, along)
            }
        };
        let (grid, scale) = (&self.grids[face], simd.splat(self.scale()));
        // Tiles are numbered in f64 and compared in f32.
        let slack = simd.splat(self.slack() * self.scale() + 1e-3);
        let low = [simd.splat(grid.low[0]), simd.splat(grid.low[1])];
        let near = depth - r;
        let seen = match self.toward {
            Toward::Direction(_) => near.eq(near),
            Toward::Point(_) => simd.splat(0.0).lt(depth + r),
        };
        Bounds {
            low: [
                (across[0] - low[0]) * scale - slack,
                (along[0] - low[1]) * scale - slack,
            ],
            high: [
                (across[1] - low[0]) * scale + slack,
                (along[1] - low[1]) * scale + slack,
            ],
            near,
            seen,
        }
    }
}

/// Returns the lowest and the highest slope `x/z` of the rays in front of the light that meet a
/// circle around (x, z) with the radius r: its tangents, as in `raster/footprint.rs`. A side is
/// unbounded if its tangent points backwards, or if the light is almost in the circle.
///
/// Unless it is, the length of the tangent has lost only two digits, so that slopes of at most 1 are
/// off by less than 1e-13.
#[inline(always)]
fn slopes<S: Simd>(simd: S, x: S::F64, z: S::F64, r: S::F64) -> [S::F64; 2] {
    let zero = simd.splat(0.0);
    let far = x * x + z * z;
    let apart = far - r * r;
    let outside = (far * simd.splat(1e-2)).lt(apart);
    let l = apart.max(zero).sqrt();
    let (low, before_low) = (x * l - z * r, z * l + x * r);
    let (high, before_high) = (x * l + z * r, z * l - x * r);
    let behind = z.lt(zero);
    let has_low = outside & zero.lt(before_low) & !(behind & x.lt(zero));
    let has_high = outside & zero.lt(before_high) & !(behind & zero.lt(x));
    [
        S::F64::select(has_low, low / before_low, simd.splat(f64::NEG_INFINITY)),
        S::F64::select(has_high, high / before_high, simd.splat(f64::INFINITY)),
    ]
}
