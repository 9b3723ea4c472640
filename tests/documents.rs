//! Documents as an editor uses them: edits, lookups, files in memory, cancellation.

use std::{fs, path::Path};

use strahl::{
    Document, ErrorKind, ReadOptions, Scene, Syntax,
    parallel::Cancel,
    scene::Memory,
    text::{Columns, Edit},
};

const RON: &str = r##"(
    camera: Perspective(eye: (0, 0, 0), gaze: (0, 0, -1), fov: 90),
    cameras: {"Top": Orthographic(eye: (0, 9, 0), gaze: (0, -1, 0), up: (0, 0, -1), scale: 4)},
    geometries: [
        Plane(point: (0, -1, 0), normal: (0, 1, 0), color: (0, 1, 0)), // the floor
        Sphere(center: (0, 2, -3), radius: 1, color: "#ff0000", name: "ball"),
    ],
)"##;

fn json() -> String {
    let document = Document::from_text("a.ron", RON, Syntax::Ron);
    document.convert(Syntax::Json).unwrap().text
}

#[test]
fn paths_and_ranges_lead_to_each_other() {
    for (text, syntax) in [(RON.to_owned(), Syntax::Ron), (json(), Syntax::Json)] {
        let document = Document::from_text("a", &*text, syntax);
        assert!(!document.has_errors());
        for (path, value) in [
            ("camera.fov", "90"),
            ("camera.gaze[2]", "-1"),
            ("cameras[\"Top\"].scale", "4"),
            ("geometries[0].color[1]", "1"),
            ("geometries[1].radius", "1"),
            ("geometries[1].color", "\"#ff0000\""),
        ] {
            let range = document
                .range_of(path)
                .unwrap_or_else(|| panic!("{path} in {text}"));
            assert_eq!(&text[range.clone()], value, "{path}");
            assert_eq!(document.path_at(range.start), path);
            assert_eq!(document.path_at(range.end), path);
        }
        let ball = document.range_of("geometries[\"ball\"].radius");
        assert_eq!(ball, document.range_of("geometries[1].radius"));
        assert_eq!(
            document.path_at(text.find("normal").unwrap()),
            "geometries[0].normal"
        );
        assert_eq!(
            document.path_at(text.find("Sphere").unwrap() + 1),
            "geometries[1]"
        );
        assert_eq!(document.path_at(text.len() + 9), "");
        for nothing in [
            "camera.scale",
            "geometries[2]",
            "geometries[0].point.x",
            "a b[",
            "",
        ] {
            assert_eq!(document.range_of(nothing), None, "{nothing}");
        }
    }
}

#[test]
fn an_edit_equals_reading_the_new_text() {
    let document = Document::from_text("a.ron", RON, Syntax::Ron);
    let radius = document.range_of("geometries[1].radius").unwrap();
    let wrong = document.edit(radius.clone(), "-1").unwrap();
    let anew = Document::from_text("a.ron", RON.replace("radius: 1", "radius: -1"), Syntax::Ron);
    assert_eq!(wrong.diagnostics(), anew.diagnostics());
    assert_eq!(
        wrong.diagnostics()[0].path.to_string(),
        "geometries[1].radius"
    );
    assert_eq!(wrong.text(), anew.text());
    let back = wrong.edit(radius.start..radius.start + 2, "1").unwrap();
    assert_eq!((back.text(), back.has_errors()), (RON, false));
    assert_eq!(document.text(), RON, "the old one is a value of its own");

    let text = "(é)";
    let document = Document::from_text("a.ron", text, Syntax::Ron);
    for range in [2..2, 0..9, 9..9] {
        assert_eq!(
            document.edit(range, "x").unwrap_err().kind(),
            ErrorKind::Usage
        );
    }
    assert_eq!(document.edit(0..text.len(), "").unwrap().text(), "");
}

#[test]
fn a_document_does_not_read_the_disk_again() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.ron");
    fs::write(&path, RON).unwrap();
    let document = Document::from_path(&path).unwrap();
    fs::write(&path, "another").unwrap();
    assert_eq!(document.text(), RON);
    fs::remove_file(&path).unwrap();
    assert_eq!(
        document.range_of("camera.fov").map(|range| &RON[range]),
        Some("90")
    );
    assert!(document.format().is_some());
}

/// Returns a scene long enough to be read in blocks.
fn long() -> String {
    let sphere = "        Sphere(center: (0, 0, -3), radius: 1, color: \"#ff0000\"),\n";
    RON.replace(
        "        Sphere",
        &format!("{}        Sphere", sphere.repeat(100_000)),
    )
}

#[test]
fn the_text_of_a_large_scene_is_kept_unless_turned_off() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.ron");
    let text = long().replace(
        "(\n    camera",
        "(\n    allow: [\"duplicate-geometry\"], camera",
    );
    fs::write(&path, &text).unwrap();
    let document = Document::from_path(&path).unwrap();
    assert_eq!(document.text(), text);
    let range = document.range_of("geometries[100001].name").unwrap();
    assert_eq!(&text[range], "\"ball\"");
    let options = ReadOptions::new().keep_text(false);
    let document = Document::from_path_with(&path, &options).unwrap();
    assert_eq!((document.text(), document.has_errors()), ("", false));
}

#[test]
fn reading_can_be_cancelled() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.ron");
    // Because of the comment, the slower tree reads the text.
    for text in [
        RON.to_owned(),
        long(),
        long().replace("radius: 1,", "radius: 1_0,"),
    ] {
        fs::write(&path, &text).unwrap();
        let cancel = Cancel::new();
        let options = ReadOptions::new().cancel(cancel.clone());
        let document = Document::from_path_with(&path, &options).unwrap();
        cancel.cancel();
        let error = Document::from_path_with(&path, &options).unwrap_err();
        assert_eq!(error.kind(), ErrorKind::Interrupted);
        assert_eq!(
            document.edit(0..0, " ").unwrap_err().kind(),
            ErrorKind::Interrupted
        );
        assert!(Document::from_reader("a", text.as_bytes(), &options).is_err());
    }
}

#[test]
fn files_can_be_in_memory() {
    let scene = r#"(camera: Orthographic(eye: (0, 0, 9), gaze: (0, 0, -1), scale: 4),
        geometries: [Spheres(file: "atoms.csv", radius: 0.5, color: (1, 0, 0))])"#;
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.ron");
    let read = |files: Memory| {
        let options = ReadOptions::new().files(files);
        Document::from_path_with(&path, &options)
    };
    // First neither file is on disk; then the table is, but the one in memory takes precedence.
    let files = Memory::new().with(&path, scene);
    let codes = |document: &Document| -> Vec<_> {
        let all = document.diagnostics().iter();
        all.map(|fault| fault.code.name()).collect()
    };
    assert_eq!(codes(&read(files.clone()).unwrap()), ["file-not-found"]);
    fs::write(folder.path().join("atoms.csv"), "x,y,z\n0,0,0\n").unwrap();
    assert!(codes(&read(files.clone()).unwrap()).is_empty());
    let files = files.with(folder.path().join("atoms.csv"), "x,y,z\n0,0,zero\n");
    assert_eq!(codes(&read(files.clone()).unwrap()), ["invalid-table"]);
    let files = files.with(
        folder.path().join("sub/../atoms.csv"),
        "x,y,z\n0,0,0\n1,1,1\n",
    );
    let scene = Scene::try_from(read(files).unwrap()).unwrap();
    assert_eq!(scene.world().geometries().len(), 2);
    assert_eq!(
        read(Memory::new()).unwrap_err().kind(),
        ErrorKind::Unreadable
    );

    // A table outside the folder is rejected in memory as well.
    let scene = r#"(camera: Orthographic(eye: (0, 0, 9), gaze: (0, 0, -1), scale: 4),
        geometries: [Spheres(file: "../atoms.csv", radius: 0.5, color: (1, 0, 0))])"#;
    let outside = folder.path().join("../atoms.csv");
    let files = Memory::new()
        .with(&path, scene)
        .with(outside, "x,y,z\n0,0,0\n");
    assert_eq!(codes(&read(files).unwrap()), ["outside-folder"]);
    let files = Memory::new()
        .with("/nowhere/a.ron", scene.replace("../", ""))
        .with("/nowhere/atoms.csv", "x,y,z\n0,0,0\n");
    let options = ReadOptions::new().files(files);
    let document = Document::from_path_with(Path::new("/nowhere/a.ron"), &options).unwrap();
    assert!(codes(&document).is_empty());
}

#[test]
fn a_pixel_leads_to_its_text() {
    for (text, syntax) in [(RON.to_owned(), Syntax::Ron), (json(), Syntax::Json)] {
        let scene = Scene::from_text(&*text, syntax).unwrap();
        let at = |x, y| {
            scene
                .geometry_at(x, y)
                .and_then(|index| scene.text_range(index))
        };
        let (ball, floor) = (at(320, 80).unwrap(), at(320, 400).unwrap());
        assert!(text[ball.clone()].contains("\"ball\"") && !text[ball].contains("normal"));
        assert!(text[floor].contains("normal"));
        assert_eq!(at(10, 10), None);
        assert_eq!(scene.geometry_at(640, 480), None);
    }
}

#[test]
fn a_fix_is_an_edit_at_its_range() {
    let text = "(camera: Perspective(eye: (0, 0, 0), gaze: (0, 0, -1), fov: \"🙂\", fovv: 3))";
    let document = Document::from_text("a.ron", text, Syntax::Ron);
    let fault = document
        .diagnostics()
        .iter()
        .find(|fault| fault.code.name() == "unknown-field");
    let fault = fault.unwrap();
    let place = document
        .lines()
        .position_in(fault.range.start, Columns::Utf16);
    assert_eq!((place.line, place.column), (1, 67));
    let at = text.find("fovv").unwrap();
    assert_eq!(document.lines().offset(place, Columns::Utf16), at);
    assert_eq!(fault.fix, None, "`fov` is given");

    let text = text.replace("fov: \"🙂\", ", "");
    let document = Document::from_text("a.ron", &*text, Syntax::Ron);
    let fix = document
        .diagnostics()
        .iter()
        .find_map(|fault| fault.fix.clone())
        .unwrap();
    let at = text.find("fovv").unwrap();
    let edit = Edit {
        range: at..at + 4,
        text: "fov".to_owned(),
    };
    assert_eq!((fix.edits, fix.is_safe), (vec![edit], true));
}

/// A scene with a part, which has a part and a table; all but the folder in memory.
fn scene_of_parts() -> (&'static str, Memory) {
    let main = r##"(
    camera: Perspective(eye: (0, 0, 9), gaze: (0, 0, -1), fov: 60),
    geometries: [
        Sphere(center: (0, 3, 0), radius: 0.5, color: "#fff"),
        Part(file: "tree.ron", name: "tree"),
    ],
)"##;
    let files = Memory::new()
        .with("nowhere/main.ron", main)
        .with(
            "nowhere/tree.ron",
            r##"(geometries: [Part(file: "leaf.json"), Spheres(file: "atoms.csv", radius: 1, color: "#f00")])"##,
        )
        .with(
            "nowhere/leaf.json",
            r##"{"geometries": [{"Sphere": {"center": [0, 0, 0], "radius": 1, "color": "#0f0", "name": "leaf"}}]}"##,
        )
        .with("nowhere/atoms.csv", "x,y,z\n2,0,0\n");
    (main, files)
}

#[test]
fn a_geometry_of_a_part_leads_to_the_place_of_the_part() {
    let (main, files) = scene_of_parts();
    let options = ReadOptions::new().files(files);
    let scene: Scene = Document::from_path_with("nowhere/main.ron", &options)
        .unwrap()
        .try_into()
        .unwrap();
    let leaf = scene.geometry_at(320, 240).unwrap();
    assert_eq!((leaf, scene.name(leaf)), (1, Some("tree")));
    let range = scene.text_range(leaf).unwrap();
    assert_eq!(&main[range], r#"Part(file: "tree.ron", name: "tree")"#);
    let places = scene.places_in_parts(leaf);
    let files: Vec<_> = places
        .iter()
        .map(|place| (place.file, place.name))
        .collect();
    let folder = |name| Path::new("nowhere").join(name).display().to_string();
    let expected = [
        (&*folder("tree.ron"), None),
        (&*folder("leaf.json"), Some("leaf")),
    ];
    assert_eq!(files, expected);
    assert!(scene.places_in_parts(0).is_empty());
}

#[test]
fn an_unsaved_part_is_read_from_memory() {
    let (main, files) = scene_of_parts();
    let read = |files: &Memory| {
        let options = ReadOptions::new()
            .syntax(Syntax::Ron)
            .folder("nowhere")
            .files(files.clone());
        Document::from_reader("nowhere/main.ron", main.as_bytes(), &options).unwrap()
    };
    let document = read(&files);
    assert!(!document.has_errors());
    assert_eq!(document.dependencies().len(), 3);

    let broken = files
        .clone()
        .with("nowhere/leaf.json", r#"{"geometries": [3]}"#);
    let document = read(&broken);
    let fault = &document.diagnostics()[0];
    assert_eq!(fault.message, "`tree.ron` has 1 error (geometry `tree`)");
    assert_eq!(&main[fault.range.clone()], "\"tree.ron\"");
    let of_parts: Vec<_> = document
        .parts()
        .map(|part| part.diagnostics().len())
        .collect();
    assert_eq!(of_parts, [1, 1]);
    // Also a document without its scene knows what to watch.
    assert_eq!(document.findings().dependencies().len(), 3);
    let error = Scene::try_from(document).unwrap_err();
    let text = format!("{error:?}");
    assert!(
        text.contains("leaf.json:1:17") || error.to_string().contains("tree.ron"),
        "{text}"
    );

    // The open text itself closes the ring, not its last version on the disk.
    let ring = files.with(
        "nowhere/leaf.json",
        r#"{"geometries": [{"Part": {"file": "main.ron"}}]}"#,
    );
    let document = read(&ring);
    let ring =
        "a part of itself: `main.ron` → `tree.ron` → `leaf.json` → `main.ron` (geometry `tree`)";
    assert_eq!(document.diagnostics()[0].message, ring);
}

#[test]
fn placed_parts_move_and_are_framed_in_all_frames() {
    let main = r##"(
    camera: Fit(from: (0, 0, 1), projection: Orthographic(), margin: 0),
    geometries: [
        Part(
            file: "ball.ron",
            lights: true,
            transform: (translate: (-4, 0, 0), rotate: (axis: (0, 1, 0), angle: 90), scale: 0.5),
            name: "ball",
        ),
    ],
    animation: (fps: 1, frames: 3, tracks: {
        "geometries.ball.transform.translate[0]": [(0, -4), (2, 4)],
        "geometries.ball.transform.rotate.angle": [(0, 90), (2, -90)],
        "geometries.ball.transform.scale": [(0, 0.5), (2, 1)],
    }),
)"##;
    let ball = r##"(
    lights: [Directional(direction: (0, 0, -1))],
    geometries: [Sphere(center: (0, 0, 2), radius: 1, color: "#fff")],
)"##;
    let files = Memory::new().with("nowhere/main.ron", main);
    let options = ReadOptions::new().files(files.with("nowhere/ball.ron", ball));
    let document = Document::from_path_with("nowhere/main.ron", &options).unwrap();
    assert_eq!(document.diagnostics(), []);
    let scene: Scene = document.try_into().unwrap();
    // At the start the sphere lies to the right of the shift, at the end to the left of it.
    for (frame, x, radius) in [(0, -3.0, 0.5), (1, 0.0, 0.75), (2, 2.0, 1.0)] {
        let world = scene.frame(frame).unwrap();
        let world = world.world();
        let [low, high] = world.geometries()[0].shape().bounds().unwrap();
        let (center, half) = ((low + high) * 0.5, (high - low) * 0.5);
        assert!(
            (center.x - x).abs() < 1e-12 && (half.x - radius).abs() < 1e-12,
            "{center} {half}"
        );
        let strahl::light::Light::Directional(light) = world.lighting().unwrap().lights[0] else {
            panic!("{world:?}");
        };
        let turned = [-1.0, 0.0, 1.0][frame as usize];
        assert!((light.direction().x - turned * radius).abs() < 1e-12);
    }
    // From -3.5 to 3 on the left and on the right.
    let eye = scene.camera_for(scene.size()).unwrap().eye();
    assert!((eye.x + 0.25).abs() < 1e-9, "{eye}");
}
