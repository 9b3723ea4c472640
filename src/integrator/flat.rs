//! The light of a world without lights: each geometry shows its first color.

use crate::{
    integrator::{
        Integrate,
        direct::Shaded,
        queue::{Lanes, Queue, Seen},
    },
    tracer::{ray::Ray, world::World},
};

/// A world without lights.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Flat<'a> {
    pub(crate) world: &'a World,
}

impl Integrate for Flat<'_> {
    fn trace(&self, ray: &Ray) -> Shaded {
        Shaded::direct(self.world.flat_light(ray))
    }

    fn shade<'s>(
        &self,
        seen: impl Iterator<Item = Seen<'s>>,
        _: (&mut Queue, Lanes),
        mut set: impl FnMut(usize, Shaded),
    ) {
        for Seen {
            place, ray, t, id, ..
        } in seen
        {
            let color = self.world.hit_on(&ray, t, id).color();
            set(place, Shaded::direct(color.to_linear()));
        }
    }
}
