//! A bounding volume hierarchy over the shapes of a world, for rays that start anywhere.

pub(crate) mod build;
pub(crate) mod frame;
pub(crate) mod node;
pub(crate) mod portion;
#[cfg(test)]
mod properties;
pub(crate) mod split;
pub(crate) mod traverse;
pub(crate) mod tree;
mod walk;

use std::sync::Arc;

use glam::DVec3;

use crate::{
    accel::{
        bvh::{
            build::Builder,
            portion::{Near, Portion, Shapes},
            walk::{Crossings, Nearest, OriginWatch, Walk},
        },
        index::index_shapes,
        kept::{WorldOfFrame, built},
        runs::geometries,
    },
    diagnostic::error::Error,
    parallel::Pool,
    simd::isa::Isa,
    tracer::{
        contact::Departure,
        hit::Hit,
        radiance::Radiance,
        ray::Ray,
        shape::{
            contact::ContactPoint,
            face::{Crossing, FaceId, Leaving},
        },
        world::World,
    },
};

/// A bounding volume hierarchy over the shapes of a world: a faster [`World::hit`].
///
/// Building one pays off from a few thousand rays and some dozen shapes upwards.
/// [`RayTracer`](crate::RayTracer) and [`Scene`](crate::Scene) render without one.
///
/// # Examples
///
/// ```
/// use strahl::{Bvh, Color, Geometry, Ray, Sphere, Vec3, World};
///
/// let mut world = World::default();
/// for i in 0..1000 {
///     let center = Vec3::new(f64::from(i % 10), f64::from(i / 10 % 10), f64::from(i / 100));
///     world.push(Geometry::new(Sphere::new(center, 0.3)?, Color::WHITE));
/// }
/// let bvh = Bvh::new(world);
/// let ray = Ray::new(Vec3::new(4.5, 4.5, 4.5), Vec3::new(1.0, -1.0, 1.0));
/// let (index, hit) = bvh.nearest(&ray, f64::INFINITY).unwrap();
/// assert_eq!(bvh.world().hit(&ray), Some((index, hit)));
/// assert!(bvh.occluded(&ray, 2.0 * hit.t) && !bvh.occluded(&ray, hit.t));
/// # Ok::<(), strahl::GeometryError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Bvh {
    world: Arc<World>,
    hierarchy: Hierarchy,
}

/// The hierarchy of a world, without the world.
#[derive(Clone, Debug)]
pub(crate) struct Hierarchy {
    isa: Isa,
    /// The geometries of all portions that are tested by the plain loop, in ascending order.
    apart: Vec<usize>,
    portions: Vec<Arc<Portion>>,
}

impl Bvh {
    /// Builds the hierarchy on all cores. On a single core, a million spheres take some tenths of a
    /// second.
    pub fn new(world: impl Into<Arc<World>>) -> Self {
        Self::build(world.into(), &Pool::new(None), Isa::best())
    }

    /// Builds the hierarchy on this many threads, with the same results; 0 means one per core.
    ///
    /// # Errors
    ///
    /// Never fails: if the system refuses threads, fewer are used.
    pub fn with_threads(world: impl Into<Arc<World>>, threads: usize) -> Result<Self, Error> {
        let pool = Pool::new(Some(threads));
        Ok(Self::build(world.into(), &pool, Isa::best()))
    }

    fn build(world: Arc<World>, pool: &Pool, isa: Isa) -> Self {
        let hierarchy = Hierarchy::new((&world, None), Builder::new(pool, isa));
        Self { world, hierarchy }
    }

    /// Returns the world of the hierarchy.
    pub fn world(&self) -> &World {
        &self.world
    }

    /// Returns the nearest hit with `0 < t < t_max` and the index of its geometry. For any ray this
    /// is the result of [`World::hit`], bit for bit, if its `t` is below `t_max`. An infinite
    /// `t_max` excludes nothing.
    ///
    /// Rays from farther away than some 100,000 times the size of the world, and rays whose
    /// direction is longer than 1e50 or shorter than 1e-50, use the plain loop.
    pub fn nearest(&self, ray: &Ray, t_max: f64) -> Option<(usize, Hit<'_>)> {
        let nearest = self.hierarchy.nearest(&self.world, ray, t_max, &[])?;
        let geometry = self.world.geometries().get(nearest.index)?;
        // The sphere of the tree is in the cache; that of the world may be far away in memory.
        let sphere = || {
            let shapes = self.hierarchy.shapes().next()?;
            shapes.sphere(nearest.place?)
        };
        let crossing = nearest.crossing();
        let normal = match sphere() {
            Some(sphere) => sphere.normal_at(ray, nearest.t),
            None => geometry.shape().normal_at(ray, crossing),
        };
        Some((nearest.index, Hit::new(geometry, ray, crossing, normal)))
    }

    /// Returns true if anything is hit with `0 < t < t_max`, as [`Bvh::nearest`] would find;
    /// faster, since any hit will do.
    pub fn occluded(&self, ray: &Ray, t_max: f64) -> bool {
        self.hierarchy.occluded(&self.world, ray, t_max)
    }
}

impl Hierarchy {
    /// Builds the hierarchy of a world, the one that all other methods are to be called with. Frames share
    /// a part of it.
    pub(crate) fn new(world: WorldOfFrame, builder: Builder<'_>) -> Self {
        let portions = built(
            world,
            |kept| &kept.portion,
            ((), ()),
            builder.cancel,
            |runs, _| {
                let some = geometries(world.0, runs).map(|(_, geometry)| geometry);
                index_shapes(some, builder);
                Some(Portion::new(world.0, runs, builder))
            },
        );
        let portions = portions.unwrap_or_default();
        let apart = portions
            .iter()
            .flat_map(|portion: &Arc<Portion>| &portion.apart);
        let mut apart: Vec<_> = apart.copied().collect();
        apart.sort_unstable();
        Self {
            isa: builder.isa,
            apart,
            portions,
        }
    }

    fn shapes(&self) -> impl Iterator<Item = &Shapes> {
        self.portions
            .iter()
            .filter_map(|portion| portion.shapes.as_ref())
    }

    /// Returns the index and the crossing of [`World::nearest`], for a ray that leaves faces.
    pub(crate) fn nearest_before(
        &self,
        world: &World,
        ray: &Ray,
        t_max: f64,
        left: &[FaceId],
    ) -> Option<(usize, Crossing)> {
        let nearest = self.nearest(world, ray, t_max, left)?;
        Some((nearest.index, nearest.crossing()))
    }

    /// The same for a ray of which it is not known whether it begins on more than one face; `None` if it may.
    pub(crate) fn nearest_alone(
        &self,
        world: &World,
        ray: &Ray,
        start: &Departure,
    ) -> Option<Option<(usize, Crossing)>> {
        let (arriving, (_, Crossing { t, .. })) = start.arrival()?;
        let point = ContactPoint::vague(&arriving, t);
        let watch = self.watch(world, &point, start)?;
        let found = self.search(world, ray, f64::INFINITY, start.left(), Some(watch))?;
        Some(found.map(|nearest| (nearest.index, nearest.crossing())))
    }

    /// Returns the watch over the origin of a ray; `None` if it may lie on another face of its own geometry, or
    /// on one of those apart.
    fn watch<'a>(
        &self,
        world: &World,
        point: &'a ContactPoint,
        start: &Departure,
    ) -> Option<OriginWatch<'a>> {
        let (geometries, own) = (world.geometries(), start.own());
        let mut largest = 0.0;
        for shapes in self.shapes() {
            let frame = &shapes.frame;
            if frame.is_far(point.size()) && frame.may_meet(point.around()) {
                return None;
            }
            largest = shapes.largest.max(largest);
        }
        let mut watch = OriginWatch {
            point,
            slack: point.slack_of_ball(largest),
            is_touched: false,
        };
        let shape = geometries.get(own.geometry)?.shape();
        if shape.has_faces() {
            shape.each_face_near(point, &mut |face| {
                watch.is_touched |= face.is_touched && face.face != own.face;
            });
        }
        let others = self.apart.iter().filter(|index| **index != own.geometry);
        for index in others {
            watch.see(geometries[*index].shape());
        }
        (!watch.is_touched).then_some(watch)
    }

    #[inline(always)]
    fn nearest(&self, world: &World, ray: &Ray, t_max: f64, left: &[FaceId]) -> Option<Nearest> {
        self.search(world, ray, t_max, left, None)?
    }

    /// Returns the nearest crossing, or `None` if what is watched for was found.
    #[inline(always)]
    fn search(
        &self,
        world: &World,
        ray: &Ray,
        t_max: f64,
        left: &[FaceId],
        watch: Option<OriginWatch>,
    ) -> Option<Option<Nearest>> {
        let geometries = world.geometries();
        let mut nearest = Nearest::before(t_max);
        apart_of(&self.apart, left).for_each(|index| {
            let shape = geometries[index].shape();
            let leaving = Leaving::of(left, index);
            // At an equal t the lower index may still win.
            if let Some(crossing) = shape.meet(ray, leaving, nearest.t.next_up()) {
                nearest.or(Nearest::new(index, crossing));
            }
        });
        for shapes in self.shapes() {
            let Some(probe) = shapes.frame.probe(ray) else {
                if watch.is_some() {
                    return None;
                }
                let found = world.nearest(ray, t_max, left);
                return Some(found.map(|(index, crossing)| Nearest::new(index, crossing)));
            };
            let walk = Walk::<false> {
                watch,
                ..shapes.walk(geometries, (ray, &probe), nearest, left)
            };
            let (found, is_touched) = self.isa.run(walk);
            if is_touched {
                return None;
            }
            nearest = found;
        }
        let is_met = nearest.t < t_max;
        Some(is_met.then_some(nearest))
    }

    /// Returns true if anything is hit with `0 < t < t_max`.
    fn occluded(&self, world: &World, ray: &Ray, t_max: f64) -> bool {
        let geometries = world.geometries();
        let meets = |index: &usize| geometries[*index].shape().intersect(ray, t_max).is_some();
        let is_among = |shapes: &Shapes| match shapes.frame.probe(ray) {
            None => world.nearest(ray, t_max, &[]).is_some(),
            Some(probe) => {
                let nearest = Nearest::before(t_max);
                let walk = shapes.walk::<true>(geometries, (ray, &probe), nearest, &[]);
                self.isa.run(walk).0.t < t_max
            }
        };
        self.apart.iter().any(meets) || self.shapes().any(is_among)
    }

    /// Returns the part of the light that comes through on a shadow ray: [`World::transmission`].
    pub(crate) fn transmission(
        &self,
        world: &World,
        ray: &Ray,
        t_max: f64,
        start: &Departure,
    ) -> Radiance {
        let found = self.light(world, ray, t_max, start, None);
        found.unwrap_or_else(|| world.transmission(ray, t_max, start))
    }

    /// The same for a ray of which it is not known whether it begins on more than one face; `None` if it may.
    pub(crate) fn transmission_alone(
        &self,
        world: &World,
        ray: &Ray,
        t_max: f64,
        start: &Departure,
    ) -> Option<Radiance> {
        let (arriving, (_, Crossing { t, .. })) = start.arrival()?;
        let point = ContactPoint::vague(&arriving, t);
        let watch = self.watch(world, &point, start)?;
        self.light(world, ray, t_max, start, Some(watch))
    }

    /// Returns the light that comes through; `None` if what is watched for was found, or if the ray needs the
    /// plain loop.
    #[inline(always)]
    fn light(
        &self,
        world: &World,
        ray: &Ray,
        t_max: f64,
        start: &Departure,
        watch: Option<OriginWatch>,
    ) -> Option<Radiance> {
        let (geometries, left) = (world.geometries(), start.left());
        // All glass that the ray crosses.
        let mut glass = Crossings::default();
        let mut is_dark = apart_of(&self.apart, left).any(|index| {
            let geometry = &geometries[index];
            let leaving = Leaving::of(left, index);
            let first = geometry.shape().meet(ray, leaving, t_max);
            first.is_some() && glass.is_opaque(geometry, index)
        });
        for shapes in self.shapes() {
            if is_dark {
                break;
            }
            let probe = shapes.frame.probe(ray)?;
            let nearest = Nearest::before(t_max);
            let walk = Walk::<true> {
                watch,
                glass: Some(&mut glass),
                ..shapes.walk(geometries, (ray, &probe), nearest, left)
            };
            let (found, is_touched) = self.isa.run(walk);
            if is_touched {
                return None;
            }
            is_dark = found.t < t_max;
        }
        Some(match is_dark {
            true => Radiance::BLACK,
            false => world.transmission_among(ray, t_max, start, glass.in_order().into_iter()),
        })
    }

    /// Calls `see` with the index of every geometry that may meet a box, given its corners.
    pub(crate) fn each_near(&self, corners: [DVec3; 2], see: &mut dyn FnMut(usize)) {
        self.apart.iter().copied().for_each(&mut *see);
        for shapes in self.shapes() {
            self.isa.run(Near {
                shapes,
                corners,
                see: &mut *see,
            });
        }
    }
}

/// Returns the indices of the geometries apart and of those that a ray leaves, each once.
fn apart_of<'a>(apart: &'a [usize], left: &'a [FaceId]) -> impl Iterator<Item = usize> + 'a {
    let is_apart = |index: &usize| apart.binary_search(index).is_ok();
    let left = left.chunk_by(|one, other| one.geometry == other.geometry);
    let left = left.filter_map(|faces| Some(faces.first()?.geometry));
    apart
        .iter()
        .copied()
        .chain(left.filter(move |index| !is_apart(index)))
}
