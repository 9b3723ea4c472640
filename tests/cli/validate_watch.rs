//! `strahl validate --watch`.

use std::{fs, os::unix::fs::symlink};

use crate::{
    support::{Folder, JSON, RON, until},
    watch::Watching,
};

#[test]
fn a_scene_is_checked_again() {
    let folder = Folder::new();
    folder.write("scene.ron", RON);
    let args = [
        "validate",
        "--watch",
        "scene.ron",
        "--output-format",
        "jsonl",
    ];
    let mut watching = Watching::new(folder.strahl(args));
    until("a report", || {
        watching.stderr().contains("1 file: no problems\nwaiting")
    });
    watching.expect("changed: scene.ron\n1 file: 1 error\nwaiting", || {
        folder.write("scene.ron", RON.replace("radius", "radios"));
    });
    watching.expect("no problems\nwaiting", || {
        folder.write("scene.ron", RON);
    });
    let stdout = watching.stdout();
    watching.end();
    for line in stdout.lines() {
        let found: serde_json::Value = serde_json::from_str(line).unwrap();
        assert_eq!(found["code"], "unknown-field");
    }
    assert!(!stdout.is_empty());
}

#[test]
fn a_folder_is_checked_again() {
    let folder = Folder::with_scenes();
    folder.write(".gitignore", "ignored*\n");
    let args = ["validate", "--watch", ".", "--output-format", "json"];
    let mut watching = Watching::new(folder.strahl(args));
    until("a report", || {
        watching.stderr().contains("2 files: no problems\nwaiting")
    });
    watching.expect("changed: ./new.ron\n3 files: 1 error", || {
        folder.write("notes.txt", "");
        folder.write("ignored.ron", "");
        folder.write(".hidden.ron", "");
        folder.write("new.ron", RON.replace("radius", "radios"));
    });
    watching.expect("changed: ./new.ron\n2 files: no problems", || {
        fs::remove_file(folder.path("new.ron")).unwrap();
    });
    let table = "Spheres(file: \"atoms.csv\", radius: 1, color: \"#f00\"),\n]";
    fs::create_dir(folder.path("deep")).unwrap();
    watching.expect("changed: ./deep/a.ron\n3 files: 1 error", || {
        folder.write("deep/a.ron", RON.replace("    ]", table));
    });
    watching.expect("atoms.csv\n3 files: no problems", || {
        folder.write("new", "x,y,z\n0,0,-5\n");
        fs::rename(folder.path("new"), folder.path("deep/atoms.csv")).unwrap();
    });
    watching.expect("a.ron\n2 files: no problems", || {
        fs::rename(folder.path("deep"), folder.path(".deep")).unwrap();
    });
    watching.expect("strahl.toml\n1 file: no problems", || {
        folder.write("strahl.toml", "exclude = [\"*.json\"]\n");
    });
    watching.expect("1 file: 1 error\nwaiting", || {
        folder.write("scene.json", "");
        folder.write("scene.ron", RON.replace("radius", "radios"));
    });
    // The two streams are read apart.
    until("all reports", || {
        let stdout = watching.stdout();
        stdout.ends_with("}\n") && stdout.matches("\"summary\"").count() >= 8
    });
    let stdout = watching.stdout();
    let stderr = watching.end();
    assert!(!stderr.contains("ignored"), "{stderr}");
    let reports = serde_json::Deserializer::from_str(&stdout).into_iter::<serde_json::Value>();
    let reports: Vec<_> = reports.map(Result::unwrap).collect();
    assert!(reports.len() >= 8, "{stdout}");
    assert_eq!(reports[0]["summary"]["errors"], 0);
    assert_eq!(reports.last().unwrap()["summary"]["errors"], 1);
}

#[test]
fn a_report_in_the_folder_is_not_a_change() {
    let folder = Folder::with_scenes();
    let script = "exec $STRAHL validate --watch . --output-format json > report.json";
    let mut watching = Watching::new(folder.shell(script));
    until("a report", || watching.stderr().contains("waiting"));
    for _ in 0..2 {
        watching.expect("scene.ron\n", || {
            folder.write("scene.ron", RON);
        });
    }
    let stderr = watching.end();
    assert!(!stderr.contains("changed: ./report.json"), "{stderr}");
}

#[test]
fn links_and_lists_are_followed() {
    let folder = Folder::new();
    fs::create_dir(folder.path("real")).unwrap();
    fs::create_dir(folder.path("scenes")).unwrap();
    folder.write("real/a.json", JSON);
    symlink("../real/a.json", folder.path("scenes/a.json")).unwrap();
    folder.write("list", "scenes\n");
    let args = ["validate", "--watch", "--files-from", "list"];
    let mut watching = Watching::new(folder.strahl(args));
    until("a report", || {
        watching.stderr().contains("1 file: no problems\nwaiting")
    });
    watching.expect("changed: scenes/a.json\n1 file: 1 error", || {
        folder.write("real/a.json", JSON.replace("radius", "radios"));
    });
    watching.expect("changed: list\n2 files: 2 errors", || {
        folder.write("list", "scenes\nreal\n");
    });
    watching.end();
}
