//! The steps of one path, for readers who want to check them by hand.
//!
//! Nothing is computed here: the path reports each value as it uses it.

use std::{cell::RefCell, ops::Range};

use super::{PathTracer, emitters::EmittedBy, sampler::Sampler};
use crate::{
    film::size::Size,
    integrator::{
        direct::{Queries, Step},
        explain::{Shading, term},
    },
    parallel::Cancel,
    tracer::{
        camera::Camera,
        contact::{Contact, Departure},
        light::transport::Transport,
        radiance::Radiance,
        ray::Ray,
        shape::{face::Crossing, working::Term},
        world::World,
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
    /// The emitter that is aimed at, with its probability.
    pub emitter: Option<(EmittedBy, f64)>,
    /// The first emitters, with their probabilities.
    pub emitters: Vec<(EmittedBy, f64)>,
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
    let listener = PathListener {
        world,
        segments: RefCell::default(),
    };
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
            segments: listener.segments.take(),
            light: traced.light.parts.sum(),
        });
    }
}

/// A world that records each step.
struct PathListener<'a> {
    world: &'a World,
    segments: RefCell<Vec<PathSegment>>,
}

impl PathListener<'_> {
    fn at_end(&self, change: impl FnOnce(&mut PathSegment)) {
        if let Some(segment) = self.segments.borrow_mut().last_mut() {
            change(segment);
        }
    }
}

impl Queries for PathListener<'_> {
    fn nearest(
        &self,
        ray: &Ray,
        start: Option<&Departure>,
    ) -> Result<Option<(usize, Crossing)>, Contact> {
        Queries::nearest(self.world, ray, start)
    }

    fn contact(&self, ray: &Ray, hit: (usize, Crossing)) -> Option<Contact> {
        Queries::contact(self.world, ray, hit)
    }

    fn brightest(&self) -> f64 {
        self.world.brightest()
    }

    fn transmission(&self, ray: &Ray, t_max: f64, start: &Departure) -> Radiance {
        self.at_end(|segment| {
            self.world.each_in_the_way(ray, t_max, start, |passed| {
                let id = self.world.id_of(passed.face.geometry, passed.face.face);
                segment.crossings.push((id, passed.t, passed.factor));
            });
        });
        self.world.transmission(ray, t_max, start)
    }

    const LISTENS: bool = true;

    fn tell(&self, step: Step) {
        match step {
            Step::Ray(path) => self.segments.borrow_mut().push(PathSegment {
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
            Step::Surface(surface) => self.at_end(|segment| {
                let id = self.world.id_of(surface.index, surface.hit.face);
                segment.surface = Some(Box::new(Shading::new(surface, id)));
            }),
            Step::Emitter(emitter, probability) => self.at_end(|segment| {
                segment.emitter = emitter.map(|emitter| (emitter, probability));
            }),
            Step::OtherEmitter(emitter, probability) => {
                self.at_end(|segment| segment.emitters.push((emitter, probability)));
            }
            Step::Term(name, symbol, value) => {
                self.at_end(|segment| segment.terms.push(term(name, symbol, value)));
            }
            Step::Adds(light) => self.at_end(|segment| segment.adds.push(light)),
            Step::Faint
            | Step::TooDeep
            | Step::Light(..)
            | Step::Arriving(_)
            | Step::FacesAway
            | Step::Summed
            | Step::Brings(_) => {}
        }
    }
}
