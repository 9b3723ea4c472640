//! The triangles of an STL file: text, or binary.
//!
//! The format is that of 3D Systems (StereoLithography Interface Specification, 1989). It gives each
//! triangle its own corners; equal ones are joined, so that a mesh is closed if its triangles are.
//! Normals are not read, because the order of the corners determines them, nor are the two bytes
//! after each triangle, where some programs keep colors.

use std::io::Read;

use glam::DVec3;

use crate::{
    scene::{
        mesh_file::{Flaw, MeshFile, join::Joined, push, reserve, stream::Stream},
        table::{Fault, ReadError, bytes::BYTE_ORDER_MARK},
    },
    text::nearest::{list, quote},
    tracer::shape::mesh::MeshGroup,
};

/// The length of the comment at the start of a binary file.
const COMMENT: usize = 80;
/// The length of all before the first triangle, with the number of triangles.
const HEADER: usize = COMMENT + 4;
/// The length of a triangle: a normal, three corners and two more bytes.
const TRIANGLE: usize = 12 * 4 + 2;

pub(super) fn read(mut file: Stream<impl Read>, length: u64) -> Result<MeshFile, ReadError> {
    file.have(HEADER)?;
    let head = file.bytes().get(..HEADER).unwrap_or(file.bytes());
    let count = head.get(COMMENT..).and_then(|bytes| bytes.first_chunk());
    let count = count.map(|bytes| u32::from_le_bytes(*bytes));
    let expected = |count: u32| HEADER as u64 + u64::from(count) * TRIANGLE as u64;
    match count {
        // Some programs start a binary file with `solid` as well, so its length decides first.
        Some(count) if expected(count) == length => binary(file, count as usize),
        _ if is_text(head) => text(file),
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

fn binary(mut file: Stream<impl Read>, count: usize) -> Result<MeshFile, ReadError> {
    let mut mesh = MeshFile::default();
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
        let place = || format!("triangle {triangle} (byte {})", file.position());
        let mut indices = [0; 3];
        for (index, corner) in indices.iter_mut().zip(corners) {
            *index = joined.vertex(corner, &mut mesh, place)?;
        }
        push(&mut mesh.triangles, indices, "triangles")?;
        file.skip(TRIANGLE, 0);
    }
    Ok(mesh)
}

/// A place between the lines of a text.
#[derive(Clone, Copy, PartialEq)]
enum State {
    Outside,
    Solid,
    Facet,
    Loop,
    LoopEnd,
}

/// The first words of lines, each with the state before and after.
const KEYWORDS: [(&str, State, State); 7] = [
    ("solid", State::Outside, State::Solid),
    ("facet", State::Solid, State::Facet),
    ("outer", State::Facet, State::Loop),
    ("vertex", State::Loop, State::Loop),
    ("endloop", State::Loop, State::LoopEnd),
    ("endfacet", State::LoopEnd, State::Solid),
    ("endsolid", State::Solid, State::Outside),
];

/// Returns the keywords that may follow in a state.
fn expected(state: State) -> String {
    let after = KEYWORDS.iter().filter(|(_, from, _)| *from == state);
    let names: Vec<_> = after.map(|(name, ..)| *name).collect();
    list(&names)
}

fn text(mut file: Stream<impl Read>) -> Result<MeshFile, ReadError> {
    file.skip_mark()?;
    let mut mesh = MeshFile::default();
    let mut joined = Joined::default();
    let mut corners: Vec<u32> = Vec::new();
    let mut state = State::Outside;
    while let Some((line, text)) = file.line(None)? {
        let place = || format!("line {line}");
        let mut words = text
            .split(u8::is_ascii_whitespace)
            .filter(|word| !word.is_empty());
        let word = words.next().unwrap_or_default();
        let mut keywords = KEYWORDS.iter();
        let keyword = keywords
            .find(|(name, from, _)| *from == state && word.eq_ignore_ascii_case(name.as_bytes()));
        let Some((keyword, _, to)) = keyword else {
            mesh.note(Flaw::Line, || {
                let (place, word) = (place(), quote(&String::from_utf8_lossy(word)));
                Fault::new(format!(
                    "{place}: expected {}, found {word}",
                    expected(state)
                ))
            });
            continue;
        };
        state = *to;
        match *keyword {
            "solid" => {
                let words: Vec<_> = words.map(String::from_utf8_lossy).collect();
                mesh.groups.push(MeshGroup {
                    name: words.join(" "),
                    first: mesh.triangles.len(),
                });
            }
            "outer" => corners.clear(),
            "vertex" => {
                let (numbers, count) = mesh.numbers(line, words);
                if count != numbers.len() {
                    mesh.note(Flaw::Length, || {
                        Fault::new(format!("{}: {count} numbers, expected 3", place()))
                    });
                }
                let corner = joined.vertex(DVec3::from_array(numbers), &mut mesh, place)?;
                push(&mut corners, corner, "corners")?;
            }
            "endloop" => match corners.as_slice() {
                [a, b, c] => push(&mut mesh.triangles, [*a, *b, *c], "triangles")?,
                _ => mesh.note(Flaw::Corners, || {
                    let (place, count) = (place(), corners.len());
                    Fault::new(format!("{place}: {count} corners, expected 3"))
                }),
            },
            _ => {}
        }
    }
    if state != State::Outside {
        mesh.note(Flaw::End, || {
            let expected = expected(state);
            Fault::new(format!(
                "the file is cut off: expected {expected} at its end"
            ))
        });
    }
    Ok(mesh)
}
