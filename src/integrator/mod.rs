//! The light that a ray brings back.

pub(crate) mod accelerated;
pub(crate) mod batch;
pub(crate) mod direct;
pub(crate) mod encode;
pub(crate) mod explain;
pub(crate) mod flat;
pub(crate) mod path;
pub(crate) mod queue;
pub(crate) mod surface;

use crate::{
    integrator::{
        direct::{Direct, Queries, Shaded},
        flat::Flat,
        path::PathTracer,
        queue::{Lanes, Queue, Seen},
    },
    tracer::{light::transport::Transport, radiance::Radiance, ray::Ray, tone::Tone, world::World},
};

/// The methods of an integrator, implemented in its own file.
pub(crate) trait Integrate {
    /// Returns the light of a camera's ray.
    fn trace(&self, ray: &Ray) -> Shaded;

    /// Passes on the light of hits.
    fn shade<'s>(
        &self,
        seen: impl Iterator<Item = Seen<'s>>,
        with: (&mut Queue, Lanes),
        set: impl FnMut(usize, Shaded),
    );
}

/// The way in which the light of a world is computed.
#[derive(Clone, Debug)]
pub(crate) enum Integrator<'a, Q> {
    /// Without lights.
    Flat(Flat<'a>),
    /// With lights that shine on surfaces directly.
    Direct(Direct<'a, Q>),
    /// With light that follows paths.
    Path(PathTracer<'a, Q>),
}

impl<'a, Q: Queries> Integrator<'a, Q> {
    /// Returns the integrator of a world. With a transparent background, the background sends no light,
    /// but is counted in [`Shaded::behind`].
    pub(crate) fn new(world: &'a World, queries: &'a Q, tone: Tone, is_transparent: bool) -> Self {
        match world.lighting() {
            None => Self::Flat(Flat { world }),
            Some(lighting) => match lighting.transport {
                Transport::Direct => {
                    let direct = Direct::new(world, lighting, queries, tone, is_transparent);
                    Self::Direct(direct)
                }
                Transport::Path(options) => {
                    let paths = PathTracer::new(world, lighting, options, queries, is_transparent);
                    Self::Path(paths)
                }
            },
        }
    }
}

impl<Q: Queries> Integrate for Integrator<'_, Q> {
    fn trace(&self, ray: &Ray) -> Shaded {
        match self {
            Self::Flat(flat) => flat.trace(ray),
            Self::Direct(direct) => direct.trace(ray),
            Self::Path(paths) => paths.trace(ray),
        }
    }

    fn shade<'s>(
        &self,
        seen: impl Iterator<Item = Seen<'s>>,
        with: (&mut Queue, Lanes),
        set: impl FnMut(usize, Shaded),
    ) {
        match self {
            Self::Flat(flat) => flat.shade(seen, with, set),
            Self::Direct(direct) => direct.shade(seen, with, set),
            Self::Path(paths) => paths.shade(seen, with, set),
        }
    }
}

impl World {
    /// Returns the linear light that a ray brings back: from the lights, if the world is lit, else
    /// that of the color that it sees.
    ///
    /// This function defines every picture with direct lighting. With another exposure than 0, other rays
    /// are so faint that they are not traced. If light follows paths, it is the mean of as many as a pixel
    /// has.
    ///
    /// # Examples
    ///
    /// ```
    /// use strahl::light::{Headlight, Light};
    /// use strahl::{Color, Geometry, Lighting, Plane, Radiance, Ray, Vec3, World};
    ///
    /// let wall = Plane::new(Vec3::new(0.0, 0.0, -3.0), Vec3::Z)?;
    /// let world = World::new(vec![Geometry::new(wall, Color::WHITE)], Color::BLACK);
    /// let headlight = Headlight::new(Color::WHITE, 0.5)?;
    /// let world = world.lit(Lighting::new(vec![Light::from(headlight)]));
    /// let radiance = world.radiance(&Ray::new(Vec3::ZERO, Vec3::NEG_Z));
    /// assert_eq!(radiance, Radiance::new(0.5, 0.5, 0.5));
    /// # Ok::<(), strahl::GeometryError>(())
    /// ```
    pub fn radiance(&self, ray: &Ray) -> Radiance {
        let integrator = Integrator::new(self, self, Tone::default(), false);
        integrator.trace(ray).parts.sum()
    }
}
