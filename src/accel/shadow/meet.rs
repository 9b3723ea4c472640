//! The exact test of points against the shapes that may shadow them, eight points at a time.

use std::cell::OnceCell;

use crate::{
    accel::{
        first_of_each,
        lanes::{Divide, bits, dot, splat3, sub},
        prefetch_inside,
        shadow::{
            Casting, FoundShadows, Points,
            casters::Toward,
            lists::{Eight, Lists},
        },
    },
    film::colors::NOTHING,
    simd::{F32x8, F64x8, LANES, Mask, Simd},
    tracer::{
        ray::Bundle,
        shape::{
            Shape,
            face::{Leaving, Own},
            sphere::Sphere,
        },
    },
};

/// The largest number of times eight shapes of a tile that points are tested against. For longer
/// lists a tree is faster.
pub(super) const MANY: usize = 1 << 8;

/// The shadow rays of eight points.
struct Rays<'a, S: Simd> {
    origin: [S::F64; 3],
    direction: [S::F64; 3],
    /// `d·d`
    a: S::F64,
    t_max: S::F64,
    /// The faces that they leave, once a shape asks for them.
    owns: OnceCell<Owns<'a>>,
}

/// The faces that eight points lie on: as a rule, one or two.
struct Owns<'a> {
    different: [Option<Own<'a>>; LANES],
    /// The place of each point's among them.
    places: [usize; LANES],
}

impl Owns<'_> {
    /// Returns the parts of the faces in a shape.
    fn on(&self, shape: &Shape) -> [Leaving<'_>; LANES] {
        let mut leaving = [Leaving::NOTHING; LANES];
        for (place, own) in self.different.iter().flatten().enumerate() {
            let on_shape = own.on(shape);
            for (leaving, of) in leaving.iter_mut().zip(&self.places) {
                if *of == place {
                    *leaving = on_shape;
                }
            }
        }
        leaving
    }
}

/// The division of the equations.
struct Plain;

impl<S: Simd> Divide<S> for Plain {}

/// The places of eight points on a face.
struct Places<S: Simd> {
    /// The coordinates in tiles.
    at: [S::F64; 2],
    depth: S::F64,
}

/// A part of a face, and the largest depth of points there.
struct Area {
    low: [f32; 2],
    high: [f32; 2],
    far: f32,
}

impl<'a> Casting<'a> {
    /// Returns the shadows on points. A point is dark exactly if its shadow ray, as
    /// [`World::transmission`](crate::World) defines it, crosses one of the casters.
    ///
    /// `last` is the sphere that shadowed the last points, or [`NOTHING`]: it is likely to shadow
    /// their neighbors.
    #[inline(always)]
    pub(super) fn meet<S: Simd>(
        &self,
        simd: S,
        points: &Points<S>,
        last: &mut u32,
    ) -> FoundShadows {
        let origin = points.at;
        let direction = match self.toward {
            Toward::Point(light) => sub(splat3(simd, light), origin),
            Toward::Direction(direction) => splat3(simd, direction),
        };
        let rays = Rays {
            origin,
            direction,
            a: dot(direction, direction),
            t_max: simd.splat(self.toward.t_max()),
            owns: OnceCell::new(),
        };
        let mut open = 0;
        let mut lit = points.asked & !self.leaves(simd, &rays, points, &mut open);
        if *last != NOTHING && lit != 0 {
            let hits = match self.geometries[*last as usize].shape().sphere() {
                Some(sphere) => meet_sphere(simd, &rays, sphere) & lit,
                None => 0,
            };
            if hits == 0 {
                *last = NOTHING;
            } else {
                lit &= !self.others(points, hits, *last);
            }
        }
        if lit != 0 && !self.planes.is_empty() {
            lit = self.meet_planes(simd, &rays, points, lit);
        }
        for occluders in &self.occluders {
            for index in &occluders.odd {
                lit = self.meet_each(simd, &rays, points, lit, *index);
            }
            if lit == 0 {
                break;
            }
            match &occluders.lists {
                Some(lists) => {
                    lit = self.meet_lists(simd, &rays, points, (lists, lit), last, &mut open)
                }
                None => open = lit,
            }
        }
        FoundShadows {
            dark: points.asked & !lit,
            open: open & lit,
        }
    }

    /// Returns the points on spheres that cast shadows whose rays meet the far side of that sphere.
    #[inline(always)]
    fn leaves<S: Simd>(&self, simd: S, rays: &Rays<S>, points: &Points<S>, open: &mut u8) -> u8 {
        let (oc, two) = (sub(rays.origin, points.center), simd.splat(2.0));
        let b = dot(rays.direction, [two * oc[0], two * oc[1], two * oc[2]]);
        // Most rays leave outward.
        if b.lt(simd.splat(0.0)).bits() & points.asked == 0 {
            return 0;
        }
        let t = -b / rays.a;
        let leaves = points.is_sphere & simd.splat(0.0).lt(t) & t.lt(rays.t_max);
        let mut leaves = leaves.bits() & points.asked;
        let mut dark = leaves;
        while leaves != 0 {
            let lane = leaves.trailing_zeros() as usize;
            leaves &= leaves - 1;
            if !self
                .casters
                .hold(&self.geometries[points.own[lane] as usize])
            {
                // An equal sphere may cast one.
                dark &= !(1 << lane);
                *open |= 1 << lane;
            }
        }
        dark
    }

    /// Returns the points that no plane shadows.
    #[inline(always)]
    fn meet_planes<S: Simd>(&self, simd: S, rays: &Rays<S>, points: &Points<S>, mut lit: u8) -> u8 {
        for (index, plane) in &self.planes {
            let normal = splat3(simd, plane.normal());
            let numerator = dot(sub(splat3(simd, plane.point()), rays.origin), normal);
            let denominator = dot(rays.direction, normal);
            let zero = simd.splat(0.0);
            let ahead = (zero.lt(numerator) & zero.lt(denominator))
                | (numerator.lt(zero) & denominator.lt(zero));
            // Otherwise, t is negative, infinite or NaN.
            if ahead.bits() & lit == 0 {
                continue;
            }
            let t = numerator / denominator;
            let hits = (simd.splat(0.0).lt(t) & t.lt(rays.t_max)).bits() & lit;
            if hits != 0 {
                lit &= !self.others(points, hits, *index);
            }
        }
        lit
    }

    /// Returns the hits of a geometry that count: those of rays that leave another surface.
    #[inline(always)]
    fn others<S: Simd>(&self, points: &Points<S>, mut hits: u8, index: u32) -> u8 {
        let shape = self.geometries[index as usize].shape();
        let mut others = hits;
        while hits != 0 {
            let lane = hits.trailing_zeros() as usize;
            hits &= hits - 1;
            let own = points.own[lane];
            let is_own = own == index
                || match shape.sphere() {
                    Some(sphere) => self.geometries[own as usize].shape().sphere() == Some(sphere),
                    None => self.is_all_of(own, points.faces[lane], shape),
                };
            if is_own {
                others &= !(1 << lane);
            }
        }
        others
    }

    /// Returns true if the only face of a shape is the same surface as a face of a geometry, at least in
    /// part. Spheres do not come here: a call in a kernel is dear.
    #[cold]
    #[inline(never)]
    fn is_all_of(&self, own: u32, face: u64, shape: &Shape) -> bool {
        let own = self.geometries[own as usize].shape();
        Own::new(own, face).is_all_of(shape)
    }

    /// Returns the faces that the points lie on.
    #[inline(never)]
    fn owns(&self, asked: u8, own: &[u32; LANES], faces: &[u64; LANES]) -> Owns<'a> {
        let (mut different, mut count) = ([None; LANES], 0);
        let mut places = [LANES; LANES];
        for lane in (0..LANES).filter(|lane| asked >> lane & 1 == 1) {
            let is_same = |other: &usize| {
                places[*other] < LANES && own[*other] == own[lane] && faces[*other] == faces[lane]
            };
            places[lane] = match (0..lane).find(is_same) {
                Some(other) => places[other],
                None => {
                    let shape = self.geometries[own[lane] as usize].shape();
                    different[count] = Some(Own::new(shape, faces[lane]));
                    count += 1;
                    count - 1
                }
            };
        }
        Owns { different, places }
    }

    /// Tests a shape against each ray, as the plain loop does.
    #[inline(always)]
    fn meet_each<S: Simd>(
        &self,
        simd: S,
        rays: &Rays<'a, S>,
        points: &Points<S>,
        lit: u8,
        index: u32,
    ) -> u8 {
        if lit == 0 {
            return 0;
        }
        let owns = || self.owns(points.asked, points.own, points.faces);
        let owns = rays.owns.get_or_init(owns);
        let mut lines = [[[0.0; LANES]; 3]; 2];
        for (lines, vectors) in lines.iter_mut().zip([rays.origin, rays.direction]) {
            for (line, axis) in lines.iter_mut().zip(vectors) {
                axis.store(line);
            }
        }
        let shape = self.geometries[index as usize].shape();
        meet_bundle(simd, lines, (lit, self.toward.t_max()), owns, shape)
    }

    /// Returns the points that no other shape shadows.
    #[inline(always)]
    fn meet_lists<S: Simd>(
        &self,
        simd: S,
        rays: &Rays<'a, S>,
        points: &Points<S>,
        (lists, mut lit): (&Lists, u8),
        last: &mut u32,
        open: &mut u8,
    ) -> u8 {
        if lists.is_empty() {
            return lit;
        }
        let frame = &lists.frame;
        let seen = frame.see(simd, rays.origin);
        let has_bounds = seen.has_bounds.bits();
        *open |= lit & !has_bounds;
        let faces = seen.face.truncate();
        let mut rest = lit & has_bounds;
        while rest != 0 {
            let face = faces[rest.trailing_zeros() as usize];
            let on_face = seen.face.eq(simd.splat(f64::from(face)));
            let is_asked = rest;
            rest &= !on_face.bits();
            let grid = &frame.grids[face as usize];
            let at = frame.in_tiles(simd, &seen, face as usize);
            let zero = simd.splat(0.0);
            let inside = on_face
                & zero.le(at[0])
                & at[0].lt(simd.splat(grid.count[0]))
                & zero.le(at[1])
                & at[1].lt(simd.splat(grid.count[1]));
            let mut inside_asked = inside.bits() & is_asked;
            if inside_asked == 0 {
                continue;
            }
            let at = [
                S::F64::select(inside, at[0], zero),
                S::F64::select(inside, at[1], zero),
            ];
            let tiles = [at[0].truncate(), at[1].truncate()];
            let places = Places {
                at,
                depth: seen.depth,
            };
            while inside_asked != 0 {
                let first = inside_asked.trailing_zeros() as usize;
                let [across, along] = [tiles[0][first], tiles[1][first]];
                let mut same = 0;
                for (lane, (x, y)) in tiles[0].iter().zip(&tiles[1]).enumerate() {
                    same |= u8::from(*x == across && *y == along) << lane;
                }
                same &= inside_asked;
                inside_asked &= !same;
                let tile = grid.first + along as usize * grid.count[0] as usize + across as usize;
                let list = lists.of(tile);
                if list.len() > MANY {
                    *open |= same;
                } else if !list.is_empty() {
                    let dark =
                        same & !self.meet_list(simd, rays, points, (list, &places, same), last);
                    lit &= !dark;
                }
            }
        }
        lit
    }

    /// Returns which of some points in a tile none of its shapes shadows.
    #[inline(always)]
    fn meet_list<S: Simd>(
        &self,
        simd: S,
        rays: &Rays<'a, S>,
        points: &Points<S>,
        (list, places, mut lit): (&[Eight], &Places<S>, u8),
        last: &mut u32,
    ) -> u8 {
        let area = places.area(simd, lit);
        let low = [simd.splat_f32(area.low[0]), simd.splat_f32(area.low[1])];
        let high = [simd.splat_f32(area.high[0]), simd.splat_f32(area.high[1])];
        let far = simd.splat_f32(area.far);
        for eight in list {
            if area.far < eight.least {
                break;
            }
            let mut near = simd.load_f32(&eight.near).le(far)
                & simd.load_f32(&eight.low[0]).le(high[0])
                & simd.load_f32(&eight.low[1]).le(high[1])
                & low[0].le(simd.load_f32(&eight.high[0]))
                & low[1].le(simd.load_f32(&eight.high[1]));
            let shape = |lane: usize| self.geometries[eight.index[lane] as usize].shape();
            for lane in bits(near) {
                simd.prefetch(shape(lane));
            }
            for lane in bits(near) {
                prefetch_inside(simd, shape(lane));
            }
            while near != 0 {
                let lane = near.trailing_zeros() as usize;
                near &= near - 1;
                let index = eight.index[lane];
                let Some(sphere) = self.geometries[index as usize].shape().sphere() else {
                    lit = self.meet_each(simd, rays, points, lit, index);
                    if lit == 0 {
                        return 0;
                    }
                    continue;
                };
                let hits = meet_sphere(simd, rays, sphere) & lit;
                if hits != 0 {
                    let others = self.others(points, hits, index);
                    if others != 0 {
                        *last = index;
                        lit &= !others;
                        if lit == 0 {
                            return 0;
                        }
                    }
                }
            }
        }
        lit
    }
}

/// Returns the rays that do not meet a shape.
#[inline(never)]
fn meet_bundle<S: Simd>(
    simd: S,
    [origins, directions]: [[[f64; LANES]; 3]; 2],
    (lit, end): (u8, f64),
    owns: &Owns,
    shape: &Shape,
) -> u8 {
    let t_max = |lane: usize| if lit >> lane & 1 == 1 { end } else { 0.0 };
    let bundle = Bundle::new(origins, directions, std::array::from_fn(t_max));
    let met = first_of_each(simd, shape, &bundle, &owns.on(shape));
    (0..LANES).fold(lit, |lit, lane| {
        lit & !(u8::from(met[lane].is_some()) << lane)
    })
}

impl<S: Simd> Places<S> {
    /// Returns the part of the face that some points lie in.
    #[inline(always)]
    fn area(&self, simd: S, lanes: u8) -> Area {
        let lanes = simd.mask(lanes);
        let infinity = simd.splat(f64::INFINITY);
        let most = |x: S::F64| S::F64::select(lanes, x, -infinity).largest();
        let least = |x: S::F64| S::F64::select(lanes, x, infinity).smallest();
        Area {
            low: [least(self.at[0]) as f32, least(self.at[1]) as f32],
            high: [most(self.at[0]) as f32, most(self.at[1]) as f32],
            far: above(most(self.depth)),
        }
    }
}

/// Returns an upper bound as an f32.
#[inline(always)]
fn above(x: f64) -> f32 {
    (x + x.abs() * 1e-6) as f32
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
