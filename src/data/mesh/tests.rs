//! Mesh files of every kind, whole and broken.

mod lenient;
mod uv;

use std::{
    fmt::Write as _,
    io::{self, Read},
};

use glam::DVec3;

use crate::{
    data::{
        fault::ReadError,
        mesh::{Flaw, Format, MeshFile, Request},
    },
    tracer::{
        random::{Rng, cases},
        shape::mesh::MeshGroup,
    },
};

fn try_read(bytes: &[u8], format: Format, value: Option<&str>) -> Result<MeshFile, String> {
    let request = Request {
        colors: true,
        value,
        ..Request::default()
    };
    try_request(bytes, format, &request)
}

fn try_request(bytes: &[u8], format: Format, request: &Request) -> Result<MeshFile, String> {
    let read = MeshFile::read(bytes, bytes.len() as u64, format, request);
    read.map_err(|error| match error {
        ReadError::Io(error) => panic!("{error}"),
        ReadError::Invalid(fault) => match fault.help {
            Some(help) => format!("{}; {help}", fault.message),
            None => fault.message,
        },
    })
}

/// Reads a file without faults.
fn read(bytes: &[u8], format: Format) -> MeshFile {
    let mesh = try_read(bytes, format, None).unwrap();
    assert_eq!(mesh.notes, []);
    mesh
}

/// Returns the faults of a file, each with the number of its places if there are several.
fn faults(bytes: &[u8], format: Format) -> Vec<String> {
    match try_read(bytes, format, None) {
        Err(message) => vec![message],
        Ok(mesh) => {
            let notes = mesh.notes.iter().map(|note| match note.count {
                1 => note.fault.message.clone(),
                count => format!("{} ({count})", note.fault.message),
            });
            notes.collect()
        }
    }
}

/// A mesh to be written.
#[derive(Clone, Debug, Default)]
struct Shape {
    vertices: Vec<DVec3>,
    colors: Vec<[u8; 3]>,
    faces: Vec<Vec<u32>>,
}

impl Shape {
    /// Creates a random mesh of flat and convex faces; an f32 holds its coordinates.
    fn random(rng: &mut Rng) -> Self {
        let count = 3 + rng.below(40);
        let factor = rng.vector() * 100.0;
        let vertices = (0..count).map(|index| {
            // A parabola in a plane.
            let x = index as f64;
            let (y, z) = (factor.x * x * x, factor.y * x * x + factor.z * x);
            DVec3::new(x, f64::from(y as f32), f64::from(z as f32))
        });
        let vertices: Vec<_> = vertices.collect();
        let faces = (0..1 + rng.below(60)).map(|_| {
            let first = rng.below(count);
            let corners = 3 + rng.below((count - 2).min(5));
            let corners = (0..corners).map(|corner| ((first + corner) % count) as u32);
            corners.collect()
        });
        let faces = faces.collect();
        let colors = vertices.iter().map(|_| [rng.next() as u8, 0, 255]);
        let colors = colors.collect();
        Self {
            vertices,
            colors,
            faces,
        }
    }

    fn triangles(&self) -> Vec<[u32; 3]> {
        let fan = |face: &Vec<u32>| {
            let ends = 2..face.len();
            let fan = ends.map(|end| [face[0], face[end - 1], face[end]]);
            fan.collect::<Vec<_>>()
        };
        self.faces.iter().flat_map(fan).collect()
    }

    /// The colors as they are read.
    fn channels(&self) -> Vec<[f64; 3]> {
        let color = |color: &[u8; 3]| color.map(|byte| f64::from(byte) / 255.0);
        self.colors.iter().map(color).collect()
    }

    /// Writes a PLY file. With `is_crowded`, there is much that is not read: elements before and
    /// after, and properties around the needed ones, lists among them.
    fn ply(&self, encoding: Encoding, is_crowded: bool, length: &str, item: &str) -> Vec<u8> {
        let (vertices, faces) = (self.vertices.len(), self.faces.len());
        let crowd = |text: &'static str| if is_crowded { text } else { "" };
        let header = format!(
            "comment a mesh\n{}element vertex {vertices}\n{}property float x\nproperty double y\n\
             {}property float z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\n\
             element face {faces}\n{}property list {length} {item} vertex_indices\n{}",
            crowd("element range 3\nproperty list ushort short cells\nelement none 7\n"),
            crowd("property char flag\n"),
            crowd("property list uint double weights\n"),
            crowd("property int material\n"),
            crowd("property list uchar float texcoord\nelement edge 2\nproperty int a\n"),
        );
        let mut file = Values::new(encoding, &header);
        if is_crowded {
            for count in [0, 70, 1] {
                let values = vec![-1.0; count];
                file.put("ushort", count as f64).list("short", &values);
                file.end();
            }
        }
        for (at, color) in self.vertices.iter().zip(&self.colors) {
            if is_crowded {
                file.put("char", -7.0);
            }
            file.put("float", at.x).put("double", at.y);
            if is_crowded {
                file.put("uint", 2.0).list("double", &[0.5, f64::NAN]);
            }
            file.put("float", at.z);
            file.list("uchar", &color.map(f64::from));
            file.end();
        }
        for face in &self.faces {
            if is_crowded {
                file.put("int", 5.0);
            }
            let corners: Vec<_> = face.iter().map(|corner| f64::from(*corner)).collect();
            file.put(length, corners.len() as f64).list(item, &corners);
            if is_crowded {
                file.put("uchar", 3.0).list("float", &[0.25, 0.5, 0.75]);
            }
            file.end();
        }
        if is_crowded {
            file.put("int", 1.0).end();
            file.put("int", 2.0).end();
        }
        file.bytes
    }

    /// Writes a PLY file with colors of faces and none of vertices.
    fn faces_with_colors(&self) -> Vec<u8> {
        let (vertices, faces) = (self.vertices.len(), self.faces.len());
        let header = format!(
            "element vertex {vertices}\nproperty float x\nproperty float y\nproperty float z\n\
             element face {faces}\nproperty uint rgb\nproperty list uchar int vertex_indices\n"
        );
        let mut file = Values::new(Encoding::Little, &header);
        for at in &self.vertices {
            file.list("float", &at.to_array()).end();
        }
        for face in &self.faces {
            let corners: Vec<_> = face.iter().map(|corner| f64::from(*corner)).collect();
            file.put("uint", 1234.0).put("uchar", corners.len() as f64);
            file.list("int", &corners).end();
        }
        file.bytes
    }

    fn obj(&self, has_colors: bool, rng: &mut Rng) -> Vec<u8> {
        let mut text = "# made by a test \\\ng\n\n".to_owned();
        for (at, color) in self.vertices.iter().zip(self.channels()) {
            let DVec3 { x, y, z } = at;
            let [r, g, b] = color;
            text += &match has_colors {
                true => format!("v {x} {y} \\\n  {z} {r} {g} {b}\n"),
                false => format!("v  {x:e}\t{y} {z} 1.0\r\n"),
            };
        }
        text += "vt 0 0\nvn 0 0 1\ns off\n";
        for face in &self.faces {
            text += "f";
            for corner in face {
                let corner = i64::from(*corner);
                let corner = match rng.below(2) {
                    0 => corner + 1,
                    _ => corner - self.vertices.len() as i64,
                };
                let end = rng.one(&["", "/1", "//1", "/1/1"]);
                write!(text, " {corner}{end}").unwrap();
            }
            text += "\n";
        }
        text.into_bytes()
    }

    fn corners(&self) -> Vec<[DVec3; 3]> {
        let at = |index: u32| self.vertices[index as usize];
        let triangles = self.triangles().into_iter();
        triangles.map(|triangle| triangle.map(at)).collect()
    }

    fn text_stl(&self) -> Vec<u8> {
        let mut text = "solid made by a test\n".to_owned();
        for corners in self.corners() {
            text += "  facet normal 0 0 0\n    outer loop\n";
            for DVec3 { x, y, z } in corners {
                writeln!(text, "      vertex {x} {y:e} {z}").unwrap();
            }
            text += "    endloop\n  ENDFACET\n";
        }
        text += "endsolid made by a test\n";
        text.into_bytes()
    }

    fn binary_stl(&self, comment: &str) -> Vec<u8> {
        let mut bytes = comment.as_bytes().to_vec();
        bytes.resize(80, b' ');
        let corners = self.corners();
        bytes.extend((corners.len() as u32).to_le_bytes());
        for corners in corners {
            bytes.extend([0; 12]);
            for number in corners.iter().flat_map(DVec3::to_array) {
                bytes.extend((number as f32).to_le_bytes());
            }
            bytes.extend([1, 2]);
        }
        bytes
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Encoding {
    Ascii,
    Little,
    Big,
}

const ENCODINGS: [Encoding; 3] = [Encoding::Ascii, Encoding::Little, Encoding::Big];

/// The values of a PLY file.
struct Values {
    encoding: Encoding,
    bytes: Vec<u8>,
}

impl Values {
    fn new(encoding: Encoding, header: &str) -> Self {
        let name = match encoding {
            Encoding::Ascii => "ascii",
            Encoding::Little => "binary_little_endian",
            Encoding::Big => "binary_big_endian",
        };
        let text = format!("ply\nformat {name} 1.0\n{header}end_header\n");
        Self {
            encoding,
            bytes: text.into_bytes(),
        }
    }

    fn put(&mut self, kind: &str, number: f64) -> &mut Self {
        macro_rules! put {
            ($type:ty) => {
                match self.encoding {
                    Encoding::Ascii => self.bytes.extend(format!("{} ", number as $type).bytes()),
                    Encoding::Little => self.bytes.extend((number as $type).to_le_bytes()),
                    Encoding::Big => self.bytes.extend((number as $type).to_be_bytes()),
                }
            };
        }
        match kind {
            "char" => put!(i8),
            "uchar" => put!(u8),
            "short" => put!(i16),
            "ushort" => put!(u16),
            "int" => put!(i32),
            "uint" => put!(u32),
            "float" => put!(f32),
            "double" => put!(f64),
            _ => panic!("{kind}"),
        }
        self
    }

    fn list(&mut self, kind: &str, numbers: &[f64]) -> &mut Self {
        for number in numbers {
            self.put(kind, *number);
        }
        self
    }

    fn end(&mut self) {
        if self.encoding == Encoding::Ascii {
            self.bytes.push(b'\n');
        }
    }
}

const INTEGERS: [&str; 6] = ["char", "uchar", "short", "ushort", "int", "uint"];

#[test]
fn a_mesh_that_was_written_is_read() {
    let mut rng = Rng(0x3e54_f11e_0000_0001);
    for _ in 0..cases(200) {
        let shape = Shape::random(&mut rng);
        for encoding in ENCODINGS {
            let (length, item) = (rng.one(&INTEGERS), rng.one(&INTEGERS));
            let is_crowded = rng.below(2) == 0;
            let mesh = read(&shape.ply(encoding, is_crowded, length, item), Format::Ply);
            assert_eq!(mesh.vertices, shape.vertices, "{encoding:?}");
            assert_eq!(mesh.triangles, shape.triangles(), "{encoding:?}");
            assert_eq!(mesh.colors, shape.channels(), "{encoding:?}");
        }
        for has_colors in [false, true] {
            let mesh = read(&shape.obj(has_colors, &mut rng), Format::Obj);
            assert_eq!(mesh.vertices, shape.vertices);
            assert_eq!(mesh.triangles, shape.triangles());
            let colors = if has_colors { shape.channels() } else { vec![] };
            assert_eq!(mesh.colors, colors);
        }
        for bytes in [
            shape.text_stl(),
            shape.binary_stl("binary"),
            shape.binary_stl("solid, but binary"),
        ] {
            let mesh = read(&bytes, Format::Stl);
            let at = |index: u32| mesh.vertices[index as usize];
            let corners = mesh.triangles.iter().map(|triangle| triangle.map(at));
            assert_eq!(corners.collect::<Vec<_>>(), shape.corners());
            let mut used: Vec<_> = shape.faces.concat();
            used.sort_unstable();
            used.dedup();
            assert_eq!(mesh.vertices.len(), used.len(), "equal vertices are joined");
        }
    }
}

/// A file of text: a square and a triangle in two groups.
const SQUARE: &str = "\
mtllib colors.mtl
o house
v 0 0 0
v 1 0 0
v 1 1 0
v 0 1 0
g wall left
usemtl brick
f 1 2 3 4
g roof
v 0.5 2 0
l 1 2
f -1 -3 -2
f 4/1 3/1 5/1 # a comment
";

#[test]
fn names_and_what_is_not_read_are_told() {
    let mesh = try_read(SQUARE.as_bytes(), Format::Obj, Some("y")).unwrap();
    let group = |name: &str, first| MeshGroup {
        name: name.to_owned(),
        first,
    };
    assert_eq!(mesh.groups, [group("wall left", 0), group("roof", 2)]);
    let triangles = [[0, 1, 2], [0, 2, 3], [4, 2, 3], [3, 2, 4]];
    assert_eq!(mesh.triangles, triangles);
    assert_eq!(mesh.values, [0.0, 0.0, 1.0, 1.0, 2.0]);
    assert_eq!(*mesh.names.all, ["x", "y", "z"]);
    assert_eq!(
        faults(SQUARE.as_bytes(), Format::Obj),
        [
            "line 1: the materials of an OBJ file are not used",
            "line 12: `l` is not used, only faces `f`",
        ]
    );
    assert!(!mesh.has_errors());
}

/// Returns a PLY file of text with x, y, z and a value, and faces.
fn ply(vertices: &[&str], faces: &[&str]) -> String {
    format!(
        "ply\nformat ascii 1.0\nelement vertex {}\nproperty float x\nproperty float y\n\
         property float z\nproperty float heat\nelement face {}\nproperty list uchar int \
         vertex_index\nend_header\n{}\n{}\n",
        vertices.len(),
        faces.len(),
        vertices.join("\n"),
        faces.join("\n"),
    )
}

const CORNERS: [&str; 4] = ["0 0 0 5", "1 0 0 6.5", "0 1 0 nan", "0 0 1 -0.1"];

#[test]
fn a_property_is_read_as_values() {
    let text = ply(&CORNERS, &["3 0 1 2"]);
    let mesh = try_read(text.as_bytes(), Format::Ply, Some("heat")).unwrap();
    let values = [5.0, 6.5, f64::NAN, f64::from(-0.1_f32)];
    assert_eq!(format!("{:?}", mesh.values), format!("{values:?}"));
    assert_eq!(*mesh.names.all, ["x", "y", "z", "heat"]);
    let none = try_read(text.as_bytes(), Format::Ply, Some("mass")).unwrap();
    assert_eq!((none.values.len(), none.notes), (0, vec![]));
}

#[test]
fn faults_have_a_place() {
    let wrong =
        |vertices: &[&str], faces: &[&str]| faults(ply(vertices, faces).as_bytes(), Format::Ply);
    assert_eq!(
        wrong(&["0 0 nan 1", "inf 0 0 1", "0 0 0 1"], &["3 0 1 2"]),
        [
            "vertex 0 (line 11), coordinate `z`: expected a finite number, found `NaN`",
            "vertex 1 (line 12), coordinate `x`: expected a finite number, found `inf`",
        ]
    );
    assert_eq!(
        wrong(&CORNERS, &["3 0 1 2", "4 0 1 2 4", "3 -1 0 1"]),
        [
            "face 1 (line 16): vertex 4 does not exist, the file has 4, 0 to 3",
            "face 2 (line 17): vertex -1 does not exist, the file has 4, 0 to 3",
        ]
    );
    assert_eq!(
        wrong(&CORNERS, &["2 0 1", "3 0 1 2", "0", "1 3"]),
        [
            "face 0 (line 15): a face with 2 corners is not used",
            "face 2 (line 17): a face with 0 corners is not used",
            "face 3 (line 18): a face with 1 corner is not used",
        ]
    );
    assert_eq!(
        wrong(&CORNERS, &["3 0 1 2", "3 1 1 2", "3 0 1 2.5", "3 0 1"]),
        [
            "face 2 (line 17): `2.5` is not a number of its type",
            "face 3 (line 18): too few numbers",
        ]
    );
    assert_eq!(
        wrong(&CORNERS, &["3 0 1 2", "3 1 1 2", "4 3 3 1 2"]),
        [
            "line 16: triangle 1 has no area and is never hit",
            "line 17: triangle 2 has no area and is never hit",
        ]
    );
    assert_eq!(
        wrong(&CORNERS, &[]),
        ["the file has no faces; a cloud of points is `Spheres(file: …, radius: …)`"]
    );
    let wrong = |text: &str| faults(text.as_bytes(), Format::Obj);
    assert_eq!(
        wrong("v 0 0 0\nv 1 0 0\nf 1 2 4\nv 0 1 0\nf 0 1 2\nf -5 1 2\n"),
        [
            "line 5: vertex 0 does not exist, the first is 1",
            "line 6: vertex -5 does not exist, there are 3 before it",
            "line 3: vertex 4 does not exist, the file has 3, 1 to 3",
        ]
    );
    assert_eq!(
        wrong("v 0 0 0\nf 1 2 3\nv 1 0 0\nf 1 2 4\n"),
        [
            "line 2: vertex 3 does not exist, the file has 2, 1 to 2",
            "line 4: vertex 4 does not exist, the file has 2, 1 to 2",
        ]
    );
    assert_eq!(
        wrong("v 0 0\nv 0 0 0 0 0\nv 1 0 O\nvertex 3\nf 1 2\nf 1 x 2\n"),
        [
            "line 1: 2 numbers in a vertex",
            "line 2: 5 numbers in a vertex",
            "line 3: `O` is not a number",
            "line 4: `vertex` is not a statement of an OBJ file",
            "line 5: a face with 2 corners is not used",
            "line 6: `x` is not a corner of a face",
        ]
    );
    assert_eq!(
        wrong("v 0 0 0 1 0 0\nv 1 0 0 255 0 0\nv 0 1 0 0 -1 0\nf 1 2 3\n"),
        [
            "line 2: a color channel is clamped to 0..1, found `255`",
            "line 3: a color channel is clamped to 0..1, found `-1`",
        ]
    );
    let wrong = |text: &str| faults(text.as_bytes(), Format::Stl);
    assert_eq!(
        wrong("solid\nfacet\nouter loop\nvertex 0 0\nvertex 0 0 1 2\nvertex x 0 1\nendloop\n"),
        [
            "line 4: 2 numbers, expected 3",
            "line 5: 4 numbers, expected 3",
            "line 6: `x` is not a number",
            "the file is cut off: expected `endfacet` at its end",
        ]
    );
    assert_eq!(
        wrong("solid\nfacet\nvertex 0 0 1\nouter loop\nendloop\nendfacet\nendsolid\n"),
        [
            "line 3: expected `outer`, found `vertex`",
            "line 2: a face with 0 corners is not used",
        ]
    );
    assert_eq!(
        wrong("v 0 0 0\n"),
        ["not an STL file: shorter than the header of a binary one; a text starts with `solid`"]
    );
    for format in [Format::Ply, Format::Obj, Format::Stl] {
        assert_eq!(faults(b"", format), ["the file is empty"]);
    }
}

#[test]
fn sizes_that_the_file_does_not_have_are_not_believed() {
    let claim = |encoding: &str, vertices: &str, faces: &str, rest: &str| {
        let text = format!(
            "ply\nformat {encoding} 1.0\nelement vertex {vertices}\nproperty float x\nproperty \
             float y\nproperty float z\nelement face {faces}\nproperty list uint int vertex_index\n\
             end_header\n{rest}"
        );
        faults(text.as_bytes(), Format::Ply)
    };
    let little = "binary_little_endian";
    for count in ["9000000000", "18446744073709551615"] {
        assert_eq!(
            claim("ascii", count, "1", "0 0 0\n3 0 0 0\n"),
            [format!(
                "the file is cut off: {count} rows of `vertex` of at least 6 bytes, found 14 bytes"
            )]
        );
        assert_eq!(
            claim(little, "0", count, "1234"),
            [format!(
                "the file is cut off: {count} rows of `face` of at least 4 bytes, found 4 bytes"
            )]
        );
    }
    let cut_off = "the file is cut off, or a list has no length: 0 of 1 rows of `face`";
    assert_eq!(
        claim(little, "0", "1", "\u{7f}\u{7f}\u{7f}\u{7f}12345678"),
        [cut_off]
    );
    assert_eq!(
        claim(little, "0", "1", "\0\0\0\0more"),
        ["the file has no faces; a cloud of points is `Spheres(file: …, radius: …)`",]
    );
    let mut stl = Shape::random(&mut Rng(1)).binary_stl("");
    let (length, count) = (stl.len(), (stl.len() - 84) / 50);
    stl[80..84].copy_from_slice(&u32::MAX.to_le_bytes());
    assert_eq!(
        faults(&stl, Format::Stl),
        [format!(
            "as a binary STL file, its header says 4294967295 triangles in 214748364834 bytes, \
             found {length} bytes; a text starts with `solid`"
        )]
    );
    assert!(count > 0);
}

#[test]
fn a_part_of_a_file_is_not_a_whole_one() {
    let shape = Shape::random(&mut Rng(7));
    for encoding in ENCODINGS {
        let bytes = shape.ply(encoding, true, "uchar", "int");
        for end in 0..bytes.len() - 2 {
            let faults = faults(&bytes[..end], Format::Ply);
            assert!(!faults.is_empty(), "{encoding:?}, {end} bytes");
        }
        let longer = [&bytes, &b"1"[..]].concat();
        let faults = faults(&longer, Format::Ply);
        assert!(faults[0].contains("after the last row"), "{faults:?}");
    }
    let bytes = shape.binary_stl("");
    for end in 0..bytes.len() {
        assert!(!faults(&bytes[..end], Format::Stl).is_empty());
    }
    let bytes = shape.text_stl();
    for end in 0..bytes.len() - "endsolid made by a test\n".len() {
        assert!(!faults(&bytes[..end], Format::Stl).is_empty());
    }
}

/// A file of text with strips.
const STRIPS: &str = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float \
                      y\nproperty float z\nelement tristrips 2\nproperty list int int \
                      vertex_indices\nend_header\n0 0 0\n4 0 0\n0 4 0\n4 4 0\n7 0 1 2 3 -1 0 2\n4 \
                      3 2 1 0\n";

/// A file of text with texture coordinates.
const TEXTURED: &str = "ply\nformat ascii 1.0\nelement face 1\nproperty list int int vertex_indices\n\
                        element vertex 4\nproperty float x\nproperty float s\nproperty float y\n\
                        property float z\nproperty float t\nend_header\n4 0 1 2 3\n0 0 0 0 0\n4 1 0 \
                        0 0\n1 1 1 0 1\n0 0 4 0 1\n";

/// The same, a pair for each corner, before and after the faces.
const CORNERS_WITH_UV: &str = "v 0 0 0\nv 4 0 0\nv 1 1 0\nv 0 4 0\nvt 0 0\nf 2/1 1/2 4/1 3/-1\nvt 1 1 \
                               1\nf 1/1 2/2 3/2 4/1\nf 1/1 2/1 3\n";

/// Faces that are not convex, before and after their vertices.
const CONCAVE: &str = "f 1 2 3 4 5\nv 0 0 0\nv 4 0 0 1 0 0\nv 4 4 0\nv 2 1 0\nv 0 4 0\nf 2 3 4 5 1\nf \
                       4 3 2 1 5\nf 1 3 2 4 5\n";

#[test]
fn any_bytes_are_read_or_refused() {
    let mut rng = Rng(0x3e54_f11e_0000_0002);
    let shape = Shape::random(&mut rng);
    let files = [
        (
            shape.ply(Encoding::Ascii, true, "uchar", "int"),
            Format::Ply,
        ),
        (
            shape.ply(Encoding::Little, true, "char", "uint"),
            Format::Ply,
        ),
        (
            shape.ply(Encoding::Big, false, "uint", "uchar"),
            Format::Ply,
        ),
        (shape.obj(true, &mut rng), Format::Obj),
        (SQUARE.as_bytes().to_vec(), Format::Obj),
        (shape.text_stl(), Format::Stl),
        (shape.binary_stl("solid"), Format::Stl),
        (shape.faces_with_colors(), Format::Ply),
        (STRIPS.as_bytes().to_vec(), Format::Ply),
        (TEXTURED.as_bytes().to_vec(), Format::Ply),
        (CORNERS_WITH_UV.as_bytes().to_vec(), Format::Obj),
        (CONCAVE.as_bytes().to_vec(), Format::Obj),
    ];
    let pieces = [
        "ply",
        "\n",
        "\r\n",
        "\\\n",
        "element face 9999999999\n",
        "element vertex 0\n",
        "list",
        "uint",
        "f 1 -1 2\n",
        "v 1e999 2 3\n",
        "g\n",
        "-2147483649",
        "/",
        "endloop\n",
        "solid\n",
        "\u{ff}",
        "nan",
        "3 ",
    ];
    let (mut whole, count) = (0, cases(20_000));
    for round in 0..count {
        let (bytes, format) = &files[round % files.len()];
        let mut bytes = bytes.clone();
        for _ in 0..=rng.below(3) {
            let near = rng.one(&[bytes.len(), 200]);
            let at = rng.below(near + 1).min(bytes.len());
            let end = (at + rng.below(9)).min(bytes.len());
            match rng.below(5) {
                0 => drop(bytes.drain(at..end)),
                1 => bytes.insert(at, rng.next() as u8),
                2 if at < bytes.len() => bytes[at] = rng.next() as u8,
                3 if rng.below(4) == 0 => bytes.truncate(at),
                _ => drop(bytes.splice(at..end, rng.one(&pieces).bytes())),
            }
        }
        let request = Request {
            colors: true,
            value: rng.one(&[None, Some("z")]),
            uv: rng.below(2) == 0,
            ..Request::default()
        };
        let Ok(mesh) = try_request(&bytes, *format, &request) else {
            continue;
        };
        let most = bytes.len() + 64;
        assert!(mesh.vertices.capacity() <= most && mesh.triangles.capacity() <= most);
        assert!(mesh.colors.capacity() <= most && mesh.values.capacity() <= most);
        if mesh.has_errors() {
            continue;
        }
        whole += 1;
        let count = mesh.vertices.len();
        assert!(!mesh.triangles.is_empty());
        let mut corners = mesh.triangles.iter().flatten();
        assert!(corners.all(|corner| mesh.vertices[*corner as usize].is_finite()));
        let of_triangles = mesh.of_triangles.len();
        assert!(of_triangles == 0 || of_triangles == mesh.triangles.len());
        assert!(mesh.colors.is_empty() || mesh.colors.len() == count);
        assert!(mesh.values.is_empty() || mesh.values.len() == count);
        let of_uv = mesh.uv.corners.len();
        assert!(of_uv == 0 || of_uv == mesh.triangles.len());
        assert_eq!(of_uv == 0, mesh.uv.all.is_empty());
    }
    assert!(whole > count / 50, "nearly everything is refused: {whole}");
}

#[test]
fn zeros_of_both_signs_are_one_point() {
    let text = "solid\nfacet\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\n\
                endfacet\nfacet\nouter loop\nvertex -0 0 -0.0\nvertex 0 1 0\nvertex 1 0 1\n\
                endloop\nendfacet\nendsolid\nsolid more\nendsolid\n";
    let mesh = read(text.as_bytes(), Format::Stl);
    assert_eq!(mesh.triangles, [[0, 1, 2], [0, 2, 3]]);
    assert_eq!(mesh.groups.len(), 2);
    assert_eq!(
        (mesh.groups[1].name.as_str(), mesh.groups[1].first),
        ("more", 2)
    );
}

/// A byte order mark at the start of a text.
const MARK: &[u8] = "\u{feff}".as_bytes();

#[test]
fn no_line_takes_the_size_of_the_file() {
    let longer = "longer than 1 MiB; lines end with LF, CRLF or CR";
    let blank = " ".repeat(100);
    for (start, format, expected) in [
        ("v 0 0 0\n#", Format::Obj, format!("line 2: {longer}")),
        ("v 0 0 \\\n\\\n", Format::Obj, format!("line 1: {longer}")),
        (
            &format!("solid x\n{blank}"),
            Format::Stl,
            format!("line 2: {longer}"),
        ),
        (
            "ply\nformat ascii 1.0\ncomment ",
            Format::Ply,
            "the header is longer than 1 MiB: there is no line `end_header` in it".to_owned(),
        ),
    ] {
        let length = 1 << 26;
        let mut rest = io::repeat(0).take(length - start.len() as u64);
        let file = start.as_bytes().chain(&mut rest);
        let read = MeshFile::read(file, length, format, &Request::default());
        let Err(ReadError::Invalid(fault)) = read else {
            panic!("{read:?}");
        };
        let help = fault.help.map(|help| format!("; {help}"));
        assert_eq!(fault.message + &help.unwrap_or_default(), expected);
        assert!(rest.limit() > length - (1 << 22), "{start}");
    }
    // A line of the greatest length is read.
    let comment = |length: usize| {
        let text = format!("#{}\nv 0 0 0\nf 1 1 1", "x".repeat(length - 1));
        faults(text.as_bytes(), Format::Obj)
    };
    assert_eq!(
        comment(1 << 20),
        ["line 3: triangle 0 has no area and is never hit"]
    );
    assert_eq!(comment(1 + (1 << 20)), [format!("line 1: {longer}")]);
}

#[test]
fn colors_that_are_not_wanted_are_not_read() {
    let file = |colors: &str, row: &str| {
        let corners = ["0 0 0", "1 0 0", "0 1 0"].map(|at| format!("{at} {row}\n"));
        format!(
            "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty \
             float z\n{colors}element face 1\nproperty list uchar int vertex_index\nend_header\n{}3 \
             0 1 2\n",
            corners.concat()
        )
    };
    let signed = "property char red\nproperty char green\nproperty char blue\n";
    for (colors, row, fault) in [
        (signed, "1 2 3", ""),
        (
            "property uchar red\n",
            "1",
            "of the properties `red`, `green` and `blue` only some are given; give all three, or none",
        ),
        (
            "property list uchar int red\n",
            "1 5",
            "of the properties `red`, `green` and `blue` only some are given; give all three, or none",
        ),
        // Only spheres have a radius.
        ("property list uchar int radius\n", "2 5 4", ""),
    ] {
        let text = file(colors, row);
        let request = Request::default();
        let mesh = MeshFile::read(text.as_bytes(), text.len() as u64, Format::Ply, &request);
        let mesh = mesh.unwrap();
        assert_eq!((mesh.triangles.len(), mesh.colors.len()), (1, 0));
        assert_eq!(mesh.notes, []);
        let faults = faults(text.as_bytes(), Format::Ply);
        assert_eq!(faults.first().map_or("", String::as_str), fault);
    }
    let text = file(signed, "7 8 9");
    let mesh = try_read(text.as_bytes(), Format::Ply, Some("red")).unwrap();
    assert_eq!(mesh.values, [7.0; 3]);
}

#[test]
fn comments_have_any_encoding() {
    let with = |line: &[u8]| {
        let text = ply(&CORNERS, &["3 0 1 2"]).into_bytes();
        let (format, rest) = text.split_at("ply\nformat ascii 1.0\n".len());
        [format, line, b"\n", rest].concat()
    };
    for line in [
        &b"comment cr\xe9\xe9"[..],
        b"obj_info \xff\xfe",
        b"\tcomment \xe9\r",
    ] {
        assert_eq!(read(&with(line), Format::Ply).triangles, [[0, 1, 2]]);
    }
    assert_eq!(
        faults(&with(b"property float \xe9"), Format::Ply),
        ["line 3: `property float \u{fffd}` is not UTF-8"]
    );
}

#[test]
fn a_byte_order_mark_is_skipped() {
    let shape = Shape::random(&mut Rng(3));
    let mut rng = Rng(4);
    let texts = [
        (shape.obj(true, &mut rng), Format::Obj),
        (shape.text_stl(), Format::Stl),
        (
            shape.ply(Encoding::Ascii, true, "uchar", "int"),
            Format::Ply,
        ),
        (shape.ply(Encoding::Big, true, "uchar", "int"), Format::Ply),
    ];
    for (bytes, format) in texts {
        let marked = read(&[MARK, &bytes].concat(), format);
        let plain = read(&bytes, format);
        assert_eq!(marked.vertices, plain.vertices);
        assert_eq!(marked.triangles, plain.triangles);
        // Only one, and only at the start.
        assert!(!faults(&[MARK, MARK, &bytes].concat(), format).is_empty());
    }
    for format in [Format::Ply, Format::Obj, Format::Stl] {
        assert!(!faults(MARK, format).is_empty());
    }
}

#[test]
fn only_a_backslash_at_the_end_of_a_line_continues_it() {
    let corners = "v 1 0 0\nv 0 1 0\n";
    for (lines, group) in [
        ("# C:\\models\\\nv 0 0 0\n", None),
        ("v 0 0 0 # C:\\models\\\r\n", None),
        ("v \\\n0\\\r\n0 0 # a \\\n", None),
        ("v 0 0 0\ng a\\b \\c d\\ e\\\n", Some("a\\b \\c d\\ e\\")),
        ("v 0 0 0\no #1\n", Some("#1")),
    ] {
        let mesh = read(
            format!("{lines}{corners}f 1 2 3 \\").as_bytes(),
            Format::Obj,
        );
        assert_eq!(mesh.vertices, [DVec3::ZERO, DVec3::X, DVec3::Y], "{lines}");
        assert_eq!(mesh.triangles, [[0, 1, 2]]);
        let names = mesh.groups.iter().map(|group| group.name.as_str()).next();
        assert_eq!(names, group);
    }
    assert_eq!(
        faults(b"v 0 0 \\ 0\nv 0 0 0\nf 1 1 1\n", Format::Obj),
        ["line 1: `\\` is not a number"]
    );
}

#[test]
fn extensions_select_the_format() {
    for (name, format) in [
        ("a/b.PLY", Some(Format::Ply)),
        ("b.obj", Some(Format::Obj)),
        ("c.Stl", Some(Format::Stl)),
        ("ply", None),
        ("a.csv", None),
    ] {
        assert_eq!(Format::of_name(name), format, "{name}");
    }
    assert!(Flaw::Index.is_error() && !Flaw::Degenerate.is_error());
}
