//! The index of a mesh: a tree over its triangles, with the results of the loop over all of them.
//!
//! A node of the tree holds the boxes of eight nodes or triangles. The triangles whose boxes a ray
//! meets, few of the eight, are tested one by one, by the equations of the format.

#[cfg(test)]
mod tests;

use crate::{
    accel::bvh::{
        Tree,
        build::{Builder, Singles},
        frame::{Frame, Hull, Probe},
        split::Item,
        traverse::Seek,
    },
    parallel::Pool,
    simd::{Isa, Kernel, Simd},
    tracer::{
        geometry::Geometry,
        shape::{
            face::Crossing,
            mesh::{Index, Mesh, Passage},
        },
    },
};

/// Number of triangles that a thread looks at at once.
const TOGETHER: usize = 1 << 14;

/// Below this many triangles the loop is as fast.
const FEW: usize = 8;

/// Gives each mesh an index, if it has none.
pub(crate) fn index_meshes<'a>(
    geometries: impl IntoIterator<Item = &'a Geometry>,
    pool: &Pool,
    isa: Isa,
) {
    for geometry in geometries {
        let shape = geometry.shape();
        shape.each_mesh(&mut |mesh| index_mesh(mesh, pool, isa));
    }
}

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
            let bounds = mesh.box_of(number)?;
            let [center, half] = frame.hull(&Hull::of_box(bounds));
            Some(Item::new(center, half, number))
        };
        let starts = (0..count).step_by(TOGETHER);
        let portions = pool.map(starts, |start| {
            let numbers = start as u32..(start + TOGETHER).min(count) as u32;
            numbers.filter_map(item).collect::<Vec<_>>()
        });
        let mut items = portions.concat();
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
    fn run<S: Simd>(mut self, simd: S) -> Crossing {
        let (triangles, probe) = (self.triangles, self.probe);
        triangles.tree.traverse(simd, probe, &mut self);
        self.first
    }
}

impl<S: Simd> Seek<S> for First<'_> {
    const ANY: bool = false;

    #[inline(always)]
    fn end(&self) -> f64 {
        self.first.t
    }

    #[inline(always)]
    fn visit(&mut self, _: S, leaf: usize) -> bool {
        // At an equal t the lower number may still win.
        let Some(found) = self.passage.cross(leaf as u32, self.first.t.next_up()) else {
            return false;
        };
        let first = self.first;
        let is_nearer = found.t < first.t || (found.t == first.t && found.face < first.face);
        if is_nearer {
            self.first = found;
        }
        is_nearer
    }

    #[inline(always)]
    fn prefetch(&self, simd: S, leaf: usize) {
        simd.prefetch(&self.passage.mesh().triangles()[leaf]);
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
        let (triangles, probe) = (self.triangles, self.probe);
        triangles.tree.traverse(simd, probe, &mut self);
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
        if let Some(found) = self.passage.cross(leaf as u32, self.t_max) {
            (self.see)(found);
        }
        false
    }

    #[inline(always)]
    fn prefetch(&self, simd: S, leaf: usize) {
        simd.prefetch(&self.passage.mesh().triangles()[leaf]);
    }
}
