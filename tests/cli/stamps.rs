//! All JSON that the program writes begins with the key `strahl`, and is never mistaken for a
//! scene.

use std::fs;

use serde_json::Value;

use crate::support::{Folder, RON, run};

/// Commands, the file that receives their JSON, and the kind that it declares.
const WRITTEN: &[(&str, &str, &str)] = &[
    ("info a.ron --output-format json", "info.json", "info/1"),
    (
        "pixel a.ron 3,4 --output-format json",
        "pixel.json",
        "pixel/1",
    ),
    (
        "render a.ron -o a.png --report -",
        "report.json",
        "report/1",
    ),
    ("render a.ron -o many/ --report -", "run.json", "run/1"),
    (
        "validate a.ron --output-format json",
        "validate.json",
        "validate/1",
    ),
    (
        "validate b.ron --output-format jsonl",
        "lines.json",
        "diagnostic/1",
    ),
    (
        "diff a.png many/a.png --output-format json",
        "diff.json",
        "diff/1",
    ),
    (
        "diff a.png small.png --output-format json",
        "other.json",
        "diff/1",
    ),
    (
        "status many --output-format json",
        "status.json",
        "status/1",
    ),
];

/// A folder with a scene and every JSON file that the program writes.
fn folder() -> Folder {
    let folder = Folder::new();
    folder.write("a.ron", RON);
    folder.write("b.ron", "(camera: 1, geometries: [], lights: 2)");
    let strahl = |args: &str| run(&mut folder.strahl(args.split_whitespace()));
    strahl("render a.ron --size 8x8 -o small.png").quiet_success();
    fs::create_dir(folder.path("many")).unwrap();
    for (args, file, _) in WRITTEN {
        if *file == "status.json" {
            strahl("render a.ron --resume -o many/");
        }
        let done = strahl(args);
        assert!(!done.stdout.is_empty(), "{args}: {}", done.stderr);
        folder.write(file, done.stdout);
    }
    let timings = strahl("render a.ron -o b.png --timings=json").stderr;
    folder.write("timings.json", timings);
    for (format, file) in [
        ("sarif", "sarif.json"),
        ("junit", "junit.json"),
        ("github", "github.json"),
    ] {
        folder.write(
            file,
            strahl(&format!("validate b.ron --output-format {format}")).stdout,
        );
    }
    folder.write("schema.json", strahl("schema").stdout);
    fs::remove_file(folder.path("b.ron")).unwrap();
    folder
}

#[test]
fn every_object_begins_with_its_kind() {
    let folder = folder();
    let stamped = WRITTEN.iter().map(|(_, file, stamp)| (*file, *stamp));
    for (file, stamp) in stamped.chain([("timings.json", "timings/1")]) {
        let text = fs::read_to_string(folder.path(file)).unwrap();
        let first: String = text
            .chars()
            .filter(|letter| !letter.is_whitespace())
            .take(50)
            .collect();
        assert!(
            first.starts_with(&format!("{{\"strahl\":\"{stamp}\",")),
            "{file}: {text}"
        );
        let mut values = serde_json::Deserializer::from_str(&text).into_iter::<Value>();
        assert!(
            values.all(|value| value.unwrap()["strahl"] == stamp),
            "{file}"
        );
    }
    for record in fs::read_dir(folder.path("many/.strahl")).unwrap() {
        let text = fs::read_to_string(record.unwrap().path()).unwrap();
        assert!(text.lines().count() > 1);
        for line in text.lines() {
            assert!(line.starts_with(r#"{"strahl":"record/1","#), "{line}");
        }
    }
}

#[test]
fn no_report_is_mistaken_for_a_scene() {
    let folder = folder();
    let before: Vec<_> = folder
        .names()
        .iter()
        .map(|name| fs::read(folder.path(name)).ok())
        .collect();
    let done = run(&mut folder.strahl(["validate", "--deny", "warnings", "."]));
    assert_eq!(
        done.status,
        Some(0),
        "{}",
        String::from_utf8_lossy(&done.stdout)
    );
    assert_eq!(done.stderr, "1 file (14 skipped): no problems\n");
    run(&mut folder.strahl(["fmt", "."])).quiet_success();
    run(&mut folder.strahl(["fmt", "--check", "."])).quiet_success();
    let after: Vec<_> = folder
        .names()
        .iter()
        .map(|name| fs::read(folder.path(name)).ok())
        .collect();
    assert!(before == after, "a report was rewritten");
    let done = run(&mut folder.strahl(["render", ".", "-o", "out/"]));
    assert_eq!(done.status, Some(0), "{}", done.stderr);
}

#[test]
fn naming_a_report_as_a_scene_is_an_error_with_its_kind() {
    let folder = folder();
    let words = "this is a report that strahl wrote, not a scene";
    for command in ["validate", "fmt", "info", "render"] {
        let done = run(&mut folder.strahl([command, "pixel.json"]));
        let messages = String::from_utf8_lossy(&done.stdout).into_owned() + &done.stderr;
        assert_eq!(done.status, Some(1), "{command}: {messages}");
        assert!(messages.contains(words), "{command}: {messages}");
    }
    let text = "{\"geometries\": [], \"other\": 1, \"strahl\": \"later/7\"";
    folder.write("broken.json", text);
    let done = run(&mut folder.strahl(["validate", "broken.json"]));
    assert!(String::from_utf8_lossy(&done.stdout).contains(words));
}
