//! Folders: detection of scene files, and of broken ones.

use crate::support::{Done, Folder, JSON, RON, run, run_with};

/// A scene with every root field misspelt.
const MISSPELT: &[(&str, &str)] = &[
    ("image", "imagee"),
    ("camera", "cameraa"),
    ("background", "backgroud"),
    ("geometries", "Geometrys"),
];

fn misspelt(scene: &str) -> String {
    MISSPELT
        .iter()
        .fold(scene.to_owned(), |scene, (name, wrong)| {
            scene.replacen(name, wrong, 1)
        })
}

/// Returns damaged scenes.
fn wrecks() -> Vec<(&'static str, String)> {
    let half = |scene: &str| scene[..scene.len() / 2].to_owned();
    vec![
        ("empty.ron", String::new()),
        ("empty.json", String::new()),
        ("mark.ron", "\u{feff}".to_owned()),
        ("mark.json", "\u{feff}".to_owned()),
        ("blank.ron", " \n\t".to_owned()),
        ("blank.json", "\n".to_owned()),
        ("comments.ron", "// one\n/* two */\n".to_owned()),
        ("comments.json", "// one\n".to_owned()),
        ("bracket.ron", "(".to_owned()),
        ("bracket-end.ron", ")".to_owned()),
        ("name.ron", "Scene(".to_owned()),
        ("words.ron", "to be done".to_owned()),
        ("zeros.ron", "\0\0\0\0".to_owned()),
        ("half.ron", half(RON)),
        ("half.json", half(JSON)),
        ("end.ron", RON[RON.len() / 2..].to_owned()),
        ("headless.ron", RON.replacen('(', "", 1)),
        ("headless.json", JSON.replacen('{', "", 1)),
        ("twice.ron", format!("{RON}{RON}")),
        ("twice.json", format!("{JSON}{JSON}")),
        (
            "conflict.ron",
            format!("<<<<<<< HEAD\n{RON}=======\n{RON}>>>>>>> other\n"),
        ),
        (
            "conflict.json",
            format!("<<<<<<< HEAD\n{JSON}=======\n{JSON}>>>>>>> other\n"),
        ),
        ("equal.ron", RON.replace("camera:", "camera =")),
        ("single.json", JSON.replace('"', "'")),
        (
            "bare.json",
            JSON.replace("\"camera\"", "camera")
                .replace("\"image\"", "image"),
        ),
        ("comment.json", format!("// mine\n{JSON}")),
        ("json.ron", JSON.to_owned()),
        ("ron.json", RON.to_owned()),
        ("misspelt.ron", misspelt(RON)),
        ("misspelt.json", misspelt(JSON)),
        ("upper.ron", RON.to_uppercase()),
        ("one.ron", "(cameraa: 1)".to_owned()),
    ]
}

/// Files next to scenes that are not scenes.
const OTHERS: &[(&str, &str)] = &[
    (
        "package.json",
        r#"{"name": "x", "version": "1.0.0", "scripts": {}}"#,
    ),
    (
        "tsconfig.json",
        "{\n  // comments\n  \"compilerOptions\": {\"strict\": true,},\n  \"include\": [\"src\"],\n}",
    ),
    (
        "sarif.json",
        r#"{"$schema": "https://example.org", "version": "2.1.0", "runs": []}"#,
    ),
    ("list.json", "[1, 2]"),
    ("words.json", "to be done"),
    ("brace.json", "{"),
    ("window.ron", "(window: (width: 3))"),
    ("unit.ron", "()"),
];

fn validate(folder: &Folder) -> Done {
    run(&mut folder.strahl(["validate", "--output-format", "short", "."]))
}

#[test]
fn a_damaged_scene_is_an_error_in_every_command() {
    for (name, text) in wrecks() {
        let folder = Folder::new();
        folder.write("a.ron", RON);
        folder.write(name, &text);
        let done = validate(&folder);
        let messages = String::from_utf8_lossy(&done.stdout);
        assert_eq!(done.status, Some(1), "{name}: {}", done.stderr);
        assert!(messages.contains(name), "{name}: {messages}");
        assert!(
            done.stderr.starts_with("2 files: "),
            "{name}: {}",
            done.stderr
        );
        let done = run(&mut folder.strahl(["render", ".", "-o", "out/", "--size", "4x4"]));
        assert_eq!(done.status, Some(1), "{name}: {}", done.stderr);
        assert!(done.stderr.contains(name), "{name}: {}", done.stderr);
        // Any text that parses can be formatted.
        let format = ["misspelt.", "upper.", "one.", "json.ron"];
        if !format.iter().any(|parses| name.starts_with(parses)) {
            let done = run(&mut folder.strahl(["fmt", "."]));
            assert_eq!(done.status, Some(1), "{name}: {}", done.stderr);
            assert!(done.stderr.contains(name), "{name}: {}", done.stderr);
        }
    }
}

#[test]
fn other_files_are_skipped() {
    for (name, text) in OTHERS {
        let folder = Folder::new();
        folder.write("a.ron", RON);
        folder.write(name, text);
        assert_eq!(
            validate(&folder).stderr,
            "1 file (1 skipped): no problems\n",
            "{name}"
        );
        run(&mut folder.strahl(["fmt", "."])).quiet_success();
        assert_eq!(
            std::fs::read_to_string(folder.path(name)).unwrap(),
            *text,
            "{name}"
        );
    }
}

#[test]
fn verbose_lists_skipped_files() {
    let folder = Folder::new();
    folder.write("a.ron", RON);
    folder.write("package.json", "{\"name\": 1}");
    for args in ["validate .", "fmt .", "render . -o out/ --size 4x4"] {
        let skipped = "skipped: ./package.json: not a scene\n";
        let args: Vec<_> = args.split_whitespace().collect();
        let done = run(&mut folder.strahl(args.iter().chain(&["--verbose"])));
        assert_eq!(done.status, Some(0), "{args:?}: {}", done.stderr);
        assert!(done.stderr.contains(skipped), "{args:?}: {}", done.stderr);
        assert!(!run(&mut folder.strahl(args)).stderr.contains("skipped: "));
    }
}

#[test]
fn fmt_takes_a_list_of_files() {
    let folder = Folder::new();
    let untidy = RON.replace("    ", " ");
    for name in ["a.ron", "b c.ron", "d.ron", "e.ron"] {
        folder.write(name, &untidy);
    }
    folder.write("list.txt", "a.ron\n\nb c.ron\n");
    let read = |name: &str| std::fs::read_to_string(folder.path(name)).unwrap();
    let done = run(&mut folder.strahl(["fmt", "--check", "--files-from", "list.txt"]));
    assert_eq!(done.status, Some(1));
    assert_eq!(String::from_utf8_lossy(&done.stdout), "a.ron\nb c.ron\n");
    run(&mut folder.strahl(["fmt", "--files-from", "list.txt"])).quiet_success();
    let both = ["fmt", "e.ron", "--files-from", "-"];
    run_with(&mut folder.strahl(both), b"a.ron\n").quiet_success();
    let names = ["a.ron", "b c.ron", "d.ron", "e.ron"];
    assert_eq!(
        names.map(|name| read(name) == untidy),
        [false, false, true, false]
    );
    run(&mut folder.strahl(["fmt", "--files-from", "no.txt"])).one_line(2, &["no.txt"]);
    run(&mut folder.strahl(["fmt"])).failure(2, &["PATH"]);
}
