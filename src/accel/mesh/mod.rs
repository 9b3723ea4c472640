//! The index of a mesh: a tree over its triangles, with the results of the loop over all of them.
//!
//! A node of the tree holds the boxes of eight nodes or patches. The triangles of a patch are tested
//! together, in the lanes of a vector, by the equations of the format. Rays of a camera walk through the
//! tree in bundles of eight; then the lanes are the rays.

mod bundle;
mod patch;
pub(super) mod sheared;
#[cfg(test)]
mod tests;

use std::cell::Cell;

use glam::DVec3;

use crate::{
    accel::{
        bvh::{
            build::Builder,
            frame::{Frame, Hull},
            split::Item,
            traverse::{OneRay, Seek},
            tree::Tree,
        },
        lanes::{bits, splat3},
        mesh::{
            bundle::FirstOfEach,
            patch::{Lists, Patch, patches_of},
            sheared::{Sheared, crossings},
        },
        pages::Pages,
    },
    simd::{F64x8, Kernel, LANES, Mask, Simd, isa::Isa},
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

thread_local! {
    /// The place of the triangle that this thread found last, in any mesh: its corners are needed next, and
    /// the list of all places is rarely in the cache.
    static LAST: Cell<usize> = const { Cell::new(0) };
}

/// Gives a mesh an index, if it has none. One that is small, or whose numbers are extreme, needs the
/// loop.
pub(crate) fn index_mesh(mesh: &Mesh, builder: Builder<'_>) {
    let build =
        |mesh: &Mesh| -> Option<Box<dyn Index>> { Some(Box::new(Triangles::new(mesh, builder)?)) };
    mesh.index_with(build);
}

/// The index of a mesh.
#[derive(Debug)]
struct Triangles {
    isa: Isa,
    frame: Frame,
    tree: Tree,
    patches: Pages<Patch>,
    /// The patch of each triangle, times eight, plus its lane.
    places: Pages<u32>,
}

impl Triangles {
    fn new(mesh: &Mesh, builder: Builder<'_>) -> Option<Self> {
        let Builder { isa, pool, .. } = builder;
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
        let mut items = Pages::zeroed(count);
        let portions = items.as_mut().chunks_mut(TOGETHER).enumerate();
        pool.map(portions, |(portion, items)| {
            let first = portion * TOGETHER;
            for (place, to) in items.iter_mut().enumerate() {
                *to = item((first + place) as u32);
            }
        });
        let (tree, lists) = builder.tree(items, Lists::of(mesh))?;
        let patches = lists.patches(pool);
        Some(Self {
            isa,
            frame,
            tree,
            places: places(&patches, count)?,
            patches,
        })
    }
}

/// Returns the places of all triangles of a mesh in patches; `None` if there are too many.
fn places(patches: &[Patch], count: usize) -> Option<Pages<u32>> {
    u32::try_from(patches.len() * LANES).ok()?;
    let mut places = Pages::zeroed(count);
    let of_face = places.as_mut();
    for (patch, first) in patches.iter().zip((0..).step_by(LANES)) {
        let faces = patch.faces.iter().take(patch.triangles.into());
        for (face, place) in faces.zip(first..) {
            of_face[*face as usize] = place;
        }
    }
    Some(places)
}

impl Index for Triangles {
    fn first(&self, passage: &Passage, t_max: f64) -> Option<Crossing> {
        let first = Crossing { t: t_max, face: 0 };
        let found = self.isa.run(Walk {
            triangles: self,
            patches: &self.patches,
            passage,
            find: first,
        });
        match found {
            Ok(found) => (found.t < t_max).then_some(found),
            Err(_) => passage.first_of_all(t_max),
        }
    }

    #[inline]
    fn corners(&self, face: u64) -> Option<[DVec3; 3]> {
        let at = |place: usize| {
            let (patch, lane) = (self.patches.get(place / LANES)?, place % LANES);
            let is_there = lane < patch.triangles.into() && u64::from(patch.faces[lane]) == face;
            is_there.then(|| patch.corners_of(lane))
        };
        at(LAST.get()).or_else(|| at(*self.places.get(face as usize)? as usize))
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
            bundle,
            leaving,
        };
        self.isa.run(together).unwrap_or_else(one_by_one)
    }

    fn each_near(&self, corners: [DVec3; 2], see: &mut dyn FnMut(u64, [DVec3; 3])) {
        self.isa.run(Near {
            triangles: self,
            corners,
            see,
        });
    }

    fn each(&self, passage: &Passage, t_max: f64, see: &mut dyn FnMut(Crossing)) {
        let found = self.isa.run(Walk {
            triangles: self,
            patches: &self.patches,
            passage,
            find: Each { t_max, see },
        });
        if let Err(Each { see, .. }) = found {
            passage.each_of_all(t_max, see);
        }
    }
}

/// The kernel that calls `see` with each triangle whose box meets another one.
struct Near<'a, 'b> {
    triangles: &'a Triangles,
    corners: [DVec3; 2],
    see: &'b mut dyn FnMut(u64, [DVec3; 3]),
}

impl Kernel for Near<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        let Triangles {
            tree,
            frame,
            patches,
            ..
        } = self.triangles;
        let around = self.corners.map(|corner| splat3(simd, corner));
        tree.each_near(simd, frame.near(self.corners), |leaf| {
            for patch in patches_of(patches, leaf) {
                for lane in bits(patch.near(simd, around)) {
                    (self.see)(patch.faces[lane].into(), patch.corners_of(lane));
                }
            }
        });
    }
}

/// What a ray looks for.
trait Find {
    /// Returns the `t` at which the ray ends.
    fn end(&self) -> f64;

    /// Returns true if a crossing is wanted.
    fn wants(&self, crossing: Crossing) -> bool;

    /// Takes a crossing that is wanted; returns true if the ray ends there.
    fn take(&mut self, crossing: Crossing) -> bool;
}

/// The first crossing so far. Nothing at `t_max` itself is taken, because no number is below 0.
impl Find for Crossing {
    #[inline(always)]
    fn end(&self) -> f64 {
        self.t
    }

    #[inline(always)]
    fn wants(&self, other: Crossing) -> bool {
        other.t < self.t || (other.t == self.t && other.face < self.face)
    }

    #[inline(always)]
    fn take(&mut self, crossing: Crossing) -> bool {
        *self = crossing;
        true
    }
}

/// Every crossing before `t_max`.
struct Each<'a> {
    t_max: f64,
    see: &'a mut dyn FnMut(Crossing),
}

impl Find for Each<'_> {
    #[inline(always)]
    fn end(&self) -> f64 {
        self.t_max
    }

    #[inline(always)]
    fn wants(&self, crossing: Crossing) -> bool {
        crossing.t < self.t_max
    }

    #[inline(always)]
    fn take(&mut self, crossing: Crossing) -> bool {
        (self.see)(crossing);
        false
    }
}

/// The kernel that finds crossings of one ray. It returns what it found, or what it looked for if the
/// ray needs the loop.
struct Walk<'a, F> {
    triangles: &'a Triangles,
    patches: &'a [Patch],
    passage: &'a Passage<'a>,
    find: F,
}

impl<F: Find> Kernel for Walk<'_, F> {
    type Output = Result<F, F>;

    #[inline(always)]
    fn run<S: Simd>(mut self, simd: S) -> Result<F, F> {
        let triangles = self.triangles;
        let Some(probe) = triangles.frame.probe(self.passage.ray()) else {
            return Err(self.find);
        };
        let ray = OneRay::new(simd, &probe);
        triangles.tree.traverse(simd, &ray, &mut self);
        Ok(self.find)
    }
}

impl<S: Simd, F: Find> Seek<S> for Walk<'_, F> {
    const ANY: bool = false;

    #[inline(always)]
    fn end(&self) -> f64 {
        self.find.end()
    }

    #[inline(always)]
    fn visit(&mut self, simd: S, leaf: usize) -> bool {
        let mut is_nearer = false;
        // Not before: half of the rays come to no leaf, and the others have to wait for it.
        let sheared = Sheared::one(simd, &self.passage.sheared());
        for (number, patch) in (leaf..).zip(patches_of(self.patches, leaf)) {
            let corners = sheared.corners(simd, patch);
            let Some((t, crosses)) = crossings(simd, corners) else {
                continue;
            };
            let lanes = (crosses & t.le(simd.splat(self.find.end()))).bits();
            if lanes != 0 {
                let mut at = [0.0; LANES];
                t.store(&mut at);
                is_nearer |= self.take((number, patch), lanes, &at);
            }
        }
        is_nearer
    }

    #[inline(always)]
    fn prefetch(&self, simd: S, leaf: usize) {
        simd.prefetch(&self.patches[leaf]);
    }
}

impl<F: Find> Walk<'_, F> {
    /// Takes the crossings with the triangles in some lanes of a patch that are wanted; returns true if
    /// the ray ends at one.
    #[inline(always)]
    fn take(&mut self, (number, patch): (usize, &Patch), mut lanes: u8, t: &[f64; LANES]) -> bool {
        let mut is_nearer = false;
        while lanes != 0 {
            let lane = lanes.trailing_zeros() as usize;
            lanes &= lanes - 1;
            let (t, face) = (t[lane], patch.faces[lane].into());
            let crossing = Crossing { t, face };
            if self.find.wants(crossing) && self.passage.counts(face, patch.corners_of(lane), t) {
                is_nearer |= self.find.take(crossing);
                LAST.set(number * LANES + lane);
            }
        }
        is_nearer
    }
}
