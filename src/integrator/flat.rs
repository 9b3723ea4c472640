//! The light of a world without lights: each geometry shows its first color.

use crate::{
    integrator::{
        Integrate,
        direct::{Path, Shaded},
    },
    tracer::{ray::Ray, shape::face::Crossing, world::World},
};

/// A world without lights.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Flat<'a> {
    pub(crate) world: &'a World,
}

impl Integrate for Flat<'_> {
    fn trace(&self, ray: &Ray) -> Shaded {
        Shaded::direct(self.world.color_of(ray).to_linear())
    }

    fn shade(&self, path: &Path, index: usize, crossing: Crossing) -> Shaded {
        let hit = self.world.geometries()[index].hit_at(&path.ray, crossing);
        Shaded::direct(hit.color().to_linear())
    }
}
