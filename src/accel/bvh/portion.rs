//! Some geometries of a world with a tree over those that have bounds.

use std::ops::Range;

use glam::DVec3;

use crate::{
    accel::{
        bvh::{
            build::{Builder, Lists},
            frame::{Frame, Hull, Probe},
            node::Leaf,
            split::Item,
            tree::Tree,
            walk::{Nearest, Walk},
        },
        lanes::{abs, bits, dot, load3, splat3, sub},
        pages::Pages,
        runs::{count, geometries},
    },
    simd::{F64x8, Kernel, Mask, Simd},
    tracer::{
        geometry::Geometry,
        ray::Ray,
        shape::{face::FaceId, sphere::Sphere},
        world::World,
    },
};

/// Some geometries of a world.
#[derive(Clone, Debug)]
pub(crate) struct Portion {
    /// The geometries tested by the plain loop: planes, and those outside of the frame.
    pub(super) apart: Vec<usize>,
    pub(super) shapes: Option<Shapes>,
}

/// The bounded shapes of a world.
#[derive(Clone, Debug)]
pub(super) struct Shapes {
    pub(super) frame: Frame,
    pub(super) tree: Tree,
    pub(super) leaves: Vec<Leaf>,
    /// The radius of the largest sphere.
    pub(super) largest: f64,
}

impl Shapes {
    /// Returns the sphere in a lane of a leaf.
    pub(super) fn sphere(&self, (leaf, lane): (usize, usize)) -> Option<Sphere> {
        self.leaves.get(leaf)?.sphere(lane)
    }

    /// Returns the walk of a ray that does not meet the geometries of the faces that it leaves.
    #[inline(always)]
    pub(super) fn walk<'a, const ANY: bool>(
        &'a self,
        geometries: &'a [Geometry],
        (ray, probe): (&'a Ray, &'a Probe),
        nearest: Nearest,
        left: &'a [FaceId],
    ) -> Walk<'a, ANY> {
        Walk {
            tree: &self.tree,
            leaves: &self.leaves,
            geometries,
            ray,
            probe,
            nearest,
            left,
            watch: None,
            glass: None,
        }
    }
}

/// The kernel that calls `see` with the index of every shape that may meet a box, given its corners.
pub(super) struct Near<'a, 'b> {
    pub(super) shapes: &'a Shapes,
    pub(super) corners: [DVec3; 2],
    pub(super) see: &'b mut dyn FnMut(usize),
}

impl Kernel for Near<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        let Self {
            shapes,
            corners,
            see,
        } = self;
        let middle = (corners[0] + corners[1]) * 0.5;
        let half = simd.splat((corners[1] - middle).max_element());
        let middle = splat3(simd, middle);
        shapes
            .tree
            .each_near(simd, shapes.frame.near(corners), |number| {
                let leaf = &shapes.leaves[number];
                // All spheres that the surface of the box may meet, and so the box itself if it is so much
                // smaller.
                let center = load3(simd, &leaf.center);
                let radius = simd.load(&leaf.radius);
                let away = sub(middle, center);
                let off = abs(dot(away, away) - radius * radius);
                let reach = simd.splat(4.0) * half;
                let is_near = off.le(reach * (radius + radius + reach));
                for lane in bits(is_near.bits() | leaf.others) {
                    see(leaf.index[lane] as usize);
                }
            });
    }
}

impl Portion {
    /// Builds the tree of some geometries. If it is cancelled, all shapes are apart.
    pub(super) fn new(world: &World, runs: &[Range<usize>], builder: Builder<'_>) -> Self {
        let some = || geometries(world, runs);
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
            let leaves = builder.leaves(&lists, world.geometries());
            let radii = leaves.iter().flat_map(|leaf| leaf.radius);
            Some(Shapes {
                frame,
                tree,
                largest: radii.fold(0.0, f64::max),
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

/// Returns the index of a geometry and its box; `None` if it cannot be in the tree.
fn inside((index, geometry): (usize, &Geometry)) -> Option<(u32, Hull)> {
    let hull = Hull::new(geometry.shape())?;
    (index <= Item::LAST).then_some((index as u32, hull))
}
