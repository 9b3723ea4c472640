//! The light of a path: what its rays find by chance, and what its surfaces aim at.

use std::{borrow::Cow, f64::consts::PI};

use glam::DVec3;

use super::{
    AimedWeight, BeforeShadow, PathState, PathTracer, PathVertex,
    sampler::{Purpose, Sampler},
};
use crate::{
    film::parts::LightParts,
    integrator::{
        direct::{Queries, Step},
        surface::Path,
    },
    tracer::{material::bsdf::Scattering, radiance::Radiance, ray::Ray, vector::unit},
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
        self.add_to(state, (self.is_limited(path), state.direct), light);
    }

    /// Returns the part that counts as direct of light that is scattered at the end of a path.
    fn direct_share(&self, path: &Path, state: &PathState, scattering: &Scattering) -> Radiance {
        match path.depth {
            0 => scattering.diffuse_share(),
            _ => state.direct,
        }
    }

    /// Returns the number of the sum that the light of a path is added to.
    fn is_limited(&self, path: &Path) -> usize {
        usize::from(self.options.clamp.is_some() && path.depth > 0)
    }

    /// Adds light to the sum of a number, a part of it as direct light.
    fn add_to(&self, state: &mut PathState, (limited, share): (usize, Radiance), light: Radiance) {
        let sum = &mut state.light[limited];
        let direct = light * share;
        let specular = light * (Radiance::WHITE - share);
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
            let direct = self.direct_share(path, state, &scattering);
            self.add_to(state, (self.is_limited(path), direct), light);
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
        let start = self.start(surface);
        let start = match self.emitters.is_curved(number) {
            // All of its faces that the point lies on are left.
            true => Cow::Owned(self.queries.known(start)),
            false => Cow::Borrowed(start),
        };
        let from = (point, &*start);
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
        let scattered = path.factor * scattering.all;
        let (light, weight) = match aim.density {
            None => (scattered * PI * aim.light, AimedWeight::Chosen(probability)),
            Some(density) => {
                let q = match aim.is_found {
                    true => scattering.density,
                    false => 0.0,
                };
                (
                    scattered * aim.light,
                    AimedWeight::Shared(probability * density, q),
                )
            }
        };
        let (direction, t_max) = aim.shadow.unwrap_or((aim.l, 0.0));
        let aimed = BeforeShadow {
            ray: Ray::new(point, direction),
            t_max,
            start: self.start_toward(vertex, aim.l),
            light,
            weight,
            limited: self.is_limited(path),
            direct: self.direct_share(path, state, &scattering),
        };
        let part = match aim.shadow {
            None => Radiance::WHITE,
            Some(_) if state.waits => {
                state.aimed = Some(aimed);
                return;
            }
            Some(_) => self.lit(&aimed),
        };
        self.add_aimed(state, &aimed, part);
    }

    /// Adds the light of an emitter that a surface aimed at, given the part of it that comes through.
    pub(super) fn add_aimed(&self, state: &mut PathState, aimed: &BeforeShadow, part: Radiance) {
        if part == Radiance::BLACK {
            return;
        }
        self.radiance("transmission", "T, the part that comes through", part);
        let light = aimed.light * part;
        let light = match aimed.weight {
            AimedWeight::Chosen(probability) => light / probability,
            AimedWeight::Shared(p, q) => {
                self.number("light_density", "p = P · density", p);
                self.number("light_lobes", "q, the density of l by all lobes", q);
                self.number("light_weight", "w = p²/(p² + q²)", p * p / (p * p + q * q));
                light * p / (p * p + q * q)
            }
        };
        self.add_to(state, (aimed.limited, aimed.direct), light);
    }

    /// Returns the part of the light that comes through on a shadow ray.
    pub(super) fn lit(&self, aimed: &BeforeShadow) -> Radiance {
        let BeforeShadow {
            ray, t_max, start, ..
        } = aimed;
        self.past_glass(aimed, self.queries.transmission(ray, *t_max, start))
    }

    /// The same, given that part if all glass lets light through.
    pub(super) fn past_glass(&self, aimed: &BeforeShadow, light: Radiance) -> Radiance {
        let BeforeShadow {
            ray, t_max, start, ..
        } = aimed;
        let goes_through =
            light != Radiance::BLACK && (self.has_clear_glass || light != Radiance::WHITE);
        if goes_through && self.stops_at_glass {
            let (start, mut is_stopped) = (self.queries.known(start), false);
            self.world.each_in_the_way(ray, *t_max, &start, |passed| {
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
