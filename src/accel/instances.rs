//! The index of copies: a tree over them, with the results of the loop over all of them.
//!
//! A copy whose box a ray meets is tested; a prototype of many shapes has a hierarchy of its own.

mod bundle;

use glam::DVec3;

use crate::{
    accel::{
        bvh::{Hierarchy, build::Builder},
        instances::bundle::FirstOfEach,
        places::Places,
    },
    simd::isa::Isa,
    tracer::{
        color::Color,
        geometry::Geometry,
        ray::{BUNDLE, Bundle},
        shape::{
            Shape,
            around::Around,
            face::{Crossing, Leaving},
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

/// The shapes of a copy, and the hierarchy over them.
#[derive(Debug)]
struct Prototype {
    world: World,
    hierarchy: Hierarchy,
    /// For eight rays at a time.
    places: Option<Places>,
}

impl Copies {
    fn new(copies: &Instances, builder: Builder<'_>) -> Option<Self> {
        let (all, box_of) = (0..copies.len(), |copy| copies.box_of(copy));
        let whole = copies.bounds().filter(|_| all.len() >= FEW);
        let places = whole.and_then(|whole| Places::new(whole, all, box_of, builder));
        let prototype = (copies.shapes().len() > FEW_SHAPES).then(|| {
            let shapes = copies.shapes();
            let shapes = shapes.map(|shape| Geometry::new(shape.clone(), Color::BLACK));
            let world = World::new(shapes.collect(), Color::BLACK);
            let hierarchy = Hierarchy::new((&world, None), builder);
            let box_of = |part| {
                copies
                    .part(part)
                    .and_then(|(shape, _)| Shape::bounds(shape))
            };
            let all = 0..world.geometries().len();
            let whole = copies.around_prototype().and_then(Around::bounds);
            let places = whole.and_then(|whole| Places::new(whole, all, box_of, builder));
            Prototype {
                world,
                hierarchy,
                places,
            }
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
            Some(Prototype {
                world, hierarchy, ..
            }) => {
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
        let places = self.places.as_ref();
        if places.is_some_and(|places| places.search(self.isa, passage.ray(), t_max, see)) {
            return;
        }
        let mut end = t_max;
        (0..passage.count()).for_each(|copy| end = see(copy, end));
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

    fn first_of_each(
        &self,
        copies: &Instances,
        bundle: &Bundle,
        leaving: &[Leaving; BUNDLE],
    ) -> [Option<Crossing>; BUNDLE] {
        let shapes = self.prototype.as_ref();
        let together = FirstOfEach {
            places: self.places.as_ref(),
            shapes: shapes.and_then(|shapes| shapes.places.as_ref()),
            meet: &|copied, t_max| self.meet(copied, t_max),
            copies,
            bundle,
            leaving,
        };
        let one_by_one = || {
            bundle.each(|lane, ray, t_max| self.first(&copies.crossings(ray, leaving[lane]), t_max))
        };
        self.isa.run(together).unwrap_or_else(one_by_one)
    }

    fn each_near(&self, corners: [DVec3; 2], see: &mut dyn FnMut(usize)) {
        match &self.places {
            Some(places) => places.each_near(self.isa, corners, see),
            None => (0..self.count).for_each(see),
        }
    }
}
