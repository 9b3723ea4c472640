//! `strahl fmt`, `convert`, `new`, `schema` and `explain`.

use std::{fs, path::Path};

use crate::support::{Folder, JSON, RON, run, run_with};

const UNTIDY: &str =
    "(camera:Perspective(eye:(0,0,0),gaze:(0,0,-1),fov:90,), // seen\n\n\n geometries:[],)";
const TIDY: &str = "\
(
    camera: Perspective(eye: (0, 0, 0), gaze: (0, 0, -1), fov: 90), // seen

    geometries: [],
)
";

#[test]
fn fmt_formats_files() {
    let folder = Folder::new();
    let untidy = folder.write("a.ron", UNTIDY);
    folder.write("b.ron", TIDY);
    let changed = format!("{}\n", Path::new(".").join("a.ron").display());
    let check = run(&mut folder.strahl(["fmt", "--check", "."]));
    assert_eq!(
        (check.status, check.stdout.as_slice()),
        (Some(1), changed.as_bytes())
    );
    assert_eq!(
        fs::read_to_string(&untidy).unwrap(),
        UNTIDY,
        "--check writes nothing"
    );
    assert_eq!(run(&mut folder.strahl(["fmt", "."])).quiet_success(), b"");
    assert_eq!(fs::read_to_string(&untidy).unwrap(), TIDY);
    assert_eq!(
        run(&mut folder.strahl(["fmt", "--check", "."])).quiet_success(),
        b""
    );
    assert_eq!(folder.names(), ["a.ron", "b.ron"]);
}

#[test]
fn fmt_filters_standard_input() {
    let folder = Folder::new();
    let done = run_with(&mut folder.strahl(["fmt", "-"]), UNTIDY.as_bytes());
    assert_eq!(String::from_utf8(done.quiet_success()).unwrap(), TIDY);
    let done = run_with(
        &mut folder.strahl(["fmt", "--check", "-"]),
        UNTIDY.as_bytes(),
    );
    assert_eq!(done.status, Some(1));
    let done = run_with(&mut folder.strahl(["fmt", "-"]), b"(camera: ");
    done.failure(1, &["<stdin>", "syntax"]);
    assert!(done.stdout.is_empty());
}

#[test]
fn fmt_skips_a_file_with_syntax_faults() {
    let folder = Folder::new();
    let bad = folder.write("a.ron", "(camera: 1 geometries: [])");
    let untidy = folder.write("b.ron", UNTIDY);
    run(&mut folder.strahl(["fmt", "a.ron", "b.ron"])).failure(1, &["a.ron:1:12", "syntax"]);
    assert_eq!(
        fs::read_to_string(bad).unwrap(),
        "(camera: 1 geometries: [])"
    );
    assert_eq!(fs::read_to_string(untidy).unwrap(), TIDY);
    run(&mut folder.strahl(["fmt", "missing.ron"])).one_line(2, &["missing.ron"]);
}

#[test]
fn fmt_ignores_the_meaning_of_values() {
    let folder = Folder::new();
    let path = folder.write("a.ron", TIDY.replace("fov: 90", "fov:  900"));
    run(&mut folder.strahl(["fmt", "a.ron"])).quiet_success();
    assert_eq!(
        fs::read_to_string(path).unwrap(),
        TIDY.replace("fov: 90", "fov: 900")
    );
}

#[test]
fn convert_works_both_ways() {
    let folder = Folder::with_scenes();
    run(&mut folder.strahl(["convert", "scene.json", "b.ron"])).quiet_success();
    run(&mut folder.strahl(["convert", "b.ron", "c.json"])).quiet_success();
    run(&mut folder.strahl(["fmt", "scene.json"])).quiet_success();
    let read = |name: &str| fs::read_to_string(folder.path(name)).unwrap();
    assert_eq!(read("c.json"), read("scene.json"));
    let mut command = folder.strahl(["convert", "-", "-", "--to", "json"]);
    let done = run_with(&mut command, RON.as_bytes());
    assert_eq!(
        String::from_utf8(done.quiet_success()).unwrap(),
        read("scene.json")
    );
}

#[test]
fn parts_without_a_camera_are_converted() {
    let folder = Folder::new();
    let part = "(\n    geometries: [\n        Sphere(center: (0, 0, 0), radius: 1, color: \"#ff0000\"),\n    ],\n)\n";
    folder.write("a.ron", part);
    run(&mut folder.strahl(["convert", "a.ron", "a.json"])).quiet_success();
    run(&mut folder.strahl(["convert", "a.json", "b.ron"])).quiet_success();
    assert_eq!(fs::read_to_string(folder.path("b.ron")).unwrap(), part);
    folder.write("a.ron", part.replace("center", "centre"));
    let done = run(&mut folder.strahl(["convert", "a.ron", "a.json"]));
    done.failure(1, &["unknown-field"]);
    assert!(!done.stderr.contains("camera"), "{}", done.stderr);
}

#[test]
fn convert_names_the_files_that_are_not_moved() {
    let folder = Folder::new();
    fs::create_dir(folder.path("sub")).unwrap();
    let ball = "Sphere(center: (0, 0, 0), radius: 1, color: \"#ff0000\", name: \"ball\")";
    let copies = "Instances(of: \"ball\", file: \"i.csv\")";
    folder.write(
        "a.ron",
        format!("(camera: Fit(), geometries: [{ball}, {copies}])"),
    );
    let done = run(&mut folder.strahl(["convert", "a.ron", "sub/a.json"]));
    assert_eq!(done.status, Some(0));
    let note = "note: the table `i.csv` is not moved; ";
    assert!(done.stderr.starts_with(note), "{}", done.stderr);
}

#[test]
fn convert_reports_losses() {
    let folder = Folder::new();
    folder.write("a.ron", TIDY);
    let lost = ["a.ron: 1 comment, the first in line", "--force"];
    run(&mut folder.strahl(["convert", "a.ron", "a.json"])).one_line(2, &lost);
    assert!(!folder.path("a.json").exists());
    run(&mut folder.strahl(["convert", "a.ron", "a.json", "--force"])).quiet_success();
    // Within one syntax, nothing is lost.
    run(&mut folder.strahl(["convert", "a.ron", "copy.ron"])).quiet_success();
    run(&mut folder.strahl(["convert", "a.ron", "a.ron"])).quiet_success();
    for name in ["copy.ron", "a.ron"] {
        assert_eq!(fs::read_to_string(folder.path(name)).unwrap(), TIDY);
    }
    let done = run(&mut folder.strahl(["convert", "a.ron", "b.ron", "--to", "json"]));
    done.one_line(2, &["b.ron", "--to"]);
    folder.write("b.json", JSON.replacen('{', "{\"$schema\": \"x\",", 1));
    let done = run(&mut folder.strahl(["convert", "b.json", "b.ron"]));
    assert_eq!(done.status, Some(0));
    assert!(done.stderr.contains("$schema"), "{}", done.stderr);

    run(&mut folder.strahl(["convert", "a.ron", "-"])).one_line(2, &["--to"]);
    run(&mut folder.strahl(["convert", "a.ron", "a.txt"])).one_line(2, &["a.txt", "--to"]);
    folder.write("bad.ron", "(camera: 1, geometries: [])");
    run(&mut folder.strahl(["convert", "bad.ron", "bad.json"])).failure(1, &["wrong-type"]);
    assert!(!folder.path("bad.json").exists());
}

#[test]
fn new_scenes_are_valid_and_overwrite_nothing() {
    let folder = Folder::new();
    for name in ["a.ron", "b.json"] {
        run(&mut folder.strahl(["new", name])).quiet_success();
        let done = run(&mut folder.strahl(["validate", "--deny", "warnings", name]));
        assert_eq!(
            (done.status, done.stderr.as_str()),
            (Some(0), "1 file: no problems\n")
        );
        run(&mut folder.strahl(["fmt", "--check", name])).quiet_success();
        folder.write(name, "mine");
        run(&mut folder.strahl(["new", name])).one_line(2, &[name, "already exists"]);
        assert_eq!(fs::read(folder.path(name)).unwrap(), b"mine");
    }
    run(&mut folder.strahl(["new", "c.txt"])).one_line(2, &["c.txt", ".ron"]);
    run(&mut folder.strahl(["new", "d.json"])).quiet_success();
    let scene = fs::read(folder.path("d.json")).unwrap();
    let scene: serde_json::Value = serde_json::from_slice(&scene).unwrap();
    assert_eq!(scene["$schema"], strahl::scene::SCHEMA_URL);
}

#[test]
fn the_schema_and_the_pages_are_printed() {
    let folder = Folder::new();
    let schema = run(&mut folder.strahl(["schema"])).quiet_success();
    assert_eq!(
        String::from_utf8(schema.clone()).unwrap(),
        strahl::scene::schema()
    );
    run(&mut folder.strahl(["schema", "-o", "s.json"])).quiet_success();
    assert_eq!(fs::read(folder.path("s.json")).unwrap(), schema);
    for code in strahl::diagnostic::Code::ALL {
        let page = run(&mut folder.strahl(["explain", code.name()])).quiet_success();
        assert_eq!(
            String::from_utf8(page).unwrap(),
            strahl::diagnostic::describe(*code)
        );
    }
    run(&mut folder.strahl(["explain", "radius"])).failure(2, &["radius", "out-of-range"]);
}
