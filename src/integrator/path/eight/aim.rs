//! The choice of emitters and directions to them for eight points: the equations of [`Emitters`], in their order of
//! operations.

use std::f64::consts::PI;

use glam::DVec3;

use super::{
    directions::{FrameLanes, circle},
    lanes::{LaneNumbers, set, vector},
};
use crate::{
    accel::lanes::{abs, bits, dot, splat3, store3, sub},
    integrator::path::emitters::{Emitter, Emitters, LightExtent, light_of_size},
    simd::{F64x8, LANES, Mask, Simd},
    tracer::{
        contact::Departure,
        light::{
            falloff::{END, Falloff},
            source::{LightSize, Source},
        },
        radiance::Radiance,
        sampling::LocalFrame,
        shape::{
            face::FaceId,
            target::{AT_ANY_ANGLE, FlatForm, FlatTarget, Target},
        },
        world::World,
    },
};

/// The largest number of emitters that are not in a tree.
const MOST: usize = 32;

/// Points from which paths aim at emitters.
pub(super) struct EightAims<'a, S: Simd> {
    pub(super) point: [S::F64; 3],
    /// The faces that they lie on.
    pub(super) own: &'a [Option<(FaceId, f64)>; LANES],
    /// The number of the emitter for each, and its probability.
    pub(super) chosen: &'a [(usize, f64); LANES],
    /// The lanes in which there is one.
    pub(super) lanes: u8,
    /// The pairs of numbers.
    pub(super) pair: &'a [LaneNumbers; 2],
}

/// Directions to emitters, as in [`Aimed`](crate::integrator::path::emitters::Aimed).
pub(super) struct AimedEach {
    /// The lanes in which there is one.
    pub(super) lanes: u8,
    pub(super) l: [LaneNumbers; 3],
    pub(super) light: [LaneNumbers; 3],
    /// The directions of the rays of shadows, and where these end.
    pub(super) to: [LaneNumbers; 3],
    pub(super) t_max: LaneNumbers,
    /// The lanes of light that casts shadows.
    pub(super) casts: u8,
    /// The lanes of emitters that have a size, and the densities of the directions to them.
    pub(super) has_size: u8,
    pub(super) density: LaneNumbers,
    /// The lanes of those that rays may find which are not aimed.
    pub(super) is_found: u8,
}

/// Directions in lanes.
struct Directions<S: Simd> {
    l: [S::F64; 3],
    t_max: S::F64,
    density: S::F64,
    /// The lanes in which there is one.
    counts: S::Mask,
}

impl AimedEach {
    const NONE: Self = Self {
        lanes: 0,
        l: [[0.0; LANES]; 3],
        light: [[0.0; LANES]; 3],
        to: [[0.0; LANES]; 3],
        t_max: [0.0; LANES],
        casts: 0,
        has_size: 0,
        density: [0.0; LANES],
        is_found: 0,
    };

    fn set(&mut self, lane: usize, [l, to, light]: [[f64; 3]; 3]) {
        set(&mut self.l, lane, l);
        set(&mut self.to, lane, to);
        set(&mut self.light, lane, light);
    }

    /// Takes over directions to an emitter whose light shows by chance, too, and casts shadows.
    #[inline(always)]
    fn take<S: Simd>(&mut self, of: &Directions<S>, lanes: u8, light: impl Fn(DVec3) -> Radiance) {
        let (mut l, mut t_max, mut density) = ([[0.0; LANES]; 3], [0.0; LANES], [0.0; LANES]);
        store3(of.l, &mut l);
        of.t_max.store(&mut t_max);
        of.density.store(&mut density);
        let lanes = lanes & of.counts.bits();
        for lane in bits(lanes) {
            let l = vector(&l, lane);
            let numbers = l.to_array();
            self.set(lane, [numbers, numbers, light(l).channels]);
            (self.t_max[lane], self.density[lane]) = (t_max[lane], density[lane]);
        }
        self.lanes |= lanes;
        self.casts |= lanes;
        self.has_size |= lanes;
        self.is_found |= lanes;
    }
}

impl FlatTarget {
    /// Returns [`Target::weight`].
    #[inline(always)]
    fn weights<S: Simd>(&self, simd: S, point: [S::F64; 3]) -> S::F64 {
        let to = sub(splat3(simd, self.middle), point);
        let (squared, area) = (dot(to, to), simd.splat(self.area));
        let infinity = simd.splat(f64::INFINITY);
        let is_direction = simd.splat(0.0).lt(squared) & squared.lt(infinity);
        let cosine = abs(dot(splat3(simd, self.normal), to)) / squared.sqrt();
        let cosine = S::F64::select(is_direction, cosine, simd.splat(1.0));
        let seen = simd.splat(AT_ANY_ANGLE) + simd.splat(1.0 - AT_ANY_ANGLE) * cosine;
        area * seen / squared.max(area)
    }

    /// Returns directions from points to it.
    #[inline(always)]
    fn aim<S: Simd>(&self, simd: S, point: [S::F64; 3], [u, v]: [S::F64; 2]) -> Directions<S> {
        let [e, f] = self.edges;
        let [x, y] = match self.form {
            FlatForm::Disc => {
                let (radius, [cosine, sine]) = (u.sqrt(), circle(simd, v));
                [radius * cosine, radius * sine]
            }
            FlatForm::Parallelogram => [u, v],
            FlatForm::Triangle => {
                let root = u.sqrt();
                [simd.splat(1.0) - root, v * root]
            }
        };
        let (origin, e, f) = (splat3(simd, self.origin), splat3(simd, e), splat3(simd, f));
        let mut to = origin;
        for axis in 0..3 {
            to[axis] = origin[axis] + x * e[axis] + y * f[axis] - point[axis];
        }
        let (zero, infinity) = (simd.splat(0.0), simd.splat(f64::INFINITY));
        let squared = dot(to, to);
        let length = squared.sqrt();
        let l = S::F64::over_length(to, length);
        let across = abs(dot(l, splat3(simd, self.normal)));
        let density = squared / (simd.splat(self.area) * across);
        let is_direction = zero.lt(squared) & squared.lt(infinity);
        Directions {
            l,
            t_max: length * simd.splat(END),
            density,
            counts: is_direction & zero.lt(density) & density.lt(infinity),
        }
    }
}

impl Emitter {
    /// Returns [`Emitter::weight`] of eight points.
    #[inline(always)]
    fn weights<S: Simd>(&self, simd: S, point: [S::F64; 3], lanes: u8) -> S::F64 {
        let (zero, infinity) = (simd.splat(0.0), simd.splat(f64::INFINITY));
        let weight = match self {
            Self::Faces {
                target: Target::Flat(flat),
                brightest,
                ..
            } => simd.splat(*brightest) * flat.weights(simd, point),
            Self::Environment(_, mean) => simd.splat(PI * mean),
            Self::Light(light) => match (light.source(), light.size()) {
                (Source::Direction(_), _) => simd.splat(self.weight(DVec3::ZERO)),
                (
                    Source::Point {
                        position,
                        falloff: Falloff::InverseSquare,
                        cone: None,
                    },
                    size,
                ) => {
                    let to = sub(splat3(simd, position), point);
                    let squared = dot(to, to);
                    let falloff = simd.splat(1.0) / squared;
                    let [r, g, b] = light.glow().radiance().channels;
                    let (r, g, b) = (simd.splat(r), simd.splat(g), simd.splat(b));
                    let most = (r * falloff).max(g * falloff).max(b * falloff);
                    let mut shines = zero.lt(squared) & squared.lt(infinity);
                    if let LightSize::Ball(radius) = size {
                        shines = shines & !squared.le(simd.splat(radius * radius));
                    }
                    S::F64::select(shines, simd.splat(PI) * most, zero)
                }
                _ => self.weights_one_by_one(simd, point, lanes),
            },
            Self::Faces { .. } => self.weights_one_by_one(simd, point, lanes),
        };
        let is_finite = abs(weight).lt(infinity);
        S::F64::select(is_finite, weight, zero)
    }

    #[inline(always)]
    fn weights_one_by_one<S: Simd>(&self, simd: S, point: [S::F64; 3], lanes: u8) -> S::F64 {
        let (mut points, mut weights) = ([[0.0; LANES]; 3], [0.0; LANES]);
        store3(point, &mut points);
        for lane in bits(lanes) {
            weights[lane] = self.weight(vector(&points, lane));
        }
        simd.load(&weights)
    }
}

impl Emitters {
    /// Chooses an emitter for each of some points by a number, as
    /// [`choose`](crate::integrator::path::emitters::EmitterWeights::choose) does; returns the sums of all weights, and the lanes that
    /// have one.
    #[inline(always)]
    pub(super) fn choose_each<S: Simd>(
        &self,
        simd: S,
        point: [S::F64; 3],
        (lanes, u): (u8, &LaneNumbers),
        chosen: &mut [(usize, f64); LANES],
    ) -> (S::F64, u8) {
        if self.tree().is_some() || self.all().len() > MOST {
            return self.choose_one_by_one(simd, point, (lanes, u), chosen);
        }
        let zero = simd.splat(0.0);
        let (mut weights, mut sums) = ([[0.0; LANES]; MOST], [[0.0; LANES]; MOST]);
        let mut sum = zero;
        for (number, emitter) in self.all().iter().enumerate() {
            let weight = emitter.weights(simd, point, lanes);
            sum = sum + weight;
            weight.store(&mut weights[number]);
            sum.store(&mut sums[number]);
        }
        let (at, mut before) = (simd.load(u) * sum, zero);
        for sums in &sums[..self.all().len()] {
            let is_before = simd.load(sums).le(at);
            before = before + S::F64::select(is_before, simd.splat(1.0), zero);
        }
        let mut has_one = zero.lt(sum).bits() & lanes;
        let (places, mut all) = (before.truncate(), [0.0; LANES]);
        sum.store(&mut all);
        for lane in bits(has_one) {
            let place = places[lane] as usize;
            match place < self.all().len() {
                true => chosen[lane] = (place, weights[place][lane] / all[lane]),
                false => has_one &= !(1 << lane),
            }
        }
        (sum, has_one)
    }

    #[inline(always)]
    fn choose_one_by_one<S: Simd>(
        &self,
        simd: S,
        point: [S::F64; 3],
        (lanes, u): (u8, &LaneNumbers),
        chosen: &mut [(usize, f64); LANES],
    ) -> (S::F64, u8) {
        let (mut points, mut sums, mut has_one) = ([[0.0; LANES]; 3], [0.0; LANES], 0);
        store3(point, &mut points);
        for lane in bits(lanes) {
            let weights = self.weights(vector(&points, lane));
            sums[lane] = weights.sum();
            if let Some(found) = weights.choose(u[lane]) {
                chosen[lane] = found;
                has_one |= 1 << lane;
            }
        }
        (simd.load(&sums), has_one)
    }

    /// Returns directions to emitters, as [`Emitters::aim`] does.
    #[inline(always)]
    pub(super) fn aim_each<S: Simd>(
        &self,
        simd: S,
        world: &World,
        aiming: EightAims<S>,
    ) -> AimedEach {
        let mut aimed = AimedEach::NONE;
        let [u, v] = aiming.pair;
        let (u, v) = (simd.load(u), simd.load(v));
        let mut rest = aiming.lanes;
        while rest != 0 {
            // All that aim at one emitter at once.
            let (number, _) = aiming.chosen[rest.trailing_zeros() as usize];
            let mut lanes = 0;
            for lane in bits(rest) {
                lanes |= u8::from(aiming.chosen[lane].0 == number) << lane;
            }
            rest &= !lanes;
            match &self.all()[number] {
                Emitter::Faces {
                    target: Target::Flat(flat),
                    light: Some(light),
                    ..
                } => aimed.take(&flat.aim(simd, aiming.point, [u, v]), lanes, |_| *light),
                Emitter::Environment(environment, _) if !environment.is_picture() => {
                    let (one, two) = (simd.splat(1.0), simd.splat(2.0));
                    let z = one - two * u;
                    let radius = (one - z * z).max(simd.splat(0.0)).sqrt();
                    let [cosine, sine] = circle(simd, v);
                    let frame = FrameLanes::one(simd, &LocalFrame::new(DVec3::Z));
                    let directions = Directions::<S> {
                        l: frame.outward([radius * cosine, radius * sine, z]),
                        t_max: simd.splat(f64::INFINITY),
                        density: simd.splat(environment.density(DVec3::Z)),
                        counts: simd.mask(u8::MAX),
                    };
                    aimed.take(&directions, lanes, |l| environment.radiance(l));
                }
                Emitter::Light(light)
                    if matches!(light.source(), Source::Direction(_)) && light.shadows() =>
                {
                    match light_of_size(light, DVec3::ZERO) {
                        Some((LightExtent::Cone(cone), light)) if cone.density().is_finite() => {
                            let (one, two) = (simd.splat(1.0), simd.splat(2.0));
                            let squared = cone.sin_squared();
                            let below =
                                u * simd.splat(squared) / simd.splat(1.0 + (1.0 - squared).sqrt());
                            let radius = (below * (two - below)).sqrt();
                            let [cosine, sine] = circle(simd, v);
                            let frame = FrameLanes::one(simd, &LocalFrame::new(cone.axis()));
                            let local = [radius * cosine, radius * sine, one - below];
                            let directions = Directions::<S> {
                                l: frame.outward(local),
                                t_max: simd.splat(f64::INFINITY),
                                density: simd.splat(cone.density()),
                                counts: simd.mask(u8::MAX),
                            };
                            aimed.take(&directions, lanes, |_| light);
                        }
                        _ => self.aim_one_by_one(world, &aiming, lanes, &mut aimed),
                    }
                }
                _ => self.aim_one_by_one(world, &aiming, lanes, &mut aimed),
            }
        }
        aimed
    }

    #[inline(always)]
    fn aim_one_by_one<S: Simd>(
        &self,
        world: &World,
        aiming: &EightAims<S>,
        lanes: u8,
        aimed: &mut AimedEach,
    ) {
        let mut points = [[0.0; LANES]; 3];
        store3(aiming.point, &mut points);
        for lane in bits(lanes) {
            let point = vector(&points, lane);
            let pair = [aiming.pair[0][lane], aiming.pair[1][lane]];
            let Some((own, _)) = aiming.own[lane] else {
                continue;
            };
            let start = Departure::at_hit(own, None, DVec3::ZERO);
            let (number, _) = aiming.chosen[lane];
            let Some(aim) = self.aim(world, number, (point, &start), pair) else {
                continue;
            };
            let (to, t_max) = aim.shadow.unwrap_or((aim.l, 0.0));
            let vectors = [aim.l, to].map(|vector| vector.to_array());
            aimed.set(lane, [vectors[0], vectors[1], aim.light.channels]);
            aimed.t_max[lane] = t_max;
            aimed.lanes |= 1 << lane;
            aimed.casts |= u8::from(aim.shadow.is_some()) << lane;
            aimed.is_found |= u8::from(aim.is_found) << lane;
            if let Some(density) = aim.density {
                aimed.has_size |= 1 << lane;
                aimed.density[lane] = density;
            }
        }
    }
}
