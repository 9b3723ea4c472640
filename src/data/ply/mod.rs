//! PLY files: text, or binary in either byte order, of vertices and faces.
//!
//! The format is Greg Turk's (The PLY Polygon File Format, 1994) with the type names of later tools.
//! Tables and meshes read the same headers and rows.

pub(crate) mod header;
pub(crate) mod row;
pub(crate) mod selection;
