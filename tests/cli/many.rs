//! Several pictures in one run: of several scenes, table rows or animation frames.

use std::fs;

use crate::support::{Done, Folder, JSON, RON, run};

/// A scene of three frames: a ball that grows and turns from red to blue.
pub(crate) const MOVING: &str = r##"(
    image: (width: 32, height: 24),
    camera: Perspective(eye: (0, 0, 0), gaze: (0, 0, -1), fov: 90),
    geometries: [Sphere(center: (0, 0, -3), radius: 1, color: "#ff0000")],
    animation: (fps: 2, frames: 3, tracks: {
        "geometries[0].radius": [(0, 1), (1, 2)],
        "geometries[0].color": [(0, "#ff0000"), (1, "#0000ff", Step)],
    }),
)"##;

fn done(folder: &Folder, args: &[&str]) -> Done {
    run(&mut folder.strahl([&["render"], args].concat()))
}

/// Runs the program, asserts that every picture was rendered, and returns the standard error.
#[track_caller]
fn drawn(folder: &Folder, args: &[&str]) -> String {
    let done = done(folder, args);
    assert_eq!(done.status, Some(0), "{}", done.stderr);
    done.stderr
}

/// Returns the names in a folder that are not hidden.
fn pictures(folder: &Folder, inside: &str) -> Vec<String> {
    let entries = fs::read_dir(folder.path(inside)).unwrap();
    let names = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap());
    let mut names: Vec<_> = names.filter(|name| !name.starts_with('.')).collect();
    names.sort();
    names
}

#[test]
fn a_folder_of_scenes_becomes_a_folder_of_pictures() {
    let folder = Folder::new();
    fs::create_dir_all(folder.path("in/deep")).unwrap();
    folder.write("in/a.ron", RON);
    folder.write("in/deep/b.json", JSON);
    folder.write("in/bad.ron", RON.replace("radius: 0.5", "radius: -1"));
    folder.write("in/package.json", r#"{"name": "no scene"}"#);
    drawn(&folder, &["in/a.ron", "-q", "-o", "one.png"]);
    let expected = fs::read(folder.path("one.png")).unwrap();
    for threads in ["1", "3"] {
        let args = [
            "in",
            "-o",
            "out/",
            "--threads",
            threads,
            "--report",
            "r.json",
        ];
        let done = done(&folder, &args);
        done.bad_scene("in/bad.ron", &["out-of-range"]);
        assert!(
            done.stderr.contains("2 drawn, 1 failed, 1 skipped"),
            "{}",
            done.stderr
        );
        assert_eq!(pictures(&folder, "out"), ["a.png", "deep"]);
        for name in ["out/a.png", "out/deep/b.png"] {
            assert!(fs::read(folder.path(name)).unwrap() == expected, "{name}");
        }
        let report = fs::read_to_string(folder.path("r.json")).unwrap();
        let report: serde_json::Value = serde_json::from_str(&report).unwrap();
        assert_eq!(report["summary"]["failed"], 1);
        let states: Vec<_> = report["pictures"].as_array().unwrap().iter().collect();
        let states: Vec<_> = states
            .iter()
            .map(|picture| picture["status"].as_str().unwrap())
            .collect();
        assert_eq!(states, ["drawn", "failed", "drawn", "skipped"]);
        fs::remove_dir_all(folder.path("out")).unwrap();
    }
}

#[test]
fn ambiguous_names_are_rejected_before_rendering() {
    let folder = Folder::with_scenes();
    folder.write("moving.ron", MOVING);
    folder.write("two.csv", "id,camera.fov\nx,60\nx,70\n");
    for (args, words) in [
        (&["scene.ron", "scene.json"][..], &["-o FOLDER/"][..]),
        (
            &["scene.ron", "scene.json", "-o", "out/"],
            &["scene.ron", "scene.json", "scene.png"],
        ),
        (
            &["moving.ron", "--frames", "0-2", "-o", "a.png"],
            &["frame 0", "frame 1", "a.png"],
        ),
        (
            &["scene.ron", "scene.json", "-o", "out"],
            &["scene.ron", "`out/`", "folder"],
        ),
        (
            &["moving.ron", "--frames", "0-2", "-o", "-"],
            &["standard output", "y4m"],
        ),
        (
            &["moving.ron", "--frames", "0-2", "-o", "{farme}.png"],
            &["{farme}", "{frame}"],
        ),
        (
            &["moving.ron", "--frames", "2-1", "-o", "{frame}.png"],
            &["0-239"],
        ),
        (
            &["moving.ron", "--frames", "0-3", "-o", "{frame}.png"],
            &["no frame 3", "0 to 2"],
        ),
        (
            &["scene.ron", "--frames", "0-1", "-o", "{frame}.png"],
            &["no animation"],
        ),
        (
            &["scene.ron", "--params", "two.csv", "-o", "{id}.png"],
            &["two.csv:2", "two.csv:3", "x.png"],
        ),
        (
            &["moving.ron", "--frames", "0-2", "-o", "{frame}.gif"],
            &[".gif", ".png"],
        ),
        (
            &["moving.ron", "--frames", "0-2", "-o", "{frame.png"],
            &["{frame.png", "{{"],
        ),
    ] {
        done(&folder, args).failure(2, words);
    }
    assert!(
        folder.names().iter().all(|name| !name.ends_with("png")),
        "{:?}",
        folder.names()
    );
}

#[test]
fn frames_depend_only_on_the_scene_and_their_number() {
    let folder = Folder::new();
    folder.write("moving.ron", MOVING);
    drawn(&folder, &["moving.ron", "-q"]);
    drawn(
        &folder,
        &["moving.ron", "--frames", "0-2", "-o", "f_{frame:04}.png"],
    );
    drawn(
        &folder,
        &["moving.ron", "--frames", "2,0", "-o", "g{frame}.png"],
    );
    let read = |name: &str| fs::read(folder.path(name)).unwrap();
    assert!(read("moving.png") == read("f_0000.png"));
    assert!(read("f_0000.png") == read("g0.png") && read("f_0002.png") == read("g2.png"));
    folder.write(
        "last.ron",
        MOVING
            .replace(
                "radius: 1, color: \"#ff0000\"",
                "radius: 2, color: \"#0000ff\"",
            )
            .split("animation")
            .next()
            .unwrap()
            .to_owned()
            + ")",
    );
    drawn(&folder, &["last.ron", "-q"]);
    assert!(read("last.png") == read("f_0002.png"));
    assert!(read("f_0001.png") != read("f_0000.png") && read("f_0001.png") != read("f_0002.png"));
}

#[test]
fn a_row_of_a_table_is_the_same_as_set() {
    let folder = Folder::with_scenes();
    folder.write(
        "t.csv",
        "id,geometries[1].color,camera.fov\nred,,60\nblue,#0000ff,70\n",
    );
    folder.write(
        "t.jsonl",
        concat!(
            r#"{"id": "red", "camera.fov": 60}"#,
            "\n\n",
            r##"{"geometries[1].color": "#0000ff", "camera.fov": 70, "id": "blue"}"##,
            "\n"
        ),
    );
    let set = [
        "--set",
        "camera.fov=70",
        "--set",
        "geometries[1].color=\"#0000ff\"",
    ];
    drawn(
        &folder,
        &[&["scene.ron", "-o", "expected.png", "-q"], &set[..]].concat(),
    );
    let expected = fs::read(folder.path("expected.png")).unwrap();
    for scene in ["scene.ron", "scene.json"] {
        for table in ["t.csv", "t.jsonl"] {
            drawn(&folder, &[scene, "--params", table, "-o", "x_{id}.png"]);
            assert!(
                fs::read(folder.path("x_blue.png")).unwrap() == expected,
                "{scene} {table}"
            );
            assert!(fs::read(folder.path("x_red.png")).unwrap() != expected);
            fs::remove_file(folder.path("x_blue.png")).unwrap();
        }
    }
    // A whole number may be written as a float, as a table program does.
    folder.write("w.csv", "id,image.width\nwhole,8.0\n");
    folder.write("w.jsonl", "{\"id\": \"whole\", \"image.width\": 8.0}\n");
    for table in ["w.csv", "w.jsonl"] {
        drawn(&folder, &["scene.ron", "--params", table, "-o", "{id}.png"]);
        fs::remove_file(folder.path("whole.png")).unwrap();
    }
    // Without an `id` column, the id is the row number.
    folder.write("n.csv", "camera.fov\n60\n70\n");
    drawn(
        &folder,
        &["scene.ron", "--params", "n.csv", "-o", "n{id:03}.png"],
    );
    assert!(folder.path("n000.png").exists() && folder.path("n001.png").exists());
}

#[test]
fn json_values_are_set_whatever_the_syntax_of_the_scene() {
    let folder = Folder::new();
    folder.write(
        "scene.ron",
        r##"(
    camera: Perspective(eye: (0, 0, 9), gaze: (0, 0, -1), fov: 90),
    geometries: [
        Ellipsoid(center: (0, 0, 0), axes: [(1, 0, 0), (0, 1, 0), (0, 0, 1)], color: "#f00"),
        Group(transform: (translate: (1, 0, 0)), geometries: [
            Box(min: (0, 0, 0), max: (1, 1, 1), color: "#f00"),
        ]),
    ],
)"##,
    );
    folder.write(
        "good.jsonl",
        r#"{"geometries[0].axes": [[1, 0, 0], [0, 2, 0], [0, 0, 1]]}
{"geometries[1].transform": {"matrix": [[1, 0, 0, 0], [0, 2, 0, 0], [0, 0, 1, 0]]}}
{"geometries[1].transform.rotate": {"axis": [0, 1, 0], "angle": 45}}
{"geometries[0].color": [0, 0.5, 1], "geometries[1].geometries[0].min[2]": -1}
{"camera": {"Orthographic": {"eye": [0, 0, 9], "gaze": [0, 0, -1], "scale": 4}}}
"#,
    );
    let args = ["validate", "scene.ron", "--params", "good.jsonl"];
    let valid = run(&mut folder.strahl(args));
    assert_eq!(valid.status, Some(0), "{valid:?}");
    folder.write(
        "bad.jsonl",
        "{\"geometries[0].axes\": [[1, 0, 0], [0, 2, 0], [0, 1]]}\n",
    );
    let args = ["validate", "scene.ron", "--params", "bad.jsonl"];
    let wrong = run(&mut folder.strahl(args.into_iter().chain(["--output-format=short"])));
    let stdout = String::from_utf8(wrong.stdout).unwrap();
    let expected = "bad.jsonl:1:2: error[wrong-type]: column `geometries[0].axes`: expected an array \
                    of 3 numbers, found an array of 2";
    assert_eq!(stdout.lines().next(), Some(expected));
}

#[test]
fn faults_in_a_table_are_reported_by_row_and_column() {
    let folder = Folder::with_scenes();
    folder.write(
        "t.csv",
        "id,camera.fov,geometries[1].color\na,60,\nb,200,\nc,60,blub\n",
    );
    let both = [
        ("t.csv:3", "camera.fov"),
        ("t.csv:4", "geometries[1].color"),
    ];
    for command in [&["render", "-o", "{id}.png"][..], &["validate"]] {
        let args = [command, &["scene.ron", "--params", "t.csv"]].concat();
        let done = run(&mut folder.strahl(args));
        assert_eq!(done.status, Some(1));
        let messages = done.stderr + &String::from_utf8(done.stdout).unwrap();
        for (row, column) in both {
            assert!(
                messages.contains(row) && messages.contains(column),
                "{messages}"
            );
        }
        assert!(
            messages.contains("out-of-range") && messages.contains("invalid-color"),
            "{messages}"
        );
    }
    assert!(folder.path("a.png").exists() && !folder.path("b.png").exists());
    for (table, words) in [
        ("camara.fov\n60\n", &["unknown-path", "camera"][..]),
        ("backgrond\n\"(0, 0, 0)\"\n", &["did you mean"]),
        ("a,b\n1\n", &["t.csv:2", "1 cells", "2 columns"]),
        ("a,a\n1,2\n", &["column a", "two"]),
        ("a\n", &["no rows"]),
        (
            "id,camera.fov\n../x,60\n",
            &["t.csv:2", "column id", "../x"],
        ),
    ] {
        folder.write("t.csv", table);
        let done = done(
            &folder,
            &["scene.ron", "--params", "t.csv", "-o", "{id}.png"],
        );
        assert!(matches!(done.status, Some(1 | 2)), "{table}");
        for word in words {
            assert!(
                done.stderr.contains(word),
                "no {word:?} for {table:?}: {}",
                done.stderr
            );
        }
    }
    folder.write("t.jsonl", "{\"camera.fov\": 60}\n{\"camera.fov\": }\n");
    let done = done(
        &folder,
        &["scene.ron", "--params", "t.jsonl", "-o", "{id}.png"],
    );
    done.failure(2, &["t.jsonl:2:16"]);
}

#[test]
fn movies_hold_the_frames() {
    let folder = Folder::new();
    folder.write("moving.ron", MOVING);
    drawn(
        &folder,
        &["moving.ron", "--frames", "0-2", "-o", "{frame}.ppm", "-q"],
    );
    let args = ["moving.ron", "-o", "-", "--image-format", "y4m"];
    let stream = run(&mut folder.strahl([&["render"], &args[..]].concat())).quiet_success();
    drawn(&folder, &["moving.ron", "-o", "m.y4m", "--threads", "1"]);
    assert!(fs::read(folder.path("m.y4m")).unwrap() == stream);
    let header = b"YUV4MPEG2 W32 H24 F2:1 Ip A1:1 C444 XCOLORRANGE=LIMITED\n";
    let frames = stream.strip_prefix(header).unwrap();
    assert_eq!(frames.len(), 3 * (6 + 3 * 32 * 24));
    for (number, frame) in frames.chunks(6 + 3 * 32 * 24).enumerate() {
        let planes = frame.strip_prefix(b"FRAME\n").unwrap();
        let picture = fs::read(folder.path(format!("{number}.ppm"))).unwrap();
        let pixels = picture.strip_prefix(b"P6\n32 24\n255\n").unwrap();
        // These pictures contain only black, pure red and pure blue.
        for (pixel, luma) in pixels.chunks(3).zip(planes) {
            let expected = match pixel {
                [0, 0, 0] => 16,
                [255, 0, 0] => 81,
                [0, 0, 255] => 41,
                other => panic!("{other:?}"),
            };
            assert_eq!(*luma, expected);
        }
    }
    drawn(&folder, &["moving.ron", "--frames", "1-2", "-o", "m.apng"]);
    let apng = fs::read(folder.path("m.apng")).unwrap();
    assert!(apng.windows(4).any(|four| four == b"acTL"));
    for (args, words) in [
        (&["-o", "m.y4m", "--shard", "0/2"][..], &["--shard"][..]),
        (&["-o", "m.y4m", "--layers", "depth"], &["--layers"]),
        (&["-o", "m.y4m", "--frames", "0-9"], &["no frame 9"]),
    ] {
        done(&folder, &[&["moving.ron"], args].concat()).one_line(2, words);
    }
}

#[test]
fn the_folders_of_patterns_are_made() {
    let folder = Folder::with_scenes();
    folder.write("moving.ron", MOVING);
    done(
        &folder,
        &[
            "moving.ron",
            "--frames",
            "0-2",
            "-o",
            "a/{frame}/{scene}.png",
        ],
    );
    for frame in 0..3 {
        assert!(folder.path(format!("a/{frame}/moving.png")).exists());
    }
    // Also with a single picture.
    done(&folder, &["scene.ron", "-o", "b/{scene}/x.png"]);
    assert!(folder.path("b/scene/x.png").exists());
}
