//! A tree of boxes over the shapes of a world, for rays that start anywhere.

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

/// A bounding volume hierarchy over the shapes of a world: [`World::hit`], sooner.
///
/// It is worth its making where a few thousand rays are shot at more than some dozen shapes.
/// For a picture, [`RayTracer`](crate::RayTracer) and [`Scene`](crate::Scene) need none.
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
    /// What is tested by the plain loop: planes, and what has no place in the frame.
    apart: Vec<usize>,
    tree: Option<(Frame, Tree)>,
}

/// How many nodes a ray can pass on its way to a leaf.
const DEPTH: usize = 28;

/// Nodes with leaves below them.
#[derive(Clone, Debug)]
struct Tree {
    nodes: Vec<Node>,
    leaves: Vec<Leaf>,
    root: Link,
}

impl Tree {
    /// The sphere in a leaf's lane.
    fn sphere(&self, (leaf, lane): (usize, usize)) -> Option<Sphere> {
        self.leaves.get(leaf)?.sphere(lane)
    }
}

impl Bvh {
    /// Builds the hierarchy on all cores: some tenths of a second for a million spheres on one.
    pub fn new(world: impl Into<Arc<World>>) -> Self {
        Self::build(world.into(), &Pool::new(None), Isa::best())
    }

    /// Builds the hierarchy on so many threads, to the same answers; 0 means one for each core.
    ///
    /// # Errors
    ///
    /// None: where the system refuses threads, there are fewer.
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

    /// The world whose geometries are hit.
    pub fn world(&self) -> &World {
        &self.world
    }

    /// The nearest hit at a `t` with `0 < t < t_max`, with the index of the geometry: what
    /// [`World::hit`] returns for this ray if its `t` is below `t_max`, bit for bit, whatever the
    /// ray is. An infinite `t_max` leaves out nothing.
    ///
    /// Rays from farther away than some 100,000 times the size of the world, and rays whose
    /// direction is longer than 1e50 or shorter than 1e-50, are left to the plain loop.
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
        // The sphere of the tree is at hand, that of the world may be far away in memory.
        let normal = match place.and_then(|place| tree.sphere(place)) {
            Some(sphere) => sphere.normal_at(ray, t),
            None => geometry.shape().normal_at(ray, t),
        };
        Some((index, Hit::new(geometry, ray, t, normal)))
    }

    /// Whether anything is hit at a `t` with `0 < t < t_max`: whether [`Bvh::nearest`] finds
    /// something, sooner, as any hit will do.
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

    /// The nearest of what is known and the shapes of the tree; any nearer one if `ANY`.
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

    /// The tree and the ray in its frame; none where only the plain loop will do.
    fn probe(&self, ray: &Ray) -> Option<(&Tree, Probe)> {
        let (frame, tree) = self.tree.as_ref()?;
        Some((tree, frame.probe(ray)?))
    }
}

/// A geometry and the box around it, if it has a place in the tree.
fn inside((index, geometry): (usize, &Geometry)) -> Option<(u32, Hull)> {
    let hull = Hull::new(geometry.shape())?;
    (index <= Item::LAST).then_some((index as u32, hull))
}
