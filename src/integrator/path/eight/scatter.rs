//! Matte surfaces in lanes: the equations of [`PathTracer::arrive`], in their order of operations, for paths that scatter.

use std::f64::consts::PI;

use super::{
    aim::EightAims,
    directions::{FrameLanes, circle},
    lanes::{EightPaths, FirstFaces, LaneNumbers, NO_FACE, add_light, light, set, vector},
};
use crate::{
    accel::lanes::{bits, dot, load3, splat3, store3, sub, unit},
    integrator::{
        direct::Queries,
        path::{AimedWeight, BeforeShadow, MOST_LIKELY, PathTracer, ROULETTE, sampler::Purpose},
    },
    simd::{F64x8, Kernel, LANES, Mask, Simd},
    tracer::{
        color::Color,
        contact::Departure,
        radiance::Radiance,
        ray::{BUNDLE, Bundle, Ray},
        shape::{
            Shape,
            face::{Crossing, FaceId},
        },
    },
};

/// The light that eight surfaces get from the emitters that they aim at, if nothing is in its way.
pub(super) struct AimedLight {
    /// The lanes whose shadow is asked for.
    pub(super) asked: u8,
    /// Those of light that casts no shadows.
    pub(super) open: u8,
    /// The rays to the emitters.
    origins: [LaneNumbers; 3],
    directions: [LaneNumbers; 3],
    t_max: LaneNumbers,
    pub(super) left: [Option<FaceId>; BUNDLE],
    /// What arrives at the camera of the light, as part of [`BeforeShadow`].
    light: [LaneNumbers; 3],
    /// The numerator and the denominator of the weight.
    weights: [AimedWeight; BUNDLE],
    /// The part of it that counts as direct.
    direct: [LaneNumbers; 3],
}

impl AimedLight {
    pub(super) const NONE: Self = Self {
        asked: 0,
        open: 0,
        origins: [[0.0; BUNDLE]; 3],
        directions: [[0.0; BUNDLE]; 3],
        t_max: [0.0; BUNDLE],
        left: [None; BUNDLE],
        light: [[0.0; BUNDLE]; 3],
        weights: [AimedWeight::Chosen(1.0); BUNDLE],
        direct: [[0.0; BUNDLE]; 3],
    };

    /// Asks for the shadow of light that was found without lanes, unless its ray leaves several faces.
    pub(super) fn ask(&mut self, lane: usize, before: &BeforeShadow) {
        if before.start.is_alone() {
            let left = before.start.own();
            self.ask_along(lane, (&before.ray, before.t_max), left);
        }
    }

    fn ask_along(&mut self, lane: usize, (ray, t_max): (&Ray, f64), left: FaceId) {
        self.asked |= 1 << lane;
        set(&mut self.origins, lane, ray.origin().to_array());
        set(&mut self.directions, lane, ray.direction().to_array());
        self.t_max[lane] = t_max;
        self.left[lane] = Some(left);
    }

    pub(super) fn bundle(&self) -> Bundle {
        Bundle::new(self.origins, self.directions, self.t_max)
    }

    /// Returns the light of a lane, whose shadow is asked for.
    pub(super) fn before_shadow(&self, lane: usize) -> BeforeShadow {
        let ray = Ray::new(vector(&self.origins, lane), vector(&self.directions, lane));
        let own = self.left[lane].unwrap_or(NO_FACE);
        BeforeShadow {
            ray,
            t_max: self.t_max[lane],
            start: Departure::at_hit(own, None, ray.direction()),
            light: light(&self.light, lane),
            weight: self.weights[lane],
            limited: 0,
            direct: light(&self.direct, lane),
        }
    }
}

/// The kernel that adds light to that of paths, in lanes where nothing is in its way.
pub(super) struct AddAimed<'a> {
    pub(super) paths: &'a mut EightPaths,
    pub(super) aimed: &'a AimedLight,
    pub(super) lanes: u8,
}

impl Kernel for AddAimed<'_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        let Self {
            paths,
            aimed,
            lanes,
        } = self;
        if lanes == 0 {
            return;
        }
        let (mut factor, mut divisor) = ([1.0; LANES], [1.0; LANES]);
        for lane in bits(lanes) {
            match aimed.weights[lane] {
                AimedWeight::Chosen(probability) => divisor[lane] = probability,
                AimedWeight::Shared(p, q) => {
                    (factor[lane], divisor[lane]) = (p, p * p + q * q);
                }
            }
        }
        let (factor, divisor) = (simd.load(&factor), simd.load(&divisor));
        let mut light = load3(simd, &aimed.light);
        for light in &mut light {
            *light = *light * factor / divisor;
        }
        let share = load3(simd, &aimed.direct);
        add_light(simd, &mut paths.light, (light, share), simd.mask(lanes));
    }
}

/// The kernel that scatters paths at matte surfaces and aims at emitters; it returns the lanes that it did so in.
pub(super) struct ScatterMatte<'a, 'w, Q> {
    pub(super) tracer: &'a PathTracer<'w, Q>,
    pub(super) paths: &'a mut EightPaths,
    pub(super) found: &'a FirstFaces,
    pub(super) aimed: &'a mut AimedLight,
}

/// MatteSurfaces in lanes.
struct MatteSurfaces<S: Simd> {
    /// The lanes that are matte.
    lanes: u8,
    point: [S::F64; 3],
    /// The unit normal on the side of the viewer.
    n: [S::F64; 3],
    /// The factor of the cosine in the light that is scattered.
    factor: [S::F64; 3],
}

impl<Q: Queries> Kernel for ScatterMatte<'_, '_, Q> {
    type Output = u8;

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> u8 {
        let Self {
            tracer,
            paths,
            found,
            aimed,
        } = self;
        let candidates = tracer.matte_lanes(paths, found);
        if candidates == 0 {
            return 0;
        }
        let (zero, one) = (simd.splat(0.0), simd.splat(1.0));
        let surfaces = surfaces(simd, tracer, paths, found, candidates);
        let lanes = surfaces.lanes;
        if lanes == 0 {
            return 0;
        }
        let MatteSurfaces {
            point, n, factor, ..
        } = surfaces;
        let frame = FrameLanes::new(simd, n);
        let mut points = [[0.0; LANES]; 3];
        store3(point, &mut points);
        let mut pairs = [[[0.0; LANES]; 2]; 4];
        let purposes = [
            Purpose::Choice,
            Purpose::Emitter,
            Purpose::Direction,
            Purpose::Roulette,
        ];
        for lane in bits(lanes) {
            let (sampler, depth) = (&paths.samplers[lane], paths.depths[lane]);
            for (pair, purpose) in pairs.iter_mut().zip(purposes) {
                let [u, v] = sampler.at(depth, purpose);
                (pair[0][lane], pair[1][lane]) = (u, v);
            }
        }
        let mut depth_is_0 = 0;
        for lane in bits(lanes) {
            let Some((id, _)) = found.faces[lane] else {
                continue;
            };
            depth_is_0 |= u8::from(paths.depths[lane] == 0) << lane;
            paths.first[lane].get_or_insert(id);
            if paths.colors[lane].is_none() {
                paths.colors[lane] = tracer.color_of(id);
            }
        }
        let beta = load3(simd, &paths.factors);
        // Light of an emitter.
        let mut chosen = [(0, 0.0); LANES];
        let u = &pairs[0][0];
        let (sums, aims) = tracer
            .emitters
            .choose_each(simd, point, (lanes, u), &mut chosen);
        let aim = tracer.emitters.aim_each(
            simd,
            tracer.world,
            EightAims {
                point,
                own: &found.faces,
                chosen: &chosen,
                lanes: aims,
                pair: &pairs[1],
            },
        );
        if aim.lanes != 0 {
            let cosine = dot(load3(simd, &aim.l), n);
            let (mut scattered, mut is_black) = ([zero; 3], simd.mask(u8::MAX));
            for channel in 0..3 {
                let all = factor[channel] * cosine;
                is_black = is_black & all.eq(zero);
                scattered[channel] = beta[channel] * all;
                let share = S::F64::select(zero.lt(all), one, zero);
                let direct = simd.load(&paths.direct[channel]);
                let at_first = simd.mask(depth_is_0);
                S::F64::select(at_first, share, direct).store(&mut aimed.direct[channel]);
            }
            let scatters = (zero.lt(cosine) & !is_black).bits() & aim.lanes;
            let has_size = simd.mask(aim.has_size);
            for channel in 0..3 {
                let sizeless = scattered[channel] * simd.splat(PI);
                let scattered = S::F64::select(has_size, scattered[channel], sizeless);
                let light = scattered * simd.load(&aim.light[channel]);
                light.store(&mut aimed.light[channel]);
            }
            let mut lobes = [0.0; LANES];
            (cosine / simd.splat(PI)).store(&mut lobes);
            for lane in bits(scatters) {
                let (is, probability) = (|mask: u8| mask >> lane & 1 != 0, chosen[lane].1);
                aimed.weights[lane] = match is(aim.has_size) {
                    true => {
                        let q = if is(aim.is_found) { lobes[lane] } else { 0.0 };
                        AimedWeight::Shared(probability * aim.density[lane], q)
                    }
                    false => AimedWeight::Chosen(probability),
                };
                aimed.left[lane] = found.faces[lane].map(|(id, _)| id);
                aimed.t_max[lane] = aim.t_max[lane];
                set(&mut aimed.origins, lane, vector(&points, lane).to_array());
                set(
                    &mut aimed.directions,
                    lane,
                    vector(&aim.to, lane).to_array(),
                );
            }
            aimed.asked |= scatters & aim.casts;
            aimed.open |= scatters & !aim.casts;
        }
        // The next ray.
        let [u, v] = [simd.load(&pairs[2][0]), simd.load(&pairs[2][1])];
        let (radius, [cosine, sine]) = (u.sqrt(), circle(simd, v));
        let local = [radius * cosine, radius * sine, (one - u).sqrt()];
        let l = frame.outward(local);
        let cosine = dot(l, n);
        let density = cosine / simd.splat(PI);
        let mut goes_on = zero.lt(cosine) & zero.lt(density);
        let (mut next, mut is_black) = ([zero; 3], simd.mask(u8::MAX));
        let mut shares = [zero; 3];
        for channel in 0..3 {
            let all = factor[channel] * cosine;
            next[channel] = beta[channel] * all / density;
            is_black = is_black & next[channel].eq(zero);
            shares[channel] = S::F64::select(zero.lt(all), one, zero);
        }
        goes_on = goes_on & !is_black;
        let deep = bits(lanes).filter(|lane| paths.depths[*lane] >= ROULETTE);
        let deep = deep.fold(0, |deep, lane| deep | 1 << lane);
        if deep != 0 {
            let most = next[0].max(next[1]).max(next[2]);
            let chance = most.min(simd.splat(MOST_LIKELY));
            let ends = !simd.load(&pairs[3][0]).lt(chance) & simd.mask(deep);
            goes_on = goes_on & !ends;
            for next in &mut next {
                *next = S::F64::select(simd.mask(deep), *next / chance, *next);
            }
        }
        let onward = goes_on.bits() & lanes;
        let moves = simd.mask(onward);
        put(simd, &mut paths.origins, point, moves);
        put(simd, &mut paths.directions, l, moves);
        put(simd, &mut paths.factors, next, moves);
        put(simd, &mut paths.diffuse, shares, moves);
        put(
            simd,
            &mut paths.direct,
            shares,
            simd.mask(onward & depth_is_0),
        );
        put(simd, &mut paths.last, point, moves);
        let [mut densities, mut weights] = [[0.0; LANES]; 2];
        density.store(&mut densities);
        sums.store(&mut weights);
        for lane in bits(onward) {
            paths.densities[lane] = densities[lane];
            paths.weights[lane] = weights[lane];
            paths.depths[lane] += 1;
            paths.left[lane] = found.faces[lane].map(|(id, _)| id);
        }
        for lane in bits(lanes) {
            paths.diffuse_depths[lane] += 1;
        }
        paths.scattered |= onward;
        paths.has_scattered |= onward;
        paths.is_caustic &= !onward;
        paths.active &= !(lanes & !onward);
        lanes
    }
}

/// Sets the numbers of some lanes.
#[inline(always)]
fn put<S: Simd>(simd: S, to: &mut [LaneNumbers; 3], from: [S::F64; 3], lanes: S::Mask) {
    for (to, from) in to.iter_mut().zip(from) {
        S::F64::select(lanes, from, simd.load(to)).store(to);
    }
}

/// Returns the surfaces that paths meet.
#[inline(always)]
fn surfaces<S: Simd, Q: Queries>(
    simd: S,
    tracer: &PathTracer<Q>,
    paths: &EightPaths,
    found: &FirstFaces,
    candidates: u8,
) -> MatteSurfaces<S> {
    let zero = simd.splat(0.0);
    let (origin, d) = (load3(simd, &paths.origins), load3(simd, &paths.directions));
    let (mut ends, mut factors) = ([0.0; LANES], [[0.0; LANES]; 3]);
    let (mut normal, mut known) = ([zero; 3], 0);
    for lane in bits(candidates) {
        if let Some((id, t)) = found.faces[lane] {
            ends[lane] = t;
            set(&mut factors, lane, tracer.matte_of(id).channels);
        }
    }
    let t = simd.load(&ends);
    let point = [
        origin[0] + t * d[0],
        origin[1] + t * d[1],
        origin[2] + t * d[2],
    ];
    let mut rest = candidates;
    while rest != 0 {
        let lane = rest.trailing_zeros() as usize;
        let Some((id, t)) = found.faces[lane] else {
            rest &= rest - 1;
            continue;
        };
        let shape = tracer.world.geometries()[id.geometry].shape();
        let (of, lanes) = match shape {
            Shape::Sphere(sphere) => {
                let same = |lane: &usize| {
                    found.faces[*lane].is_some_and(|(face, _)| face.geometry == id.geometry)
                };
                let same = bits(rest)
                    .filter(same)
                    .fold(0, |same, lane| same | 1 << lane);
                let from = sub(origin, splat3(simd, sphere.center()));
                let t = simd.load(&ends);
                let out = [from[0] + t * d[0], from[1] + t * d[1], from[2] + t * d[2]];
                let squared = dot(out, out);
                let is_direction = zero.lt(squared) & squared.lt(simd.splat(f64::INFINITY));
                known |= is_direction.bits() & same;
                (unit(out), same)
            }
            _ => {
                let crossing = Crossing { t, face: id.face };
                known |= 1 << lane;
                let normal = shape.normal_at(&paths.ray(lane), crossing);
                (splat3(simd, normal), 1 << lane)
            }
        };
        for axis in 0..3 {
            normal[axis] = S::F64::select(simd.mask(lanes), of[axis], normal[axis]);
        }
        rest &= !lanes;
    }
    let along = dot(d, normal);
    let is_front = along.le(zero);
    let v = unit(d);
    let mut n = normal;
    for n in &mut n {
        *n = S::F64::select(is_front, *n, -*n);
    }
    // Seen along the surface, it is left to the plain definition.
    let grazes = dot([-v[0], -v[1], -v[2]], n).eq(zero).bits();
    let passing = tracer
        .emitters
        .passed_by(simd, [origin, v], along_rays(simd, t, d));
    let at_first = bits(candidates).filter(|lane| paths.depths[*lane] == 0);
    let at_first = at_first.fold(0, |first, lane| first | 1 << lane);
    MatteSurfaces {
        lanes: candidates & known & !grazes & !(passing & !at_first),
        point,
        n,
        factor: load3(simd, &factors),
    }
}

/// Returns the distances of the points at `t`.
#[inline(always)]
fn along_rays<S: Simd>(_: S, t: S::F64, d: [S::F64; 3]) -> S::F64 {
    t * dot(d, d).sqrt()
}

impl<Q: Queries> PathTracer<'_, Q> {
    /// Returns the lanes of paths that meet matte surfaces, and are to be scattered there.
    fn matte_lanes(&self, paths: &EightPaths, found: &FirstFaces) -> u8 {
        if self.options.clamp.is_some() || self.headlight != Radiance::BLACK {
            return 0;
        }
        let diffuse_depth = self.options.diffuse_depth.unwrap_or(u32::MAX);
        let is_matte = |lane: &usize| {
            let is_scattered = paths.depths[*lane] < self.max_depth
                && paths.diffuse_depths[*lane] <= diffuse_depth;
            let is_matte = |id: FaceId| {
                let matte = self.matte.get(id.geometry);
                matte.is_some_and(Option::is_some)
            };
            is_scattered && found.faces[*lane].is_some_and(|(id, _)| is_matte(id))
        };
        let asked = found.asked & !found.touching & paths.active;
        bits(asked)
            .filter(is_matte)
            .fold(0, |lanes, lane| lanes | 1 << lane)
    }

    fn matte_of(&self, id: FaceId) -> Radiance {
        let matte = self.matte.get(id.geometry).copied().flatten();
        matte.unwrap_or(Radiance::BLACK)
    }

    fn color_of(&self, id: FaceId) -> Option<Color> {
        let material = self.world.geometries()[id.geometry].only_material();
        material.map(|material| material.color())
    }
}
