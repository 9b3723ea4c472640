//! The index of copies: a tree over them, with the results of the loop over all of them.
//!
//! A leaf holds the numbers of up to eight copies and a box around each. A copy whose box a ray meets is
//! tested; a prototype of many shapes has a hierarchy of its own.

use glam::DVec3;

use crate::{
    accel::{
        bvh::{
            Hierarchy,
            build::{Builder, Leaves, Lists},
            frame::{Frame, Hull, Probe},
            split::Item,
            traverse::{OneRay, Seek},
            tree::Tree,
        },
        pages::Pages,
    },
    simd::{Kernel, Simd, isa::Isa},
    tracer::{
        color::Color,
        geometry::Geometry,
        shape::{
            face::Crossing,
            instances::{
                Instances,
                passage::{Copied, Index, Passage},
            },
        },
        world::World,
    },
};

/// Below this many copies the loop is as fast.
const FEW: usize = 4;

/// Below this many shapes the loop over those of a copy is as fast.
const FEW_SHAPES: usize = 8;

/// Gives copies an index, if they have none. Few of them, or some whose numbers are extreme, need the
/// loop.
pub(crate) fn index_copies(copies: &Instances, builder: Builder<'_>) {
    copies.index_with(|copies| {
        let index = Copies::new(copies, builder)?;
        // One that was cancelled may be a part only.
        (!builder.is_cancelled()).then(|| Box::new(index) as Box<dyn Index>)
    });
}

/// The index of copies.
#[derive(Debug)]
struct Copies {
    isa: Isa,
    /// The number of copies.
    count: usize,
    places: Option<Places>,
    prototype: Option<Prototype>,
}

/// A tree over the boxes around copies.
#[derive(Debug)]
struct Places {
    frame: Frame,
    tree: Tree,
    lists: Lists,
    /// The lower and upper corners of the box around each copy, in the order of the lists.
    boxes: Vec<[[f32; 3]; 2]>,
    /// The place of the first box of each list.
    firsts: Vec<u32>,
}

/// The shapes of a copy, and the hierarchy over them.
#[derive(Debug)]
struct Prototype {
    world: World,
    hierarchy: Hierarchy,
}

impl Copies {
    fn new(copies: &Instances, builder: Builder<'_>) -> Option<Self> {
        let places = Places::new(copies, builder);
        let prototype = (copies.shapes().len() > FEW_SHAPES).then(|| {
            let shapes = copies.shapes();
            let shapes = shapes.map(|shape| Geometry::new(shape.clone(), Color::BLACK));
            let world = World::new(shapes.collect(), Color::BLACK);
            let hierarchy = Hierarchy::new((&world, None), builder);
            Prototype { world, hierarchy }
        });
        (places.is_some() || prototype.is_some()).then_some(Self {
            isa: builder.isa,
            count: copies.len(),
            places,
            prototype,
        })
    }

    /// Returns the first crossing of a ray with a copy.
    fn meet(&self, copied: &Copied, t_max: f64) -> Option<Crossing> {
        match &self.prototype {
            Some(Prototype { world, hierarchy }) => {
                let left = copied.left();
                let nearest = hierarchy.nearest_before(world, copied.ray(), t_max, &left);
                copied.first_that_counts(nearest, t_max)
            }
            None => copied.first(t_max),
        }
    }

    /// Calls `see` with the copies that a ray may meet, the nearest first, and the `t` from which on
    /// others do not matter; `see` returns that.
    fn search(&self, passage: &Passage, t_max: f64, see: &mut dyn FnMut(usize, f64) -> f64) {
        let probe = self.places.as_ref().and_then(|places| {
            let probe = places.frame.probe(passage.ray())?;
            Some((places, probe))
        });
        match probe {
            Some((places, probe)) => self.isa.run(Near {
                places,
                probe: &probe,
                end: t_max,
                see,
            }),
            None => {
                let mut end = t_max;
                (0..passage.count()).for_each(|copy| end = see(copy, end));
            }
        }
    }
}

impl Places {
    fn new(copies: &Instances, builder: Builder<'_>) -> Option<Self> {
        let whole = Hull::of_box(copies.bounds()?);
        if !(FEW..=Item::LAST).contains(&copies.len()) || !whole.is_ordinary() {
            return None;
        }
        let frame = Frame::around(std::iter::once(whole))?;
        let mut items = Pages::zeroed(copies.len());
        for (copy, item) in items.as_mut().iter_mut().enumerate() {
            let [center, half] = frame.hull(&Hull::of_box(copies.box_of(copy)?));
            *item = Item::new(center, half, copy as u32);
        }
        let (tree, lists) = builder.tree(items, Lists::default())?;
        let (mut boxes, mut firsts) = (Vec::new(), Vec::new());
        boxes.reserve_exact(copies.len());
        for list in 0..lists.len() {
            firsts.push(boxes.len() as u32);
            for copy in lists.of(list) {
                let hull = Hull::of_box(copies.box_of(copy as usize)?);
                let [center, half] = frame.hull(&hull);
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
}

impl Index for Copies {
    fn first(&self, passage: &Passage, t_max: f64) -> Option<Crossing> {
        let mut first: Option<Crossing> = None;
        self.search(passage, t_max, &mut |copy, end| {
            // At an equal t the copy with the lower number may still win.
            let farthest = if first.is_some() { end.next_up() } else { end };
            let copied = passage
                .copied(copy)
                .filter(|copied| copied.is_near(farthest));
            let met = copied.and_then(|copied| self.meet(&copied, farthest));
            let is_first = |met: &Crossing| {
                first.is_none_or(|first| {
                    met.t < first.t || (met.t == first.t && met.face < first.face)
                })
            };
            first = met.filter(is_first).or(first);
            first.map_or(end, |first| first.t)
        });
        first
    }

    fn each(&self, passage: &Passage, t_max: f64, see: &mut dyn FnMut(Crossing)) {
        self.search(passage, t_max, &mut |copy, end| {
            if let Some(copied) = passage.copied(copy).filter(|copied| copied.is_near(end)) {
                copied.each(t_max, see);
            }
            end
        });
    }

    fn each_near(&self, corners: [DVec3; 2], see: &mut dyn FnMut(usize)) {
        let Some(places) = &self.places else {
            return (0..self.count).for_each(see);
        };
        self.isa.run(NearBox {
            places,
            around: places.frame.near(corners),
            see,
        });
    }
}

/// The kernel that calls `see` with the copies near a box.
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
        let Places {
            tree,
            lists,
            boxes,
            firsts,
            ..
        } = self.places;
        tree.each_near(simd, self.around, |list| {
            let boxes = &boxes[firsts[list] as usize..];
            let copies = lists.of(list).zip(boxes);
            let near = copies.filter(|(_, around)| is_near(around));
            near.for_each(|(copy, _)| (self.see)(copy as usize));
        });
    }
}

/// The kernel that finds copies near a ray.
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

/// The search for copies and its ray in lanes.
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
        let Places {
            lists,
            boxes,
            firsts,
            ..
        } = near.places;
        let first = firsts[leaf] as usize;
        for (copy, bounds) in lists.of(leaf).zip(&boxes[first..]) {
            if self.ray.meets(bounds, near.end) {
                near.end = (near.see)(copy as usize, near.end);
            }
        }
        near.end < before
    }

    #[inline(always)]
    fn prefetch(&self, simd: S, leaf: usize) {
        let places = self.near.places;
        simd.prefetch(places.lists.place(leaf));
        simd.prefetch(&places.boxes[places.firsts[leaf] as usize]);
    }
}
