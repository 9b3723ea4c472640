//! Equal points as one vertex.

use std::{collections::HashMap, io};

use glam::DVec3;

use crate::scene::{mesh_file::MeshFile, table::ReadError};

/// The vertices of a mesh by their bits.
#[derive(Default)]
pub(super) struct Joined(HashMap<[u64; 3], u32>);

impl Joined {
    /// Returns the vertex at a point; the first time, it is added.
    pub(super) fn vertex(
        &mut self,
        at: DVec3,
        mesh: &mut MeshFile,
        place: impl FnOnce() -> String,
    ) -> Result<u32, ReadError> {
        // Adding 0 turns -0 into 0, which is the same point.
        let at = at + DVec3::ZERO;
        let bits = at.to_array().map(f64::to_bits);
        if let Some(index) = self.0.get(&bits) {
            return Ok(*index);
        }
        // Fits: a mesh has fewer vertices.
        let index = mesh.vertices.len() as u32;
        mesh.add_vertex(at, place)?;
        self.0.try_reserve(1).map_err(io::Error::from)?;
        self.0.insert(bits, index);
        Ok(index)
    }
}
