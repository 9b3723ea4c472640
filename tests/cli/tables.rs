//! Scenes with tables.

use std::fs;

use crate::support::{Folder, RON, run, run_with};

const TABLE: &str = "x,y,z,radius,color\n0,0,-4,1,#ff0000\n0,0,-9,20,#0000ff\n";

/// A scene with a table and a plane behind it.
fn scene(file: &str) -> String {
    format!(
        "(
    image: (width: 9, height: 9),
    camera: Perspective(eye: (0, 0, 20), gaze: (0, 0, -1), fov: 90),
    geometries: [
        Spheres(file: \"{file}\"),
        Plane(point: (0, 0, -90), normal: (0, 0, 1), color: \"#00ff00\"),
    ],
)
"
    )
}

/// A folder `scenes` with a scene that names this table.
fn folder(file: &str) -> Folder {
    let folder = Folder::new();
    fs::create_dir(folder.path("scenes")).unwrap();
    folder.write("scenes/a.ron", scene(file));
    folder
}

const RENDER: [&str; 5] = ["render", "scenes/a.ron", "-o", "-", "--quiet"];

/// Runs the three commands that read tables, each with an additional option.
fn commands(option: &'static str) -> [Vec<&'static str>; 3] {
    let option = |mut command: Vec<&'static str>| {
        command.extend((!option.is_empty()).then_some(option));
        command
    };
    [
        option(vec!["render", "scenes/a.ron", "-o", "-"]),
        option(vec!["pixel", "scenes/a.ron", "4,4"]),
        option(vec!["validate", "scenes/a.ron", "--output-format", "short"]),
    ]
}

#[track_caller]
fn allowed(folder: &Folder, option: &'static str) {
    for command in commands(option) {
        let done = run(&mut folder.strahl(&command));
        assert_eq!(done.status, Some(0), "{command:?}: {}", done.stderr);
    }
}

#[track_caller]
fn refused(folder: &Folder, option: &'static str, words: &[&str]) {
    for command in commands(option) {
        let done = run(&mut folder.strahl(&command));
        assert_eq!(done.status, Some(1), "{command:?}: {}", done.stderr);
        let messages = done.stderr.clone() + &String::from_utf8_lossy(&done.stdout);
        for word in words {
            assert!(
                messages.contains(word),
                "{command:?}: no {word:?} in: {messages}"
            );
        }
        done.no_panic();
    }
}

#[test]
fn a_table_path_is_relative_to_its_scene() {
    let folder = folder("data/atoms.csv");
    fs::create_dir(folder.path("scenes/data")).unwrap();
    folder.write("scenes/data/atoms.csv", TABLE);
    allowed(&folder, "");
    allowed(&folder, "--allow-outside");
    let picture = run(&mut folder.strahl(RENDER)).quiet_success();
    folder.write(
        "listed.ron",
        scene("").replace(
            "Spheres(file: \"\")",
            "Sphere(center: (0, 0, -4), radius: 1, color: \"#ff0000\"), Sphere(center: (0, 0, -9), \
         radius: 20, color: \"#0000ff\")",
        ),
    );
    let listed = run(&mut folder.strahl(["render", "listed.ron", "-o", "-"]));
    assert_eq!(picture, listed.quiet_success());
}

#[test]
fn a_table_outside_the_folder_is_rejected_unless_allowed() {
    let folder = folder("../atoms.csv");
    refused(
        &folder,
        "",
        &["[outside-folder]", "`../atoms.csv`", "a.ron:5:23"],
    );
    refused(
        &folder,
        "--allow-outside",
        &["[file-not-found]", "no such file"],
    );
    folder.write("atoms.csv", TABLE);
    refused(&folder, "", &["[outside-folder]"]);
    allowed(&folder, "--allow-outside");

    let absolute = folder.path("atoms.csv");
    folder.write(
        "scenes/a.ron",
        scene(&absolute.to_str().unwrap().replace('\\', "/")),
    );
    refused(&folder, "", &["[outside-folder]", "the path is absolute"]);
    allowed(&folder, "--allow-outside");
}

#[cfg(unix)]
#[test]
fn a_link_out_of_the_folder_is_rejected_unless_allowed() {
    use std::os::unix::fs::symlink;

    let folder = folder("data/atoms.csv");
    fs::create_dir(folder.path("elsewhere")).unwrap();
    folder.write("elsewhere/atoms.csv", TABLE);
    symlink(folder.path("elsewhere"), folder.path("scenes/data")).unwrap();
    refused(&folder, "", &["[outside-folder]", "a link leads out"]);
    allowed(&folder, "--allow-outside");

    // A link that stays inside the folder works like a file.
    fs::remove_file(folder.path("scenes/data")).unwrap();
    fs::create_dir(folder.path("scenes/data")).unwrap();
    folder.write("scenes/real.csv", TABLE);
    symlink("../real.csv", folder.path("scenes/data/atoms.csv")).unwrap();
    allowed(&folder, "");

    // A scene folder that is itself a link does not count as outside.
    symlink("scenes", folder.path("other")).unwrap();
    let done = run(&mut folder.strahl(["validate", "other/a.ron"]));
    assert_eq!(done.status, Some(0), "{}", done.stderr);
}

#[cfg(unix)]
#[test]
fn only_regular_files_are_opened() {
    use std::{os::unix::fs::symlink, process::Command};

    let folder = folder("atoms.csv");
    refused(&folder, "", &["[file-not-found]", "no such file"]);
    fs::create_dir(folder.path("scenes/atoms.csv")).unwrap();
    refused(&folder, "", &["[file-not-found]", "is a folder"]);
    fs::remove_dir(folder.path("scenes/atoms.csv")).unwrap();
    let pipe = Command::new("mkfifo")
        .arg(folder.path("scenes/atoms.csv"))
        .status();
    if pipe.is_ok_and(|status| status.success()) {
        refused(&folder, "", &["[file-not-found]", "not a regular file"]);
        fs::remove_file(folder.path("scenes/atoms.csv")).unwrap();
    }
    symlink("/dev/zero", folder.path("scenes/atoms.csv")).unwrap();
    refused(
        &folder,
        "--allow-outside",
        &["[file-not-found]", "not a regular file"],
    );
}

#[test]
fn standard_input_finds_its_tables_in_the_current_folder() {
    let folder = Folder::new();
    folder.write("atoms.csv", TABLE);
    let render = ["render", "-", "-o", "-"];
    let done = run_with(&mut folder.strahl(render), scene("atoms.csv").as_bytes());
    assert_eq!(done.status, Some(0), "{}", done.stderr);
    for command in [vec!["render", "-", "-o", "a.png"], vec!["validate", "-"]] {
        let done = run_with(
            &mut folder.strahl(command),
            scene("../atoms.csv").as_bytes(),
        );
        assert_eq!(done.status, Some(1));
        let messages = done.stderr + &String::from_utf8_lossy(&done.stdout);
        assert!(
            messages.contains("[outside-folder]") && messages.contains("<stdin>"),
            "{messages}"
        );
    }
}

#[test]
fn faults_name_file_row_and_column() {
    let folder = folder("atoms.csv");
    folder.write("scenes/atoms.csv", TABLE.replace("-9,20", "-9,-20"));
    let words = [
        "a.ron:5:23",
        "scenes/atoms.csv:3:8",
        "row 1 (line 3), column `radius`",
        "`-20`",
    ];
    refused(&folder, "", &words);
    // The first rows are listed, regardless of their number.
    let many = format!("x,y,z,radius,color\n{}", "0,0,nan,-1,#000\n".repeat(5000));
    folder.write("scenes/atoms.csv", many);
    let done = run(&mut folder.strahl(["validate", "scenes", "--output-format", "short"]));
    let messages = String::from_utf8(done.stdout).unwrap();
    assert_eq!(messages.lines().count(), 101, "{messages}");
    for fault in [
        "atoms.csv:2:5: error[invalid-table]: row 0 (line 2), column `z`",
        "atoms.csv:51:9: error[invalid-table]: row 49 (line 51), column `radius`",
        "a.ron: … and 100 more errors in this file",
    ] {
        assert!(messages.contains(fault), "{fault}: {messages}");
    }
}

#[test]
fn a_pixel_reports_the_row() {
    let folder = folder("atoms.csv");
    folder.write("scenes/atoms.csv", TABLE);
    let done = run(&mut folder.strahl(["pixel", "scenes/a.ron", "4,4"]));
    let text = String::from_utf8(done.quiet_success()).unwrap();
    for line in [
        "  [0] row 0 Sphere, center c (0.0, 0.0, -4.0)",
        "  [0] row 1 Sphere, center c (0.0, 0.0, -9.0)",
        "  [1] Plane, point a",
        "  [0] row 1 at t = 9.0, the smallest",
    ] {
        assert!(text.contains(line), "no {line:?} in: {text}");
    }
    let json = ["pixel", "scenes/a.ron", "4,4", "--output-format", "json"];
    let json = run(&mut folder.strahl(json)).quiet_success();
    let json: serde_json::Value = serde_json::from_slice(&json).unwrap();
    assert_eq!(json["hit"]["index"], 0);
    assert_eq!(json["hit"]["row"], 1);
    assert_eq!(json["geometries"][2]["index"], 1);
    assert_eq!(json["geometries"][2].get("row"), None);
    assert_eq!(json["geometries"][2].get("name"), None);
}

#[test]
fn a_pixel_reports_names() {
    let folder = folder("atoms.csv");
    folder.write("scenes/atoms.csv", TABLE);
    let scene = fs::read_to_string(folder.path("scenes/a.ron")).unwrap();
    let named = scene.replace("\"atoms.csv\"", "\"atoms.csv\", name: \"water\"");
    assert_ne!(named, scene);
    folder.write("scenes/a.ron", named);
    let done = run(&mut folder.strahl(["pixel", "scenes/a.ron", "4,4"]));
    let text = String::from_utf8(done.quiet_success()).unwrap();
    assert!(text.contains("  [0] row 1 \"water\" at t = 9.0"), "{text}");
    assert!(text.contains("  [1] Plane, point a"), "{text}");
    let json = ["pixel", "scenes/a.ron", "4,4", "--output-format", "json"];
    let json = run(&mut folder.strahl(json)).quiet_success();
    let json: serde_json::Value = serde_json::from_slice(&json).unwrap();
    assert_eq!(json["hit"]["name"], "water");
}

#[test]
fn formatting_and_conversion_do_not_read_the_table() {
    let folder = folder("missing.npy");
    let done = run(&mut folder.strahl(["fmt", "scenes/a.ron", "--check"]));
    assert_eq!(done.quiet_success(), b"");
    let done = run(&mut folder.strahl(["convert", "scenes/a.ron", "scenes/b.json"]));
    assert_eq!(done.quiet_success(), b"");
    let json = fs::read_to_string(folder.path("scenes/b.json")).unwrap();
    assert!(
        json.contains("{\"Spheres\": {\"file\": \"missing.npy\"}}"),
        "{json}"
    );
    // In another folder, the same name is a different table.
    let done = run(&mut folder.strahl(["convert", "scenes/a.ron", "b.json"]));
    assert_eq!(done.status, Some(0));
    assert!(
        done.stderr.starts_with("note: the table `missing.npy`"),
        "{}",
        done.stderr
    );
    assert_eq!(fs::read_to_string(folder.path("b.json")).unwrap(), json);
    let back = run(&mut folder.strahl(["convert", "b.json", "-", "--to", "ron"]));
    let back = String::from_utf8(back.quiet_success()).unwrap();
    assert_eq!(
        back,
        fs::read_to_string(folder.path("scenes/a.ron")).unwrap()
    );
}

#[test]
fn a_folder_is_searched_for_scenes_and_not_for_tables() {
    let folder = folder("atoms.csv");
    folder.write("scenes/atoms.csv", TABLE);
    folder.write("scenes/broken.npy", "no table at all");
    folder.write("scenes/b.ron", RON);
    let done = run(&mut folder.strahl(["validate", "scenes"]));
    assert_eq!(done.status, Some(0), "{}", done.stderr);
    assert!(done.stderr.contains('2'), "{}", done.stderr);
}

#[test]
fn cylinders_are_told_and_changed_like_spheres() {
    let folder = Folder::new();
    folder.write(
        "pipes.csv",
        "x1,y1,z1,x2,y2,z2,length\n9,0,-4,9,0,-3,1\n0,0,-4,0,0,-3,1\n0,0,-9,0,0,-7,2\n",
    );
    let scene = "(
    image: (width: 9, height: 9),
    camera: Perspective(eye: (0, 0, 5), gaze: (0, 0, -1), fov: 90),
    geometries: [
        Plane(point: (0, 0, -90), normal: (0, 0, 1), color: \"#00ff00\"),
        Cylinders(file: \"pipes.csv\", radius: 1, color_by: (column: \"length\", map: Gray), \
                 name: \"pipes\"),
    ],
)
";
    folder.write("a.ron", scene);
    let output = |args: &[&str]| {
        let done = run(&mut folder.strahl(args));
        assert_eq!(done.status, Some(0), "{args:?}: {}", done.stderr);
        String::from_utf8(done.stdout).unwrap()
    };
    let info = output(&["info", "a.ron"]);
    for line in [
        "geometries     4: 1 plane, 3 rows of 1 table",
        "  geometries[1] \"pipes\": 3 rows of \"pipes.csv\", columns x1, y1, z1, x2, y2, z2, length",
    ] {
        assert!(info.contains(line), "no {line:?} in: {info}");
    }
    let pixel = output(&["pixel", "a.ron", "4,4"]);
    for line in [
        "  [1] row 1 \"pipes\" Cylinder, from a (0.0, 0.0, -4.0)",
        "  [1] row 1 \"pipes\" at t = 8.0, the smallest",
    ] {
        assert!(pixel.contains(line), "no {line:?} in: {pixel}");
    }
    // Through the open tubes, the plane is seen.
    let open = output(&[
        "pixel",
        "a.ron",
        "4,4",
        "--set",
        "geometries.pipes.capped=false",
    ]);
    assert!(open.contains("  [0] at t = 95.0, the smallest"), "{open}");
    output(&["legend", "a.ron", "-o", "legend.svg"]);
    let legend = fs::read_to_string(folder.path("legend.svg")).unwrap();
    assert!(legend.contains(">length</text>"), "{legend}");
}
