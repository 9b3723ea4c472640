//! The exact test of points against the shapes that may shadow them, eight points at a time.

use std::slice;

use crate::{
    accel::{
        first_of_each,
        lanes::{Divide, abs, bits, dot, splat3, sub},
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
            contact::ContactPoint,
            face::{Crossing, FaceId, Leaving},
            sphere::Sphere,
        },
    },
};

/// The largest number of times eight shapes of a tile that points are tested against. For longer
/// lists a tree is faster.
pub(super) const MANY: usize = 1 << 8;

/// The shadow rays of eight points.
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
        };
        let mut open = 0;
        let mut lit = points.asked & !self.leaves(simd, &rays, points);
        if *last != NOTHING && lit != 0 {
            let hits = match self.world.geometries()[*last as usize].shape().sphere() {
                Some(sphere) => {
                    self.meet_sphere(simd, &rays, points, (*last, sphere), &mut open) & lit
                }
                None => 0,
            };
            lit &= !hits;
            if hits == 0 {
                *last = NOTHING;
            }
        }
        if lit != 0 && !self.planes.is_empty() {
            lit = self.meet_planes(simd, &rays, points, lit, &mut open);
        }
        for occluders in &self.occluders {
            for index in &occluders.odd {
                lit = self.meet_each(simd, &rays, points, lit, *index, &mut open);
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
    fn leaves<S: Simd>(&self, simd: S, rays: &Rays<S>, points: &Points<S>) -> u8 {
        let (oc, two) = (sub(rays.origin, points.center), simd.splat(2.0));
        let b = dot(rays.direction, [two * oc[0], two * oc[1], two * oc[2]]);
        // Most rays leave outward.
        if b.lt(simd.splat(0.0)).bits() & points.asked == 0 {
            return 0;
        }
        let t = -b / rays.a;
        let leaves = points.is_sphere & simd.splat(0.0).lt(t) & t.lt(rays.t_max);
        let mut dark = leaves.bits() & points.asked;
        for lane in bits(dark) {
            let own = &self.world.geometries()[points.own[lane] as usize];
            if !self.casters.hold(own) {
                dark &= !(1 << lane);
            }
        }
        dark
    }

    /// Returns the points that no plane shadows.
    #[inline(always)]
    fn meet_planes<S: Simd>(
        &self,
        simd: S,
        rays: &Rays<S>,
        points: &Points<S>,
        mut lit: u8,
        open: &mut u8,
    ) -> u8 {
        for (index, plane) in &self.planes {
            let normal = splat3(simd, plane.normal());
            let numerator = dot(sub(splat3(simd, plane.point()), rays.origin), normal);
            let denominator = dot(rays.direction, normal);
            let zero = simd.splat(0.0);
            let touching = simd.splat(points.slack_of_plane(plane));
            let near = abs(numerator).le(touching).bits() & lit;
            let ahead = (zero.lt(numerator) & zero.lt(denominator))
                | (numerator.lt(zero) & denominator.lt(zero));
            // Otherwise, t is negative, infinite or NaN.
            if ahead.bits() & lit | near == 0 {
                continue;
            }
            let t = numerator / denominator;
            let hits = (simd.splat(0.0).lt(t) & t.lt(rays.t_max)).bits() & lit;
            lit &= !self.others(points, [hits, near], *index, open);
        }
        lit
    }

    /// Returns the hits of a geometry that count: those of rays that leave other surfaces. Notes the points
    /// that lie on the geometry, given those that may.
    #[inline(always)]
    fn others<S: Simd>(
        &self,
        points: &Points<S>,
        [hits, near]: [u8; 2],
        index: u32,
        open: &mut u8,
    ) -> u8 {
        let own = points.on(index);
        let near = near & points.asked & !own;
        match near {
            0 => hits & !own,
            _ => {
                let touched = self.touched(points, near, index);
                *open |= touched;
                hits & !(own | touched)
            }
        }
    }

    /// Returns which of some points lie on a geometry, which is not the one that was hit.
    #[cold]
    #[inline(never)]
    fn touched<S: Simd>(&self, points: &Points<S>, near: u8, index: u32) -> u8 {
        let shape = self.world.geometries()[index as usize].shape();
        let mut touched = 0;
        for lane in bits(near) {
            let (ray, t) = points.ray(lane);
            let mut is_touched = false;
            shape.each_face_near(&ContactPoint::vague(&ray, t), &mut |face| {
                is_touched |= face.is_touched;
            });
            if is_touched {
                let (own, face) = (points.own[lane] as usize, points.faces[lane]);
                let among = [own, index as usize];
                let each = |_, see: &mut dyn FnMut(usize)| among.into_iter().for_each(see);
                let contact = self.world.contact(&ray, (own, Crossing { t, face }), each);
                touched |= u8::from(contact.is_some()) << lane;
            }
        }
        touched
    }

    /// Tests a shape against each ray, as the plain loop does.
    #[inline(always)]
    fn meet_each<S: Simd>(
        &self,
        simd: S,
        rays: &Rays<S>,
        points: &Points<S>,
        mut lit: u8,
        index: u32,
        open: &mut u8,
    ) -> u8 {
        if lit == 0 {
            return 0;
        }
        let shape = self.world.geometries()[index as usize].shape();
        let mut lines = [[[0.0; LANES]; 3]; 2];
        for (lines, vectors) in lines.iter_mut().zip([rays.origin, rays.direction]) {
            for (line, axis) in lines.iter_mut().zip(vectors) {
                axis.store(line);
            }
        }
        let mut touched = lit & !points.on(index);
        if touched != 0 {
            touched = points.near(simd, (&lines[0], touched), shape);
        }
        if touched != 0 {
            touched = self.touched(points, touched, index);
            *open |= touched;
            lit &= !touched;
        }
        let left: [FaceId; LANES] = std::array::from_fn(|lane| FaceId {
            geometry: points.own[lane] as usize,
            face: points.faces[lane],
        });
        meet_bundle(
            simd,
            lines,
            (lit, self.toward.t_max()),
            (&left, index),
            shape,
        ) | touched
    }

    /// Returns the points that no other shape shadows.
    #[inline(always)]
    fn meet_lists<S: Simd>(
        &self,
        simd: S,
        rays: &Rays<S>,
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
        let is_near = frame.is_near(simd, points.rays.0[0]);
        let has_bounds = (seen.has_bounds & is_near).bits();
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
                    let dark = same
                        & !self.meet_list(simd, rays, points, (list, &places, same), last, open);
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
        rays: &Rays<S>,
        points: &Points<S>,
        (list, places, mut lit): (&[Eight], &Places<S>, u8),
        last: &mut u32,
        open: &mut u8,
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
            let geometries = self.world.geometries();
            let shape = |lane: usize| geometries[eight.index[lane] as usize].shape();
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
                let Some(sphere) = geometries[index as usize].shape().sphere() else {
                    lit = self.meet_each(simd, rays, points, lit, index, open);
                    if lit == 0 {
                        return 0;
                    }
                    continue;
                };
                let hits = self.meet_sphere(simd, rays, points, (index, sphere), open) & lit;
                if hits != 0 {
                    *last = index;
                    lit &= !hits;
                    if lit == 0 {
                        return 0;
                    }
                }
            }
        }
        lit
    }

    /// Returns the rays that hit a sphere. Notes the points that lie on it.
    #[inline(always)]
    fn meet_sphere<S: Simd>(
        &self,
        simd: S,
        rays: &Rays<S>,
        points: &Points<S>,
        (index, sphere): (u32, &Sphere),
        open: &mut u8,
    ) -> u8 {
        let (zero, two) = (simd.splat(0.0), simd.splat(2.0));
        let radius = sphere.radius();
        // By so much less, the equation of a point on the sphere may be wrong.
        let slack = points.slack_of_ball(radius);
        let oc = sub(rays.origin, splat3(simd, sphere.center()));
        let b = dot(rays.direction, [two * oc[0], two * oc[1], two * oc[2]]);
        let (squared, of_radius) = (dot(oc, oc), radius * radius);
        let (bb, a4) = (b * b, simd.splat(4.0) * rays.a);
        let grown = bb - a4 * (squared - simd.splat(of_radius + slack));
        if zero.le(grown).bits() == 0 {
            return 0;
        }
        let c = squared - simd.splat(of_radius);
        let near = abs(c).le(simd.splat(slack)).bits();
        let discriminant = bb - a4 * c;
        let meets = zero.le(discriminant);
        let root = discriminant.sqrt();
        let first = Plain.over_2a(simd, -b - root, rays.a);
        let hits = meets & zero.lt(first) & first.lt(rays.t_max);
        let others = meets & !hits;
        let mut hits = hits.bits();
        if others.bits() != 0 {
            let last = Plain.over_2a(simd, -b + root, rays.a);
            hits |= (others & zero.lt(last) & last.lt(rays.t_max)).bits();
        }
        match hits | near {
            0 => 0,
            _ => self.others(points, [hits, near], index, open),
        }
    }
}

/// Returns the rays that do not meet a shape.
#[inline(never)]
fn meet_bundle<S: Simd>(
    simd: S,
    [origins, directions]: [[[f64; LANES]; 3]; 2],
    (lit, end): (u8, f64),
    (left, index): (&[FaceId; LANES], u32),
    shape: &Shape,
) -> u8 {
    let t_max = |lane: usize| if lit >> lane & 1 == 1 { end } else { 0.0 };
    let bundle = Bundle::new(origins, directions, std::array::from_fn(t_max)).any();
    let leaving = left
        .each_ref()
        .map(|left| match left.geometry == index as usize {
            true => Leaving::of(slice::from_ref(left), index as usize),
            false => Leaving::NOTHING,
        });
    let met = first_of_each(simd, shape, &bundle, &leaving);
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
