//! The paths of eight samples in lanes.

use glam::DVec3;

use crate::{
    film::parts::LightParts,
    integrator::{
        direct::Shaded,
        path::{PathState, Scattered, sampler::Sampler},
        surface::Path,
    },
    simd::{F64x8, Simd},
    tracer::{
        color::Color,
        contact::Departure,
        radiance::Radiance,
        ray::{BUNDLE, Ray},
        shape::face::FaceId,
    },
};

/// The face of a ray that leaves none.
pub(super) const NO_FACE: FaceId = FaceId {
    geometry: 0,
    face: 0,
};

/// LaneNumbers numbers.
pub(super) type LaneNumbers = [f64; BUNDLE];

/// The paths of eight samples, each of which has a lane; lane i is bit i of a mask.
pub(super) struct EightPaths {
    /// The lanes of paths that go on.
    pub(super) active: u8,
    pub(super) origins: [LaneNumbers; 3],
    pub(super) directions: [LaneNumbers; 3],
    /// The face that each ray leaves.
    pub(super) left: [Option<FaceId>; BUNDLE],
    /// Where rays begin that leave several faces.
    pub(super) starts: [Option<Departure>; BUNDLE],
    pub(super) depths: [u32; BUNDLE],
    pub(super) factors: [LaneNumbers; 3],
    /// The fields of [`PathState`].
    pub(super) direct: [LaneNumbers; 3],
    pub(super) diffuse: [LaneNumbers; 3],
    /// The lanes whose ray was scattered, where, the density of its direction and the sum of all weights there.
    pub(super) scattered: u8,
    pub(super) last: [LaneNumbers; 3],
    pub(super) densities: LaneNumbers,
    pub(super) weights: LaneNumbers,
    pub(super) has_scattered: u8,
    pub(super) is_caustic: u8,
    pub(super) diffuse_depths: [u32; BUNDLE],
    /// The direct and the specular light.
    pub(super) light: [[LaneNumbers; 3]; 2],
    /// The light that is limited, and what is behind: of lanes that are followed one by one.
    pub(super) rest: [Option<Box<[Shaded; 2]>>; BUNDLE],
    pub(super) first: [Option<FaceId>; BUNDLE],
    pub(super) colors: [Option<Color>; BUNDLE],
    pub(super) samplers: [Sampler; BUNDLE],
    pub(super) numbers: [u32; BUNDLE],
}

/// What the rays meet first.
pub(super) struct FirstFaces {
    pub(super) faces: [Option<(FaceId, f64)>; BUNDLE],
    /// The rays that were asked for.
    pub(super) asked: u8,
    /// Those whose point may lie on more faces.
    pub(super) touching: u8,
}

/// Returns the vector of a lane.
pub(super) fn vector([x, y, z]: &[LaneNumbers; 3], lane: usize) -> DVec3 {
    DVec3::new(x[lane], y[lane], z[lane])
}

/// Returns the light of a lane.
pub(super) fn light([r, g, b]: &[LaneNumbers; 3], lane: usize) -> Radiance {
    Radiance::new(r[lane], g[lane], b[lane])
}

/// Sets the numbers of a lane.
pub(super) fn set(to: &mut [LaneNumbers; 3], lane: usize, numbers: [f64; 3]) {
    for (to, number) in to.iter_mut().zip(numbers) {
        to[lane] = number;
    }
}

/// Adds light to sums of direct and of specular light, in some lanes: this part of it is direct.
#[inline(always)]
pub(super) fn add_light<S: Simd>(
    simd: S,
    [direct, specular]: &mut [[LaneNumbers; 3]; 2],
    (light, share): ([S::F64; 3], [S::F64; 3]),
    lanes: S::Mask,
) {
    let one = simd.splat(1.0);
    for channel in 0..3 {
        let parts = [share[channel], one - share[channel]];
        for (sum, part) in [&mut direct[channel], &mut specular[channel]]
            .into_iter()
            .zip(parts)
        {
            let before = simd.load(sum);
            S::F64::select(lanes, before + light[channel] * part, before).store(sum);
        }
    }
}

impl EightPaths {
    pub(super) fn new() -> Self {
        const ZERO: [LaneNumbers; 3] = [[0.0; BUNDLE]; 3];
        Self {
            active: 0,
            origins: ZERO,
            directions: ZERO,
            left: [None; BUNDLE],
            starts: [const { None }; BUNDLE],
            depths: [0; BUNDLE],
            factors: ZERO,
            direct: ZERO,
            diffuse: ZERO,
            scattered: 0,
            last: ZERO,
            densities: [0.0; BUNDLE],
            weights: [0.0; BUNDLE],
            has_scattered: 0,
            is_caustic: 0,
            diffuse_depths: [0; BUNDLE],
            light: [ZERO; 2],
            rest: [const { None }; BUNDLE],
            first: [None; BUNDLE],
            colors: [None; BUNDLE],
            samplers: [Sampler::new([0; 2], 0, 0); BUNDLE],
            numbers: [0; BUNDLE],
        }
    }

    /// Begins a path along a camera's ray.
    pub(super) fn begin(&mut self, lane: usize, number: u32, ray: &Ray) {
        self.active |= 1 << lane;
        self.numbers[lane] = number;
        set(&mut self.origins, lane, ray.origin().to_array());
        set(&mut self.directions, lane, ray.direction().to_array());
        self.left[lane] = None;
        self.starts[lane] = None;
        self.depths[lane] = 0;
        set(&mut self.factors, lane, Radiance::WHITE.channels);
        set(&mut self.direct, lane, Radiance::WHITE.channels);
        set(&mut self.diffuse, lane, Radiance::BLACK.channels);
        self.set_flags(lane, [false; 3]);
        self.diffuse_depths[lane] = 0;
        for light in &mut self.light {
            set(light, lane, Radiance::BLACK.channels);
        }
        self.rest[lane] = None;
        self.first[lane] = None;
        self.colors[lane] = None;
    }

    fn set_flags(&mut self, lane: usize, flags: [bool; 3]) {
        let masks = [
            &mut self.scattered,
            &mut self.has_scattered,
            &mut self.is_caustic,
        ];
        for (mask, flag) in masks.into_iter().zip(flags) {
            *mask = *mask & !(1 << lane) | u8::from(flag) << lane;
        }
    }

    pub(super) fn ray(&self, lane: usize) -> Ray {
        Ray::new(vector(&self.origins, lane), vector(&self.directions, lane))
    }

    /// Takes a path out of its lane.
    pub(super) fn path(&mut self, lane: usize) -> Path {
        let ray = self.ray(lane);
        let alone = || Some(Departure::at_hit(self.left[lane]?, None, ray.direction()));
        Path {
            ray,
            start: self.starts[lane].take().or_else(alone),
            depth: self.depths[lane],
            factor: light(&self.factors, lane),
        }
    }

    /// Sets how a path goes on.
    pub(super) fn go_on(&mut self, lane: usize, path: Path) {
        set(&mut self.origins, lane, path.ray.origin().to_array());
        set(&mut self.directions, lane, path.ray.direction().to_array());
        self.left[lane] = path.start.as_ref().map(Departure::own);
        self.starts[lane] = path.start.filter(|start| !start.is_alone());
        self.depths[lane] = path.depth;
        set(&mut self.factors, lane, path.factor.channels);
    }

    /// Copies the state of a path.
    pub(super) fn state_to(&self, lane: usize, state: &mut PathState) {
        let is = |mask: u8| mask >> lane & 1 != 0;
        let [direct, specular] = &self.light;
        let parts = LightParts::new([light(direct, lane), light(specular, lane)]);
        let [first, limited] = self.rest[lane].as_deref().copied().unwrap_or_default();
        state.direct = light(&self.direct, lane);
        state.diffuse = light(&self.diffuse, lane);
        state.last = is(self.scattered).then(|| Scattered {
            point: vector(&self.last, lane),
            density: self.densities[lane],
            weights: self.weights[lane],
        });
        state.has_scattered = is(self.has_scattered);
        state.is_caustic = is(self.is_caustic);
        state.diffuse_depth = self.diffuse_depths[lane];
        state.light = [Shaded { parts, ..first }, limited];
        state.first = self.first[lane];
        state.color = self.colors[lane];
    }

    pub(super) fn set_state(&mut self, lane: usize, state: &PathState) {
        set(&mut self.direct, lane, state.direct.channels);
        set(&mut self.diffuse, lane, state.diffuse.channels);
        if let Some(last) = &state.last {
            set(&mut self.last, lane, last.point.to_array());
            self.densities[lane] = last.density;
            self.weights[lane] = last.weights;
        }
        let flags = [state.last.is_some(), state.has_scattered, state.is_caustic];
        self.set_flags(lane, flags);
        self.diffuse_depths[lane] = state.diffuse_depth;
        let [first, limited] = state.light;
        for (light, part) in self.light.iter_mut().zip(first.parts.all()) {
            set(light, lane, part.channels);
        }
        let has_rest = first.behind != Radiance::BLACK || limited != Shaded::default();
        if has_rest || self.rest[lane].is_some() {
            self.rest[lane] = Some(Box::new([first, limited]));
        }
        self.first[lane] = state.first;
        self.colors[lane] = state.color;
    }
}
