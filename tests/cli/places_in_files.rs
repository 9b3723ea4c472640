//! The places of faults in tables and meshes: their own lines, in every format.

use crate::support::{Folder, run};

/// A scene with a table, a mesh and a part that names the table as well, all with faults.
fn with_faulty_files() -> Folder {
    let folder = Folder::new();
    let scene = "(\n  camera: Fit(),\n  geometries: [\n    Spheres(file: \"a.csv\", color: \"#f00\"),\n    \
                 Spheres(file: \"a.xyz\"),\n    Mesh(file: \"m.obj\", color: \"#f00\"),\n    \
                 Part(file: \"part.ron\"),\n  ],\n)\n";
    folder.write("s.ron", scene);
    folder.write(
        "part.ron",
        "(geometries: [Spheres(file: \"a.csv\", color: \"#f00\")])",
    );
    folder.write(
        "a.csv",
        "x,y,z,radius\n0,0,0,1\n1,äbc,0,1\n2,0,0\n3,1,nan,-1\n3,1,2,-1.0\n",
    );
    folder.write("a.xyz", "2\n\nH 0 0 0\nQq 0 0 1\n");
    folder.write("m.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 7\nf 1 9 2\n");
    folder
}

#[test]
fn faults_are_reported_in_their_own_files() {
    let folder = with_faulty_files();
    let short = |scene: &str| {
        let args = ["validate", scene, "--output-format", "short"];
        let done = run(&mut folder.strahl(args));
        assert_eq!(done.status, Some(1));
        String::from_utf8(done.stdout).unwrap()
    };
    let lines = short("s.ron");
    for (place, used_by) in [
        (
            "a.csv:3:3: error[invalid-table]: row 1 (line 3), column `y`: `äbc`",
            "s.ron:4:19",
        ),
        (
            "a.csv:4:1: error[invalid-table]: row 2 (line 4): 3 columns",
            "s.ron:4:19",
        ),
        (
            "a.csv:5:5: error[invalid-table]: row 3 (line 5), column `z`",
            "s.ron:4:19",
        ),
        (
            "a.csv:5:9: error[invalid-table]: row 3 (line 5), column `radius`",
            "s.ron:4:19",
        ),
        (
            "a.csv:6:7: error[invalid-table]: row 4 (line 6), column `radius`",
            "s.ron:4:19",
        ),
        (
            "m.obj:4:7: error[invalid-mesh]: line 4: vertex 7",
            "s.ron:6:16",
        ),
        (
            "m.obj:5:5: error[invalid-mesh]: line 5: vertex 9",
            "s.ron:6:16",
        ),
        (
            "a.csv:3:3: error[invalid-table]: row 1 (line 3)",
            "part.ron:1:29",
        ),
    ] {
        let is_it = |line: &&str| {
            line.starts_with(place) && line.ends_with(&format!(" (used by {used_by})"))
        };
        assert_eq!(lines.lines().filter(is_it).count(), 1, "{place}: {lines}");
    }
    assert!(
        lines.lines().any(|line| line.starts_with("a.xyz:4:1: ")),
        "{lines}"
    );
}

#[test]
fn every_format_names_the_place_in_the_table() {
    let folder = with_faulty_files();
    for (format, words) in [
        (
            "human",
            &[
                " --> a.csv:3:3\n  |\n3 | 1,äbc,0,1\n  |   ^^^\n  |\n  = note: used by s.ron:4:19\n",
                " --> m.obj:4:7\n",
            ][..],
        ),
        (
            "json",
            &[
                "\"file\": \"a.csv\", \"line\": 3, \"column\": 3, \"end_line\": 3, \"end_column\": 6",
                "\"used_by\": {\"file\": \"s.ron\", \"line\": 4, \"column\": 19}",
            ],
        ),
        (
            "jsonl",
            &["\"file\": \"a.csv\", \"line\": 5, \"column\": 9"],
        ),
        (
            "github",
            &[
                "::error file=a.csv,line=3,endLine=3,col=3,endColumn=6,",
                "%0Anote: used by s.ron:4:19\n",
            ],
        ),
        (
            "sarif",
            &[
                "{\"uri\": \"a.csv\"}, \"region\": {\"startLine\": 3, \"startColumn\": 3,",
                "[{\"message\": {\"text\": \"used by this file\"}, \"physicalLocation\": \
               {\"artifactLocation\": {\"uri\": \"s.ron\"}, \"region\": {\"startLine\": 4, \"startColumn\": 19,",
            ],
        ),
        (
            "junit",
            &[
                "<testcase name=\"a.csv\"",
                "a.csv:3:3: error",
                "\nnote: used by s.ron:4:19<",
            ],
        ),
    ] {
        let args = ["validate", "s.ron", "--output-format", format];
        let done = run(&mut folder.strahl(args));
        let text = String::from_utf8(done.stdout).unwrap();
        for word in words {
            assert!(text.contains(word), "{format}: no {word:?} in {text}");
        }
    }
    let done = run(&mut folder.strahl(["render", "s.ron", "-o", "x.png"]));
    assert!(done.stderr.contains(" --> a.csv:3:3\n"), "{}", done.stderr);
}

#[test]
fn every_faulty_row_is_named_up_to_a_limit() {
    let folder = Folder::new();
    folder.write(
        "s.ron",
        "(camera: Fit(), geometries: [Spheres(file: \"a.csv\", color: \"#f00\")])",
    );
    for (bad, count) in [("x", 7), ("-1", 7), ("x", 150), ("nan", 150)] {
        let rows = format!("0,0,0,{bad}\n").repeat(count);
        folder.write("a.csv", format!("x,y,z,radius\n{rows}"));
        let args = ["validate", "s.ron", "--output-format", "short"];
        let done = run(&mut folder.strahl(args));
        let text = String::from_utf8(done.stdout).unwrap();
        assert_eq!(text.lines().count(), count.min(100), "{text}");
        let more = format!(", and {} more (used by", count.saturating_sub(100));
        assert_eq!(text.contains(&more), count > 100, "{text}");
        for line in 2..2 + count.min(100) {
            assert!(
                text.contains(&format!("a.csv:{line}:7: ")),
                "{line}: {text}"
            );
        }
    }
}

#[test]
fn every_fault_of_a_mesh_has_its_line() {
    let folder = Folder::new();
    let corners = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0.5\n";
    let ply = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
               element face 2\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 nan 0\n0 x 0\n\
               3 0 1 2\n3 0 1 5\n";
    let stl = "solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 y\nvertex 0 z 0\nendloop\n\
               endfacet\nendsolid\n";
    for (name, text, places) in [
        (
            "a.obj",
            &*format!("{corners}f 1 2 9\nf 1 q 2\nfoo\nv 1 x 0\n"),
            &["5:7: error", "6:5: error", "7:1: error", "8:5: error"][..],
        ),
        (
            "b.obj",
            &format!("{corners}f 1 2 4 3\nf 1 2 4 3\nf 1 2\nf 1\n"),
            &[
                "5:1: warning",
                "6:1: warning",
                "7:1: warning",
                "8:1: warning",
            ],
        ),
        ("c.ply", ply, &["12:1: error", "11:3: error", "14:7: error"]),
        ("d.stl", stl, &["5:12: error", "6:10: error"]),
    ] {
        folder.write(name, text);
        folder.write(
            "s.ron",
            format!("(camera: Fit(), geometries: [Mesh(file: {name:?}, color: \"#f00\")])"),
        );
        let args = ["validate", "s.ron", "--output-format", "short"];
        let done = run(&mut folder.strahl(args));
        let text = String::from_utf8(done.stdout).unwrap();
        for place in places {
            let start = format!("{name}:{place}[");
            let mut lines = text.lines().filter(|line| line.starts_with(&start));
            let line = lines.next().unwrap_or_else(|| panic!("{start}: {text}"));
            assert!(line.ends_with(" (used by s.ron:1:41)"), "{line}");
        }
        assert_eq!(text.lines().count(), places.len(), "{text}");
    }
}

#[test]
fn warnings_name_their_rows_as_errors_do() {
    let folder = Folder::new();
    for (name, text, rest, first, words) in [
        (
            "a.csv",
            "x,y,z,radius,r,g,b\n",
            "0,0,0,1,2,3,4\n",
            2,
            "color channel",
        ),
        ("a.xyz", "40\n\n", "Qq 0 0 1\n", 3, "not an element"),
        ("a.obj", "", "v 0 0 0 0 0 7\n", 1, "color channel"),
    ] {
        let mesh = if name == "a.obj" { "f 1 2 3\n" } else { "" };
        folder.write(name, format!("{text}{}{mesh}", rest.repeat(40)));
        let what = match name {
            "a.obj" => "Mesh",
            _ => "Spheres",
        };
        folder.write(
            "s.ron",
            format!("(camera: Fit(), geometries: [{what}(file: {name:?})])"),
        );
        let args = ["validate", "s.ron", "--output-format", "short"];
        let done = run(&mut folder.strahl(args));
        let text = String::from_utf8(done.stdout).unwrap();
        let found: Vec<_> = text.lines().filter(|line| line.contains(words)).collect();
        assert_eq!(found.len(), 10, "{text}");
        for (line, found) in (first..).zip(&found) {
            assert!(found.starts_with(&format!("{name}:{line}:")), "{text}");
        }
        assert!(found[9].contains(" more (used by "), "{text}");
    }
}
