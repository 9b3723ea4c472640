//! Commands, options and files as people type and keep them.

use std::fs;

use crate::support::{Folder, RON, run, run_with};

#[test]
fn other_commands_and_options() {
    let folder = Folder::new();
    folder.write("fig.ron", RON);
    for (args, words) in [
        (&["compare", "a.png", "b.png"][..], "'diff'"),
        (&["check", "fig.ron"], "'validate'"),
        (&["format", "fig.ron"], "'fmt'"),
        (
            &["render", "fig.ron", "--resolution", "9x9"],
            "'--size WIDTHxHEIGHT'",
        ),
        (
            &["render", "fig.ron", "--width", "9"],
            "'--size WIDTHxHEIGHT'",
        ),
        (&["render", "fig.ron", "--dpi", "300"], "'--size 1200x900'"),
        (&["render", "fig.ron", "--spp", "4"], "'--samples N'"),
        (&["render", "fig.ron", "--frame", "3"], "'--frames N'"),
        (&["info", "fig.ron", "--frames", "3"], "'--frame N'"),
        (&["render", "fig.ron", "--format", "png"], "'-o FILE'"),
        (&["explain", "unknown-feild"], "'unknown-field'"),
        (
            &["render", "fig.ron", "-o", "x.mp4"],
            "--image-format y4m | ffmpeg -i - -pix_fmt yuv420p x.mp4",
        ),
        (
            &["render", "fig.ron", "-o", "x.GIF"],
            "--image-format y4m | ffmpeg -i - x.GIF",
        ),
    ] {
        let done = run(&mut folder.strahl(args));
        assert_eq!(done.status, Some(2), "{args:?}");
        assert!(done.stderr.contains(words), "{args:?}: {}", done.stderr);
        let tips = done.stderr.matches("tip:").count();
        assert!(tips <= 1, "{args:?}: {}", done.stderr);
        assert!(!done.stderr.contains("possible values"), "{}", done.stderr);
    }
}

#[test]
fn standard_input_stands_for_a_file() {
    let folder = Folder::new();
    fs::create_dir(folder.path("sub")).unwrap();
    folder.write("sub/points.csv", "x,y,z\n0,0,0\n");
    let json = r##"{"camera": {"Orthographic": {"eye": [0, 0, 9], "gaze": [0, 0, -1], "scale": 4}},
        "geometries": [{"Spheres": {"file": "points.csv", "radius": 1, "color": "#fff"}}]}"##;
    for args in [
        &["validate", "-"][..],
        &["fmt", "-"],
        &["info", "-"],
        &["render", "-", "-o", "a.png", "--size", "8x8", "-q"],
    ] {
        let with = [args, &["--stdin-filename", "sub/a.json"]].concat();
        let done = run_with(&mut folder.strahl(&with), json.as_bytes());
        assert_eq!(done.status, Some(0), "{with:?}: {}", done.stderr);
    }
    let done = run_with(&mut folder.strahl(["validate", "-"]), json.as_bytes());
    assert_eq!(done.status, Some(1));
    let args = ["fmt", "-", "--stdin-filename", "sub/a.json"];
    let done = run_with(&mut folder.strahl(args), b"(camera: 1)");
    assert_eq!(done.status, Some(1));
    assert!(done.stderr.contains("sub/a.json:1:1"), "{}", done.stderr);
}

#[test]
fn a_byte_order_mark_stays() {
    let folder = Folder::new();
    let path = folder.write("a.ron", format!("\u{feff}{}", RON.replace("    ", "  ")));
    let done = run(&mut folder.strahl(["fmt", "a.ron"]));
    assert_eq!(done.status, Some(0), "{}", done.stderr);
    let text = fs::read_to_string(&path).unwrap();
    assert!(text.starts_with("\u{feff}("), "{text}");
    assert_eq!(text.matches('\u{feff}').count(), 1);
    let done = run(&mut folder.strahl(["fmt", "--check", "a.ron"]));
    assert_eq!(done.status, Some(0), "{}", done.stderr);
}

#[cfg(unix)]
#[test]
fn hard_links_stay() {
    use std::os::unix::fs::MetadataExt;

    let folder = Folder::new();
    let path = folder.write("a.ron", RON.replace("    ", "  "));
    let other = path.with_file_name("b.ron");
    fs::hard_link(&path, &other).unwrap();
    let done = run(&mut folder.strahl(["fmt", "a.ron"]));
    assert_eq!(done.status, Some(0), "{}", done.stderr);
    let text = fs::read_to_string(&path).unwrap();
    assert_eq!(fs::read_to_string(&other).unwrap(), text);
    assert_eq!(fs::metadata(&path).unwrap().nlink(), 2);
    assert_eq!(folder.names(), ["a.ron", "b.ron"]);
}

#[cfg(target_os = "linux")]
#[test]
fn a_name_that_is_not_text_has_a_uri() {
    use std::{ffi::OsStr, os::unix::ffi::OsStrExt};

    let folder = Folder::new();
    let path = folder.write("a.ron", "(camera: 1)");
    let other = path.with_file_name(OsStr::from_bytes(b"caf\xe9.ron"));
    fs::rename(&path, &other).unwrap();
    let done = run(&mut folder.strahl(["validate", "--output-format", "sarif", "."]));
    let report = String::from_utf8(done.stdout).unwrap();
    assert!(report.contains("caf%E9.ron\""), "{report}");
}

#[test]
fn the_limit_of_groups_is_told() {
    let folder = Folder::new();
    let ball = "Sphere(center: (0, 0, 0), radius: 1, color: \"#f00\")";
    let scene = |depth: usize| {
        let camera = "camera: Orthographic(eye: (0, 0, 9), gaze: (0, 0, -1), scale: 4)";
        let (open, close) = ("Group(geometries: [".repeat(depth), "])".repeat(depth));
        format!("({camera}, geometries: [{open}{ball}{close}])")
    };
    folder.write("a.ron", scene(61));
    let done = run(&mut folder.strahl(["validate", "a.ron"]));
    assert_eq!(done.status, Some(0), "{}", done.stderr);
    let done = run(&mut folder.strahl(["convert", "a.ron", "a.json"]));
    assert_ne!(done.status, Some(0));
    assert!(done.stderr.contains("nested too deep"), "{}", done.stderr);
    assert_eq!(folder.names(), ["a.ron"]);
    folder.write("b.ron", scene(40));
    let done = run(&mut folder.strahl(["convert", "b.ron", "b.json"]));
    assert_eq!(done.status, Some(0), "{}", done.stderr);
    let done = run(&mut folder.strahl(["validate", "b.json"]));
    assert_eq!(done.status, Some(0), "{}", done.stderr);
}

#[test]
fn the_fourth_column_of_an_array_is_told() {
    let folder = Folder::new();
    let mut bytes = b"\x93NUMPY\x01\x00\x76\x00".to_vec();
    let header = "{'descr': '<f8', 'fortran_order': False, 'shape': (1, 4), }";
    bytes.extend(format!("{header:<117}\n").as_bytes());
    bytes.extend([0.0_f64, 0.0, 0.0, 0.5].map(f64::to_le_bytes).concat());
    folder.write("a.npy", bytes);
    for (fields, help) in [
        (
            "radius: 1, color: \"#fff\"",
            "such as `columns: [\"x\", \"y\", \"z\", \"value\"]`, or leave `radius` out here",
        ),
        (
            "color_by: (column: \"energy\")",
            "such as `columns: [\"x\", \"y\", \"z\", \"energy\"]`",
        ),
    ] {
        let camera = "camera: Orthographic(eye: (0, 0, 9), gaze: (0, 0, -1), scale: 4)";
        let spheres = format!("Spheres(file: \"a.npy\", {fields})");
        folder.write("a.ron", format!("({camera}, geometries: [{spheres}])"));
        let args = ["validate", "--output-format", "json", "a.ron"];
        let done = run(&mut folder.strahl(args));
        let report = String::from_utf8(done.stdout)
            .unwrap()
            .replace("\\\"", "\"");
        assert!(report.contains(help), "{report}");
    }
}
