//! The questions of direct lighting, answered by a tree.

use std::sync::OnceLock;

use crate::{
    accel::{
        bvh::{Hierarchy, build::Builder},
        kept::{WorldOfFrame, built},
        runs::geometries,
    },
    integrator::direct::Queries,
    tracer::{
        radiance::Radiance,
        ray::Ray,
        shape::face::{Crossing, FaceId},
    },
};

/// Below this many geometries the plain loop is as fast as a tree.
const FEW: usize = 8;

/// A world, with a tree once that pays.
pub(crate) struct Accelerated<'a> {
    world: WorldOfFrame<'a>,
    builder: Builder<'a>,
    hierarchy: OnceLock<Hierarchy>,
}

impl<'a> Accelerated<'a> {
    /// Prepares a world, of which frames may share a part.
    pub(crate) fn new(world: WorldOfFrame<'a>, builder: Builder<'a>) -> Self {
        let accelerated = Self {
            world,
            builder,
            hierarchy: OnceLock::new(),
        };
        let key = ((), world.0.lighting().is_some());
        let found = built(
            world,
            |kept| &kept.sends_rays,
            key,
            builder.cancel,
            |runs, _| {
                let mut materials = geometries(world.0, runs).flat_map(|(_, it)| it.materials());
                Some(materials.any(|material| world.0.lobes(material).sends_rays()))
            },
        );
        if found.into_iter().flatten().any(|sends_rays| *sends_rays) {
            accelerated.prepare();
        }
        accelerated
    }
}

impl Queries for Accelerated<'_> {
    fn nearest(&self, ray: &Ray, own: Option<FaceId>) -> Option<(usize, Crossing)> {
        match self.hierarchy.get() {
            Some(hierarchy) => hierarchy.nearest_from(self.world.0, ray, own),
            None => Queries::nearest(self.world.0, ray, own),
        }
    }

    fn transmission(&self, ray: &Ray, t_max: f64, own: FaceId) -> Radiance {
        match self.hierarchy.get() {
            Some(hierarchy) => hierarchy.transmission(self.world.0, ray, t_max, own),
            None => self.world.0.transmission(ray, t_max, own),
        }
    }

    fn prepare(&self) {
        if self.world.0.geometries().len() > FEW {
            let build = || Hierarchy::new(self.world, self.builder);
            self.hierarchy.get_or_init(build);
        }
    }
}
