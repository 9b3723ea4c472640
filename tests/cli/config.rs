//! `strahl.toml`: its discovery, settings and faults.

use std::fs;

use crate::support::{Done, Folder, RON, run, run_with};

/// A scene with a warning that is on by default, `empty-scene`.
const EMPTY: &str =
    "(camera: Perspective(eye: (0, 0, 0), gaze: (0, 0, -1), fov: 90), geometries: [])";

/// A folder with the scenes `in/a.ron`, `in/deep/b.ron` and a `strahl.toml` above them.
fn folder(config: &str) -> Folder {
    let folder = Folder::new();
    fs::create_dir_all(folder.path("in/deep")).unwrap();
    folder.write("in/a.ron", EMPTY);
    folder.write("in/deep/b.ron", EMPTY);
    folder.write("strahl.toml", config);
    folder
}

fn strahl(folder: &Folder, args: &str) -> Done {
    run(&mut folder.strahl(args.split_whitespace()))
}

fn stdout(done: &Done) -> String {
    String::from_utf8(done.stdout.clone()).unwrap()
}

#[test]
fn lint_levels_apply_wherever_a_scene_is_read() {
    let folder = folder("deny = [\"warnings\"]\n");
    for args in [
        "validate in/a.ron",
        "validate in",
        "render in/a.ron",
        "render in -o out/",
        "info in/a.ron",
        "pixel in/a.ron 0,0",
        "merge in/a.ron -o a.png",
    ] {
        let done = strahl(&folder, args);
        let messages = stdout(&done) + &done.stderr;
        assert_eq!(done.status, Some(1), "{args}: {messages}");
        assert!(
            messages.contains("error[empty-scene]"),
            "{args}: {messages}"
        );
        let done = strahl(&folder, &format!("{args} --no-config"));
        let messages = stdout(&done) + &done.stderr;
        assert!(
            !messages.contains("error[empty-scene]"),
            "{args}: {messages}"
        );
    }
    let args = ["validate", "-"];
    let done = run_with(&mut folder.strahl(args), EMPTY.as_bytes());
    assert_eq!(done.status, Some(1), "standard input: the current folder");
}

#[test]
fn one_code_beats_all_and_options_beat_the_file() {
    let folder = folder("deny = [\"warnings\"]\nallow = [\"empty-scene\"]\n");
    assert_eq!(
        strahl(&folder, "validate in").stderr,
        "2 files: no problems\n"
    );
    let done = strahl(&folder, "validate in --warn empty-scene");
    assert_eq!(done.stderr, "2 files: 2 warnings\n");
    let done = strahl(&folder, "validate in --deny empty-scene");
    assert_eq!(
        (done.status, &*done.stderr),
        (Some(1), "2 files: 2 errors\n")
    );
    folder.write("strahl.toml", "deny = [\"empty-scene\"]\n");
    let done = strahl(&folder, "validate in --allow empty-scene");
    assert_eq!(done.stderr, "2 files: no problems\n");
}

#[test]
fn only_the_nearest_file_applies_to_each_scene() {
    let folder = folder("deny = [\"warnings\"]\n");
    folder.write("in/deep/strahl.toml", "allow = [\"empty-scene\"]\n");
    let done = strahl(&folder, "validate in --output-format short");
    assert_eq!(done.stderr, "2 files: 1 error\n");
    assert!(
        stdout(&done).starts_with("in/a.ron:1:"),
        "{}",
        stdout(&done)
    );
    folder.write("in/deep/strahl.toml", "");
    let done = strahl(&folder, "validate in/deep");
    assert_eq!(done.stderr, "1 file: 1 warning\n");
    let done = strahl(&folder, "render in -o out/");
    assert_eq!(done.status, Some(1), "{}", done.stderr);
    assert!(
        folder.path("out/deep/b.png").is_file(),
        "only one is refused"
    );
}

#[test]
fn exclusions_apply_only_to_folders() {
    let folder = folder("exclude = [\"deep\", \"in/old.*\"]\n");
    folder.write("in/old.ron", "(");
    folder.write("in/deep/b.ron", "(");
    folder.write("in/mine.ron", RON);
    let done = strahl(&folder, "validate in");
    assert_eq!(done.stderr, "2 files: 1 warning\n");
    let done = strahl(&folder, "validate in --exclude a.ron");
    assert_eq!(done.stderr, "1 file: no problems\n", "an option adds to it");
    assert_eq!(strahl(&folder, "fmt in").status, Some(0));
    assert_eq!(strahl(&folder, "render in -o out/").status, Some(0));
    for args in [
        "validate in/deep",
        "validate in/old.ron",
        "validate in --no-config",
        "fmt in --no-config",
    ] {
        assert_eq!(strahl(&folder, args).status, Some(1), "{args}");
    }
    // Patterns are relative to the folder of their file.
    let inside = run(folder
        .strahl(["validate", "."])
        .current_dir(folder.path("in")));
    assert_eq!(inside.stderr, "2 files: 1 warning\n");
}

#[test]
fn forms_and_limits_are_those_of_the_first_path() {
    // A whole number may be written as a float.
    let folder = folder("output-format = \"short\"\nmax-diagnostics = 1.0\n");
    folder.write("in/a.ron", "(camera: 1, geometries: [], lights: 2)");
    let done = strahl(&folder, "validate in/a.ron");
    assert_eq!(stdout(&done).lines().count(), 2, "{}", stdout(&done));
    assert!(stdout(&done).starts_with("in/a.ron:1:10: error[wrong-type]: "));
    let done = strahl(
        &folder,
        "validate in/a.ron --output-format jsonl --max-diagnostics 9",
    );
    assert_eq!(stdout(&done).lines().count(), 3, "{}", stdout(&done));
    let done = strahl(&folder, "validate in/a.ron --no-config");
    assert!(
        stdout(&done).starts_with("error[wrong-type]"),
        "{}",
        stdout(&done)
    );
}

#[test]
fn tables_outside_may_be_allowed() {
    let folder = folder("allow-outside = true\n");
    folder.write("t.csv", "x,y,z,radius\n0,0,-3,1\n");
    let scene = EMPTY.replace("[]", "[Spheres(file: \"../t.csv\", color: (1, 0, 0))]");
    folder.write("in/a.ron", scene);
    for args in [
        "validate in/a.ron",
        "render in/a.ron",
        "pixel in/a.ron 0,0",
        "info in/a.ron",
    ] {
        assert_eq!(strahl(&folder, args).status, Some(0), "{args}");
        assert_eq!(
            strahl(&folder, &format!("{args} --no-config")).status,
            Some(1),
            "{args}"
        );
        assert_eq!(
            strahl(&folder, &format!("{args} --no-config --allow-outside")).status,
            Some(0)
        );
    }
}

#[test]
fn every_fault_is_one_line_with_its_position() {
    for (config, words) in [
        (
            "exlude = []",
            "1:1: unknown key `exlude`; did you mean `exclude`?",
        ),
        (
            "\nmax_diagnostics = 3",
            "2:1: unknown key `max_diagnostics`; did you mean `max-diagnostics`?",
        ),
        (
            "threads = 3",
            "1:1: unknown key `threads`, expected one of `exclude`, ",
        ),
        (
            "exclude = \"x\"",
            "1:11: expected an array of strings, found a string",
        ),
        (
            "deny = [\"warnings\", 3]",
            "1:21: expected a string, found `3`",
        ),
        (
            "max-diagnostics = -1",
            "1:19: expected a number of 0 or more, found `-1`",
        ),
        (
            "max-diagnostics = 1.5",
            "1:19: expected a number of 0 or more, found `1.5`",
        ),
        (
            "allow-outside = 1",
            "1:17: expected `true` or `false`, found `1`",
        ),
        (
            "output-format = \"jsno\"",
            "1:17: unknown output format `jsno`; did you mean `json`?",
        ),
        (
            "deny = [\"eye-insid\"]",
            "1:9: unknown warning `eye-insid`; did you mean `eye-inside`?",
        ),
        (
            "allow = [\"syntax\"]",
            "1:10: `syntax` is an error; only warnings can be changed",
        ),
        (
            "deny = [\"empty-scene\"]\nallow = [\"empty-scene\"]",
            "2:10: `empty-scene` is named twice",
        ),
        ("exclude = [\"[z-a\"]", "1:12: `[z-a` is not a pattern"),
        (
            &format!("exclude = [{}]", "\"a\", ".repeat(1001)),
            "1:11: too many patterns",
        ),
        ("exclude = []\nexclude = []", "2:1: duplicate key"),
        ("deny = ", "1:8: "),
        ("\"\\u001b[31m\" = 1", "1:1: unknown key `\\u{1b}[31m`"),
        ("deny = [\"\\u202e\"]", "1:9: unknown warning "),
    ] {
        let folder = folder(config);
        for args in [
            "validate in",
            "validate in/a.ron",
            "fmt in",
            "render in -o out/",
            "render in/a.ron",
            "info in/a.ron",
        ] {
            let done = strahl(&folder, args);
            done.one_line(2, &["strahl.toml:", words]);
            assert!(!done.stderr.contains(['\u{1b}', '\u{202e}']), "{config}");
            assert_ne!(
                strahl(&folder, &format!("{args} --no-config")).status,
                Some(2),
                "{args}"
            );
        }
    }
}

#[test]
fn binary_and_overlong_files_are_rejected() {
    let folder = folder("");
    folder.write("strahl.toml", vec![b'#'; 2 << 20]);
    strahl(&folder, "validate in").one_line(2, &["strahl.toml: is larger than 1 MiB"]);
    folder.write("strahl.toml", b"# \xff\n");
    strahl(&folder, "validate in").one_line(2, &["strahl.toml: "]);
    fs::remove_file(folder.path("strahl.toml")).unwrap();
    fs::create_dir(folder.path("strahl.toml")).unwrap();
    strahl(&folder, "validate in").one_line(2, &["strahl.toml: is a folder, not a file"]);
}
