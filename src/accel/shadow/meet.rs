//! The exact test of points against the shapes that may shadow them, eight points at a time.

use glam::DVec3;

use crate::{
    accel::{
        lanes::{Divide, dot, splat3, sub},
        shadow::{
            Casting, Points, Shadowed, Toward,
            bins::{Bins, Blocker, Task},
            place::{above, larger},
        },
    },
    simd::{F32x8, F64x8, Kernel, LANES, Mask, Simd},
    tracer::shape::{Shape, sphere::Sphere},
};

/// The largest number of blockers of a tile. Longer lists are slower than a tree.
const MANY: usize = 1 << 12;

/// The kernel that finds the dark points of some tiles.
pub(super) struct Meet<'a> {
    pub(super) casting: &'a Casting<'a>,
    pub(super) points: Points<'a>,
    pub(super) bins: &'a Bins,
    pub(super) task: Task,
}

/// Up to eight blockers of a tile.
struct Eight {
    near: [f32; LANES],
    low: [[f32; LANES]; 2],
    high: [[f32; LANES]; 2],
    index: [u32; LANES],
}

impl Eight {
    /// No blockers: no point is in their bounds.
    const NONE: Self = Self {
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

/// Up to eight points.
struct Group {
    places: [u32; LANES],
    own: [u32; LANES],
    at: [[f64; LANES]; 3],
    count: usize,
}

/// The shadow rays of a group.
struct Rays<S: Simd> {
    origin: [S::F64; 3],
    direction: [S::F64; 3],
    /// `d·d`
    a: S::F64,
    t_max: S::F64,
}

/// The division of the equations.
struct Plain;

impl<S: Simd> Divide<S> for Plain {}

impl Kernel for Meet<'_> {
    type Output = Shadowed;

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> Shadowed {
        let mut found = Shadowed::default();
        let mut blockers = Vec::new();
        let mut group = Group {
            places: [0; LANES],
            own: [0; LANES],
            at: [[0.0; LANES]; 3],
            count: 0,
        };
        for tile in self.task.tiles.clone() {
            let entries = self.bins.blockers(tile);
            if entries.len() > MANY {
                for portion in self.task.portions.clone() {
                    let places = self.bins.places(portion, tile);
                    found.open.extend_from_slice(places);
                }
                continue;
            }
            let mut is_ready = false;
            let face = self.bins.face(tile);
            for portion in self.task.portions.clone() {
                for place in self.bins.places(portion, tile) {
                    if !is_ready {
                        is_ready = true;
                        self.gather(simd, entries, &mut blockers);
                    }
                    let lane = group.count;
                    let at = *place as usize;
                    group.places[lane] = *place;
                    group.own[lane] = self.points.own[at];
                    group.at[0][lane] = self.points.at[0][at];
                    group.at[1][lane] = self.points.at[1][at];
                    group.at[2][lane] = self.points.at[2][at];
                    group.count += 1;
                    if group.count == LANES {
                        self.meet(simd, &group, &mut blockers, face, &mut found);
                        group.count = 0;
                    }
                }
            }
            if group.count > 0 {
                self.meet(simd, &group, &mut blockers, face, &mut found);
                group.count = 0;
            }
        }
        found
    }
}

impl Meet<'_> {
    /// Copies the blockers of a tile.
    #[inline(always)]
    fn gather<S: Simd>(&self, simd: S, entries: &[u32], blockers: &mut Vec<Eight>) {
        blockers.clear();
        let geometries = self.casting.world.geometries();
        for entries in entries.chunks(LANES) {
            let mut eight = Eight::NONE;
            for (lane, number) in entries.iter().enumerate() {
                let blocker = &self.bins.blockers[*number as usize];
                simd.prefetch(geometries[blocker.index as usize].shape());
                eight.set(lane, blocker);
            }
            blockers.push(eight);
        }
    }

    #[inline(always)]
    fn meet<S: Simd>(
        &self,
        simd: S,
        group: &Group,
        blockers: &mut [Eight],
        face: usize,
        found: &mut Shadowed,
    ) {
        let origin = [
            simd.load(&group.at[0]),
            simd.load(&group.at[1]),
            simd.load(&group.at[2]),
        ];
        let direction = match self.casting.toward {
            Toward::Point(light) => sub(splat3(simd, light), origin),
            Toward::Direction(direction) => splat3(simd, direction),
        };
        let rays = Rays {
            origin,
            direction,
            a: dot(direction, direction),
            t_max: simd.splat(self.casting.toward.t_max()),
        };
        let all = u8::MAX >> (LANES - group.count);
        let mut lit = all & !self.leaves(simd, &rays, group, all, found);
        if lit != 0 && !self.casting.planes.is_empty() {
            lit = self.meet_planes(simd, &rays, group, lit);
        }
        for index in &self.casting.odd {
            let shape = self.casting.world.geometries()[*index as usize].shape();
            lit = self.meet_each(group, lit, shape);
        }
        if lit != 0 && !blockers.is_empty() {
            lit = self.meet_blockers(simd, &rays, group, blockers, face, lit);
        }
        let mut dark = all & !lit;
        while dark != 0 {
            let lane = dark.trailing_zeros() as usize;
            dark &= dark - 1;
            found.dark.push(group.places[lane]);
        }
    }

    /// Returns the points on spheres that cast shadows whose rays meet the far side of that sphere.
    #[inline(always)]
    fn leaves<S: Simd>(
        &self,
        simd: S,
        rays: &Rays<S>,
        group: &Group,
        all: u8,
        found: &mut Shadowed,
    ) -> u8 {
        let geometries = self.casting.world.geometries();
        let mut center = [[f64::NAN; LANES]; 3];
        for lane in 0..group.count {
            let shape = geometries[group.own[lane] as usize].shape();
            if let Some(sphere) = shape.sphere() {
                let c = sphere.center();
                center[0][lane] = c.x;
                center[1][lane] = c.y;
                center[2][lane] = c.z;
            }
        }
        let center = [
            simd.load(&center[0]),
            simd.load(&center[1]),
            simd.load(&center[2]),
        ];
        let (oc, two) = (sub(rays.origin, center), simd.splat(2.0));
        let b = dot(rays.direction, [two * oc[0], two * oc[1], two * oc[2]]);
        let t = -b / rays.a;
        let mut leaves = (simd.splat(0.0).lt(t) & t.lt(rays.t_max)).bits() & all;
        let mut dark = leaves;
        while leaves != 0 {
            let lane = leaves.trailing_zeros() as usize;
            leaves &= leaves - 1;
            if !self
                .casting
                .casters
                .hold(&geometries[group.own[lane] as usize])
            {
                // An equal sphere may cast one.
                dark &= !(1 << lane);
                found.open.push(group.places[lane]);
            }
        }
        dark
    }

    /// Returns the points that no plane shadows.
    #[inline(always)]
    fn meet_planes<S: Simd>(&self, simd: S, rays: &Rays<S>, group: &Group, mut lit: u8) -> u8 {
        let geometries = self.casting.world.geometries();
        for (index, plane) in &self.casting.planes {
            let normal = splat3(simd, plane.normal());
            let numerator = dot(sub(splat3(simd, plane.point()), rays.origin), normal);
            // With a denominator of 0, t is infinite or NaN.
            let t = numerator / dot(rays.direction, normal);
            let hits = (simd.splat(0.0).lt(t) & t.lt(rays.t_max)).bits() & lit;
            if hits != 0 {
                lit &= !self.others(group, hits, *index, geometries[*index as usize].shape());
            }
        }
        lit
    }

    /// Returns the hits of a geometry that count: those of rays that leave another surface.
    #[inline(always)]
    fn others(&self, group: &Group, mut hits: u8, index: u32, shape: &Shape) -> u8 {
        let geometries = self.casting.world.geometries();
        let mut others = hits;
        while hits != 0 {
            let lane = hits.trailing_zeros() as usize;
            hits &= hits - 1;
            let own = group.own[lane];
            if own == index || geometries[own as usize].shape().shares_surface(shape) {
                others &= !(1 << lane);
            }
        }
        others
    }

    /// Tests a shape against each ray, as the plain loop does.
    #[inline(never)]
    fn meet_each(&self, group: &Group, mut lit: u8, shape: &Shape) -> u8 {
        let (toward, geometries) = (self.casting.toward, self.casting.world.geometries());
        for lane in 0..LANES {
            if lit >> lane & 1 == 1 {
                let point = DVec3::from(group.at.map(|axis| axis[lane]));
                let own = geometries[group.own[lane] as usize].shape();
                let [first, _] = shape.crossings_from(own, &toward.ray(point), toward.t_max());
                lit &= !(u8::from(first.is_some()) << lane);
            }
        }
        lit
    }

    /// Returns the points that no blocker shadows.
    #[inline(always)]
    fn meet_blockers<S: Simd>(
        &self,
        simd: S,
        rays: &Rays<S>,
        group: &Group,
        blockers: &mut [Eight],
        face: usize,
        mut lit: u8,
    ) -> u8 {
        let geometries = self.casting.world.geometries();
        let area = self.area(simd, rays.origin, face, lit);
        let low = [simd.splat_f32(area.low[0]), simd.splat_f32(area.low[1])];
        let high = [simd.splat_f32(area.high[0]), simd.splat_f32(area.high[1])];
        let far = simd.splat_f32(area.far);
        for number in 0..blockers.len() {
            let eight = &blockers[number];
            let mut near = simd.load_f32(&eight.near).le(far)
                & simd.load_f32(&eight.low[0]).le(high[0])
                & simd.load_f32(&eight.low[1]).le(high[1])
                & low[0].le(simd.load_f32(&eight.high[0]))
                & low[1].le(simd.load_f32(&eight.high[1]));
            while near != 0 {
                let lane = near.trailing_zeros() as usize;
                near &= near - 1;
                let index = eight.index[lane];
                let shape = geometries[index as usize].shape();
                let Some(sphere) = shape.sphere() else {
                    lit = self.meet_each(group, lit, shape);
                    continue;
                };
                let hits = meet_sphere(simd, rays, sphere) & lit;
                if hits != 0 {
                    lit &= !self.others(group, hits, index, shape);
                    if lit == 0 {
                        // The next points are likely to be shadowed by the same.
                        blockers.swap(0, number);
                        return 0;
                    }
                }
            }
        }
        lit
    }

    /// Returns the part of a face that some points lie in, in tiles.
    #[inline(always)]
    fn area<S: Simd>(&self, simd: S, points: [S::F64; 3], face: usize, lanes: u8) -> Area {
        let frame = &self.bins.frame;
        let seen = frame.see(simd, points);
        let at = frame.in_tiles(simd, &seen, face);
        let [mut x, mut y, mut depth] = [[0.0; LANES]; 3];
        at[0].store(&mut x);
        at[1].store(&mut y);
        seen.depth.store(&mut depth);
        if lanes != u8::MAX {
            // Any of the other points represents those that do not count.
            let some = lanes.trailing_zeros() as usize;
            for lane in 0..LANES {
                if lanes >> lane & 1 == 0 {
                    (x[lane], y[lane], depth[lane]) = (x[some], y[some], depth[some]);
                }
            }
        }
        Area {
            low: [-most(x.map(|x| -x)) as f32, -most(y.map(|y| -y)) as f32],
            high: [most(x) as f32, most(y) as f32],
            far: above(most(depth)),
        }
    }
}

/// Returns the largest of eight numbers that are not NaN.
#[inline(always)]
fn most(x: [f64; LANES]) -> f64 {
    let [a, b, c, d, e, f, g, h] = x;
    let left = larger(larger(a, b), larger(c, d));
    larger(left, larger(larger(e, f), larger(g, h)))
}

/// A part of a face, and the largest depth of points there.
struct Area {
    low: [f32; 2],
    high: [f32; 2],
    far: f32,
}

/// Returns the rays that hit a sphere.
#[inline(always)]
fn meet_sphere<S: Simd>(simd: S, rays: &Rays<S>, sphere: &Sphere) -> u8 {
    let (zero, two) = (simd.splat(0.0), simd.splat(2.0));
    let radius = sphere.radius();
    let oc = sub(rays.origin, splat3(simd, sphere.center()));
    let b = dot(rays.direction, [two * oc[0], two * oc[1], two * oc[2]]);
    let c = dot(oc, oc) - simd.splat(radius * radius);
    let discriminant = b * b - (simd.splat(4.0) * rays.a) * c;
    let meets = zero.le(discriminant);
    if meets.bits() == 0 {
        return 0;
    }
    let root = discriminant.sqrt();
    let near = Plain.over_2a(simd, -b - root, rays.a);
    let hits = meets & zero.lt(near) & near.lt(rays.t_max);
    let others = meets & !hits;
    if others.bits() == 0 {
        return hits.bits();
    }
    let far = Plain.over_2a(simd, -b + root, rays.a);
    (hits | (others & zero.lt(far) & far.lt(rays.t_max))).bits()
}
