//! The index of a mesh: a tree over its triangles, with the results of the loop over all of them.
//!
//! A node of the tree holds the boxes of eight nodes or triangles. The triangles of a node whose boxes a
//! ray meets are tested together, in the lanes of a vector, by the equations of the format. Rays of a
//! camera walk through the tree in bundles of eight; then the lanes are the rays.

mod bundle;
mod sheared;
#[cfg(test)]
mod tests;

use crate::{
    accel::{
        bvh::{
            Tree,
            build::{Builder, Singles},
            frame::{Frame, Hull, Probe},
            split::Item,
            traverse::{OneRay, Seek},
        },
        lanes::load3,
        mesh::{bundle::FirstOfEach, sheared::Sheared},
    },
    parallel::Pool,
    simd::{F64x8, Isa, Kernel, LANES, Mask, Simd},
    tracer::{
        ray::{BUNDLE, Bundle},
        shape::{
            face::{Crossing, Leaving},
            mesh::{Index, Mesh, Passage},
        },
    },
};

/// Number of triangles that a thread looks at at once.
const TOGETHER: usize = 1 << 14;

/// Below this many triangles the loop is as fast.
const FEW: usize = 8;

/// Gives a mesh an index, if it has none. One that is small, or whose numbers are extreme, needs the
/// loop.
pub(crate) fn index_mesh(mesh: &Mesh, pool: &Pool, isa: Isa) {
    let build = |mesh: &Mesh| -> Option<Box<dyn Index>> {
        Some(Box::new(Triangles::new(mesh, pool, isa)?))
    };
    mesh.index_with(build);
}

/// The index of a mesh.
#[derive(Debug)]
struct Triangles {
    isa: Isa,
    frame: Frame,
    tree: Tree,
}

impl Triangles {
    fn new(mesh: &Mesh, pool: &Pool, isa: Isa) -> Option<Self> {
        let count = mesh.triangles().len();
        let whole = Hull::of_box(mesh.bounds()?);
        if !(FEW..=Item::LAST).contains(&count) || !whole.is_ordinary() {
            return None;
        }
        let frame = Frame::around(std::iter::once(whole))?;
        let item = |number: u32| {
            let bounds = mesh.box_of(number.into()).unwrap_or_default();
            let [center, half] = frame.hull(&Hull::of_box(bounds));
            Item::new(center, half, number)
        };
        // In place: with millions of triangles, copies would be the peak of memory.
        let mut items = vec![Item::new([0.0; 3], [0.0; 3], 0); count];
        let portions = items.chunks_mut(TOGETHER).enumerate();
        pool.map(portions, |(portion, items)| {
            let first = portion * TOGETHER;
            for (place, to) in items.iter_mut().enumerate() {
                *to = item((first + place) as u32);
            }
        });
        let (tree, Singles) = Builder { isa, pool }.tree(&mut items);
        Some(Self { isa, frame, tree })
    }
}

impl Index for Triangles {
    fn first(&self, passage: &Passage, t_max: f64) -> Option<Crossing> {
        let Some(probe) = self.frame.probe(passage.ray()) else {
            return passage.first_of_all(t_max);
        };
        let first = Crossing { t: t_max, face: 0 };
        let found = self.isa.run(First {
            triangles: self,
            probe: &probe,
            passage,
            first,
        });
        (found.t < t_max).then_some(found)
    }

    fn first_of_each(
        &self,
        mesh: &Mesh,
        bundle: &Bundle,
        leaving: &[Leaving; BUNDLE],
    ) -> [Option<Crossing>; BUNDLE] {
        let one_by_one = || {
            bundle.each(|lane, ray, t_max| {
                let passage = mesh.crossings(ray, leaving[lane]);
                self.first(&passage, t_max)
            })
        };
        let together = FirstOfEach {
            triangles: self,
            mesh,
            bundle,
            leaving,
        };
        self.isa.run(together).unwrap_or_else(one_by_one)
    }

    fn each(&self, passage: &Passage, t_max: f64, see: &mut dyn FnMut(Crossing)) {
        match self.frame.probe(passage.ray()) {
            Some(probe) => self.isa.run(Each {
                triangles: self,
                probe: &probe,
                passage,
                t_max,
                see,
            }),
            None => passage.each_of_all(t_max, see),
        }
    }
}

/// The kernel that finds the first crossing.
struct First<'a> {
    triangles: &'a Triangles,
    probe: &'a Probe,
    passage: &'a Passage<'a>,
    /// The first crossing so far. Nothing at `t_max` itself is taken, because no number is below 0.
    first: Crossing,
}

impl Kernel for First<'_> {
    type Output = Crossing;

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> Crossing {
        let (triangles, ray) = (self.triangles, OneRay::new(simd, self.probe));
        let mut search = Search {
            sheared: Sheared::one(simd, self.passage.sheared()),
            passage: self.passage,
            first: self.first,
        };
        triangles.tree.traverse(simd, &ray, &mut search);
        search.first
    }
}

/// A ray in lanes, and its first crossing so far.
struct Search<'a, S: Simd> {
    sheared: Sheared<S>,
    passage: &'a Passage<'a>,
    first: Crossing,
}

impl<S: Simd> Seek<S> for Search<'_, S> {
    const ANY: bool = false;
    const TOGETHER: bool = true;

    #[inline(always)]
    fn end(&self) -> f64 {
        self.first.t
    }

    #[inline(always)]
    fn visit(&mut self, simd: S, leaf: usize) -> bool {
        self.visit_all(simd, &[leaf as u32; LANES], 1)
    }

    #[inline(always)]
    fn visit_all(&mut self, simd: S, leaves: &[u32; LANES], lanes: u8) -> bool {
        let mut corners = [[[0.0; LANES]; 3]; 3];
        let mut rest = lanes;
        while rest != 0 {
            let lane = rest.trailing_zeros() as usize;
            rest &= rest - 1;
            let Some(of_one) = self.passage.mesh().corners_in_place(leaves[lane].into()) else {
                continue;
            };
            for (axes, corner) in corners.iter_mut().zip(of_one) {
                let corner: &[f64; 3] = corner.as_ref();
                for (to, axis) in axes.iter_mut().zip(self.sheared.axes) {
                    to[lane] = corner[axis];
                }
            }
        }
        let [a, b, c] = &corners;
        let corners = [load3(simd, a), load3(simd, b), load3(simd, c)];
        let Some((t, crosses)) = self.sheared.crossings(simd, corners) else {
            return false;
        };
        let crosses = crosses & t.le(simd.splat(self.first.t));
        let lanes = lanes & crosses.bits();
        if lanes == 0 {
            return false;
        }
        let mut at = [0.0; LANES];
        t.store(&mut at);
        self.take(leaves, lanes, &at)
    }

    #[inline(always)]
    fn prefetch(&self, simd: S, leaf: usize) {
        simd.prefetch(&self.passage.mesh().triangles()[leaf]);
    }
}

impl<S: Simd> Search<'_, S> {
    /// Takes the crossings with the triangles in some lanes that are first so far; returns true if
    /// there is one.
    #[inline(never)]
    fn take(&mut self, faces: &[u32; LANES], lanes: u8, t: &[f64; LANES]) -> bool {
        let mut is_nearer = false;
        for lane in (0..LANES).filter(|lane| lanes >> lane & 1 == 1) {
            let (t, face, first) = (t[lane], faces[lane].into(), self.first);
            let is_first = t < first.t || (t == first.t && face < first.face);
            if is_first && self.passage.counts(face, t) {
                self.first = Crossing { t, face };
                is_nearer = true;
            }
        }
        is_nearer
    }
}

/// The kernel that finds each crossing.
struct Each<'a> {
    triangles: &'a Triangles,
    probe: &'a Probe,
    passage: &'a Passage<'a>,
    t_max: f64,
    see: &'a mut dyn FnMut(Crossing),
}

impl Kernel for Each<'_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(mut self, simd: S) {
        let (triangles, ray) = (self.triangles, OneRay::new(simd, self.probe));
        triangles.tree.traverse(simd, &ray, &mut self);
    }
}

impl<S: Simd> Seek<S> for Each<'_> {
    const ANY: bool = false;

    #[inline(always)]
    fn end(&self) -> f64 {
        self.t_max
    }

    #[inline(always)]
    fn visit(&mut self, _: S, leaf: usize) -> bool {
        if let Some(found) = self.passage.cross(leaf as u64, self.t_max) {
            (self.see)(found);
        }
        false
    }

    #[inline(always)]
    fn prefetch(&self, simd: S, leaf: usize) {
        simd.prefetch(&self.passage.mesh().triangles()[leaf]);
    }
}
