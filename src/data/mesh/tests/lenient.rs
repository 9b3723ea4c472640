//! Mesh files as programs and people write them, beyond the letter of their formats.

use std::fmt::Write as _;

use glam::DVec3;

use crate::{
    data::{
        fault::ReadError,
        mesh::{
            Format, MeshFile, Request,
            tests::{ENCODINGS, Shape, faults, read, try_read},
        },
    },
    parallel::Cancel,
    tracer::random::Rng,
};

/// Returns the sum of the areas of the triangles.
fn area(mesh: &MeshFile) -> f64 {
    let at = |index: u32| mesh.vertices[index as usize];
    let areas = mesh.triangles.iter().map(|triangle| {
        let [a, b, c] = triangle.map(at);
        (b - a).cross(c - a).length() / 2.0
    });
    areas.sum()
}

/// Reads a file without errors, and returns its warnings as well.
fn warned(bytes: &[u8], format: Format) -> (MeshFile, Vec<String>) {
    let mesh = try_read(bytes, format, None).unwrap();
    assert!(!mesh.has_errors(), "{:?}", mesh.notes);
    (mesh, faults(bytes, format))
}

#[test]
fn concave_faces_are_not_fans() {
    let concave = "v 0 0 0\nv 4 0 0\nv 4 4 0\nv 2 1 0\nv 0 4 0\nf 1 2 3 4 5\n";
    let mesh = read(concave.as_bytes(), Format::Obj);
    assert_eq!((area(&mesh), mesh.triangles.len()), (10.0, 3));
    // Faces may come before their vertices.
    let (vertices, face) = concave.split_at(concave.find('f').unwrap());
    let early = read(format!("{face}{vertices}").as_bytes(), Format::Obj);
    assert_eq!(early.triangles, mesh.triangles);
    let l = "v 1 2 0\nv 0 2 0\nv 0 0 0\nv 2 0 0\nv 2 1 0\nv 1 1 0\n";
    for face in ["f 1 2 3 4 5 6\n", "f 2 3 4 5 6 1\n", "f 5 4 3 2 1 6\n"] {
        let mesh = read(
            format!("o a\n{l}{face}o b\nf 1 2 3\n").as_bytes(),
            Format::Obj,
        );
        assert_eq!((area(&mesh), mesh.triangles.len()), (3.0 + 1.0, 5));
        assert_eq!(mesh.groups[1].first, 4);
    }
}

#[test]
fn faces_that_leave_their_surface_open_are_told() {
    let vertices = "v 0 0 0\nv 1 0 0\nv 1 1 0.5\nv 0 1 0\nv 2 2 0\nv 2 0 0\nv 0 1 0\n";
    let (mesh, warnings) = warned(
        format!("{vertices}f 1 2 3\nf 1 2 3 4\nf 2 3 4 1\nf 1 5 6 7\n").as_bytes(),
        Format::Obj,
    );
    assert_eq!(
        warnings,
        [
            "line 9: the corners of a face are not in a plane",
            "line 10: the corners of a face are not in a plane",
            "line 11: the edges of a face cross; it is a fan around its first corner",
        ]
    );
    assert_eq!(mesh.triangles[1..3], [[0, 1, 2], [0, 2, 3]]);
    assert_eq!(mesh.triangles[5..7], [[0, 4, 5], [0, 5, 6]]);
    // A face that would take too long.
    let mut text = String::new();
    for at in 0..100_000 {
        let (x, y) = (f64::from(at), f64::from(at % 2));
        writeln!(text, "v {x} {y} 0").unwrap();
    }
    text += "v 100000 -1 0\nv 0 -1 0\nf";
    (1..=100_002).for_each(|corner| write!(text, " {corner}").unwrap());
    let (mesh, warnings) = warned(text.as_bytes(), Format::Obj);
    assert_eq!(mesh.triangles.len(), 100_000);
    let message = "a face has too many corners that turn inward";
    assert!(warnings[0].contains(message), "{warnings:?}");
}

#[test]
fn faces_with_few_corners_are_left_out() {
    let faces = "f 1\nf 1 2\nf\nf 1 2 3\n";
    let text = format!("v 0 0 0\nv 1 0 0\nv 0 1 0\n{faces}");
    let (mesh, warnings) = warned(text.as_bytes(), Format::Obj);
    assert_eq!(mesh.triangles, [[0, 1, 2]]);
    assert_eq!(
        warnings,
        [
            "line 4: a face with 1 corner is not used",
            "line 5: a face with 2 corners is not used",
            "line 6: a face with 0 corners is not used",
        ]
    );
}

#[test]
fn strips_are_triangles() {
    let strips = |row: &str| {
        format!(
            "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty \
             float z\nelement tristrips 1\nproperty list int int vertex_indices\nend_header\n0 0 0\n4 \
             0 0\n0 4 0\n4 4 0\n{row}\n"
        )
    };
    let mesh = read(strips("7 0 1 2 3 -1 0 2").as_bytes(), Format::Ply);
    assert_eq!(mesh.triangles, [[0, 1, 2], [2, 1, 3]]);
    assert_eq!(area(&mesh), 16.0);
    let normal = |[a, b, c]: [u32; 3]| {
        let at = |index: u32| mesh.vertices[index as usize];
        (at(b) - at(a)).cross(at(c) - at(a)).z
    };
    assert!(
        mesh.triangles
            .iter()
            .all(|triangle| normal(*triangle) > 0.0)
    );
    // A repeated vertex turns around a corner.
    let mesh = read(strips("9 0 1 2 2 3 -1 3 2 1").as_bytes(), Format::Ply);
    assert_eq!(mesh.triangles, [[0, 1, 2], [3, 2, 1]]);
    assert_eq!(
        faults(strips("4 0 1 2 4").as_bytes(), Format::Ply),
        ["tristrips 0 (line 14): vertex 4 does not exist, the file has 4, 0 to 3"]
    );
    assert_eq!(
        faults(strips("4 0 1 2 -2").as_bytes(), Format::Ply),
        ["tristrips 0 (line 14): vertex -2 does not exist, the file has 4, 0 to 3"]
    );
}

#[test]
fn strips_have_colors() {
    let file = |faces: &str, rows: &str| {
        format!(
            "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty \
             float z\n{faces}element tristrips 2\nproperty list int int vertex_indices\nproperty \
             uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n0 0 0\n4 0 0\n0 4 \
             0\n4 4 0\n{rows}4 0 1 2 3 255 0 0\n7 0 1 2 -1 1 3 2 0 0 255\n"
        )
    };
    let [red, blue] = [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0]];
    let mesh = read(file("", "").as_bytes(), Format::Ply);
    assert_eq!(mesh.of_triangles, [red, red, blue, blue]);
    // A mesh has a color for each of its triangles, or for none.
    let plain = "element face 1\nproperty list uchar int vertex_indices\n";
    let mesh = try_read(file(plain, "3 0 1 2\n").as_bytes(), Format::Ply, None).unwrap();
    assert_eq!((mesh.triangles.len(), mesh.of_triangles.len()), (5, 0));
    let colored =
        &format!("{plain}property float red\nproperty float green\nproperty float blue\n");
    let mesh = read(file(colored, "3 0 1 2 1 0 0\n").as_bytes(), Format::Ply);
    assert_eq!(mesh.of_triangles, [red, red, red, blue, blue]);
    let none = &plain.replace('1', "0");
    let mesh = read(file(none, "").as_bytes(), Format::Ply);
    assert_eq!(mesh.of_triangles, [red, red, blue, blue]);
}

#[test]
fn what_is_behind_the_end_is_not_read() {
    let shape = Shape::random(&mut Rng(8));
    for encoding in ENCODINGS {
        let bytes = [shape.ply(encoding, true, "uchar", "int"), b"1 \n".to_vec()].concat();
        let (mesh, warnings) = warned(&bytes, Format::Ply);
        assert_eq!(mesh.triangles, shape.triangles());
        assert!(warnings[0].contains("after the last row"), "{warnings:?}");
    }
    let bytes = shape.binary_stl("solid");
    let (mesh, warnings) = warned(&[&bytes[..], b"12"].concat(), Format::Stl);
    assert_eq!(mesh.triangles.len(), shape.triangles().len());
    assert_eq!(warnings, ["bytes after the last triangle are not read: 2"]);
}

#[test]
fn triangles_have_attributes() {
    let shape = Shape::random(&mut Rng(9));
    let plain = shape.binary_stl("");
    let mut long = plain[..84].to_vec();
    for (index, triangle) in plain[84..].chunks(50).enumerate() {
        let length = [0, 7, 300][index % 3];
        long.extend(&triangle[..48]);
        long.extend((length as u16).to_le_bytes());
        long.extend(vec![0xa5; length]);
    }
    let expected = read(&plain, Format::Stl);
    let mesh = read(&long, Format::Stl);
    assert_eq!(
        (mesh.triangles, mesh.vertices),
        (expected.triangles, expected.vertices)
    );
    // Colors in the place of a number are not one.
    let mut colored = plain.clone();
    for triangle in colored[84..].chunks_mut(50) {
        triangle[48..].copy_from_slice(&0xffff_u16.to_le_bytes());
    }
    read(&colored, Format::Stl);
    colored.push(b'\n');
    let (_, warnings) = warned(&colored, Format::Stl);
    assert_eq!(warnings, ["bytes after the last triangle are not read: 1"]);
}

const FACET: &str = "facet normal 0 0 1 outer loop vertex 0 0 0 vertex 1 0 0 vertex 0 1 0 endloop \
                     endfacet";

#[test]
fn words_of_a_text_count_and_not_its_lines() {
    let lines = "solid a part\n# comment\nfacet normal 0 0 1\n outer loop\n// vertex\n vertex 0 0 \
                 0\n vertex 1 0 0 # first\n VERTEX 0 1e0 0\n end loop\nendfacet\nendsolid a part\n";
    let spread = lines
        .replace("# comment", ";")
        .replace("normal 0", "normal\nnan");
    let name = |mesh: &MeshFile| mesh.groups.first().map(|group| group.name.clone());
    for (text, group) in [
        (lines.to_owned(), "a part"),
        (lines.replace('\n', "\r"), "a part"),
        (lines.replace('\n', "\r\n"), "a part"),
        (spread, "a part"),
        (format!("solid {FACET} endsolid"), ""),
        (
            format!("solid a facet b {FACET} end facet endsolid").replace("endfacet end", "end"),
            "a facet b",
        ),
        (format!("solid x\n{FACET}\nendsolidx\n"), "x"),
        (format!("solid x\n{FACET}\nend solid x\n"), "x"),
        (
            format!("solid normal facet\n{FACET}\nendsolid solid normal\n"),
            "normal facet",
        ),
        (format!("\n solid #1\n{FACET}\nendsolid #1"), "#1"),
    ] {
        let mesh = read(text.as_bytes(), Format::Stl);
        assert_eq!(mesh.triangles, [[0, 1, 2]], "{text}");
        assert_eq!(mesh.vertices, [DVec3::ZERO, DVec3::X, DVec3::Y], "{text}");
        assert_eq!(name(&mesh).as_deref(), Some(group), "{text}");
    }
    let two = format!("solid a {FACET} endsolid a solid b {FACET} {FACET} endsolid b");
    let mesh = read(two.as_bytes(), Format::Stl);
    assert_eq!((mesh.triangles.len(), mesh.groups[1].first), (3, 1));
    let colored = format!("solid x\ncolor 1 0 0\n{FACET}\nendsolid x\n")
        .replace("outer", "color 0.5 0.5 0.5 outer");
    let (mesh, warnings) = warned(colored.as_bytes(), Format::Stl);
    assert_eq!(mesh.triangles, [[0, 1, 2]]);
    assert_eq!(warnings, ["line 2: the colors of an STL file are not used"]);
    // However long its only line is.
    let all = format!("{FACET} ").repeat(20_000);
    let mesh = read(format!("solid long {all} endsolid").as_bytes(), Format::Stl);
    assert_eq!(mesh.triangles.len(), 20_000);
}

#[test]
fn numbers_that_no_face_needs_may_be_anything() {
    let mesh = read(
        b"v nan nan nan\nv 0 0 0\nv 1 0 0\nv inf 0 0\nv 0 1 0\nf 2 3 5\n",
        Format::Obj,
    );
    assert_eq!(mesh.triangles, [[1, 2, 4]]);
    let colored = "v 0 0 0 nan 0 0\nv 0 0 0 1 0 0\nv 1 0 0 1 0 0\nv 0 1 0 1 0 0\nf 2 3 4\n";
    read(colored.as_bytes(), Format::Obj);
    assert_eq!(
        faults(format!("{colored}f 1 2 3\n").as_bytes(), Format::Obj),
        ["line 1: expected a finite number, found `NaN`"]
    );
}

#[test]
fn vertices_without_a_color_are_white() {
    let text = "v 0 0 0\nv 1 0 0 1 0 0\nv 0 1 0\nf 1 2 3\n";
    let (mesh, warnings) = warned(text.as_bytes(), Format::Obj);
    assert_eq!(mesh.colors, [[1.0; 3], [1.0, 0.0, 0.0], [1.0; 3]]);
    let white = |line: usize| format!("line {line}: a vertex without a color is white");
    assert_eq!(warnings, [white(1), white(3)]);
    // Others than the first ten are counted.
    let text = "v 0 0 0\n".repeat(12) + text;
    let (_, warnings) = warned(text.as_bytes(), Format::Obj);
    let mut expected: Vec<_> = (1..=10).map(white).collect();
    expected[9] += " (5)";
    expected.push("line 16: triangle 0 has no area and is never hit".to_owned());
    assert_eq!(warnings, expected);
}

/// Returns a PLY file with a square of two faces; `of_vertex` and `of_face` are properties and values.
fn square(of_vertex: (&str, &str), of_face: (&str, &str)) -> String {
    let properties = |names: &str| {
        let names = names.split(", ").filter(|name| !name.is_empty());
        names
            .map(|name| format!("property {name}\n"))
            .collect::<String>()
    };
    let rows = ["0 0 0", "1 0 0", "1 1 0", "0 1 0"].map(|at| format!("{at} {}\n", of_vertex.1));
    format!(
        "ply\nformat ascii 1.0\nelement vertex 4\n{}{}element face 1\nproperty list uchar int \
         vertex_index\n{}end_header\n{}4 0 1 2 3 {}\n",
        properties("float x, float y, float z"),
        properties(of_vertex.0),
        properties(of_face.0),
        rows.concat(),
        of_face.1,
    )
}

#[test]
fn colors_have_many_names_and_types() {
    let float = f32::from_bits(0x00ff_8000);
    let orange = [1.0, 128.0 / 255.0, 0.0];
    for (properties, values) in [
        ("uchar red, uchar green, uchar blue", "255 128 0"),
        ("int red, int green, int blue", "255 128 0"),
        ("short red, uint green, int blue", "255 128 0"),
        ("ushort red, ushort green, ushort blue", "65535 32896 0"),
        (
            "uchar diffuse_red, uchar diffuse_green, uchar diffuse_blue",
            "255 128 0",
        ),
        // A `char` has the bits of a `uchar`.
        ("char red, char green, char blue", "-1 -128 0"),
        ("uint rgb", "16744448"),
        ("int rgba", "-32768"),
        ("float rgb", &format!("{float:e}")),
    ] {
        let mesh = read(
            square((properties, values), ("", "")).as_bytes(),
            Format::Ply,
        );
        assert_eq!(mesh.colors, [orange; 4], "{properties}");
        assert_eq!(mesh.of_triangles.len(), 0);
        // Those of a face are those of all of its triangles.
        let mesh = read(
            square(("", ""), (properties, values)).as_bytes(),
            Format::Ply,
        );
        assert_eq!(mesh.of_triangles, [orange; 2], "{properties}");
        assert_eq!(mesh.colors.len(), 0);
        // Those of vertices come first.
        let both = square(
            ("float red, float green, float blue", "0 0 1"),
            (properties, values),
        );
        let mesh = read(both.as_bytes(), Format::Ply);
        assert_eq!(
            (mesh.colors, mesh.of_triangles.len()),
            (vec![[0.0, 0.0, 1.0]; 4], 0)
        );
    }
    assert_eq!(
        faults(
            square(("int red, int green, int blue", "256 0 0"), ("", "")).as_bytes(),
            Format::Ply
        ),
        [13, 14, 15, 16].map(|line| format!(
            "vertex {} (line {line}): a color channel is clamped to 0..1, found `{}`",
            line - 13,
            256.0 / 255.0
        ))
    );
}

#[test]
fn names_may_end_with_a_backslash() {
    let square = "v 0 0 0\nv 4 0 0\nv 0 4 0\nv 4 4 0\n";
    for statement in [
        "usemtl C:\\tex\\",
        "mtllib a\\",
        "g a\\",
        "o \\\\",
        "usemtl C:\\tex\\\r",
    ] {
        let text = format!("{square}{statement}\nf 1 2 3\nf 2 4 3\n");
        let mesh = try_read(text.as_bytes(), Format::Obj, None).unwrap();
        assert_eq!(mesh.triangles, [[0, 1, 2], [1, 3, 2]], "{statement}");
        assert!(!mesh.has_errors());
    }
    let mesh = read(
        format!("{square}g a \\\n  b\nf 1 2 3\n").as_bytes(),
        Format::Obj,
    );
    assert_eq!(mesh.groups[0].name, "a b");
}

// A quadratic reader would take minutes.
#[test]
fn many_joined_lines_are_read() {
    let (blank, zeros) = ("\\\n".repeat(100_000), "0 \\\n".repeat(100_000));
    let text = format!(
        "v 0 0 0\nv 1 0 0\nv 0 1 0\n{blank}f 1 2 {blank}3\nvt {zeros}0\ng a {blank}b\n{blank}g {blank}"
    );
    let mesh = read(text.as_bytes(), Format::Obj);
    assert_eq!(mesh.triangles, [[0, 1, 2]]);
    let line = text.matches('\n').count() + 2;
    assert_eq!(
        faults(format!("{text}\nf 1 2 4\n").as_bytes(), Format::Obj),
        [format!(
            "line {line}: vertex 4 does not exist, the file has 3, 1 to 3"
        )]
    );
}

#[test]
fn lines_may_end_with_cr() {
    let mesh = read(b"v 0 0 0\rv 1 0 \\\r 0\rv 0 1 0\rf 1 2 3\r", Format::Obj);
    assert_eq!(mesh.triangles, [[0, 1, 2]]);
    assert_eq!(
        faults(b"v 0 0 0\rv 1 0 0\rv 0 1 0\rf 1 2 4\r", Format::Obj),
        ["line 4: vertex 4 does not exist, the file has 3, 1 to 3"]
    );
    let ply = "ply\rformat ascii 1.0\relement vertex 3\rproperty float x\rproperty float y\rproperty \
               float z\relement face 1\rproperty list uchar int vertex_indices\rend_header\r\
               0 0 0\r1 0 0\r\r0 1 0\r3 0 1 2\r";
    assert_eq!(read(ply.as_bytes(), Format::Ply).triangles, [[0, 1, 2]]);
    assert_eq!(
        faults(ply.replace("3 0 1 2", "3 0 1 x").as_bytes(), Format::Ply),
        ["face 0 (line 14): `x` is not a number of its type"]
    );
}

#[test]
fn triangles_that_the_header_of_stl_does_not_count_are_refused() {
    let mut stl = [0; 84 + 50];
    stl[..4].copy_from_slice(b"made");
    assert_eq!(
        faults(&stl, Format::Stl),
        [
            "as a binary STL file, its header says 0 triangles in 84 bytes, found 134 bytes; a text \
          starts with `solid`"
        ]
    );
}

#[test]
fn usual_facets_are_those_of_single_words() {
    let usual = "solid facet x\nfacet normal 0 0 nan\n outer loop\n  vertex 0 0 0\n  \
                 vertex 1 0 0\r\n  vertex 0 1e0 -0\n endloop\nendfacet\nFACET Normal -1 0 .5\nouter \
                 loop vertex 1 0 0 vertex 0 0 0\n\n\nvertex 0 0 1e999 endloop\nendfacet\n\
                 facet normal 1 1 1 outer loop vertex 0 0 0 vertex 0 1 0 vertex 0 0 1 endloop endfacet\n\
                 endsolid\n";
    for text in [
        usual.to_owned(),
        usual.replace("\r\n", "\n").replace('\n', "\r"),
    ] {
        let (mesh, faults) = (
            try_read(text.as_bytes(), Format::Stl, None).unwrap(),
            faults(text.as_bytes(), Format::Stl),
        );
        assert_eq!(mesh.triangles, [[0, 1, 2], [1, 0, 3], [0, 2, 4]]);
        assert_eq!(mesh.groups[0].name, "facet x");
        let place = "line 13, coordinate `z`";
        assert_eq!(
            faults,
            [format!("{place}: expected a finite number, found `inf`")]
        );
        // Words of two parts are not usual.
        let odd = text.replace("endloop", "end loop");
        let (other, same) = (
            try_read(odd.as_bytes(), Format::Stl, None).unwrap(),
            self::faults(odd.as_bytes(), Format::Stl),
        );
        assert_eq!(
            (other.triangles, other.vertices, same),
            (mesh.triangles, mesh.vertices, faults)
        );
    }
}

#[test]
fn plain_faces_are_fans_with_an_area() {
    // The second has a triangle without area, and the third comes before its last vertex.
    let text = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\nf 1 1 3 4\nf 1 2 3 5\nv -1 2 0\n\
                f 4 3 2 1\nf 4 4 4\n";
    let (mesh, warnings) = warned(text.as_bytes(), Format::Obj);
    assert_eq!(mesh.triangles.len(), 9);
    assert_eq!(
        warnings,
        [
            "line 6: triangle 2 has no area and is never hit",
            "line 10: triangle 8 has no area and is never hit",
        ]
    );
}

#[test]
fn triangles_without_area_have_lines() {
    let [flat, right] = ["2 0 0", "0 1 0"].map(|last| {
        format!(
            "facet normal 0 0 1\n outer loop\n vertex 0 0 0\n vertex 1 0 0\n vertex {last}\n \
             endloop\nendfacet\n"
        )
    });
    let text = format!("solid\n{flat}{}{flat}endsolid\n", right.repeat(20));
    let expected = [(2, 0), (149, 21)].map(|(line, triangle)| {
        format!("line {line}: triangle {triangle} has no area and is never hit")
    });
    // Words of two parts are not usual.
    for text in [&text, &text.replace("endloop", "end loop")] {
        assert_eq!(warned(text.as_bytes(), Format::Stl).1, expected);
    }
    let strips = "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\n\
                  property float z\nelement tristrips 1\nproperty list int int vertex_indices\n\
                  end_header\n0 0 0\n1 0 0\n2 0 0\n0 1 0\n1 1 0\n5 0 1 2 3 4\n";
    assert_eq!(
        warned(strips.as_bytes(), Format::Ply).1,
        ["line 15: triangle 0 has no area and is never hit"]
    );
    // All triangles of a file of bytes have one place.
    let mut binary = vec![0; 80];
    binary.extend(3_u32.to_le_bytes());
    binary.resize(84 + 3 * 50, 0);
    assert_eq!(
        warned(&binary, Format::Stl).1,
        ["triangle 0 has no area and is never hit (3)"]
    );
}

#[test]
fn cancelled_cuts_end() {
    let cancel = Cancel::new();
    cancel.cancel();
    let request = Request {
        cancel: Some(&cancel),
        ..Request::default()
    };
    let concave = "v 0 0 0\nv 4 0 0\nv 4 4 0\nv 2 1 0\nv 0 4 0\nf 1 2 3 4 5\n";
    let (length, format) = (concave.len() as u64, Format::Obj);
    let read = MeshFile::read(concave.as_bytes(), length, format, &request);
    assert!(matches!(read, Err(ReadError::Io(_))));
}
