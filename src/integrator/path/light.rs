//! The light of a path: what its rays find by chance, and what its surfaces aim at.

use std::f64::consts::PI;

use glam::DVec3;

use super::{
    PathState, PathTracer, PathVertex,
    sampler::{Purpose, Sampler},
};
use crate::{
    film::parts::LightParts,
    integrator::{
        direct::{Queries, Step},
        surface::{Path, Surface},
    },
    tracer::{contact::Departure, radiance::Radiance, ray::Ray, vector::unit},
};

impl<Q: Queries> PathTracer<'_, Q> {
    /// Adds the light of a ray that hits nothing.
    pub(super) fn escape(&self, path: &Path, state: &mut PathState) {
        let beta = path.factor;
        self.add(state, path, beta * state.diffuse * self.ambient);
        if let Some((environment, number)) = self.emitters.environment() {
            // A transparent picture shows none of it behind everything.
            if path.depth == 0 && self.is_transparent {
                return;
            }
            if path.depth > 0 || environment.is_visible() {
                if !self.is_unseen(state) {
                    let l = unit(path.ray.direction());
                    let weight = self.weight(state, |_| Some((number, environment.density(l))));
                    let light = environment.radiance(l);
                    self.add(state, path, beta * weight * light);
                }
                return;
            }
        }
        let sharp = beta * (Radiance::WHITE - state.diffuse);
        if !self.is_transparent {
            self.add(state, path, sharp * self.world.behind(&path.ray));
        } else if path.depth > 0 {
            state.light[0].behind = state.light[0].behind + sharp;
        }
    }

    /// Adds light of a path.
    pub(super) fn add(&self, state: &mut PathState, path: &Path, light: Radiance) {
        let limited = usize::from(self.options.clamp.is_some() && path.depth > 0);
        let sum = &mut state.light[limited];
        let direct = light * state.direct;
        let specular = light * (Radiance::WHITE - state.direct);
        self.queries.tell(Step::Adds(light));
        sum.parts = sum.parts + LightParts { direct, specular };
    }

    /// Returns true if no emitter shows in a path: light gets to the last surface that scatters by shadow rays
    /// alone.
    pub(super) fn is_unseen(&self, state: &PathState) -> bool {
        state.is_caustic && !self.options.caustics
    }

    /// Returns the weight of light that a path finds, given the emitter that is aimed at from a point and the
    /// density of the direction, if it is (the power heuristic).
    pub(super) fn weight(
        &self,
        state: &PathState,
        emitter: impl FnOnce(DVec3) -> Option<(usize, f64)>,
    ) -> f64 {
        let Some(last) = &state.last else {
            return 1.0;
        };
        let Some((number, density)) = emitter(last.point) else {
            return 1.0;
        };
        let at = (last.point, last.weights);
        let (p, q) = (
            self.emitters.probability(at, number) * density,
            last.density,
        );
        let weight = q * q / (q * q + p * p);
        self.number("found_density", "p of the emitter found", p);
        self.number("found_weight", "w = q²/(q² + p²)", weight);
        weight
    }

    /// Adds the light of emitters that a ray passes before a distance, other than a camera's ray.
    pub(super) fn pass(&self, path: &Path, distance: f64, state: &mut PathState) {
        if path.depth == 0 || self.is_unseen(state) {
            return;
        }
        let last = state.last.as_ref();
        let from = last.map_or(path.ray.origin(), |last| last.point);
        self.emitters
            .each_passed(&path.ray, (from, distance), |passing| {
                let weight = self.weight(state, |_| Some((passing.number, passing.density)));
                self.add(state, path, path.factor * weight * passing.light);
            });
    }

    /// Adds the light of an emitter that is chosen by a number, and of the headlights.
    pub(super) fn shine(
        &self,
        vertex: &PathVertex,
        u: f64,
        state: &mut PathState,
        sampler: &Sampler,
    ) {
        let surface = vertex.surface;
        let path = surface.path;
        if !state.has_scattered && self.headlight != Radiance::BLACK {
            let scattering = vertex.from(surface.v);
            let light = path.factor * scattering.all * PI * self.headlight;
            self.add_scattered(state, path, scattering.diffuse_share(), light);
        }
        let point = surface.hit.point;
        self.number("choice", "u of the emitter", u);
        let weights = self.emitters.weights(point);
        state.weights = weights.sum();
        self.number("weights", "ΣW of all emitters", state.weights);
        let Some((number, probability)) = weights.choose(u) else {
            return;
        };
        if Q::LISTENS {
            let chosen = (number, probability);
            if let Some(chosen) = self.emitters.chance(self.world, point, chosen) {
                self.queries.tell(Step::Emitter(chosen));
            }
            for first in self.emitters.first_chances(self.world, point) {
                self.queries.tell(Step::OtherEmitter(first));
            }
        }
        let pair = sampler.at(path.depth, Purpose::Emitter);
        let from = (point, self.start(surface));
        let Some(aim) = self.emitters.aim(self.world, number, from, pair) else {
            return;
        };
        let scattering = vertex.from(aim.l);
        self.direction("light_l", "l to the emitter", aim.l);
        self.radiance("light", "L of the emitter", aim.light);
        self.radiance("light_f", "f, with the cosine", scattering.all);
        if scattering.all == Radiance::BLACK {
            return;
        }
        let transmission = match aim.shadow {
            Some(shadow) => {
                let start = self.start_toward(vertex, aim.l);
                self.transmission(surface, &start, shadow)
            }
            None => Radiance::WHITE,
        };
        if transmission == Radiance::BLACK {
            return;
        }
        self.radiance(
            "transmission",
            "T, the part that comes through",
            transmission,
        );
        let scattered = path.factor * scattering.all;
        let light = match aim.density {
            None => scattered * PI * aim.light * transmission / probability,
            Some(density) => {
                let p = probability * density;
                let q = match aim.is_found {
                    true => scattering.density,
                    false => 0.0,
                };
                self.number("light_density", "p = P · density", p);
                self.number("light_lobes", "q, the density of l by all lobes", q);
                self.number("light_weight", "w = p²/(p² + q²)", p * p / (p * p + q * q));
                scattered * aim.light * transmission * p / (p * p + q * q)
            }
        };
        self.add_scattered(state, path, scattering.diffuse_share(), light);
    }

    /// Adds light that a surface scatters, of which its diffuse lobe scatters a part.
    fn add_scattered(
        &self,
        state: &mut PathState,
        path: &Path,
        diffuse: Radiance,
        light: Radiance,
    ) {
        let direct = state.direct;
        if path.depth == 0 {
            state.direct = diffuse;
        }
        self.add(state, path, light);
        state.direct = direct;
    }

    /// Returns the part of the light that comes through on a shadow ray.
    fn transmission(
        &self,
        surface: &Surface,
        start: &Departure,
        (direction, t_max): (DVec3, f64),
    ) -> Radiance {
        let ray = Ray::new(surface.hit.point, direction);
        let light = self.queries.transmission(&ray, t_max, start);
        let goes_through =
            light != Radiance::BLACK && (self.has_clear_glass || light != Radiance::WHITE);
        if goes_through && self.stops_at_glass {
            let (start, mut is_stopped) = (self.queries.known(start), false);
            self.world.each_in_the_way(&ray, t_max, &start, |passed| {
                is_stopped |= passed.glass.is_some_and(|glass| {
                    self.options.caustics && !glass.is_pane || glass.facets().is_some()
                });
            });
            if is_stopped {
                return Radiance::BLACK;
            }
        }
        light
    }
}
