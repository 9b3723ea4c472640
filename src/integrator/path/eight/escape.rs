//! Paths that meet nothing, in lanes: the equations of [`PathTracer::escape`], in their order of operations.

use glam::DVec3;

use super::lanes::{EightPaths, FirstFaces, add_light, set, vector};
use crate::{
    accel::lanes::{bits, load3, splat3, store3, unit},
    integrator::{direct::Queries, path::PathTracer},
    simd::{F64x8, Kernel, LANES, Simd},
};

/// The kernel that ends paths that meet nothing; it returns the lanes of those that it ended.
pub(super) struct Escape<'a, 'w, Q> {
    pub(super) tracer: &'a PathTracer<'w, Q>,
    pub(super) paths: &'a mut EightPaths,
    pub(super) found: &'a FirstFaces,
}

impl<Q: Queries> Kernel for Escape<'_, '_, Q> {
    type Output = u8;

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> u8 {
        let Self {
            tracer,
            paths,
            found,
        } = self;
        let mut lanes = found.asked & paths.active;
        for (lane, found) in found.faces.iter().enumerate() {
            lanes &= !(u8::from(found.is_some()) << lane);
        }
        if lanes == 0 || tracer.is_transparent || tracer.options.clamp.is_some() {
            return 0;
        }
        // What sees no emitters is left to the plain definition.
        if !tracer.options.caustics {
            lanes &= !paths.is_caustic;
        }
        let (zero, one) = (simd.splat(0.0), simd.splat(1.0));
        let d = load3(simd, &paths.directions);
        let l = unit(d);
        let origin = load3(simd, &paths.origins);
        let infinity = simd.splat(f64::INFINITY);
        let mut deep = 0;
        for lane in bits(lanes) {
            deep |= u8::from(paths.depths[lane] > 0) << lane;
        }
        // Lights that a ray passes are found one by one.
        lanes &= !(deep & tracer.emitters.passed_by(simd, [origin, l], infinity));
        let environment = tracer.emitters.environment();
        let seen = environment.filter(|(environment, _)| environment.is_visible());
        if environment.is_some() && seen.is_none() {
            lanes &= deep;
        }
        if lanes == 0 {
            return 0;
        }
        let (beta, diffuse) = (load3(simd, &paths.factors), load3(simd, &paths.diffuse));
        let ends = simd.mask(lanes);
        let ambient = splat3(simd, tracer.ambient.channels.into());
        let mut light = beta;
        for channel in 0..3 {
            light[channel] = beta[channel] * diffuse[channel] * ambient[channel];
        }
        let share = load3(simd, &paths.direct);
        add_light(simd, &mut paths.light, (light, share), ends);
        let (mut vectors, mut behind) = ([[0.0; LANES]; 3], [[0.0; LANES]; 3]);
        store3(l, &mut vectors);
        let mut weight = one;
        if let Some((environment, number)) = environment {
            let mut densities = [0.0; LANES];
            for lane in bits(lanes) {
                let l = vector(&vectors, lane);
                set(&mut behind, lane, environment.radiance(l).channels);
                densities[lane] = environment.density(l);
            }
            let scattered = simd.mask(lanes & paths.scattered);
            let sums = simd.load(&paths.weights);
            // It is not in a tree.
            let own = tracer.emitters.all()[number].weight(DVec3::ZERO);
            let probability = simd.splat(own) / sums;
            let probability = S::F64::select(zero.lt(sums), probability, zero);
            let (p, q) = (
                probability * simd.load(&densities),
                simd.load(&paths.densities),
            );
            weight = S::F64::select(scattered, q * q / (q * q + p * p), one);
        } else {
            for lane in bits(lanes) {
                let light = tracer.world.behind(&paths.ray(lane));
                set(&mut behind, lane, light.channels);
            }
        }
        for channel in 0..3 {
            let behind = simd.load(&behind[channel]);
            light[channel] = match environment {
                Some(_) => beta[channel] * weight * behind,
                None => beta[channel] * (one - diffuse[channel]) * behind,
            };
        }
        add_light(simd, &mut paths.light, (light, share), ends);
        paths.active &= !lanes;
        lanes
    }
}
