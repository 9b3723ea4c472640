//! Meshes: the contents of a PLY, OBJ or STL file.
//!
//! The readers are our own: those of `ply-rs-bw`, `tobj` and `stl_io` do not tell the places of most
//! faults, and they keep a copy of the file or allocate what it claims to hold. These decode a file
//! piece by piece into the vertices and triangles of the mesh, which is all that they keep. They
//! open no files; `scene/tables.rs` does.

mod face;
mod flaw;
mod join;
mod lines;
mod obj;
mod place;
mod ply;
mod polygon;
mod read;
mod stl;
mod stl_facet;
mod stl_text;
mod stream;
#[cfg(test)]
mod tests;

use std::{io, ops::Range};

use glam::DVec3;

pub(crate) use flaw::{Flaw, Note};

use crate::{
    data::{
        fault::{At, Fault, LinePart, ReadError, most_listed},
        mesh::{face::Early, lines::Lines, place::FilePlace},
        table::Names,
    },
    parallel::Cancel,
    text::{nearest::quote, syntax::Decimal},
    tracer::{
        shape::mesh::{MeshGroup, MeshUv},
        vector::is_direction,
    },
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
    /// True to read texture coordinates.
    pub(crate) uv: bool,
    /// Ends the reading early; the file fails then as well.
    pub(crate) cancel: Option<&'a Cancel>,
}

/// The contents of a mesh file.
#[derive(Clone, Debug, Default)]
pub(crate) struct MeshFile {
    pub(crate) vertices: Vec<DVec3>,
    pub(crate) triangles: Vec<[u32; 3]>,
    /// The color of each vertex, 0 to 1; empty if the file has no colors.
    pub(crate) colors: Vec<[f64; 3]>,
    /// The color of each triangle; empty if the faces of the file have no colors, or its vertices do.
    pub(crate) of_triangles: Vec<[f64; 3]>,
    /// The value of each vertex that determines its color; empty if the file has no such property.
    pub(crate) values: Vec<f64>,
    /// The texture coordinates; empty if the file has none.
    pub(crate) uv: MeshUv,
    /// The names of the properties of a vertex.
    pub(crate) names: Names,
    /// The named groups of an OBJ file and the solids of an STL file.
    pub(crate) groups: Vec<MeshGroup>,
    /// The faults, each once; if one of them is an error, the mesh must not be used.
    pub(crate) notes: Vec<Note>,
    /// The vertices with a number that is not finite, which matter if a face has them.
    not_finite: Vec<(u32, NotFinite)>,
    /// The faces of more than three corners that come before their vertices.
    early: Vec<Early>,
    /// The triangles that have an area for certain.
    with_area: Vec<Range<usize>>,
    /// The lines of the faces, if the file is a text.
    lines: Lines,
    /// Ends the reading. What was read is of no use then.
    cancel: Option<Cancel>,
    /// The work that went into cutting polygons.
    work: u64,
    /// The corners of a face.
    corners: Vec<DVec3>,
}

/// A number of a vertex that is not finite.
#[derive(Clone, Copy, Debug)]
struct NotFinite {
    place: FilePlace,
    /// The color channel, if it is one.
    channel: Option<f64>,
}

impl MeshFile {
    fn new(request: &Request) -> Self {
        Self {
            cancel: request.cancel.cloned(),
            ..Self::default()
        }
    }

    /// Fails once cancelled.
    fn ask(&self) -> io::Result<()> {
        let cancel = self.cancel.as_ref();
        cancel.map_or(Ok(()), |cancel| cancel.check().map_err(io::Error::other))
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

    /// Notes a fault. The first of its kind are listed, as far as they have lines; the others are
    /// counted with the last of these.
    fn note(&mut self, flaw: Flaw, fault: impl FnOnce() -> Fault) {
        let last = self.notes.iter_mut().rfind(|note| note.flaw == flaw);
        let before = last.as_ref().map_or(0, |note| note.before + 1);
        let most = most_listed(flaw.is_error());
        match last.filter(|note| before >= most || note.fault.spot.is_none()) {
            Some(note) => note.count += 1,
            None => self.notes.push(Note {
                flaw,
                fault: fault(),
                before,
                count: 1,
            }),
        }
    }

    /// Notes a fault at this many places, the first of which are `listed`.
    fn note_all<T>(
        &mut self,
        flaw: Flaw,
        (listed, count): (&[T], usize),
        fault: impl Fn(&T) -> Fault,
    ) {
        for place in listed {
            self.note(flaw, || fault(place));
        }
        let last = self.notes.iter_mut().rfind(|note| note.flaw == flaw);
        if let Some(note) = last {
            note.count += count - listed.len();
        }
    }

    /// Notes a fault whose number does not matter.
    fn once(&mut self, flaw: Flaw, fault: impl FnOnce() -> Fault) {
        if self.notes.iter().all(|note| note.flaw != flaw) {
            self.note(flaw, fault);
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
                    self.not_a_number(line, word);
                    0.0
                });
            }
            count += 1;
        }
        (numbers, count)
    }

    #[cold]
    fn not_a_number(&mut self, line: u64, word: &[u8]) {
        self.note(Flaw::Number, || {
            let word = String::from_utf8_lossy(word);
            let at = At::line(line).word(&*word);
            at.fault(format!("{} is not a number", quote(&word)))
        });
    }

    /// Adds a vertex.
    #[inline(always)]
    fn add_vertex(&mut self, at: DVec3, place: FilePlace) -> Result<(), ReadError> {
        if !at.is_finite() {
            self.unsure(self.vertices.len(), place, None)?;
        }
        push(&mut self.vertices, at, "vertices")
    }

    /// Adds the color of a vertex.
    #[inline(always)]
    fn add_color(&mut self, color: [f64; 3], place: FilePlace) -> Result<(), ReadError> {
        if let Some(channel) = self.clamp(color, place) {
            self.unsure(self.colors.len(), place, Some(channel))?;
        }
        push(&mut self.colors, color, "colors")
    }

    /// Adds a pair of texture coordinates.
    #[inline(always)]
    fn add_uv(&mut self, uv: [f64; 2], place: FilePlace) -> Result<(), ReadError> {
        if let Some(number) = uv.into_iter().find(|number| !number.is_finite()) {
            self.note(Flaw::NotFinite, || infinite(number, place));
        }
        push(&mut self.uv.all, uv, "texture coordinates")
    }

    /// Gives a color to the triangles that have none yet, which are those of the last face.
    #[inline(always)]
    fn color_triangles(&mut self, color: [f64; 3], place: FilePlace) -> Result<(), ReadError> {
        if let Some(channel) = self.clamp(color, place) {
            self.note(Flaw::NotFinite, || infinite(channel, place));
        }
        while self.of_triangles.len() < self.triangles.len() {
            push(&mut self.of_triangles, color, "colors")?;
        }
        Ok(())
    }

    /// Warns about a channel that is clamped, and returns one that is not finite.
    #[inline(always)]
    fn clamp(&mut self, color: [f64; 3], place: FilePlace) -> Option<f64> {
        let mut channels = color.into_iter();
        let channel = channels.find(|channel| !(0.0..=1.0).contains(channel))?;
        if !channel.is_finite() {
            return Some(channel);
        }
        self.note(Flaw::Clamped, || {
            let what = "a color channel is clamped to 0..1";
            let at = place.at().part(LinePart::Number(channel));
            at.fault(format!("{what}, found `{channel}`"))
        });
        None
    }

    #[cold]
    fn unsure(
        &mut self,
        vertex: usize,
        place: FilePlace,
        channel: Option<f64>,
    ) -> Result<(), ReadError> {
        // Fits, or the vertex is refused.
        let item = (vertex as u32, NotFinite { place, channel });
        push(&mut self.not_finite, item, "numbers that are not finite")
    }

    /// Returns true if the mesh must not be used.
    pub(crate) fn has_errors(&self) -> bool {
        let mut notes = self.notes.iter();
        notes.any(|note| note.flaw.is_error())
    }

    /// Cuts the polygons that came before their vertices, looks for numbers that are not finite where
    /// a face has them, for triangles, and for those without area.
    fn check(&mut self, format: Format) -> Result<(), ReadError> {
        for face in std::mem::take(&mut self.early) {
            self.ask()?;
            self.cut(face);
        }
        self.check_numbers()?;
        if self.has_errors() {
            return Ok(());
        }
        if self.triangles.is_empty() {
            let fault = Fault::new("the file has no faces");
            return Err(match format {
                Format::Ply => fault.help("a cloud of points is `Spheres(file: …, radius: …)`"),
                Format::Obj | Format::Stl => fault,
            }
            .into());
        }
        let corner = |index: u32| self.vertices.get(index as usize).copied();
        let is_degenerate = |[a, b, c]: &[u32; 3]| {
            let (Some(a), Some(b), Some(c)) = (corner(*a), corner(*b), corner(*c)) else {
                return true;
            };
            !is_direction((b - a).cross(c - a))
        };
        let runs = self.with_area.iter();
        let starts = [0].into_iter().chain(runs.clone().map(|run| run.end));
        let ends = runs.map(|run| run.start).chain([self.triangles.len()]);
        let (mut listed, mut count) = (Vec::new(), 0);
        for (start, end) in starts.zip(ends) {
            let unknown = self.triangles.get(start..end).unwrap_or_default();
            for (number, triangle) in (start..).zip(unknown) {
                if number % 4096 == 0 {
                    self.ask()?;
                }
                if is_degenerate(triangle) {
                    if listed.len() < most_listed(Flaw::Degenerate.is_error()) {
                        listed.push(number);
                    }
                    count += 1;
                }
            }
        }
        let lines = std::mem::take(&mut self.lines);
        self.note_all(Flaw::Degenerate, (&listed, count), |triangle| {
            let message = format!("triangle {triangle} has no area and is never hit");
            match lines.of(*triangle) {
                Some(line) => At::line(line).fault(message),
                None => Fault::new(message),
            }
        });
        Ok(())
    }

    /// Notes the numbers that are not finite of vertices that a face has.
    fn check_numbers(&mut self) -> io::Result<()> {
        if self.not_finite.is_empty() {
            return Ok(());
        }
        let mut is_used = Vec::new();
        is_used.try_reserve_exact(self.vertices.len())?;
        is_used.resize(self.vertices.len(), false);
        for corner in self.triangles.iter().flatten() {
            if let Some(is_used) = is_used.get_mut(*corner as usize) {
                *is_used = true;
            }
        }
        for (vertex, NotFinite { place, channel }) in std::mem::take(&mut self.not_finite) {
            let vertex = vertex as usize;
            if !is_used.get(vertex).is_some_and(|is_used| *is_used) {
                continue;
            }
            let at = self.vertices.get(vertex).copied().unwrap_or_default();
            self.note(Flaw::NotFinite, || match channel {
                Some(channel) => infinite(channel, place),
                None => not_finite(at, place),
            });
        }
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
fn infinite(number: f64, place: FilePlace) -> Fault {
    let at = place.at().part(LinePart::Number(number));
    at.fault(format!("expected a finite number, found `{number}`"))
}

#[cold]
fn not_finite(at: DVec3, place: FilePlace) -> Fault {
    let coordinates = COORDINATES.into_iter().zip(at.to_array());
    let mut bad = coordinates.filter(|(_, number)| !number.is_finite());
    let (name, number) = bad.next().unwrap_or_default();
    let words = format!("{place}, coordinate `{name}`");
    let at = At::new(words, place.text_line()).part(LinePart::Number(number));
    at.fault(format!("expected a finite number, found `{number}`"))
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
