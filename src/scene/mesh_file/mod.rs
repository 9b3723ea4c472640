//! Meshes: the contents of a PLY, OBJ or STL file.
//!
//! The readers are our own: those of `ply-rs-bw`, `tobj` and `stl_io` do not tell the places of most
//! faults, and they keep a copy of the file or allocate what it claims to hold. These decode a file
//! piece by piece into the vertices and triangles of the mesh, which is all that they keep. They
//! open no files; `scene/tables.rs` does.

mod join;
mod obj;
mod ply;
mod stl;
mod stream;
#[cfg(test)]
mod tests;

use std::io::{self, Read};

use glam::DVec3;

use crate::{
    scene::{
        mesh_file::stream::Stream,
        table::{Fault, Names, ReadError},
    },
    text::{nearest::quote, syntax::Decimal},
    tracer::{shape::mesh::MeshGroup, vector::is_direction},
};

/// The file format of a mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Format {
    /// The Stanford polygon format.
    Ply,
    /// Wavefront's format, without its materials.
    Obj,
    /// Triangles of stereolithography.
    Stl,
}

impl Format {
    /// Returns the format for a file extension, in either case.
    pub(crate) fn of_name(name: &str) -> Option<Self> {
        let (_, ending) = name.rsplit_once('.')?;
        match ending.to_ascii_lowercase().as_str() {
            "ply" => Some(Self::Ply),
            "obj" => Some(Self::Obj),
            "stl" => Some(Self::Stl),
            _ => None,
        }
    }
}

/// A fault of a mesh file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Flaw {
    /// A line of an unknown kind.
    Line,
    /// Too few or too many numbers.
    Length,
    /// A word that is not a number of its type.
    Number,
    NotFinite,
    /// A vertex that the file does not have.
    Index,
    /// A face with fewer than three corners.
    Corners,
    /// A vertex without a color among others with one.
    Colorless,
    /// The file is too short or too long.
    End,
    /// A color channel outside 0 to 1.
    Clamped,
    /// Materials, which are not read.
    Material,
    /// Lines, points and curves, which are not read.
    NotFace,
    /// A triangle without area.
    Degenerate,
}

impl Flaw {
    /// Returns true if the mesh must not be used.
    pub(crate) const fn is_error(self) -> bool {
        match self {
            Self::Line
            | Self::Length
            | Self::Number
            | Self::NotFinite
            | Self::Index
            | Self::Corners
            | Self::Colorless
            | Self::End => true,
            Self::Clamped | Self::Material | Self::NotFace | Self::Degenerate => false,
        }
    }
}

/// The places of a file with the same fault.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Note {
    pub(crate) flaw: Flaw,
    /// The fault at the first place.
    pub(crate) fault: Fault,
    /// The number of places.
    pub(crate) count: usize,
}

/// The maximum number of vertices and of triangles: an index has 32 bits, and one value is reserved
/// for none.
const MOST: usize = u32::MAX as usize - 1;

/// The names of the coordinates.
const COORDINATES: [&str; 3] = ["x", "y", "z"];

/// What a scene wants from a mesh file besides its triangles.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Request<'a> {
    /// True to read the colors of the vertices, unless their values determine the colors.
    pub(crate) colors: bool,
    /// The name of the property whose values determine the colors.
    pub(crate) value: Option<&'a str>,
}

/// The contents of a mesh file.
#[derive(Clone, Debug, Default)]
pub(crate) struct MeshFile {
    pub(crate) vertices: Vec<DVec3>,
    pub(crate) triangles: Vec<[u32; 3]>,
    /// The color of each vertex, 0 to 1; empty if the file has no colors.
    pub(crate) colors: Vec<[f64; 3]>,
    /// The value of each vertex that determines its color; empty if the file has no such property.
    pub(crate) values: Vec<f64>,
    /// The names of the properties of a vertex.
    pub(crate) names: Names,
    /// The named groups of an OBJ file and the solids of an STL file.
    pub(crate) groups: Vec<MeshGroup>,
    /// The faults, each once; if one of them is an error, the mesh must not be used.
    pub(crate) notes: Vec<Note>,
}

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
            Format::Stl => stl::read(file, length)?.with_coordinates(request)?,
        };
        mesh.check(format)?;
        Ok(mesh)
    }

    /// Gives the vertices of a file that has only coordinates their values.
    fn with_coordinates(mut self, request: &Request) -> io::Result<Self> {
        self.names.all = COORDINATES.map(str::to_owned).into();
        let axis = COORDINATES
            .iter()
            .position(|name| request.value == Some(name));
        if let Some(axis) = axis {
            self.values.try_reserve_exact(self.vertices.len())?;
            let coordinates = self.vertices.iter().map(|at| at.to_array()[axis]);
            self.values.extend(coordinates);
        }
        Ok(self)
    }

    /// Notes a fault. Only the first of its kind is reported, the others are counted.
    fn note(&mut self, flaw: Flaw, fault: impl FnOnce() -> Fault) {
        match self.notes.iter_mut().find(|note| note.flaw == flaw) {
            Some(note) => note.count += 1,
            None => self.notes.push(Note {
                flaw,
                fault: fault(),
                count: 1,
            }),
        }
    }

    /// Parses the numbers of a line. Returns the first of them, and how many there are.
    #[inline(always)]
    fn numbers<'t, const N: usize>(
        &mut self,
        line: u64,
        words: impl Iterator<Item = &'t [u8]>,
    ) -> ([f64; N], usize) {
        let (mut numbers, mut count) = ([0.0; N], 0);
        for word in words {
            if let Some(slot) = numbers.get_mut(count) {
                *slot = number(word).unwrap_or_else(|| {
                    self.note(Flaw::Number, || {
                        let word = quote(&String::from_utf8_lossy(word));
                        Fault::new(format!("line {line}: {word} is not a number"))
                    });
                    0.0
                });
            }
            count += 1;
        }
        (numbers, count)
    }

    /// Adds a vertex; `place` formats the start of a message about it.
    #[inline(always)]
    fn add_vertex(&mut self, at: DVec3, place: impl FnOnce() -> String) -> Result<(), ReadError> {
        if !at.is_finite() {
            self.note(Flaw::NotFinite, || not_finite(at, &place()));
        }
        push(&mut self.vertices, at, "vertices")
    }

    /// Adds the color of a vertex.
    #[inline(always)]
    fn add_color(
        &mut self,
        color: [f64; 3],
        place: impl FnOnce() -> String,
    ) -> Result<(), ReadError> {
        if let Some(channel) = color.iter().find(|channel| !(0.0..=1.0).contains(*channel)) {
            let (flaw, what) = if channel.is_finite() {
                (Flaw::Clamped, "a color channel is clamped to 0..1")
            } else {
                (Flaw::NotFinite, "expected a finite number")
            };
            self.note(flaw, || {
                Fault::new(format!("{}: {what}, found `{channel}`", place()))
            });
        }
        push(&mut self.colors, color, "colors")
    }

    /// Adds the triangles of a face: a fan around its first corner.
    #[inline(always)]
    fn add_face(
        &mut self,
        corners: &[u32],
        place: impl FnOnce() -> String,
    ) -> Result<(), ReadError> {
        let [first, rest @ ..] = corners else {
            self.few_corners(corners, place);
            return Ok(());
        };
        if rest.len() < 2 {
            self.few_corners(corners, place);
        }
        for edge in rest.windows(2) {
            if let [second, third] = edge {
                push(&mut self.triangles, [*first, *second, *third], "triangles")?;
            }
        }
        Ok(())
    }

    #[cold]
    fn few_corners(&mut self, corners: &[u32], place: impl FnOnce() -> String) {
        self.note(Flaw::Corners, || {
            let (place, count) = (place(), corners.len());
            Fault::new(format!("{place}: {count} corners, expected at least 3"))
        });
    }

    /// Returns true if the mesh must not be used.
    pub(crate) fn has_errors(&self) -> bool {
        let mut notes = self.notes.iter();
        notes.any(|note| note.flaw.is_error())
    }

    /// Looks for triangles, and for those without area.
    fn check(&mut self, format: Format) -> Result<(), Fault> {
        if self.has_errors() {
            return Ok(());
        }
        if self.triangles.is_empty() {
            let fault = Fault::new("the file has no faces");
            return Err(match format {
                Format::Ply => fault.help("a cloud of points is `Spheres(file: …, radius: …)`"),
                Format::Obj | Format::Stl => fault,
            });
        }
        let corner = |index: u32| self.vertices.get(index as usize).copied();
        let is_degenerate = |[a, b, c]: &[u32; 3]| {
            let (Some(a), Some(b), Some(c)) = (corner(*a), corner(*b), corner(*c)) else {
                return true;
            };
            !is_direction((b - a).cross(c - a))
        };
        let mut degenerate = self.triangles.iter().enumerate();
        let mut degenerate = degenerate.by_ref().filter(|(_, each)| is_degenerate(each));
        let Some((first, _)) = degenerate.next() else {
            return Ok(());
        };
        let count = 1 + degenerate.count();
        let fault = Fault::new(format!("triangle {first} has no area and is never hit"));
        self.notes.push(Note {
            flaw: Flaw::Degenerate,
            fault,
            count,
        });
        Ok(())
    }
}

/// Adds an item: more than an index can tell are a fault, more than the memory holds an error.
#[inline(always)]
fn push<T>(all: &mut Vec<T>, item: T, what: &str) -> Result<(), ReadError> {
    if all.len() == all.capacity() {
        grow(all, what)?;
    }
    all.push(item);
    Ok(())
}

#[cold]
fn grow<T>(all: &mut Vec<T>, what: &str) -> Result<(), ReadError> {
    let left = MOST - all.len().min(MOST);
    if left == 0 {
        return Err(Fault::new(format!("more than {MOST} {what}")).into());
    }
    let size = all.len().max(64).min(left);
    all.try_reserve_exact(size).map_err(io::Error::from)?;
    Ok(())
}

/// Reserves space for items that the length of the file allows.
fn reserve<T>(all: &mut Vec<T>, count: usize) -> io::Result<()> {
    Ok(all.try_reserve_exact(count.min(MOST))?)
}

#[cold]
fn not_finite(at: DVec3, place: &str) -> Fault {
    let coordinates = COORDINATES.into_iter().zip(at.to_array());
    let mut bad = coordinates.filter(|(_, number)| !number.is_finite());
    let (name, number) = bad.next().unwrap_or_default();
    Fault::new(format!(
        "{place}, coordinate `{name}`: expected a finite number, found `{number}`"
    ))
}

/// Parses a number of a text.
#[inline(always)]
fn number(word: &[u8]) -> Option<f64> {
    let text = str::from_utf8(word).ok()?;
    if let Some(decimal) = Decimal::scan(text, 0)
        && decimal.end == text.len()
        && let Some(number) = decimal.float(text)
    {
        return Some(number);
    }
    text.parse().ok()
}
