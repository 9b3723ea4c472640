//! A bounding volume hierarchy over the shapes of a world, for rays that start anywhere.

pub(crate) mod build;
pub(crate) mod frame;
pub(crate) mod node;
#[cfg(test)]
mod properties;
pub(crate) mod split;
pub(crate) mod traverse;
mod walk;

use std::{ops::Range, sync::Arc};

use crate::{
    accel::{
        bvh::{
            build::{Builder, Lists},
            frame::{Frame, Hull},
            node::{Leaf, Link, LinkTarget, Node},
            split::Item,
            walk::{Crossings, Nearest, Walk},
        },
        index_shapes,
        kept::{self, WorldOfFrame, built, count},
        pages::Pages,
    },
    diagnostic::error::Error,
    parallel::Pool,
    simd::{Isa, LANES},
    tracer::{
        geometry::Geometry,
        hit::Hit,
        radiance::Radiance,
        ray::Ray,
        shape::{
            face::{Crossing, FaceId},
            sphere::Sphere,
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

/// Some geometries of a world.
#[derive(Clone, Debug)]
pub(crate) struct Portion {
    /// The geometries tested by the plain loop: planes, and those outside of the frame.
    apart: Vec<usize>,
    shapes: Option<Shapes>,
}

/// The largest number of nodes between the root and a leaf.
const DEPTH: usize = 28;

/// A tree of nodes, whose leaves are elsewhere.
#[derive(Clone, Debug)]
pub(crate) struct Tree {
    nodes: Pages<Node>,
    root: Link,
}

/// The bounded shapes of a world.
#[derive(Clone, Debug)]
struct Shapes {
    frame: Frame,
    tree: Tree,
    leaves: Vec<Leaf>,
}

impl Tree {
    /// Calls `see` with the number of every leaf that may hold a box, and returns once it has seen all.
    fn around(&self, [center, half]: [[f32; 3]; 2], mut see: impl FnMut(usize)) {
        let is_around = |node: &Node, lane: usize| {
            (0..3).all(|axis| {
                node.planes[axis][lane] <= center[axis] - half[axis]
                    && node.planes[axis + 3][lane] >= center[axis] + half[axis]
            })
        };
        let mut links = vec![self.root];
        while let Some(link) = links.pop() {
            match link.place() {
                LinkTarget::Node(number) => {
                    let node = &self.nodes[number];
                    let lanes = (0..LANES).filter(|lane| is_around(node, *lane));
                    links.extend(lanes.map(|lane| node.links[lane]));
                }
                LinkTarget::Leaf(number) => see(number),
            }
        }
    }
}

impl Shapes {
    /// Returns the sphere in a lane of a leaf.
    fn sphere(&self, (leaf, lane): (usize, usize)) -> Option<Sphere> {
        self.leaves.get(leaf)?.sphere(lane)
    }

    /// Calls `see` with the index of every sphere that has the same numbers, and so the same box.
    fn twins(&self, sphere: &Sphere, mut see: impl FnMut(usize)) {
        let Some(hull) = Hull::new(&(*sphere).into()) else {
            return;
        };
        self.tree.around(self.frame.hull(&hull), |number| {
            let leaf = &self.leaves[number];
            let lanes = (0..LANES).filter(|lane| leaf.sphere(*lane).as_ref() == Some(sphere));
            lanes.for_each(|lane| see(leaf.index[lane] as usize));
        });
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
        let nearest = self.hierarchy.nearest(&self.world, ray, t_max, None)?;
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

impl Portion {
    /// Builds the tree of some geometries. If it is cancelled, all shapes are apart.
    fn new(world: &World, runs: &[Range<usize>], builder: Builder<'_>) -> Self {
        let geometries = world.geometries();
        let some = || kept::geometries(world, runs);
        index_shapes(some().map(|(_, geometry)| geometry), builder);
        let hulls = || some().filter_map(inside);
        // A tree of a single shape, such as a mesh, has no boxes: the plain loop is faster.
        let second = hulls().nth(1);
        let frame = second.and_then(|_| Frame::around(hulls().map(|(_, hull)| hull)));
        let shapes = frame.and_then(|frame| {
            let items = hulls().map(|(index, hull)| {
                let [center, half] = frame.hull(&hull);
                Item::new(center, half, index)
            });
            let items = Pages::collect(count(runs), items);
            let (tree, lists) = builder.tree(items, Lists::default())?;
            let leaves = builder.leaves(&lists, geometries);
            Some(Shapes {
                frame,
                tree,
                leaves,
            })
        });
        let within = |at: &(usize, &Geometry)| shapes.is_some() && inside(*at).is_some();
        let mut apart = Vec::new();
        let others = some().filter(|at| !within(at));
        others.for_each(|(index, _)| apart.push(index));
        Self { apart, shapes }
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
            |runs, _| Some(Portion::new(world.0, runs, builder)),
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

    /// Returns the index and the crossing of [`World::hit_from`], for a ray that leaves the face
    /// `own`.
    pub(crate) fn nearest_from(
        &self,
        world: &World,
        ray: &Ray,
        own: Option<FaceId>,
    ) -> Option<(usize, Crossing)> {
        self.nearest_before(world, ray, f64::INFINITY, own)
    }

    /// The same for a crossing with a `t` below `t_max`.
    pub(crate) fn nearest_before(
        &self,
        world: &World,
        ray: &Ray,
        t_max: f64,
        own: Option<FaceId>,
    ) -> Option<(usize, Crossing)> {
        let nearest = self.nearest(world, ray, t_max, own)?;
        Some((nearest.index, nearest.crossing()))
    }

    #[inline(always)]
    fn nearest(
        &self,
        world: &World,
        ray: &Ray,
        t_max: f64,
        own: Option<FaceId>,
    ) -> Option<Nearest> {
        let face = own;
        let geometries = world.geometries();
        let own = world.own(own);
        let own = own.as_ref();
        let mut nearest = Nearest::before(t_max);
        for index in &self.apart {
            let shape = geometries[*index].shape();
            if let Some(crossing) = shape.meet_from(own, ray, nearest.t) {
                nearest = Nearest::new(*index, crossing);
            }
        }
        for shapes in self.shapes() {
            let Some(probe) = shapes.frame.probe(ray) else {
                let (index, crossing) = world.nearest(ray, t_max, face)?;
                return Some(Nearest::new(index, crossing));
            };
            if let Some(sphere) = own.and_then(|own| own.shape().sphere())
                && let Some(t) = sphere.far_from_own(ray, t_max)
            {
                shapes.twins(sphere, |index| {
                    nearest.or(Nearest::new(index, t.into()));
                });
            }
            nearest = self.isa.run(Walk::<false> {
                tree: &shapes.tree,
                leaves: &shapes.leaves,
                geometries,
                ray,
                probe: &probe,
                nearest,
                own,
                glass: None,
            });
        }
        let is_met = nearest.t < t_max;
        is_met.then_some(nearest)
    }

    /// Returns true if anything is hit with `0 < t < t_max`.
    fn occluded(&self, world: &World, ray: &Ray, t_max: f64) -> bool {
        let geometries = world.geometries();
        let meets = |index: &usize| geometries[*index].shape().intersect(ray, t_max).is_some();
        let is_among = |shapes: &Shapes| match shapes.frame.probe(ray) {
            None => world.nearest(ray, t_max, None).is_some(),
            Some(probe) => {
                let walk = Walk::<true> {
                    tree: &shapes.tree,
                    leaves: &shapes.leaves,
                    geometries,
                    ray,
                    probe: &probe,
                    nearest: Nearest::before(t_max),
                    own: None,
                    glass: None,
                };
                self.isa.run(walk).t < t_max
            }
        };
        self.apart.iter().any(meets) || self.shapes().any(is_among)
    }

    /// Returns [`World::transmission`].
    pub(crate) fn transmission(
        &self,
        world: &World,
        ray: &Ray,
        t_max: f64,
        own: FaceId,
    ) -> Radiance {
        let geometries = world.geometries();
        let face = own;
        let Some(own) = world.own(Some(own)) else {
            return world.transmission(ray, t_max, face);
        };
        // All glass that the ray crosses.
        let mut glass = Crossings::default();
        let mut is_dark = self.apart.iter().any(|index| {
            let geometry = &geometries[*index];
            let first = geometry.shape().meet_from(Some(&own), ray, t_max);
            first.is_some() && glass.is_opaque(geometry, *index)
        });
        for shapes in self.shapes() {
            let Some(probe) = shapes.frame.probe(ray) else {
                return world.transmission(ray, t_max, face);
            };
            if let Some(sphere) = own.shape().sphere()
                && sphere.far_from_own(ray, t_max).is_some()
            {
                shapes.twins(sphere, |index| {
                    is_dark |= glass.is_opaque(&geometries[index], index);
                });
            }
            let walk = Walk::<true> {
                tree: &shapes.tree,
                leaves: &shapes.leaves,
                geometries,
                ray,
                probe: &probe,
                nearest: Nearest::before(t_max),
                own: Some(&own),
                glass: Some(&mut glass),
            };
            if is_dark || self.isa.run(walk).t < t_max {
                return Radiance::BLACK;
            }
        }
        if is_dark {
            return Radiance::BLACK;
        }
        let mut transmission = Radiance::WHITE;
        for index in glass.in_order() {
            let (geometry, shape) = (&geometries[index], geometries[index].shape());
            shape.each_crossing(ray, own.on(shape), t_max, |crossing| {
                transmission = transmission * geometry.transmission(ray, crossing);
            });
        }
        transmission
    }
}

/// Returns the index of a geometry and its box; `None` if it cannot be in the tree.
fn inside((index, geometry): (usize, &Geometry)) -> Option<(u32, Hull)> {
    let hull = Hull::new(geometry.shape())?;
    (index <= Item::LAST).then_some((index as u32, hull))
}
