//! `strahl validate`: its input files, output and exit status.

use std::{fs, path::Path};

use crate::support::{Done, Folder, JSON, RON, run, run_with};

const BAD: &str = "(camera: 1, geometries: [], lights: 2)";

fn validate(folder: &Folder, args: &[&str]) -> Done {
    run(&mut folder.strahl(["validate"].iter().chain(args)))
}

fn stdout(done: &Done) -> String {
    String::from_utf8(done.stdout.clone()).unwrap()
}

#[test]
fn scenes_without_faults_are_only_counted() {
    let folder = Folder::with_scenes();
    let done = validate(&folder, &["scene.ron", "scene.json"]);
    assert_eq!((done.status, stdout(&done).as_str()), (Some(0), ""));
    assert_eq!(done.stderr, "2 files: no problems\n");
}

#[test]
fn every_problem_is_printed_in_the_order_of_the_files() {
    let folder = Folder::new();
    for index in 0..600 {
        folder.write(format!("{index:03}.ron"), BAD);
    }
    let first = Path::new(".").join("000.ron");
    for threads in ["1", "2", "7"] {
        let done = validate(
            &folder,
            &["--output-format", "short", "--threads", threads, "."],
        );
        assert_eq!(done.status, Some(1));
        let lines: Vec<_> = stdout(&done).lines().map(str::to_owned).collect();
        assert_eq!(
            lines.len(),
            600 * 3,
            "wrong type, unknown field, empty scene"
        );
        assert!(lines.is_sorted(), "{threads} threads");
        assert!(
            lines[0].starts_with(&format!("{}:1:10: error[wrong-type]: ", first.display())),
            "{}",
            lines[0]
        );
        assert_eq!(done.stderr, "600 files: 1200 errors, 600 warnings\n");
    }
}

#[test]
fn folders_skip_files_that_are_not_scenes() {
    let folder = Folder::with_scenes();
    for (name, text) in [
        ("package.json", "{\"name\": \"x\", \"version\": \"1.0.0\"}"),
        ("list.json", "[1, 2]"),
        ("notes.txt", "("),
        (".hidden.ron", "("),
        ("ignored.ron", "("),
        (".gitignore", "ignored.ron\n"),
        ("old.ron", "(camera: "),
    ] {
        folder.write(name, text);
    }
    let done = validate(&folder, &["--exclude", "old.*", "."]);
    assert_eq!((done.status, stdout(&done).as_str()), (Some(0), ""));
    assert_eq!(done.stderr, "2 files (2 skipped): no problems\n");
    // A named file is always read.
    let done = validate(&folder, &["package.json"]);
    assert_eq!(done.status, Some(1));
    assert!(
        stdout(&done).contains("error[missing-field]"),
        "{}",
        stdout(&done)
    );
}

#[test]
fn a_folder_without_a_scene_is_exit_status_2() {
    let folder = Folder::new();
    fs::create_dir(folder.path("empty")).unwrap();
    validate(&folder, &["empty"]).one_line(2, &["empty", "no scene"]);
    folder.write("empty/list.json", "[]");
    validate(&folder, &["empty"]).failure(2, &["empty", "no scene"]);
}

#[test]
fn a_scene_in_another_encoding_is_not_skipped() {
    let folder = Folder::with_scenes();
    let utf_16: Vec<u8> = "\u{feff}("
        .encode_utf16()
        .flat_map(u16::to_le_bytes)
        .collect();
    folder.write("utf-16.ron", utf_16);
    let done = validate(&folder, &["--output-format", "short", "."]);
    assert_eq!(done.status, Some(1));
    assert!(stdout(&done).contains("utf-16.ron:1:1: error[syntax]: the text is UTF-16"));
}

#[test]
fn a_file_that_cannot_be_read_does_not_stop_the_others() {
    let folder = Folder::with_scenes();
    folder.write("bad.ron", BAD);
    let done = validate(
        &folder,
        &["--output-format", "short", "missing.ron", "bad.ron"],
    );
    assert_eq!(done.status, Some(2), "2 comes before 1");
    let lines = stdout(&done);
    assert!(
        lines.starts_with("missing.ron:1:1: error[unreadable]: no such file"),
        "{lines}"
    );
    assert!(lines.contains("bad.ron:1:10: error[wrong-type]"), "{lines}");
}

#[test]
fn standard_input_and_lists_of_files_are_taken() {
    let folder = Folder::with_scenes();
    let mut command = folder.strahl(["validate", "--output-format", "short", "-"]);
    let done = run_with(&mut command, BAD.as_bytes());
    assert_eq!(done.status, Some(1));
    assert!(
        stdout(&done).starts_with("<stdin>:1:10: error[wrong-type]"),
        "{}",
        stdout(&done)
    );
    for text in [RON, JSON] {
        let done = run_with(&mut folder.strahl(["validate", "-"]), text.as_bytes());
        assert_eq!(
            (done.status, done.stderr.as_str()),
            (Some(0), "1 file: no problems\n")
        );
    }

    folder.write("list", "scene.ron\n\nscene.json\r\n");
    let done = validate(&folder, &["--files-from", "list"]);
    assert_eq!(
        (done.status, done.stderr.as_str()),
        (Some(0), "2 files: no problems\n")
    );
    let mut command = folder.strahl(["validate", "--files-from", "-"]);
    let done = run_with(&mut command, b"scene.ron\nmissing.ron\n");
    assert_eq!(
        (done.status, done.stderr.as_str()),
        (Some(2), "2 files: 1 error\n")
    );
    assert_eq!(run(&mut folder.strahl(["validate"])).status, Some(2));
}

#[test]
fn the_last_lint_option_wins() {
    let folder = Folder::new();
    folder.write(
        "empty.ron",
        RON.split("Plane").next().unwrap().to_owned() + "])",
    );
    let status = |args: &[&str]| {
        let done = validate(&folder, &[args, &["empty.ron"]].concat());
        (done.status.unwrap(), done.stderr)
    };
    let (none, warning, error) = (
        "1 file: no problems\n",
        "1 file: 1 warning\n",
        "1 file: 1 error\n",
    );
    for (args, expected) in [
        (&[][..], (0, warning)),
        (&["--deny", "warnings"], (1, error)),
        (&["--deny", "empty-scene"], (1, error)),
        (&["--deny", "eye-inside"], (0, warning)),
        (&["--allow", "empty-scene"], (0, none)),
        (&["--deny", "warnings", "--allow", "empty-scene"], (0, none)),
        (
            &["--allow", "empty-scene", "--warn", "empty-scene"],
            (0, warning),
        ),
        (&["--warn", "empty-scene", "--deny", "warnings"], (1, error)),
    ] {
        let (code, text) = status(args);
        assert_eq!((code, text.as_str()), expected, "{args:?}");
    }
    validate(&folder, &["--allow", "syntax", "empty.ron"]).failure(2, &["syntax", "error"]);
    validate(&folder, &["--deny", "radius", "empty.ron"]).failure(2, &["radius", "eye-inside"]);
}

#[test]
fn diagnostics_beyond_the_maximum_are_counted() {
    let folder = Folder::new();
    let spheres: String = (0..150)
        .map(|x| format!("Sphere(center: ({x}, 0, -3), radius: -1, color: (2, 0, 0)),"))
        .collect();
    folder.write(
        "many.ron",
        RON.replace("Plane(", &format!("{spheres} Plane(")),
    );
    let lines = |args: &[&str]| {
        let args = [args, &["--output-format", "short", "many.ron"]].concat();
        let done = validate(&folder, &args);
        assert_eq!(done.stderr, "1 file: 150 errors, 150 warnings\n");
        stdout(&done).lines().map(str::to_owned).collect::<Vec<_>>()
    };
    let shown = lines(&[]);
    assert_eq!(shown.len(), 101);
    assert!(
        shown[..100]
            .iter()
            .all(|line| line.contains("error[out-of-range]"))
    );
    assert!(
        shown[100].contains("50 more errors, 150 more warnings"),
        "{}",
        shown[100]
    );
    assert_eq!(lines(&["--max-diagnostics", "1000"]).len(), 300);
    assert_eq!(lines(&["--max-diagnostics", "0"]).len(), 1);
}

#[test]
fn every_output_format_is_valid() {
    let folder = Folder::new();
    folder.write("bad.ron", BAD);
    let text = |format: &str| {
        let done = validate(&folder, &["--output-format", format, "bad.ron"]);
        assert_eq!(done.status, Some(1));
        assert_eq!(done.stderr, "1 file: 2 errors, 1 warning\n");
        stdout(&done)
    };
    assert!(
        text("human").contains("  --> bad.ron:1:10\n")
            || text("human").contains(" --> bad.ron:1:10\n")
    );
    let json: serde_json::Value = serde_json::from_str(&text("json")).unwrap();
    assert_eq!(json["format"], 1);
    assert_eq!(json["summary"]["errors"], 2);
    let first = &json["diagnostics"][0];
    assert_eq!(
        (&first["file"], &first["line"], &first["column"]),
        (&"bad.ron".into(), &1.into(), &10.into())
    );
    assert_eq!(
        (&first["code"], &first["path"]),
        (&"wrong-type".into(), &"camera".into())
    );
    for line in text("jsonl").lines() {
        serde_json::from_str::<serde_json::Value>(line).unwrap();
    }
    let sarif: serde_json::Value = serde_json::from_str(&text("sarif")).unwrap();
    assert_eq!(sarif["version"], "2.1.0");
    assert_eq!(sarif["runs"][0]["results"].as_array().unwrap().len(), 3);
    assert!(text("github").starts_with("::error file=bad.ron,line=1,"));
    let uri = sarif["runs"][0]["tool"]["driver"]["rules"][0]["helpUri"].as_str();
    assert!(uri.unwrap().ends_with("/docs/diagnostics.md#syntax"));
    let junit = text("junit");
    assert!(junit.starts_with("<?xml"));
    let time = junit.split_once(" time=\"").unwrap().1;
    let time: f64 = time.split_once('"').unwrap().0.parse().unwrap();
    assert!(time > 0.0, "{junit}");
}
