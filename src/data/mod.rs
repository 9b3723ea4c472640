//! Tables and meshes as data: the rows and faces of a file, with the place of each fault in it.
//!
//! Files are not opened here; `scene/` does.

pub(crate) mod bytes;
pub(crate) mod fault;
pub(crate) mod mesh;
pub(crate) mod npy;
pub(crate) mod ply;
pub(crate) mod table;
