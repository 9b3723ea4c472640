//! A point of a surface on the path of a ray, and the rays whose light it sends on.

use std::cell::OnceCell;

use glam::DVec3;

use crate::tracer::{
    contact::{Crossed, Departure, Interface},
    hit::Hit,
    material::glass::{Fresnel, Glass},
    radiance::Radiance,
    ray::Ray,
    shape::face::FaceId,
    vector::unit,
    world::World,
};

/// A ray on its way from the camera.
#[derive(Clone, Debug)]
pub(crate) struct Path {
    pub(crate) ray: Ray,
    /// Where it begins, unless it is that of a camera.
    pub(crate) start: Option<Departure>,
    /// The number of reflections and refractions before it.
    pub(crate) depth: u32,
    /// The part of its light that arrives at the camera.
    pub(crate) factor: Radiance,
}

/// The shadow of a light at a point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Shadow {
    /// Nothing is in the way of the light.
    Lit,
    /// An opaque geometry is in its way.
    Dark,
    /// Glass may be in its way.
    Glass,
}

impl Path {
    /// Creates the path of a camera's ray.
    pub(super) const fn new(ray: Ray) -> Self {
        Self {
            ray,
            start: None,
            depth: 0,
            factor: Radiance::WHITE,
        }
    }
}

/// A point of a surface as a viewer sees it.
#[derive(Clone, Debug)]
pub(crate) struct Surface<'a> {
    pub(crate) path: &'a Path,
    pub(crate) hit: Hit<'a>,
    /// The index of the geometry.
    pub(crate) index: usize,
    /// The unit vector to the viewer.
    pub(crate) v: DVec3,
    /// The unit normal on the side of the viewer.
    pub(crate) n: DVec3,
    /// The shadow of each light, as far as it is known.
    pub(super) shadows: Option<&'a [Shadow]>,
    /// Where rays begin that it sends back, once that is asked.
    pub(super) start: OnceCell<Departure>,
}

/// A ray whose light a surface sends on along the path on which it is seen.
#[derive(Clone, Debug)]
pub(crate) struct Onward {
    pub(crate) path: Path,
    /// The part of its light that is sent on.
    pub(crate) factor: Radiance,
}

/// What is seen at a point of glass, which other surfaces may meet.
pub(super) enum AtGlass<'a> {
    /// The surface of glass, or of several that meet.
    Interface(Surface<'a>, Interface),
    /// An opaque surface.
    Opaque(Surface<'a>),
    /// Nothing: the ray goes straight on.
    Nothing(Departure),
}

impl<'a> Surface<'a> {
    pub(super) fn new(world: &'a World, path: &'a Path, t: f64, id: FaceId) -> Self {
        let hit = world.hit_on(&path.ray, t, id);
        Self {
            v: -unit(path.ray.direction()),
            n: if hit.front_face {
                hit.normal
            } else {
                -hit.normal
            },
            path,
            hit,
            index: id.geometry,
            shadows: None,
            start: OnceCell::new(),
        }
    }

    /// Creates the surface that a path meets, given the shadow of each light there.
    pub(super) fn shadowed(
        world: &'a World,
        path: &'a Path,
        (t, id): (f64, FaceId),
        shadows: &'a [Shadow],
    ) -> Self {
        Self {
            shadows: Some(shadows),
            ..Self::new(world, path, t, id)
        }
    }

    /// Returns the surface of another face that its point lies on.
    pub(super) fn on(&self, world: &'a World, start: &Departure, id: FaceId) -> Self {
        Self {
            start: OnceCell::from(start.on(id)),
            ..Self::new(world, self.path, self.hit.t, id)
        }
    }

    /// Returns what is seen at a point of glass, given all faces that rays leave there.
    pub(super) fn at_glass(&self, world: &'a World, start: Departure, glass: Glass) -> AtGlass<'a> {
        match start.seen(world) {
            None => {
                let (own, is_front) = (start.own(), self.hit.front_face);
                let is_pane = self.hit.geometry.shape().is_pane(own.face);
                let interface = Interface::alone(own, glass, is_front, is_pane);
                let start = OnceCell::from(start);
                AtGlass::Interface(
                    Self {
                        start,
                        ..self.clone()
                    },
                    interface,
                )
            }
            Some(Crossed::Opaque(id)) => AtGlass::Opaque(self.on(world, &start, id)),
            Some(Crossed::Glass(interface)) => {
                AtGlass::Interface(self.on(world, &start, interface.face), interface)
            }
            Some(Crossed::Nothing) => AtGlass::Nothing(start),
        }
    }

    /// Returns the ray along which light arrives that leaves, times a factor, along this path.
    #[inline]
    pub(super) fn onward(&self, direction: DVec3, factor: Radiance, start: Departure) -> Onward {
        let path = Path {
            ray: Ray::new(self.hit.point, direction),
            start: Some(start),
            depth: self.path.depth + 1,
            factor: self.path.factor * factor,
        };
        Onward { path, factor }
    }

    /// Returns the ray that goes straight on: no deeper than the path, unless that did not get on either, in f64, since
    /// it began; so it ends.
    pub(super) fn straight(&self, factor: Radiance, start: &Departure) -> Box<Onward> {
        let direction = self.path.ray.direction();
        let mut onward = self.onward(direction, factor, start.through(direction));
        let got_on = self.hit.t == 0.0 || self.hit.point != self.path.ray.origin();
        onward.path.depth = self.path.depth + u32::from(!got_on);
        Box::new(onward)
    }

    /// Returns the face that was hit.
    pub(super) const fn own(&self) -> FaceId {
        FaceId {
            geometry: self.index,
            face: self.hit.face,
        }
    }

    /// Returns the direction of a mirrored ray: `d - 2(d·n)n`.
    pub(super) fn mirrored(&self) -> DVec3 {
        let d = self.path.ray.direction();
        d - 2.0 * d.dot(self.n) * self.n
    }

    /// Returns the direction of a refracted ray.
    pub(super) fn refracted(&self, fresnel: &Fresnel) -> DVec3 {
        -self.v / fresnel.eta + (self.n.dot(self.v) / fresnel.eta - fresnel.cos_refracted) * self.n
    }
}
