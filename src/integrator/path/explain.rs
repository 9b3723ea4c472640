//! The steps of one path, for readers who want to check them by hand.
//!
//! Nothing is computed here: the path reports each value as it uses it.

use std::{cell::RefCell, ops::Range};

use super::{PathTracer, emitters::EmitterChance, sampler::Sampler};
use crate::{
    film::size::Size,
    integrator::{
        direct::Step,
        explain::{Listener, Shading, each_crossing, term},
    },
    parallel::Cancel,
    tracer::{
        camera::Camera, light::transport::Transport, radiance::Radiance, ray::Ray,
        shape::working::Term, world::World,
    },
};

/// A path that is explained.
#[derive(Clone, Debug)]
pub struct ExplainedPath {
    /// The number of its sample, from 0.
    pub sample: u32,
    /// The pair of numbers for its place in the pixel, and that for its place on the lens.
    pub pairs: [[f64; 2]; 2],
    /// Its rays, from the camera on.
    pub segments: Vec<PathSegment>,
    /// Its light.
    pub light: Radiance,
}

/// A ray of a path, and what happens at its end.
#[derive(Clone, Debug)]
pub struct PathSegment {
    /// The ray.
    pub ray: Ray,
    /// The number of scatterings before it.
    pub depth: u32,
    /// β: the part of its light that arrives at the camera.
    pub factor: Radiance,
    /// The surface that it meets; `None` if it meets none.
    pub surface: Option<Box<Shading>>,
    /// The numbers of what happens there, in their order.
    pub terms: Vec<Term>,
    /// The emitter that is aimed at.
    pub emitter: Option<EmitterChance>,
    /// The first emitters.
    pub emitters: Vec<EmitterChance>,
    /// The geometries in the way of its light: id, `t` and the part of the light that comes through.
    pub crossings: Vec<(usize, f64, Radiance)>,
    /// The light that the path brings there.
    pub adds: Vec<Radiance>,
}

/// Explains samples of a pixel, counted from the bottom left, one after the other. There are none if light does
/// not follow paths, and no more once it is cancelled.
pub(crate) fn explain_paths(
    (world, cancel): (&World, &Cancel),
    (camera, size): (&Camera, Size),
    pixel: [u32; 2],
    samples: Range<u32>,
    mut see: impl FnMut(ExplainedPath),
) {
    let Some(lighting) = world.lighting() else {
        return;
    };
    let Transport::Path(options) = lighting.transport else {
        return;
    };
    let segments = RefCell::default();
    let tell = |step: Step| note(world, &segments, step);
    let listener = Listener { world, tell: &tell };
    let paths = PathTracer::new(world, lighting, options, &listener, false);
    for sample in samples {
        if cancel.is_cancelled() {
            return;
        }
        let traced = paths.sample_of((camera, size), pixel, sample);
        let sampler = Sampler::new(pixel, sample, options.seed);
        see(ExplainedPath {
            sample,
            pairs: [sampler.pair(0), sampler.pair(1)],
            segments: segments.take(),
            light: traced.light.parts.sum(),
        });
    }
}

/// Records a step.
fn note(world: &World, segments: &RefCell<Vec<PathSegment>>, step: Step) {
    let at_end = |change: &dyn Fn(&mut PathSegment)| {
        if let Some(segment) = segments.borrow_mut().last_mut() {
            change(segment);
        }
    };
    match step {
        Step::Ray(path) => segments.borrow_mut().push(PathSegment {
            ray: path.ray,
            depth: path.depth,
            factor: path.factor,
            surface: None,
            terms: Vec::new(),
            emitter: None,
            emitters: Vec::new(),
            crossings: Vec::new(),
            adds: Vec::new(),
        }),
        Step::Surface(surface) => at_end(&|segment| {
            let id = world.id_of(surface.index, surface.hit.face);
            segment.surface = Some(Box::new(Shading::new(surface, id)));
        }),
        Step::Emitter(chosen) => at_end(&|segment| segment.emitter = Some(chosen)),
        Step::OtherEmitter(first) => at_end(&|segment| segment.emitters.push(first)),
        Step::Term(name, symbol, value) => {
            at_end(&|segment| segment.terms.push(term(name, symbol, value)));
        }
        Step::Shadow(ray, t_max, start, _) => at_end(&|segment| {
            let way = (ray, t_max, start);
            each_crossing(world, way, |crossing| segment.crossings.push(crossing));
        }),
        Step::Adds(light) => at_end(&|segment| segment.adds.push(light)),
        Step::Faint
        | Step::TooDeep
        | Step::Light(..)
        | Step::Arriving(_)
        | Step::FacesAway
        | Step::Summed
        | Step::Brings(_) => {}
    }
}
