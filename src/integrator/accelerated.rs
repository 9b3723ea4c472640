//! The questions of direct lighting, answered by a tree.

use std::sync::OnceLock;

use crate::{
    accel::bvh::{Hierarchy, build::Builder},
    integrator::direct::Queries,
    tracer::{
        geometry::Geometry,
        radiance::Radiance,
        ray::Ray,
        shape::face::{Crossing, FaceId},
        world::World,
    },
};

/// Below this many geometries the plain loop is as fast as a tree.
const FEW: usize = 8;

/// A world, with a tree once that pays.
pub(crate) struct Accelerated<'a> {
    world: &'a World,
    builder: Builder<'a>,
    hierarchy: OnceLock<Hierarchy>,
}

impl<'a> Accelerated<'a> {
    /// Prepares a world.
    pub(crate) fn new(world: &'a World, builder: Builder<'a>) -> Self {
        let accelerated = Self {
            world,
            builder,
            hierarchy: OnceLock::new(),
        };
        let mut materials = world.geometries().iter().flat_map(Geometry::materials);
        if materials.any(|material| world.lobes(material).sends_rays()) {
            accelerated.prepare();
        }
        accelerated
    }
}

impl Queries for Accelerated<'_> {
    fn nearest(&self, ray: &Ray, own: Option<FaceId>) -> Option<(usize, Crossing)> {
        match self.hierarchy.get() {
            Some(hierarchy) => hierarchy.nearest_from(self.world, ray, own),
            None => Queries::nearest(self.world, ray, own),
        }
    }

    fn transmission(&self, ray: &Ray, t_max: f64, own: FaceId) -> Radiance {
        match self.hierarchy.get() {
            Some(hierarchy) => hierarchy.transmission(self.world, ray, t_max, own),
            None => self.world.transmission(ray, t_max, own),
        }
    }

    fn prepare(&self) {
        if self.world.geometries().len() > FEW {
            let build = || Hierarchy::new(self.world, self.builder);
            self.hierarchy.get_or_init(build);
        }
    }
}
