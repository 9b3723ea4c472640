//! The questions of direct lighting, answered by a tree.

use std::sync::{Arc, OnceLock};

use crate::{
    accel::{
        bvh::{Hierarchy, build::Builder},
        few::Few,
        kept::{WorldOfFrame, built},
        runs::geometries,
    },
    integrator::direct::Queries,
    simd::isa::Isa,
    tracer::{
        contact::{Contact, Departure},
        material::lobes::LightOfMaterials,
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
    /// [`World::brightest`]
    brightest: f64,
}

impl<'a> Accelerated<'a> {
    /// Prepares a world, of which frames may share a part.
    pub(crate) fn new(world: WorldOfFrame<'a>, builder: Builder<'a>) -> Self {
        let key = ((), world.0.lighting().is_some());
        let found = built(
            world,
            |kept| &kept.light,
            key,
            builder.cancel,
            |runs, _| {
                let materials = geometries(world.0, runs).flat_map(|(_, it)| it.materials());
                let all = materials.map(|material| LightOfMaterials::new(&world.0.lobes(material)));
                Some(all.fold(LightOfMaterials::default(), LightOfMaterials::and))
            },
        );
        let all = found.into_iter().flatten().map(|found| *found);
        let light = all.fold(LightOfMaterials::default(), LightOfMaterials::and);
        let accelerated = Self {
            world,
            builder,
            hierarchy: OnceLock::new(),
            brightest: world.0.brightest_light().max(light.brightest),
        };
        if light.sends_rays {
            accelerated.prepare();
        }
        accelerated
    }
}

impl Queries for Accelerated<'_> {
    fn nearest(
        &self,
        ray: &Ray,
        start: Option<&Departure>,
    ) -> Result<Option<(usize, Crossing)>, Contact> {
        let Some(hierarchy) = self.hierarchy.get() else {
            return Queries::nearest(self.world.0, ray, start);
        };
        if let Some(start) = start
            && let Some((arriving, hit)) = start.arrival()
        {
            if let Some(found) = hierarchy.nearest_alone(self.world.0, ray, start) {
                start.settle();
                return Ok(found);
            }
            if let Some(contact) = self.contact(&arriving, hit) {
                return Err(contact);
            }
            start.settle();
        }
        let left = start.map_or(&[][..], Departure::left);
        Ok(hierarchy.nearest_before(self.world.0, ray, f64::INFINITY, left))
    }

    /// Rays find on how many faces they begin, so that it need not be asked before.
    fn start(&self, own: FaceId, arriving: &Ray, t: f64) -> Departure {
        let start = Departure::unknown(own, arriving, t);
        match self.hierarchy.get() {
            Some(_) => start,
            None => self.known(&start),
        }
    }

    fn contact(&self, ray: &Ray, hit: (usize, Crossing)) -> Option<Contact> {
        let Some(hierarchy) = self.hierarchy.get() else {
            return Queries::contact(self.world.0, ray, hit);
        };
        let each = |corners, see: &mut dyn FnMut(usize)| hierarchy.each_near(corners, see);
        self.world.0.contact(ray, hit, each)
    }

    fn transmission(&self, ray: &Ray, t_max: f64, start: &Departure) -> Radiance {
        let world = self.world.0;
        let Some(hierarchy) = self.hierarchy.get() else {
            return world.transmission(ray, t_max, start);
        };
        let Some((arriving, hit)) = start.arrival() else {
            return hierarchy.transmission(world, ray, t_max, start);
        };
        if let Some(light) = hierarchy.transmission_alone(world, ray, t_max, start) {
            // In the dark, not all shapes were seen.
            if light != Radiance::BLACK {
                start.settle();
            }
            return light;
        }
        match self.contact(&arriving, hit) {
            Some(contact) => {
                let start = start.with(Some(Arc::new(contact)));
                hierarchy.transmission(world, ray, t_max, &start)
            }
            None => {
                start.settle();
                hierarchy.transmission(world, ray, t_max, start)
            }
        }
    }

    fn brightest(&self) -> f64 {
        self.brightest
    }

    fn few(&self) -> Option<Few<'_>> {
        Few::new(self.world.0.geometries(), self.builder.isa)
    }

    fn isa(&self) -> Isa {
        self.builder.isa
    }

    fn prepare(&self) {
        if self.world.0.geometries().len() > FEW {
            let build = || Hierarchy::new(self.world, self.builder);
            self.hierarchy.get_or_init(build);
        }
    }
}
