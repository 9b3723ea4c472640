//! The leaves of the tree: a few triangles with copies of their corners, so that a ray waits for memory
//! only once.

use std::mem;

use glam::DVec3;
use zerocopy::{FromBytes, FromZeros, Immutable, IntoBytes, KnownLayout};

use crate::{
    accel::{
        bvh::{build::Leaves, node::Link, split::Item},
        pages::Pages,
    },
    parallel::Pool,
    simd::{F64x8, LANES, Mask, Simd},
    tracer::shape::mesh::Mesh,
};

/// The largest number of corners in a patch: eight triangles side by side have nine or ten, and more
/// would take one more line of the cache.
pub(super) const CORNERS: usize = 11;

/// Number of bits of a corner's place.
const BITS: usize = 4;

/// The number of places that these bits have.
pub(super) const PLACES: usize = 1 << BITS;

/// Up to eight triangles and the vertices that are their corners.
#[derive(Clone, Debug, FromBytes, Immutable, IntoBytes, KnownLayout)]
#[repr(C, align(64))]
pub(super) struct Patch {
    /// x of the corners, then y, then z, and one more number, for [`Patch::halves`].
    corners: [f64; 3 * CORNERS + 1],
    /// The first, second and third corners of the triangles: their places in the patch, four bits for
    /// each triangle. Those of an empty lane are all the same, so that no ray hits it.
    pub(super) places: [u32; 3],
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
    /// Creates the patch of some triangles, whose corners have room in one.
    fn new(mesh: &Mesh, list: &List) -> Self {
        let mut patch = Self::new_zeroed();
        let mut corners = Corners::default();
        for lane in 0..list.triangles {
            let face = list.faces[usize::from(lane)];
            let places = corners.add(triangle(mesh, face)).unwrap_or_default();
            for (of_all, place) in patch.places.iter_mut().zip(places) {
                *of_all |= place << (BITS * usize::from(lane));
            }
        }
        for (place, vertex) in corners.vertices[..corners.count].iter().enumerate() {
            let corner = mesh.vertices().get(*vertex as usize).copied();
            for (axis, x) in corner
                .unwrap_or_default()
                .to_array()
                .into_iter()
                .enumerate()
            {
                patch.corners[axis * CORNERS + place] = x;
            }
        }
        Self {
            faces: list.faces,
            count: corners.count as u8,
            triangles: list.triangles,
            has_more: list.has_more.into(),
            ..patch
        }
    }

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

    /// Returns the coordinates of a corner.
    #[inline(always)]
    pub(super) fn corner(&self, place: usize) -> [f64; 3] {
        [
            self.corners[place],
            self.corners[CORNERS + place],
            self.corners[2 * CORNERS + place],
        ]
    }

    /// Returns the corners of a triangle.
    // One by one: in a kernel, a map over an array may be a call.
    #[inline(always)]
    pub(super) fn corners_of(&self, triangle: usize) -> [DVec3; 3] {
        let [a, b, c] = self.places_of(triangle);
        [
            self.corner(a).into(),
            self.corner(b).into(),
            self.corner(c).into(),
        ]
    }

    /// Returns the triangles whose boxes meet another one, given its corners.
    #[inline(always)]
    pub(super) fn near<S: Simd>(&self, simd: S, [from, to]: [[S::F64; 3]; 2]) -> u8 {
        let mut near = ((1_u16 << self.triangles) - 1) as u8;
        for axis in 0..3 {
            let (first, rest) = self.halves(axis);
            let all = [simd.load(first), simd.load_twice(rest)];
            let [a, b, c] = self.places;
            let (a, b, c) = (simd.pick(all, a), simd.pick(all, b), simd.pick(all, c));
            near &= a.min(b).min(c).le(to[axis]).bits();
            near &= from[axis].le(a.max(b).max(c)).bits();
        }
        near
    }

    /// Returns the coordinates of all corners along an axis: the first eight, and four of which the last
    /// is none.
    #[inline(always)]
    pub(super) fn halves(&self, axis: usize) -> (&[f64; LANES], &[f64; LANES / 2]) {
        let (first, rest) = self.corners[CORNERS * axis..][..LANES + LANES / 2].split_at(LANES);
        let first = first.first_chunk().unwrap_or(&[0.0; LANES]);
        (first, rest.first_chunk().unwrap_or(&[0.0; LANES / 2]))
    }
}

/// The vertices that are the corners of a patch.
#[derive(Default)]
struct Corners {
    vertices: [u32; CORNERS],
    count: usize,
}

impl Corners {
    /// Adds those of a triangle and returns their places; `None` if there is no room for them.
    fn add(&mut self, triangle: [u32; 3]) -> Option<[u32; 3]> {
        let before = self.count;
        let mut places = [0; 3];
        for (to, vertex) in places.iter_mut().zip(triangle) {
            let known = &self.vertices[..self.count];
            let place = known.iter().position(|known| *known == vertex);
            let place = place.unwrap_or(self.count);
            if place == CORNERS {
                self.count = before;
                return None;
            }
            self.vertices[place] = vertex;
            self.count = self.count.max(place + 1);
            *to = place as u32;
        }
        Some(places)
    }
}

/// Returns the corners of a triangle of a mesh.
fn triangle(mesh: &Mesh, face: u32) -> [u32; 3] {
    let corners = mesh.triangles().get(face as usize);
    corners.copied().unwrap_or_default()
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
#[derive(Default)]
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
                *patch = Patch::new(self.mesh, list);
            }
        });
        patches
    }
}

impl Leaves for Lists<'_> {
    fn none(&self) -> Self {
        Self::of(self.mesh)
    }

    fn add(&mut self, items: &[Item]) -> Link {
        let first = self.lists.len();
        let (mut list, mut corners) = (List::default(), Corners::default());
        for item in items {
            let (face, triangle) = (item.index(), triangle(self.mesh, item.index()));
            if corners.add(triangle).is_none() {
                list.has_more = true;
                self.lists.push(mem::take(&mut list));
                corners = Corners::default();
                corners.add(triangle);
            }
            list.faces[usize::from(list.triangles)] = face;
            list.triangles += 1;
        }
        self.lists.push(list);
        Link::leaf(first)
    }

    fn len(&self) -> usize {
        self.lists.len()
    }

    fn append(&mut self, other: Self) {
        self.lists.extend(other.lists);
    }
}
