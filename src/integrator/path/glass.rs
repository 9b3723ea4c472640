//! Paths at glass: smooth, rough, and where it meets other surfaces.

use super::{
    PathState, PathTracer, PathVertex, VertexLobes,
    sampler::{Purpose, Sampler},
};
use crate::{
    integrator::{
        direct::Queries,
        surface::{AtGlass, Path, Surface},
    },
    tracer::{
        contact::Interface,
        material::{glass::Glass, microfacet::Microfacets, rough_glass::RoughGlass},
        radiance::Radiance,
        sampling::LocalFrame,
    },
};

impl<Q: Queries> PathTracer<'_, Q> {
    /// Returns how a path goes on through glass, or what meets it at its point.
    pub(super) fn glass(
        &self,
        surface: &Surface,
        glass: Glass,
        state: &mut PathState,
        sampler: &Sampler,
    ) -> Option<Path> {
        let start = self.queries.known(self.start(surface));
        match surface.at_glass(self.world, start, glass) {
            AtGlass::Interface(surface, interface) => {
                self.interface(&surface, &interface, state, sampler)
            }
            AtGlass::Opaque(surface) => self.surface(&surface, state, sampler),
            AtGlass::Nothing(start) => Some(surface.straight(Radiance::WHITE, &start).path),
        }
    }

    /// Returns how a path goes on at a surface between two media.
    pub(super) fn interface(
        &self,
        surface: &Surface,
        interface: &Interface,
        state: &mut PathState,
        sampler: &Sampler,
    ) -> Option<Path> {
        let (path, color) = (surface.path, interface.color());
        let start = self.start(surface);
        if interface.is_joint() {
            if self.options.caustics {
                // No shadow ray gets through.
                state.last = None;
            }
            return Some(surface.straight(color, start).path);
        }
        if let Some(facets) = interface.facets() {
            return self.rough_glass(surface, (interface, facets), state, sampler);
        }
        let fresnel = interface.fresnel(surface.n.dot(surface.v));
        let [_, u] = sampler.at(path.depth, Purpose::Choice);
        self.number("reflected", "F", fresnel.reflected);
        self.number("lobe", "u of F", u);
        let is_reflected = u < fresnel.reflected;
        let is_straight = interface.is_pane && !is_reflected;
        // The light of an emitter that is aimed at through a pane needs the half that is found by chance.
        if self.is_exhausted(path, state) && !(is_straight && state.has_scattered) {
            return None;
        }
        let (diffuse, last) = (state.diffuse, state.last);
        self.sharpen(state, path);
        if is_straight {
            (state.diffuse, state.last) = (diffuse, last);
            let direction = path.ray.direction();
            return Some(
                surface
                    .onward(direction, color, start.through(direction))
                    .path,
            );
        }
        state.is_caustic |= state.has_scattered && !interface.is_pane;
        if is_reflected {
            return Some(self.onward(surface, surface.mirrored(), path.factor));
        }
        let through = start.through(path.ray.direction());
        let onward = surface.onward(surface.refracted(&fresnel), color, through);
        Some(onward.path)
    }

    /// Returns how a path goes on at a rough surface between two media.
    fn rough_glass(
        &self,
        surface: &Surface,
        (interface, facets): (&Interface, Microfacets),
        state: &mut PathState,
        sampler: &Sampler,
    ) -> Option<Path> {
        let path = surface.path;
        let material = surface.hit.material();
        state.color.get_or_insert_with(|| material.color());
        if self.is_exhausted(path, state) {
            return None;
        }
        let frame = LocalFrame::new(surface.n);
        let eta = interface.fresnel(surface.n.dot(surface.v)).eta;
        let behind = (eta, interface.color());
        let glass = RoughGlass::new(frame.inward(surface.v), facets, behind, interface.is_pane);
        let vertex = PathVertex {
            surface,
            frame,
            lobes: VertexLobes::Glass(glass),
        };
        let [emitter, lobe] = sampler.at(path.depth, Purpose::Choice);
        self.shine(&vertex, emitter, state, sampler);
        let l = glass.sample(lobe, sampler.at(path.depth, Purpose::Direction))?;
        self.scatter(&vertex, l, state, sampler)
    }
}
