//! A tree over the boxes of numbered things: the copies of shapes, or the parts of a solid.
//!
//! A leaf holds the numbers of up to eight things and a box around each.

use glam::DVec3;

use crate::{
    accel::{
        bvh::{
            build::{Builder, Leaves, Lists},
            frame::{Frame, Hull, Probe},
            split::Item,
            traverse::{OneRay, Seek, Together},
            tree::Tree,
        },
        pages::Pages,
    },
    simd::{Kernel, Simd, isa::Isa},
    tracer::ray::Ray,
};

/// A tree over the boxes of numbered things.
#[derive(Debug)]
pub(super) struct Places {
    frame: Frame,
    tree: Tree,
    lists: Lists,
    /// The lower and upper corners of each box, in the order of the lists.
    boxes: Vec<[[f32; 3]; 2]>,
    /// The place of the first box of each list.
    firsts: Vec<u32>,
}

/// What is done with things that eight rays may meet.
pub(super) trait Met<S: Simd> {
    /// Sees one, and returns the `t` from which on others do not matter.
    fn see(&mut self, simd: S, number: usize) -> f64;
}

impl Places {
    /// Creates a tree over the boxes of things with these numbers, all of which are in one box; `None` if one
    /// has no box, or if they are too many, too large or all one point.
    pub(super) fn new(
        whole: [DVec3; 2],
        numbers: impl ExactSizeIterator<Item = usize> + Clone,
        box_of: impl Fn(usize) -> Option<[DVec3; 2]>,
        builder: Builder<'_>,
    ) -> Option<Self> {
        let whole = Hull::of_box(whole);
        let last = numbers.clone().max()?;
        if last >= Item::LAST || !whole.is_ordinary() {
            return None;
        }
        let (frame, count) = (Frame::around(std::iter::once(whole))?, numbers.len());
        let hull = |number: usize| Some(frame.hull(&Hull::of_box(box_of(number)?)));
        let mut items = Pages::zeroed(count);
        for (number, item) in numbers.zip(items.as_mut()) {
            let [center, half] = hull(number)?;
            *item = Item::new(center, half, number as u32);
        }
        let (tree, lists) = builder.tree(items, Lists::default())?;
        let (mut boxes, mut firsts) = (Vec::new(), Vec::new());
        boxes.reserve_exact(count);
        for list in 0..lists.len() {
            firsts.push(boxes.len() as u32);
            for number in lists.of(list) {
                let [center, half] = hull(number as usize)?;
                let side = |sign: f32| std::array::from_fn(|axis| center[axis] + sign * half[axis]);
                boxes.push([side(-1.0), side(1.0)]);
            }
        }
        Some(Self {
            frame,
            tree,
            lists,
            boxes,
            firsts,
        })
    }

    /// Returns the numbers and the boxes of a leaf.
    #[inline(always)]
    fn of_leaf(&self, leaf: usize) -> impl Iterator<Item = (usize, &[[f32; 3]; 2])> {
        let boxes = &self.boxes[self.firsts[leaf] as usize..];
        let numbers = self.lists.of(leaf).map(|number| number as usize);
        numbers.zip(boxes)
    }

    #[inline(always)]
    fn prefetch<S: Simd>(&self, simd: S, leaf: usize) {
        simd.prefetch(self.lists.place(leaf));
        simd.prefetch(&self.boxes[self.firsts[leaf] as usize]);
    }

    /// Calls `see` with the things whose boxes a ray may meet, the nearest first, and the `t` from which on
    /// others do not matter; `see` returns that. Returns false if nothing is known of such a ray.
    pub(super) fn search(
        &self,
        isa: Isa,
        ray: &Ray,
        t_max: f64,
        see: &mut dyn FnMut(usize, f64) -> f64,
    ) -> bool {
        let Some(probe) = self.frame.probe(ray) else {
            return false;
        };
        isa.run(Near {
            places: self,
            probe: &probe,
            end: t_max,
            see,
        });
        true
    }

    /// Tells `met` the things whose boxes one of eight rays may meet before `t_max`, the nearest first. Returns
    /// false if nothing is known of such rays.
    #[inline(always)]
    pub(super) fn search_together<S: Simd, M: Met<S>>(
        &self,
        simd: S,
        rays: [[S::F64; 3]; 2],
        t_max: f64,
        met: &mut M,
    ) -> bool {
        let Some(beam) = self.frame.beam(simd, rays, 0.0) else {
            return false;
        };
        let rays = Together::new(simd, &beam);
        let mut search = TogetherSearch {
            places: self,
            rays: &rays,
            end: t_max,
            met,
        };
        self.tree.traverse(simd, &rays, &mut search);
        true
    }

    /// Calls `see` with the things whose boxes meet another one, given its corners, and maybe with others.
    pub(super) fn each_near(&self, isa: Isa, corners: [DVec3; 2], see: &mut dyn FnMut(usize)) {
        isa.run(NearBox {
            places: self,
            around: self.frame.near(corners),
            see,
        });
    }
}

/// The kernel that calls `see` with the things near a box.
struct NearBox<'a, 'b> {
    places: &'a Places,
    around: [[f32; 3]; 2],
    see: &'b mut dyn FnMut(usize),
}

impl Kernel for NearBox<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        let [from, to] = self.around;
        let is_near = |[low, high]: &[[f32; 3]; 2]| {
            (0..3).all(|axis| low[axis] <= to[axis] && from[axis] <= high[axis])
        };
        self.places.tree.each_near(simd, self.around, |list| {
            let all = self.places.of_leaf(list);
            let near = all.filter(|(_, around)| is_near(around));
            near.for_each(|(number, _)| (self.see)(number));
        });
    }
}

/// The kernel that finds things near a ray.
struct Near<'a> {
    places: &'a Places,
    probe: &'a Probe,
    end: f64,
    see: &'a mut dyn FnMut(usize, f64) -> f64,
}

impl Kernel for Near<'_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        let (places, ray) = (self.places, OneRay::new(simd, self.probe));
        let mut search = Search {
            near: self,
            ray: &ray,
        };
        places.tree.traverse(simd, &ray, &mut search);
    }
}

/// The search for things and its ray in lanes.
struct Search<'a, 'b, S: Simd> {
    near: Near<'a>,
    ray: &'b OneRay<'a, S>,
}

impl<S: Simd> Seek<S> for Search<'_, '_, S> {
    const ANY: bool = false;

    #[inline(always)]
    fn end(&self) -> f64 {
        self.near.end
    }

    #[inline(always)]
    fn visit(&mut self, _: S, leaf: usize) -> bool {
        let near = &mut self.near;
        let before = near.end;
        for (number, bounds) in near.places.of_leaf(leaf) {
            if self.ray.meets(bounds, near.end) {
                near.end = (near.see)(number, near.end);
            }
        }
        near.end < before
    }

    #[inline(always)]
    fn prefetch(&self, simd: S, leaf: usize) {
        self.near.places.prefetch(simd, leaf);
    }
}

/// The search for things that eight rays may meet.
struct TogetherSearch<'a, S: Simd, M> {
    places: &'a Places,
    rays: &'a Together<'a, S>,
    end: f64,
    met: &'a mut M,
}

impl<S: Simd, M: Met<S>> Seek<S> for TogetherSearch<'_, S, M> {
    const ANY: bool = false;

    #[inline(always)]
    fn end(&self) -> f64 {
        self.end
    }

    #[inline(always)]
    fn visit(&mut self, simd: S, leaf: usize) -> bool {
        let before = self.end;
        for (number, bounds) in self.places.of_leaf(leaf) {
            if self.rays.meets(bounds, self.end) {
                self.end = self.met.see(simd, number);
            }
        }
        self.end < before
    }

    #[inline(always)]
    fn prefetch(&self, simd: S, leaf: usize) {
        self.places.prefetch(simd, leaf);
    }
}
