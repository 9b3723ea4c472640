//! The triangles of an STL file: text, or binary.
//!
//! The format is that of 3D Systems (StereoLithography Interface Specification, 1989). It gives each
//! triangle its own corners; equal ones are joined, so that a mesh is closed if its triangles are.
//! Normals are not read, because the order of the corners determines them, nor are the attributes
//! of a triangle. The number of their bytes is behind it, but most programs keep a color there.

use std::io::Read;

use glam::DVec3;

use crate::data::{
    bytes::BYTE_ORDER_MARK,
    fault::{Fault, ReadError},
    mesh::{
        Flaw, MeshFile, Request, join::Joined, place::FilePlace, push, reserve, stl_text,
        stream::Stream,
    },
};

/// The length of the comment at the start of a binary file.
const COMMENT: usize = 80;
/// The length of all before the first triangle, with the number of triangles.
const HEADER: usize = COMMENT + 4;
/// The length of a triangle: a normal, three corners and two more bytes.
const TRIANGLE: usize = 12 * 4 + 2;

pub(super) fn read(
    mut file: Stream<impl Read>,
    length: u64,
    request: &Request,
) -> Result<MeshFile, ReadError> {
    file.have(HEADER)?;
    let head = file.bytes().get(..HEADER).unwrap_or(file.bytes());
    let count = head.get(COMMENT..).and_then(|bytes| bytes.first_chunk());
    let count = count.map(|bytes| u32::from_le_bytes(*bytes));
    let expected = |count: u32| HEADER as u64 + u64::from(count) * TRIANGLE as u64;
    let mesh = MeshFile::new(request);
    match count {
        // Some programs start a binary file with `solid` as well, so its length decides first.
        Some(count) if expected(count) == length => binary(file, count as usize, mesh),
        _ if is_text(head) => stl_text::read(file, mesh),
        Some(count) if count > 0 && expected(count) < length => binary(file, count as usize, mesh),
        Some(count) => {
            let expected = expected(count);
            let fault = Fault::new(format!(
                "as a binary STL file, its header says {count} triangles in {expected} bytes, found \
                 {length} bytes"
            ));
            Err(fault.help("a text starts with `solid`").into())
        }
        None => {
            let fault = Fault::new("not an STL file: shorter than the header of a binary one");
            Err(fault.help("a text starts with `solid`").into())
        }
    }
}

fn is_text(head: &[u8]) -> bool {
    let head = head.strip_prefix(BYTE_ORDER_MARK).unwrap_or(head);
    let start = head.trim_ascii_start().first_chunk();
    let is_control = |byte: &u8| byte.is_ascii_control() && !byte.is_ascii_whitespace();
    start.is_some_and(|start: &[u8; 5]| start.eq_ignore_ascii_case(b"solid"))
        && !head.iter().any(is_control)
}

fn binary(
    mut file: Stream<impl Read>,
    count: usize,
    mut mesh: MeshFile,
) -> Result<MeshFile, ReadError> {
    reserve(&mut mesh.triangles, count)?;
    let mut joined = Joined::default();
    file.skip(HEADER, 0);
    for triangle in 0..count {
        file.have(TRIANGLE)?;
        let (floats, _) = file.bytes().as_chunks::<4>();
        let mut floats = floats.iter().map(|bytes| f32::from_le_bytes(*bytes));
        let [_, corners @ ..] = [(); 4].map(|()| {
            let [x, y, z] = [(); 3].map(|()| f64::from(floats.next().unwrap_or_default()));
            DVec3::new(x, y, z)
        });
        let place = FilePlace::byte(file.position()).row("triangle", triangle);
        let mut indices = [0; 3];
        for (index, corner) in indices.iter_mut().zip(corners) {
            *index = joined.vertex(corner, &mut mesh, place)?;
        }
        push(&mut mesh.triangles, indices, "triangles")?;
        let attributes = file
            .bytes()
            .get(TRIANGLE - 2..)
            .and_then(|rest| rest.first_chunk());
        let attributes = u64::from(attributes.map_or(0, |bytes| u16::from_le_bytes(*bytes)));
        file.skip(TRIANGLE, 0);
        // The file is as long as its triangles unless they have attributes.
        let others = (count - triangle - 1) as u64 * TRIANGLE as u64;
        if attributes > 0 && file.remaining() >= others + attributes {
            file.have(attributes as usize)?;
            file.skip(attributes as usize, 0);
        }
    }
    let behind = file.remaining();
    if behind > 0 {
        mesh.note(Flaw::Behind, || {
            Fault::new(format!(
                "bytes after the last triangle are not read: {behind}"
            ))
            .help("is the number of triangles in the header right?")
        });
    }
    Ok(mesh)
}
