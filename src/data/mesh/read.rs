//! The reader of each format.

use std::io::Read;

use crate::data::{
    fault::{Fault, ReadError},
    mesh::{Format, MeshFile, Request, obj, ply, stl, stream::Stream},
};

impl MeshFile {
    /// Reads a mesh file of `length` bytes.
    pub(crate) fn read(
        reader: impl Read,
        length: u64,
        format: Format,
        request: &Request,
    ) -> Result<Self, ReadError> {
        if length == 0 {
            return Err(Fault::new("the file is empty").into());
        }
        let file = Stream::new(reader, length);
        let mut mesh = match format {
            Format::Ply => ply::read(file, request)?,
            Format::Obj => obj::read(file, request)?.with_coordinates(request)?,
            Format::Stl => stl::read(file, length, request)?.with_coordinates(request)?,
        };
        mesh.check(format)?;
        mesh.share_corners()?;
        Ok(mesh)
    }
}
