//! The places at which faults of options and of parameter tables are reported: a real file and its
//! line for tools, the scene in runs of several scenes.

use std::fs;

use crate::support::{Done, Folder, RON, run};

const TABLE: &str = "id,camera.fov,geometries[1].color\na,60,\nb,200,\n\nc,60,blub\n";

fn messages(folder: &Folder, args: &[&str]) -> (Done, String) {
    let done = run(&mut folder.strahl(args));
    let all = String::from_utf8_lossy(&done.stdout).into_owned() + &done.stderr;
    (done, all)
}

/// A folder with three scenes in `in`.
fn three() -> Folder {
    let folder = Folder::new();
    fs::create_dir(folder.path("in")).unwrap();
    for name in ["a", "b", "c"] {
        folder.write(format!("in/{name}.ron"), RON);
    }
    folder
}

#[test]
fn every_format_names_the_line_of_the_table() {
    let folder = Folder::with_scenes();
    folder.write("bad.csv", TABLE);
    for (format, words) in [
        (
            "short",
            &["bad.csv:3:3: error[out-of-range]: column `camera.fov`: "][..],
        ),
        (
            "short",
            &["bad.csv:5:6: error[invalid-color]: column `geometries[1].color`: "],
        ),
        (
            "github",
            &["::error file=bad.csv,line=3,endLine=3,col=3,endColumn=6,"],
        ),
        (
            "jsonl",
            &["\"file\": \"bad.csv\", \"line\": 3, \"column\": 3, "],
        ),
        (
            "json",
            &["\"file\": \"bad.csv\", \"line\": 3, \"column\": 3, "],
        ),
        (
            "sarif",
            &[
                "{\"uri\": \"bad.csv\"",
                "\"startLine\": 3, \"startColumn\": 3",
            ],
        ),
        ("junit", &["name=\"bad.csv\"", "bad.csv:3:3: error"]),
        (
            "human",
            &[
                "--> bad.csv:3:3\n",
                "3 | b,200,\n  |   ^^^",
                "5 | c,60,blub\n  |      ^^^^",
            ],
        ),
    ] {
        let args = [
            "validate",
            "scene.ron",
            "--params",
            "bad.csv",
            "--output-format",
            format,
        ];
        let (done, messages) = messages(&folder, &args);
        assert_eq!(done.status, Some(1), "{messages}");
        for word in words {
            assert!(
                messages.contains(word),
                "{format}: no {word:?} in {messages}"
            );
        }
        assert!(!messages.contains("csv:3: column"), "{format}: {messages}");
    }
}

#[test]
fn a_json_table_is_reported_with_its_lines() {
    let folder = Folder::with_scenes();
    folder.write(
        "bad.jsonl",
        "{\"camera.fov\": 60}\n\n{\"id\": 1, \"camera.fov\": 200}\n",
    );
    let args = [
        "validate",
        "scene.ron",
        "--params",
        "bad.jsonl",
        "--output-format",
        "short",
    ];
    let (_, messages) = messages(&folder, &args);
    assert!(
        messages.contains("bad.jsonl:3:11: error[out-of-range]"),
        "{messages}"
    );
}

#[test]
fn a_fault_in_a_set_value_is_reported_at_the_scene() {
    let folder = three();
    for (format, word) in [
        (
            "short",
            "in/a.ron:1:1: error[out-of-range]: --set camera.fov:1:12: ",
        ),
        (
            "github",
            "::error file=in/b.ron,line=1,endLine=1,col=1,endColumn=1,",
        ),
        (
            "jsonl",
            "\"file\": \"in/c.ron\", \"line\": 1, \"column\": 1, ",
        ),
        ("sarif", "{\"uri\": \"in/c.ron\""),
        ("junit", "name=\"in/c.ron\""),
        ("human", "--> in/c.ron: --set camera.fov:1:12\n"),
    ] {
        let args = [
            "validate",
            "in",
            "--set",
            "camera.fov=200",
            "--output-format",
            format,
        ];
        let (done, messages) = messages(&folder, &args);
        assert_eq!(done.status, Some(1), "{messages}");
        assert!(
            messages.contains(word),
            "{format}: no {word:?} in {messages}"
        );
        assert!(!messages.contains("file=--set"), "{messages}");
    }
}

#[test]
fn errors_in_runs_of_many_scenes_name_the_scene_once() {
    let folder = three();
    for option in [
        ["--frames", "0-3"],
        ["--camera", "nosuch"],
        ["--set", "geometries[30].radius=1"],
        ["--all-cameras", "--quiet"],
    ] {
        let args = [&["render", "in", "-o", "out/"], &option[..]].concat();
        let (done, messages) = messages(&folder, &args);
        assert!(matches!(done.status, Some(1 | 2)), "{messages}");
        for scene in ["in/a.ron", "in/b.ron", "in/c.ron"] {
            assert_eq!(messages.matches(scene).count(), 1, "{option:?}: {messages}");
        }
    }
    // Faults that do not depend on the scene are reported once.
    for option in [
        &["--set", "nonsense"][..],
        &["--layers", "depth"],
        &["--size", "70000x1", "--image-format", "jpg"],
    ] {
        let args = [&["render", "in", "-o", "out/"], option].concat();
        let (done, messages) = messages(&folder, &args);
        assert!(matches!(done.status, Some(1 | 2)), "{messages}");
        assert_eq!(
            messages.matches("error").count(),
            1,
            "{option:?}: {messages}"
        );
    }
}

#[test]
fn a_fault_in_an_option_is_reported_once_for_all_pictures_of_a_scene() {
    let folder = three();
    folder.write("fov.csv", "camera.fov\n10\n20\n");
    let render = [
        "render",
        "in/a.ron",
        "--params",
        "fov.csv",
        "-o",
        "{camera.fov}.png",
        "--camera",
        "nosuch",
    ];
    let (done, messages) = messages(&folder, &render);
    assert_eq!(done.status, Some(2), "{messages}");
    assert_eq!(messages.matches("unknown camera").count(), 1, "{messages}");
    for command in ["render in -o out/", "validate in"] {
        let words = command.split(' ').chain(["--set", "camera.fov=["]);
        let (_, messages) = self::messages(&folder, &words.collect::<Vec<_>>());
        assert_eq!(messages.matches("expected `]`").count(), 1, "{messages}");
    }
}

#[test]
fn a_table_that_cannot_be_read_has_its_place_in_every_format() {
    let folder = three();
    folder.write("short.csv", "camera.fov,id\n10,1\n20\n");
    folder.write("wrong.jsonl", "{\"id\": 1}\n{\"id\": }\n");
    for (table, format, place) in [
        ("short.csv", "github", "file=short.csv,line=3"),
        ("short.csv", "short", "short.csv:3:1: error[invalid-table]"),
        ("wrong.jsonl", "jsonl", "\"line\": 2, \"column\": 8"),
        ("none.csv", "sarif", "\"none.csv\""),
        ("short.csv", "junit", "short.csv"),
    ] {
        let args = [
            "validate",
            "in",
            "--params",
            table,
            "--output-format",
            format,
        ];
        let (done, messages) = messages(&folder, &args);
        assert_eq!(done.status, Some(2), "{messages}");
        assert!(messages.contains(place), "{format}: {messages}");
        assert!(!messages.contains("error: "), "{messages}");
    }
}

#[test]
fn an_unused_column_is_reported() {
    let folder = three();
    folder.write("z.csv", "id,fov,label,radius\na,10,x,1\nb,90,y,2\n");
    let args = ["render", "in", "--params", "z.csv", "-o", "out/"];
    let (done, all) = messages(&folder, &args);
    assert_eq!(done.status, Some(0), "{all}");
    for words in [
        "warning[unused-column]: column `fov` is not used",
        "--> z.csv:1:4\n",
        "did you mean `camera.fov`?",
        "column `label` is not used",
        "did you mean `geometries[1].radius`?",
    ] {
        assert_eq!(all.matches(words).count(), 1, "{words}: {all}");
    }
    let (_, all) = messages(&folder, &[&args[..], &["--quiet"]].concat());
    assert_eq!(all, "");
    let named = [
        "render",
        "in",
        "--params",
        "z.csv",
        "-o",
        "{scene}_{id}{fov}{label}{radius}.png",
    ];
    let (_, all) = messages(&folder, &named);
    assert!(!all.contains("unused-column"), "{all}");
    // Without a pattern, any word that is not a field can be a name.
    let validate = [
        "validate",
        "in",
        "--params",
        "z.csv",
        "--output-format",
        "short",
    ];
    let (done, all) = messages(&folder, &validate);
    assert_eq!(done.status, Some(0), "{all}");
    assert!(
        all.contains("z.csv:1:4: warning[unused-column]: column `fov`"),
        "{all}"
    );
    assert!(all.contains("z.csv:1:14: warning[unused-column]"), "{all}");
    assert!(!all.contains("`label`"), "{all}");
    for (level, status) in [("--deny", 1), ("--allow", 0)] {
        let (done, all) = messages(
            &folder,
            &[&validate[..], &[level, "unused-column"]].concat(),
        );
        assert_eq!(done.status, Some(status), "{all}");
        assert_eq!(all.contains("unused-column"), status == 1, "{all}");
    }
    folder.write(
        "a.ron",
        RON.replace("(\n", "(\n allow: [\"unused-column\"],\n"),
    );
    let (_, all) = messages(&folder, &["validate", "a.ron", "--params", "z.csv"]);
    assert!(!all.contains("unused-column"), "{all}");
    // A JSON table whose first row lacks the column.
    folder.write("z.jsonl", "{\"camera.fov\": 60}\n{\"fov\": 10}\n");
    let args = [
        "render", "in/a.ron", "--params", "z.jsonl", "-o", "{id}.png",
    ];
    let (_, all) = messages(&folder, &args);
    assert!(all.contains("--> z.jsonl:2:2\n"), "{all}");
    folder.write("strahl.toml", "deny = [\"unused-column\"]\n");
    let (done, messages) = self::messages(&folder, &args);
    assert_eq!(done.status, Some(1), "{messages}");
    assert!(messages.contains("0 drawn"), "{messages}");
}

#[test]
fn a_path_that_leads_nowhere_is_reported_once_at_its_column() {
    let folder = Folder::with_scenes();
    let rows: String = (0..2000).map(|row| format!("{row},60,1\n")).collect();
    folder.write(
        "t.csv",
        format!("id,camera.fvo,geometries[9].radius\n{rows}"),
    );
    let rows = (0..2000).map(|_| "{\"camera.fvo\": 60, \"geometries[9].radius\": 1}\n");
    folder.write("t.jsonl", rows.collect::<String>());
    for (table, columns) in [("t.csv", [4, 15]), ("t.jsonl", [2, 20])] {
        let short = ["--output-format", "short", "--params", table];
        let (done, all) = messages(&folder, &[&["validate", "scene.ron"], &short[..]].concat());
        assert_eq!(done.status, Some(1), "{all}");
        let [fov, radius] =
            columns.map(|column| format!("{table}:1:{column}: error[unknown-path]"));
        let lines: Vec<&str> = all.lines().collect();
        assert_eq!(lines.len(), 3, "{all}");
        assert!(
            lines[0].starts_with(&fov) && lines[1].starts_with(&radius),
            "{all}"
        );
        assert!(
            lines[0].contains("column `camera.fvo`: unknown field `fvo`"),
            "{all}"
        );
        let render = ["render", "scene.ron", "--params", table, "-o", "out/"];
        let (done, all) = messages(&folder, &render);
        assert_eq!(done.status, Some(1), "{all}");
        assert_eq!(all.matches("unknown-path").count(), 2, "{all}");
        assert!(
            all.contains("did you mean `fov`?") && all.len() < 2000,
            "{all}"
        );
    }
}

#[test]
fn a_bad_column_hides_no_other_fault() {
    let folder = Folder::with_scenes();
    // A scale is a field of the camera that the first row sets.
    let camera = "\"Orthographic(eye: (0, 0, 9), gaze: (0, 0, -1), scale: 4)\"";
    folder.write(
        "t.csv",
        format!("camera.fvo,camera,camera.scale,image.width\n1,{camera},2,8\n1,,2,0\n"),
    );
    let args = [
        "validate",
        "scene.ron",
        "--params",
        "t.csv",
        "--output-format",
        "short",
    ];
    let (_, all) = messages(&folder, &args);
    for fault in [
        "t.csv:3:4: error[unknown-path]: column `camera.scale`",
        "t.csv:3:6: error[out-of-range]: column `image.width`",
    ] {
        assert_eq!(all.matches(fault).count(), 1, "{fault}: {all}");
    }
}

#[test]
fn a_fault_of_the_scene_is_reported_once_for_all_rows() {
    let folder = Folder::new();
    let scene = RON.replace("radius: 0.5", "radius: 0.5, material: Named(\"red\")");
    let scene = scene.replace(", color: \"#ff0000\"", "");
    folder.write(
        "a.ron",
        scene.replace("image:", "materials: {\"red\": Mirror()}, image:"),
    );
    folder.write("t.csv", "materials,image.width\n{},8\n{},9\n{},10\n");
    let args = [
        "validate",
        "a.ron",
        "--params",
        "t.csv",
        "--output-format",
        "short",
    ];
    let (_, all) = messages(&folder, &args);
    assert_eq!(all.matches("unknown-name").count(), 1, "{all}");
}

#[test]
fn no_more_faults_of_a_table_are_listed_than_wanted() {
    let folder = Folder::with_scenes();
    folder.write("t.csv", "camera.fov\n".to_owned() + &"200\n".repeat(300));
    for (most, listed) in [(None, 100), (Some("7"), 7)] {
        let mut args = vec![
            "validate",
            "scene.ron",
            "--params",
            "t.csv",
            "--output-format",
            "short",
        ];
        args.extend(most.iter().flat_map(|most| ["--max-diagnostics", most]));
        let (_, all) = messages(&folder, &args);
        assert_eq!(all.matches("error[out-of-range]").count(), listed, "{all}");
        let more = format!("t.csv: … and {} more errors in this file", 300 - listed);
        assert!(all.contains(&more), "{all}");
        assert!(all.contains("300 errors"), "{all}");
    }
}

#[test]
fn an_empty_cell_of_a_name_is_called_empty() {
    let folder = Folder::with_scenes();
    folder.write("t.csv", "id,camera.fov\na,60\n,70\n");
    let args = ["render", "scene.ron", "--params", "t.csv", "-o", "{id}.png"];
    let (done, all) = messages(&folder, &args);
    assert_eq!(done.status, Some(2));
    assert!(
        all.contains("t.csv:3: column id: the cell is empty"),
        "{all}"
    );
}
