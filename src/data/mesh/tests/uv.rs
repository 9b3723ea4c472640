//! Texture coordinates.

use crate::{
    data::{
        fault::ReadError,
        mesh::{Format, MeshFile, Request},
    },
    tracer::shape::mesh::MeshUv,
};

fn read(text: &str, format: Format, uv: bool) -> MeshFile {
    let request = Request {
        uv,
        ..Request::default()
    };
    match MeshFile::read(text.as_bytes(), text.len() as u64, format, &request) {
        Ok(mesh) => mesh,
        Err(ReadError::Invalid(fault)) => panic!("{}", fault.message),
        Err(ReadError::Io(error)) => panic!("{error}"),
    }
}

fn faults(text: &str, format: Format) -> Vec<String> {
    let notes = read(text, format, true).notes.into_iter();
    notes
        .map(|note| match note.count {
            1 => note.fault.message,
            count => format!("{} ({count})", note.fault.message),
        })
        .collect()
}

/// Returns the coordinates of the corners of all triangles.
fn corners(mesh: &MeshFile) -> Vec<[Option<[f64; 2]>; 3]> {
    let of = |number: u32| mesh.uv.all.get(number as usize).copied();
    let triangles = mesh.uv.corners.iter();
    triangles.map(|numbers| numbers.map(of)).collect()
}

const SQUARE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

#[test]
fn a_vertex_of_an_obj_file_may_have_several() {
    let text = format!(
        "{SQUARE}vt 0 0.5\nvt 1\nf 1/1/1 2/2 3/-1\nvt 0.25 0.75 0.5\nf 1/4 3/3 4/-3/1\nvt 9 9\n"
    );
    let mesh = read(&text, Format::Obj, true);
    assert_eq!(mesh.notes, []);
    let [a, b, c, d] = [[0.0, 0.5], [1.0, 0.0], [0.25, 0.75], [9.0, 9.0]].map(Some);
    assert_eq!(corners(&mesh), [[a, b, b], [d, c, a]]);
    let unread = read(&text, Format::Obj, false);
    assert_eq!(unread.triangles, mesh.triangles);
    assert_eq!(unread.uv, MeshUv::default());
    // What is not wanted is not checked either.
    let wrong = format!("{SQUARE}vt x\nf 1/7 2/0 3/-3\n");
    assert_eq!(read(&wrong, Format::Obj, false).notes, []);
}

#[test]
fn polygons_are_cut_with_their_coordinates() {
    // Each vertex has its own place as coordinates.
    let places = ["0 0", "4 0", "4 4", "2 1", "0 4"];
    let lines = |keyword: &str, end: &str| {
        let lines = places.map(|place| format!("{keyword} {place}{end}\n"));
        lines.concat()
    };
    let (v, vt) = (lines("v", " 0"), lines("vt", ""));
    let face = "f 1/1 2/2 3/3 4/4 5/5\nf 1/1 2/2 4/4\n";
    for text in [
        format!("{v}{vt}{face}"),
        format!("{face}{v}{vt}"),
        format!("{vt}{face}{v}"),
    ] {
        let mesh = read(&text, Format::Obj, true);
        assert_eq!(mesh.triangles.len(), 4);
        for (triangle, uv) in mesh.triangles.iter().zip(corners(&mesh)) {
            let places = triangle.map(|corner| {
                let place = mesh.vertices[corner as usize];
                Some([place.x, place.y])
            });
            assert_eq!(uv, places);
        }
    }
}

#[test]
fn a_file_may_have_none_or_only_some() {
    for text in [
        format!("{SQUARE}f 1 2 3\n"),
        format!("{SQUARE}vt 0 0\nf 1// 2//1 3/\n"),
    ] {
        let mesh = read(&text, Format::Obj, true);
        assert_eq!((mesh.notes, mesh.uv), (vec![], MeshUv::default()));
    }
    let text = format!("{SQUARE}vt 0 0\nf 1/1 2/1 3/1\nf 1 2 3\nf 1/1 2 3/1\n");
    let mesh = read(&text, Format::Obj, true);
    let corner = Some([0.0; 2]);
    assert_eq!(
        corners(&mesh),
        [[corner; 3], [None; 3], [corner, None, corner]]
    );
    assert_eq!(
        faults(&text, Format::Obj),
        ["7", "8"].map(|line| format!(
            "line {line}: a face without texture coordinates shows no texture"
        ))
    );
}

#[test]
fn faults_of_texture_vertices() {
    assert_eq!(
        faults(
            &format!(
                "{SQUARE}vt 0 nan\nvt 1 2 3 4\nvt 0 y\nf 1/0 2/1 3/1\nf 1/1 2/4 3/1\nf 1/-4 2/1 3/1\nf 1/a 2 3\n"
            ),
            Format::Obj
        ),
        [
            "line 5: expected a finite number, found `NaN`",
            "line 6: 4 numbers in a texture vertex",
            "line 7: `y` is not a number",
            "line 8: texture vertex 0 does not exist, the first is 1",
            "line 10: texture vertex -4 does not exist, there are 3 before it",
            "line 11: `1/a` is not a corner of a face",
            "line 9: texture vertex 4 does not exist, the file has 3, 1 to 3",
        ]
    );
}

fn ply(names: &str, rows: [&str; 3]) -> String {
    let corners = ["0 0 0", "1 0 0", "0 1 0"].into_iter().zip(rows);
    let corners: String = corners.map(|(at, row)| format!("{at} {row}\n")).collect();
    let names: String = names
        .split_whitespace()
        .map(|name| format!("property float {name}\n"))
        .collect();
    format!(
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty \
         float z\n{names}element face 1\nproperty list uchar int vertex_index\nend_header\n\
         {corners}3 2 0 1\n"
    )
}

#[test]
fn vertices_of_a_ply_file_have_one() {
    let rows = ["0 0.25 7", "0.5 1 7", "-1 3 7"];
    for names in ["s t w", "u v w", "texture_u texture_v w"] {
        let mesh = read(&ply(names, rows), Format::Ply, true);
        assert_eq!(mesh.notes, []);
        let [a, b, c] = [[0.0, 0.25], [0.5, 1.0], [-1.0, 3.0]].map(Some);
        assert_eq!(corners(&mesh), [[c, a, b]]);
    }
    for (names, uv) in [("s t w", false), ("s v w", true)] {
        assert_eq!(
            read(&ply(names, rows), Format::Ply, uv).uv,
            MeshUv::default()
        );
    }
    assert_eq!(
        faults(&ply("s t w", ["0 inf 0", "0 0 0", "0 0 0"]), Format::Ply),
        ["vertex 0 (line 13): expected a finite number, found `inf`"]
    );
}
