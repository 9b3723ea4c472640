//! Equal points as one vertex.

use std::{
    hash::{BuildHasher, RandomState},
    io,
};

use glam::DVec3;

use crate::data::{
    fault::ReadError,
    mesh::{MeshFile, place::FilePlace},
};

/// A hash table of the vertices of a mesh by their bits: 8 bytes for a vertex or a little more, a
/// fifth of what a map of copies takes.
#[derive(Default)]
pub(super) struct Joined {
    /// Vertices at the places of their hashes or behind; at most half of the places are in use.
    places: Vec<u32>,
    /// The keys differ in each run, so that no file can have many points with equal hashes.
    hasher: RandomState,
}

/// A place without a vertex.
const FREE: u32 = u32::MAX;

impl Joined {
    /// Returns the vertex at a point; the first time, it is added.
    pub(super) fn vertex(
        &mut self,
        at: DVec3,
        mesh: &mut MeshFile,
        place: FilePlace,
    ) -> Result<u32, ReadError> {
        // Adding 0 turns -0 into 0, which is the same point.
        let at = at + DVec3::ZERO;
        if self.places.len() / 2 <= mesh.vertices.len() {
            self.grow(&mesh.vertices)?;
        }
        let (found, free) = self.find(at, &mesh.vertices);
        if found != FREE {
            return Ok(found);
        }
        // Fits: a mesh has fewer vertices.
        let index = mesh.vertices.len() as u32;
        mesh.add_vertex(at, place)?;
        self.set(free, index);
        Ok(index)
    }

    /// Returns the vertex at a point, or `FREE`, and its place.
    fn find(&self, at: DVec3, vertices: &[DVec3]) -> (u32, usize) {
        let bits = bits(at);
        let is_it = |index: u32| {
            let vertex = vertices.get(index as usize);
            vertex.is_none_or(|vertex| self::bits(*vertex) == bits)
        };
        let last = self.places.len().wrapping_sub(1);
        let mut place = self.hasher.hash_one(bits) as usize & last;
        loop {
            let index = self.places.get(place).copied().unwrap_or(FREE);
            if is_it(index) {
                return (index, place);
            }
            place = (place + 1) & last;
        }
    }

    fn set(&mut self, place: usize, index: u32) {
        if let Some(free) = self.places.get_mut(place) {
            *free = index;
        }
    }

    /// Doubles the number of places, which is a power of two.
    #[cold]
    fn grow(&mut self, vertices: &[DVec3]) -> io::Result<()> {
        let count = (self.places.len() * 2).max(64);
        self.places.clear();
        self.places.try_reserve_exact(count)?;
        self.places.resize(count, FREE);
        for (index, vertex) in (0..).zip(vertices) {
            let (_, free) = self.find(*vertex, vertices);
            self.set(free, index);
        }
        Ok(())
    }
}

fn bits(at: DVec3) -> [u64; 3] {
    at.to_array().map(f64::to_bits)
}
