//! The leaves of the tree: a few triangles with copies of their corners, so that a ray waits for memory
//! only once.

use glam::DVec3;
use zerocopy::{FromBytes, FromZeros, Immutable, IntoBytes, KnownLayout};

use crate::{
    accel::{
        bvh::{build::Leaves, node::Link, split::Item},
        pages::Pages,
    },
    parallel::Pool,
    simd::LANES,
    tracer::shape::mesh::Mesh,
};

/// The largest number of corners in a patch: eight triangles side by side have nine or ten.
pub(super) const CORNERS: usize = 12;

/// Number of bits of a corner's place.
const BITS: usize = 4;

/// The number of places that these bits have.
pub(super) const PLACES: usize = 1 << BITS;

/// Up to eight triangles and the vertices that are their corners.
#[derive(Clone, Debug, FromBytes, Immutable, IntoBytes, KnownLayout)]
#[repr(C, align(64))]
pub(super) struct Patch {
    /// x, y and z of the corners.
    pub(super) corners: [[f64; CORNERS]; 3],
    /// The first, second and third corners of the triangles: their places in the patch, four bits for
    /// each triangle. Those of an empty lane are all the same, so that no ray hits it.
    pub(super) places: [u32; 3],
    /// The numbers of the corners in the mesh.
    vertices: [u32; CORNERS],
    /// The numbers of the triangles in the mesh.
    pub(super) faces: [u32; LANES],
    /// The number of corners.
    pub(super) count: u8,
    /// The number of triangles.
    pub(super) triangles: u8,
    /// 1 if the next patch belongs to the same leaf, else 0.
    has_more: u8,
    /// To the end of a line of the cache.
    rest: u8,
}

impl Patch {
    /// Returns true if the next patch belongs to the same leaf.
    #[inline(always)]
    pub(super) const fn has_more(&self) -> bool {
        self.has_more != 0
    }

    /// Returns the places of a triangle's corners.
    #[inline(always)]
    pub(super) fn places_of(&self, triangle: usize) -> [usize; 3] {
        let [a, b, c] = self.places;
        let place = |all: u32| (all >> (BITS * triangle)) as usize % PLACES;
        [place(a), place(b), place(c)]
    }

    /// Returns the corners of a triangle.
    #[inline]
    pub(super) fn corners_of(&self, triangle: usize) -> [DVec3; 3] {
        let axes = self.corners.each_ref();
        let places = self.places_of(triangle);
        places.map(|place| DVec3::from(axes.map(|axis| axis[place])))
    }

    /// Adds a triangle if there is room for it and its corners; returns true if so.
    fn add(&mut self, mesh: &Mesh, face: u32) -> bool {
        let lane = usize::from(self.triangles);
        if lane == LANES {
            return false;
        }
        let Some(vertices) = mesh.triangles().get(face as usize) else {
            return true;
        };
        let (before, mut places) = (self.count, self.places);
        for (places, vertex) in places.iter_mut().zip(vertices) {
            let known = &self.vertices[..usize::from(self.count)];
            let place = known.iter().position(|known| known == vertex);
            let place = place.unwrap_or(known.len());
            if place == CORNERS {
                self.count = before;
                return false;
            }
            self.vertices[place] = *vertex;
            self.count = self.count.max(place as u8 + 1);
            *places |= (place as u32) << (BITS * lane);
        }
        self.places = places;
        self.faces[lane] = face;
        self.triangles += 1;
        true
    }

    /// Copies the corners.
    fn fill(&mut self, mesh: &Mesh) {
        for (place, vertex) in self.vertices.iter().enumerate().take(self.count.into()) {
            let corner = mesh.vertices().get(*vertex as usize).copied();
            let corner = corner.unwrap_or_default().to_array();
            for (axis, x) in self.corners.iter_mut().zip(corner) {
                axis[place] = x;
            }
        }
    }
}

/// Returns the first eight numbers and the last four.
#[inline(always)]
pub(super) fn halves(numbers: &[f64; CORNERS]) -> (&[f64; LANES], &[f64; LANES / 2]) {
    let first = numbers.first_chunk().unwrap_or(&[0.0; LANES]);
    (first, numbers.last_chunk().unwrap_or(&[0.0; LANES / 2]))
}

/// Returns the patches of the leaf that begins with one of them.
#[inline(always)]
pub(super) fn patches_of(all: &[Patch], leaf: usize) -> impl Iterator<Item = &Patch> {
    let mut next = all.get(leaf..);
    std::iter::from_fn(move || {
        let (patch, rest) = next?.split_first()?;
        next = patch.has_more().then_some(rest);
        Some(patch)
    })
}

/// The patches of a mesh, before their corners are copied: while the tree is built, there is no memory
/// to spare.
pub(super) struct Lists<'a> {
    mesh: &'a Mesh,
    lists: Vec<List>,
}

/// The triangles of a patch.
struct List {
    faces: [u32; LANES],
    triangles: u8,
    has_more: bool,
}

/// Number of patches that a thread fills at once.
const TOGETHER: usize = 1 << 10;

impl<'a> Lists<'a> {
    pub(super) const fn of(mesh: &'a Mesh) -> Self {
        let lists = Vec::new();
        Self { mesh, lists }
    }

    /// Fills the patches.
    pub(super) fn patches(&self, pool: &Pool) -> Pages<Patch> {
        let mut patches = Pages::<Patch>::zeroed(self.lists.len());
        let portions = patches
            .as_mut()
            .chunks_mut(TOGETHER)
            .zip(self.lists.chunks(TOGETHER));
        pool.map(portions, |(patches, lists)| {
            for (patch, list) in patches.iter_mut().zip(lists) {
                for face in list.faces.iter().take(list.triangles.into()) {
                    patch.add(self.mesh, *face);
                }
                patch.fill(self.mesh);
                patch.has_more = list.has_more.into();
            }
        });
        patches
    }

    fn push(&mut self, patch: &Patch, has_more: bool) {
        let Patch {
            faces, triangles, ..
        } = *patch;
        self.lists.push(List {
            faces,
            triangles,
            has_more,
        });
    }
}

impl Leaves for Lists<'_> {
    fn none(&self) -> Self {
        Self::of(self.mesh)
    }

    fn add(&mut self, items: &[Item]) -> Link {
        let first = self.lists.len();
        let mut patch = Patch::new_zeroed();
        for item in items {
            if !patch.add(self.mesh, item.index()) {
                self.push(&patch, true);
                patch = Patch::new_zeroed();
                patch.add(self.mesh, item.index());
            }
        }
        self.push(&patch, false);
        Link::leaf(first)
    }

    fn len(&self) -> usize {
        self.lists.len()
    }

    fn append(&mut self, other: Self) {
        self.lists.extend(other.lists);
    }
}
