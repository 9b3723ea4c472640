//! The vertices and faces of a PLY file: text, or binary in either byte order.
//!
//! The header is that of tables. Of a vertex, its place, its color, the property whose values
//! determine the colors and its texture coordinates are read; of a face, the list of its vertices, and its color if the vertices
//! have none. All else is skipped.

use std::io::Read;

use glam::DVec3;

use crate::{
    data::{
        fault::{At, Fault, LinePart, ReadError},
        mesh::{Flaw, MeshFile, Request, place::FilePlace, push, reserve, stream::Stream},
        ply::{
            header::{Element, Encoding, Header, Type, VERTEX},
            row::{PlyRow, Unlike},
            selection::{Selected, Selection},
        },
        table::layout::{COLORS, Endian, VALUE},
    },
    text::nearest::quote,
};

/// The element of the faces.
const FACE: &str = "face";
/// The element of strips of triangles.
const STRIPS: &str = "tristrips";
/// The names of the list of the vertices of a face or of strips.
const CORNERS: [&str; 2] = ["vertex_indices", "vertex_index"];

pub(super) fn read(mut file: Stream<impl Read>, request: &Request) -> Result<MeshFile, ReadError> {
    let header = loop {
        let found = Header::parse(file.bytes());
        match found {
            Ok(Some(header)) => break header,
            // The first line may not have been read.
            Err(fault) if !file.bytes().is_empty() => return Err(fault.into()),
            _ if file.more()? => {}
            _ => return Err(Header::endless().into()),
        }
    };
    file.skip(header.end, header.lines);
    let vertex = header.vertex()?;
    let selection = Selection::of_corners(vertex, request.colors, request.value)?;
    let may_have_colors = request.colors && request.value.is_none();
    let mut are_colored = may_have_colors && !selection.has()[COLORS.start];
    for element in &header.elements {
        let has_triangles = corners(element)?.is_some() && element.rows > 0;
        are_colored &= !has_triangles || Selection::of_face(element).is_some();
    }
    let mut mesh = MeshFile {
        names: selection.names.clone(),
        ..MeshFile::new(request)
    };
    let mut reader = Reader {
        encoding: header.encoding,
        selection,
        uv: Selection::of_uv(vertex).filter(|_| request.uv),
        of_face: None,
        vertices: vertex.rows,
        row: PlyRow::default(),
        indices: Vec::new(),
    };
    for element in &header.elements {
        // Either all triangles have a color or none.
        reader.of_face = Selection::of_face(element).filter(|_| are_colored);
        if !reader.element(element, &mut file, &mut mesh)? {
            return Ok(mesh);
        }
    }
    reader.end(&mut file, &mut mesh)?;
    Ok(mesh)
}

/// Returns the place of the list of vertices among the properties of an element, if it has triangles.
fn corners(element: &Element) -> Result<Option<usize>, Fault> {
    let name = element.name.as_str();
    if ![FACE, STRIPS].contains(&name) {
        return Ok(None);
    }
    let mut properties = element.properties.iter();
    let index = properties
        .position(|property| CORNERS.contains(&property.name.as_str()))
        .ok_or_else(|| {
            Fault::new(format!(
                "the element `{name}` has no property `vertex_indices`"
            ))
        })?;
    match element.properties.get(index).map(|property| property.kind) {
        Some(Type::List { item, .. }) if item.is_integer() => Ok(Some(index)),
        _ => {
            let message = "the property `vertex_indices` is not a list of integers";
            Err(Fault::new(message))
        }
    }
}

struct Reader {
    encoding: Encoding,
    selection: Selection,
    /// The texture coordinates of a vertex.
    uv: Option<[Selected; 2]>,
    /// The color of a row of the element that is read, if it has triangles.
    of_face: Option<[Selected; 3]>,
    /// The number of vertices.
    vertices: usize,
    row: PlyRow,
    /// The corners of a face.
    indices: Vec<u32>,
}

impl Reader {
    /// Reads the rows of an element; returns false if the file ends before.
    fn element(
        &mut self,
        element: &Element,
        file: &mut Stream<impl Read>,
        mesh: &mut MeshFile,
    ) -> Result<bool, ReadError> {
        // A row of an element without properties is empty.
        if element.properties.is_empty() {
            return Ok(true);
        }
        let smallest = match self.encoding {
            // A digit and a space or a line end, except for the last.
            Encoding::Ascii => 2 * element.properties.len(),
            _ => element.smallest_row(),
        };
        let left = usize::try_from(file.remaining()).unwrap_or(usize::MAX);
        let needed = element.rows.checked_mul(smallest);
        if needed.is_none_or(|needed| needed > left.saturating_add(1)) {
            let (rows, name) = (element.rows, quote(&element.name));
            mesh.note(Flaw::End, || {
                Fault::new(format!(
                    "the file is cut off: {rows} rows of {name} of at least {smallest} bytes, \
                     found {left} bytes"
                ))
            });
            return Ok(false);
        }
        let is_vertex = element.name == VERTEX;
        let is_face = element.name == FACE;
        let corners = corners(element)?;
        if corners.is_none() {
            self.of_face = None;
        }
        let wanted: Vec<bool> = (0..element.properties.len())
            .map(|index| {
                let uv = self.uv.iter().flatten();
                let mut selected = self.selection.iter().chain(uv);
                is_vertex && selected.any(|selected| selected.index == index)
                    || corners == Some(index)
                    || self
                        .of_face
                        .iter()
                        .flatten()
                        .any(|each| each.index == index)
            })
            .collect();
        if is_vertex {
            let has = self.selection.has();
            reserve(&mut mesh.vertices, element.rows)?;
            if has[COLORS.start] {
                reserve(&mut mesh.colors, element.rows)?;
            }
            if has[VALUE] {
                reserve(&mut mesh.values, element.rows)?;
            }
            if self.uv.is_some() {
                reserve(&mut mesh.uv.all, element.rows)?;
            }
        } else if is_face {
            // The row of a triangle is longer than the shortest by its corners.
            let possible = left / (smallest + 3);
            reserve(&mut mesh.triangles, element.rows.min(possible))?;
        }
        for row in 0..element.rows {
            let (place, read) = match self.encoding {
                Encoding::Ascii => {
                    let Some((line, text)) = file.line(|_, _| false)? else {
                        cut_off(element, row, mesh);
                        return Ok(false);
                    };
                    (FilePlace::line(line), self.parse(text, element, &wanted))
                }
                Encoding::Binary(endian) => {
                    let place = FilePlace::byte(file.position());
                    if !self.decode(file, element, endian, &wanted)? {
                        cut_off(element, row, mesh);
                        return Ok(false);
                    }
                    (place, Ok(()))
                }
            };
            match (read, corners) {
                (Err((flaw, what)), _) => mesh.note(flaw, || {
                    let words = match element.name.as_str() {
                        VERTEX => place.row(VERTEX, row).to_string(),
                        FACE => place.row(FACE, row).to_string(),
                        other => format!("element {}, {}", quote(other), place.row("row", row)),
                    };
                    At::new(words, place.text_line()).fault(what)
                }),
                (Ok(()), Some(corners)) if is_face => {
                    self.face(mesh, corners, place.row(FACE, row))?;
                }
                (Ok(()), Some(corners)) => self.strips(mesh, corners, place.row(STRIPS, row))?,
                (Ok(()), None) if is_vertex => self.vertex(mesh, place.row(VERTEX, row))?,
                (Ok(()), None) => {}
            }
        }
        Ok(true)
    }

    /// Parses a row of a text; returns the fault if it is not one.
    fn parse(
        &mut self,
        text: &[u8],
        element: &Element,
        wanted: &[bool],
    ) -> Result<(), (Flaw, String)> {
        let text = str::from_utf8(text);
        let text = text.map_err(|_| (Flaw::Line, "this is not text".to_owned()))?;
        self.row.parse(text, element, wanted).map_err(|unlike| {
            let flaw = match unlike {
                Unlike::Number(_) => Flaw::Number,
                Unlike::Short | Unlike::Long | Unlike::Length(_) => Flaw::Length,
            };
            (flaw, unlike.to_string())
        })
    }

    /// Decodes a row of bytes; returns false if the file ends before, or a list has no length.
    #[inline(always)]
    fn decode(
        &mut self,
        file: &mut Stream<impl Read>,
        element: &Element,
        endian: Endian,
        wanted: &[bool],
    ) -> Result<bool, ReadError> {
        loop {
            match self.row.decode(file.bytes(), element, endian, wanted)? {
                Ok(size) => {
                    file.skip(size, 0);
                    return Ok(true);
                }
                Err(needed) if needed as u64 > file.remaining() => return Ok(false),
                Err(_) if file.more()? => {}
                Err(_) => return Ok(false),
            }
        }
    }

    #[inline(always)]
    fn vertex(&self, mesh: &mut MeshFile, place: FilePlace) -> Result<(), ReadError> {
        let columns = &self.selection.columns;
        let selected = |column: usize| columns.get(column)?.as_ref();
        // Only those of a color are divided.
        let number = |column| Some(self.row.number(selected(column)?.index));
        let coordinate = |axis| number(axis).unwrap_or_default();
        let at = DVec3::new(coordinate(0), coordinate(1), coordinate(2));
        mesh.add_vertex(at, place)?;
        let first = COLORS.start;
        let channels = [first, first + 1, first + 2].map(selected);
        if let [Some(red), Some(green), Some(blue)] = channels {
            let color = [red, green, blue];
            let color = color.map(|channel| channel.number(self.row.number(channel.index)));
            mesh.add_color(color, place)?;
        }
        if let Some(value) = number(VALUE) {
            mesh.values.push(value);
        }
        if let Some(uv) = &self.uv {
            mesh.add_uv(uv.map(|each| self.row.number(each.index)), place)?;
        }
        Ok(())
    }

    #[inline(always)]
    fn face(
        &mut self,
        mesh: &mut MeshFile,
        corners: usize,
        place: FilePlace,
    ) -> Result<(), ReadError> {
        self.indices.clear();
        for number in self.row.list(corners) {
            let Some(corner) = self.corner(*number) else {
                self.no_vertex(mesh, *number, place);
                return Ok(());
            };
            self.indices.push(corner);
        }
        mesh.add_face(&self.indices, place)?;
        self.color(mesh, place)
    }

    /// Gives the triangles of a row its color.
    #[inline(always)]
    fn color(&self, mesh: &mut MeshFile, place: FilePlace) -> Result<(), ReadError> {
        if let Some(color) = &self.of_face {
            let color = color.map(|channel| channel.number(self.row.number(channel.index)));
            mesh.color_triangles(color, place)?;
        }
        Ok(())
    }

    /// Adds the triangles of strips: each vertex after the second makes one with the two before, every
    /// other one turned around. After -1, another strip starts.
    fn strips(
        &mut self,
        mesh: &mut MeshFile,
        corners: usize,
        place: FilePlace,
    ) -> Result<(), ReadError> {
        let first = mesh.triangles.len();
        for strip in self.row.list(corners).split(|number| *number == -1.0) {
            self.indices.clear();
            for number in strip {
                let Some(corner) = self.corner(*number) else {
                    self.no_vertex(mesh, *number, place);
                    return Ok(());
                };
                self.indices.push(corner);
            }
            for (index, corners) in self.indices.windows(3).enumerate() {
                let [a, b, c] = [corners[0], corners[1], corners[2]];
                let triangle = match index % 2 {
                    0 => [a, b, c],
                    _ => [b, a, c],
                };
                // Vertices are repeated to turn around a corner.
                if a != b && b != c && c != a {
                    push(&mut mesh.triangles, triangle, "triangles")?;
                }
            }
        }
        if mesh.triangles.len() > first {
            mesh.start_face(first, place)?;
        }
        self.color(mesh, place)
    }

    /// Returns the vertex with a number, if the file has it.
    #[inline(always)]
    fn corner(&self, number: f64) -> Option<u32> {
        // Also false for negative numbers.
        let is_one = (0.0..self.vertices as f64).contains(&number);
        is_one.then_some(number as u32)
    }

    #[cold]
    fn no_vertex(&self, mesh: &mut MeshFile, number: f64, place: FilePlace) {
        mesh.note(Flaw::Index, || {
            let count = self.vertices;
            let has = match count {
                0 => "the file has none".to_owned(),
                _ => format!("the file has {count}, 0 to {}", count - 1),
            };
            let at = place.at().part(LinePart::Number(number));
            at.fault(format!("vertex {number} does not exist, {has}"))
        });
    }

    /// Reports what stands after the last row.
    fn end(&self, file: &mut Stream<impl Read>, mesh: &mut MeshFile) -> Result<(), ReadError> {
        if self.encoding == Encoding::Ascii {
            if let Some((line, _)) = file.line(|_, _| false)? {
                mesh.note(Flaw::Behind, || Header::text_behind(line));
            }
        } else if file.remaining() > 0 {
            mesh.note(Flaw::Behind, || Header::bytes_behind(file.remaining()));
        }
        Ok(())
    }
}

#[cold]
fn cut_off(element: &Element, row: usize, mesh: &mut MeshFile) {
    let (name, count) = (quote(&element.name), element.rows);
    mesh.note(Flaw::End, || {
        Fault::new(format!(
            "the file is cut off, or a list has no length: {row} of {count} rows of {name}"
        ))
    });
}
