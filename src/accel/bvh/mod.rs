//! A bounding volume hierarchy over the shapes of a world, for rays that start anywhere.

mod build;
mod frame;
mod node;
#[cfg(test)]
mod properties;
mod split;
mod walk;

use std::sync::Arc;

use crate::{
    accel::bvh::{
        build::Builder,
        frame::{Frame, Hull, Probe},
        node::{Leaf, Link, Node},
        split::Item,
        walk::{Nearest, Walk},
    },
    diagnostic::error::Error,
    parallel::Pool,
    simd::Isa,
    tracer::{geometry::Geometry, hit::Hit, ray::Ray, shape::sphere::Sphere, world::World},
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
    isa: Isa,
    /// The geometries tested by the plain loop: planes, and those outside of the frame.
    apart: Vec<usize>,
    tree: Option<(Frame, Tree)>,
}

/// The largest number of nodes between the root and a leaf.
const DEPTH: usize = 28;

/// A tree of nodes and leaves.
#[derive(Clone, Debug)]
struct Tree {
    nodes: Vec<Node>,
    leaves: Vec<Leaf>,
    root: Link,
}

impl Tree {
    /// Returns the sphere in a lane of a leaf.
    fn sphere(&self, (leaf, lane): (usize, usize)) -> Option<Sphere> {
        self.leaves.get(leaf)?.sphere(lane)
    }
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
        let geometries = world.geometries();
        let hulls = || geometries.iter().enumerate().filter_map(inside);
        let frame = Frame::around(hulls().map(|(_, hull)| hull));
        let mut items = Vec::new();
        if let Some(frame) = &frame {
            items.reserve_exact(geometries.len());
            items.extend(hulls().map(|(index, hull)| {
                let [center, half] = frame.hull(&hull);
                Item::new(center, half, index)
            }));
        }
        let within = |at: &(usize, &Geometry)| frame.is_some() && inside(*at).is_some();
        let apart = geometries.iter().enumerate().filter(|at| !within(at));
        let apart = apart.map(|(index, _)| index).collect();
        let tree = frame.map(|frame| (frame, Builder { isa, pool }.tree(&mut items, geometries)));
        Self {
            world,
            isa,
            apart,
            tree,
        }
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
        let Some((tree, probe)) = self.probe(ray) else {
            let (index, geometry, t) = self.world.nearest(ray, t_max)?;
            return Some((index, geometry.hit_at(ray, t)));
        };
        let geometries = self.world.geometries();
        let mut nearest = Nearest::before(t_max);
        for index in &self.apart {
            if let Some(t) = geometries[*index].shape().intersect(ray, nearest.t) {
                nearest = Nearest {
                    index: *index,
                    t,
                    place: None,
                };
            }
        }
        let Nearest { index, t, place } = self.walk::<false>(tree, ray, &probe, nearest);
        let is_met = t < t_max;
        if !is_met {
            return None;
        }
        let geometry = geometries.get(index)?;
        // The sphere of the tree is in the cache; that of the world may be far away in memory.
        let normal = match place.and_then(|place| tree.sphere(place)) {
            Some(sphere) => sphere.normal_at(ray, t),
            None => geometry.shape().normal_at(ray, t),
        };
        Some((index, Hit::new(geometry, ray, t, normal)))
    }

    /// Returns true if anything is hit with `0 < t < t_max`, as [`Bvh::nearest`] would find;
    /// faster, since any hit will do.
    pub fn occluded(&self, ray: &Ray, t_max: f64) -> bool {
        let Some((tree, probe)) = self.probe(ray) else {
            return self.world.nearest(ray, t_max).is_some();
        };
        let geometries = self.world.geometries();
        let meets = |index: &usize| geometries[*index].shape().intersect(ray, t_max).is_some();
        self.apart.iter().any(meets)
            || self
                .walk::<true>(tree, ray, &probe, Nearest::before(t_max))
                .t
                < t_max
    }

    /// Returns the nearest of the known hit and those in the tree; with `ANY`, any hit nearer than
    /// the known one.
    fn walk<const ANY: bool>(
        &self,
        tree: &Tree,
        ray: &Ray,
        probe: &Probe,
        nearest: Nearest,
    ) -> Nearest {
        self.isa.run(Walk::<ANY> {
            tree,
            geometries: self.world.geometries(),
            ray,
            probe,
            nearest,
        })
    }

    /// Returns the tree and the ray in its frame; `None` if the ray needs the plain loop.
    fn probe(&self, ray: &Ray) -> Option<(&Tree, Probe)> {
        let (frame, tree) = self.tree.as_ref()?;
        Some((tree, frame.probe(ray)?))
    }
}

/// Returns the index of a geometry and its box; `None` if it cannot be in the tree.
fn inside((index, geometry): (usize, &Geometry)) -> Option<(u32, Hull)> {
    let hull = Hull::new(geometry.shape())?;
    (index <= Item::LAST).then_some((index as u32, hull))
}
