//! Scenes made of parts, which are other scene files.

use std::fs;

use serde_json::{Value, json};

use crate::support::{Done, Folder, run};

const CAMERA: &str = "image: (width: 32, height: 24),
    camera: Perspective(eye: (0, 0, 6), gaze: (0, 0, -1), fov: 60),";

const TREE: &str = r##"(
    materials: {"paint": Matte(color: "#804000")},
    geometries: [
        Sphere(center: (-1, 0, 0), radius: 1, material: Named("paint"), name: "trunk"),
        Part(file: "inner/leaf.json"),
        Spheres(file: "inner/atoms.csv", radius: 0.3, color: "#00ff00", name: "atoms"),
    ],
)"##;

const LEAF: &str =
    r##"{"geometries": [{"Sphere": {"center": [0, 1, 0], "radius": 0.7, "color": "#ffff00"}}]}"##;

const ATOMS: &str = "x,y,z\n1,-1,0\n1.5,-1,0\n";

fn main(geometries: &str) -> String {
    format!(
        "(\n    {CAMERA}\n    materials: {{\"paint\": Matte(color: \"#ff0000\")}},\n    geometries: \
         [{geometries}],\n)\n"
    )
}

const MAIN: &str = r##"
        Sphere(center: (2, 1, 0), radius: 0.8, material: Named("paint"), name: "ball"),
        Part(file: "tree.ron", name: "tree"),
        Sphere(center: (2, -2, 0), radius: 0.8, color: "#0000ff"),
    "##;

/// A folder with `main.ron`, the part `tree.ron`, and the files that this names.
fn folder() -> Folder {
    let folder = Folder::new();
    fs::create_dir(folder.path("inner")).unwrap();
    folder.write("main.ron", main(MAIN));
    folder.write("tree.ron", TREE);
    folder.write("inner/leaf.json", LEAF);
    folder.write("inner/atoms.csv", ATOMS);
    folder
}

fn strahl(folder: &Folder, args: &str) -> Done {
    run(&mut folder.strahl(args.split(' ')))
}

#[track_caller]
fn text(folder: &Folder, args: &str) -> String {
    String::from_utf8(strahl(folder, args).quiet_success()).unwrap()
}

#[track_caller]
fn json(folder: &Folder, args: &str) -> Value {
    serde_json::from_slice(&strahl(folder, args).quiet_success()).unwrap()
}

/// Returns the result of `strahl validate --output-format short`: its lines.
fn validate(folder: &Folder, args: &str) -> (Option<i32>, Vec<String>) {
    let done = strahl(folder, &format!("validate --output-format short {args}"));
    done.no_panic();
    let lines = String::from_utf8(done.stdout).unwrap();
    (done.status, lines.lines().map(str::to_owned).collect())
}

#[test]
fn a_picture_of_parts_is_that_of_their_geometries() {
    let folder = folder();
    let listed = r##"
        Sphere(center: (2, 1, 0), radius: 0.8, color: "#ff0000"),
        Sphere(center: (-1, 0, 0), radius: 1, color: "#804000"),
        Sphere(center: (0, 1, 0), radius: 0.7, color: "#ffff00"),
        Sphere(center: (1, -1, 0), radius: 0.3, color: "#00ff00"),
        Sphere(center: (1.5, -1, 0), radius: 0.3, color: "#00ff00"),
        Sphere(center: (2, -2, 0), radius: 0.8, color: "#0000ff"),
    "##;
    folder.write("listed.ron", main(listed));
    for layer in ["", " --layers id", " --layers depth --depth-range 1,9"] {
        let draw = |scene| strahl(&folder, &format!("render {scene} -o - -q{layer}"));
        let picture = draw("main.ron").quiet_success();
        assert_eq!(picture, draw("listed.ron").quiet_success(), "{layer}");
    }
    // A ray goes to a geometry of the file, whatever its place among the files.
    folder.write("main.ron", main(MAIN).replace("tree.ron", "./tree.ron"));
    strahl(&folder, "validate main.ron").quiet_validation();
}

impl Done {
    /// Asserts that a validation found nothing.
    #[track_caller]
    fn quiet_validation(self) {
        assert_eq!(self.status, Some(0), "{}", self.stderr);
        assert!(
            self.stdout.is_empty(),
            "{:?}",
            String::from_utf8(self.stdout)
        );
    }
}

#[test]
fn geometries_are_named_with_their_files() {
    let folder = folder();
    let pixel = json(&folder, "pixel main.ron 11,12 --output-format json");
    let trunk = json!([{"file": "tree.ron", "geometry": 0, "row": null, "name": "trunk"}]);
    assert_eq!(pixel["hit"]["index"], 1);
    assert_eq!(pixel["hit"]["name"], "tree");
    assert_eq!(pixel["hit"]["parts"], trunk);
    assert_eq!(pixel["geometries"][0]["parts"], Value::Null);
    let row = json!([{"file": "tree.ron", "geometry": 2, "row": 1, "name": "atoms"}]);
    assert_eq!(pixel["geometries"][4]["parts"], row);
    let leaf = json!([
        {"file": "tree.ron", "geometry": 1, "row": null, "name": null},
        {"file": "inner/leaf.json", "geometry": 0, "row": null, "name": null},
    ]);
    assert_eq!(pixel["geometries"][2]["parts"], leaf);
    let pixel = text(&folder, "pixel main.ron 11,12");
    let hit = "\n  [1] \"tree\", \"tree.ron\" geometries[0] \"trunk\" at t = ";
    assert!(pixel.contains(hit), "{pixel}");

    let report = json(&folder, "render main.ron -o main.png --report -");
    let of_id = |id| {
        let all = report["geometries"].as_array().unwrap();
        all.iter().find(|one| one["id"] == id).unwrap()
    };
    assert_eq!(
        (&of_id(0)["name"], &of_id(0)["parts"]),
        (&json!("ball"), &Value::Null)
    );
    assert_eq!(
        (&of_id(1)["geometry"], &of_id(1)["parts"]),
        (&json!(1), &trunk)
    );
    // Ids count the geometries in the order of the file.
    assert_eq!(of_id(5)["geometry"], 2);
}

#[test]
fn info_lists_what_depends_on_what() {
    let folder = folder();
    let shown = text(&folder, "info main.ron");
    for line in [
        "               \"tree.ron\", ",
        "\"inner/leaf.json\", 86 bytes, used by \"tree.ron\"\n",
        "\"inner/atoms.csv\", 22 bytes, used by \"tree.ron\"\n",
        "geometries     6: 2 spheres, 4 of 1 part\n",
        "  geometries[1] \"tree\": 4 geometries of \"tree.ron\"\n",
    ] {
        assert!(shown.contains(line), "{line:?} in {shown}");
    }
    let info = json(&folder, "info main.ron --output-format json");
    let files = info["files"].as_array().unwrap().iter();
    let files: Vec<_> = files
        .map(|file| (&file["file"], &file["used_by"]))
        .collect();
    let expected = [
        (json!("main.ron"), json!([])),
        (json!("tree.ron"), json!(["main.ron"])),
        (json!("inner/leaf.json"), json!(["tree.ron"])),
        (json!("inner/atoms.csv"), json!(["tree.ron"])),
    ];
    assert!(
        files.into_iter().eq(expected.iter().map(|(a, b)| (a, b))),
        "{info:#}"
    );
    let parts = json!([
        {"geometry": 1, "name": "tree", "file": "tree.ron", "geometries": 4, "first_id": 1}
    ]);
    assert_eq!(info["geometries"]["parts"], parts);
    assert_eq!(info["geometries"]["tables"], json!([]));
}

#[test]
fn a_file_named_by_two_paths_is_listed_once() {
    let folder = folder();
    let named = |paths: &[&str]| {
        let parts = paths.iter().enumerate().map(|(index, path)| {
            format!("Part(file: \"{path}\", transform: (translate: (0, 0, -{index})))")
        });
        folder.write("main.ron", main(&parts.collect::<Vec<_>>().join(", ")));
        let files = json(&folder, "info main.ron --output-format json");
        let files = files["files"].as_array().unwrap().iter();
        let files = files.map(|file| file["file"].as_str().unwrap().to_owned());
        files.collect::<Vec<_>>()
    };
    let rest = ["inner/leaf.json", "inner/atoms.csv"];
    let expected = [&["main.ron", "tree.ron"], &rest[..]].concat();
    assert_eq!(named(&["tree.ron", "inner/../tree.ron"]), expected);
    assert_eq!(named(&["./inner/../tree.ron", "tree.ron"]), expected);
    // Behind a link, `..` leads elsewhere.
    #[cfg(unix)]
    {
        fs::create_dir_all(folder.path("far/inner")).unwrap();
        folder.write("far/tree.ron", "(geometries: [])");
        std::os::unix::fs::symlink("far/inner", folder.path("link")).unwrap();
        let expected = ["main.ron", "tree.ron", "link/../tree.ron"];
        let expected = [&expected[..], &rest].concat();
        assert_eq!(named(&["tree.ron", "link/../tree.ron"]), expected);
    }
}

#[test]
fn a_depfile_lists_every_file() {
    let folder = folder();
    let empty = "\ntree.ron:\n\ninner/leaf.json:\n\ninner/atoms.csv:\n";
    let files = "\\\n  tree.ron \\\n  inner/leaf.json \\\n  inner/atoms.csv\n";
    strahl(&folder, "info main.ron --depfile main.d");
    let depfile = fs::read_to_string(folder.path("main.d")).unwrap();
    assert_eq!(depfile, format!("main.ron: {files}{empty}"));
    strahl(&folder, "render main.ron -o out.png --depfile out.d").quiet_success();
    let depfile = fs::read_to_string(folder.path("out.d")).unwrap();
    assert_eq!(
        depfile,
        format!("out.png: \\\n  main.ron {files}\nmain.ron:\n{empty}")
    );

    strahl(&folder, "render main.ron -o out.png --depfile tree.ron").failure(2, &["tree.ron"]);
    strahl(&folder, "render main.ron -o out.png --report tree.ron").failure(2, &["tree.ron"]);
    strahl(&folder, "info main.ron --depfile main.ron").failure(2, &["main.ron"]);
    strahl(&folder, "render main.ron -o - --depfile a.d").failure(2, &["--depfile"]);
    strahl(&folder, "render . -o out/ --depfile a.d").failure(2, &["--depfile"]);
    assert_eq!(fs::read_to_string(folder.path("tree.ron")).unwrap(), TREE);
}

#[test]
fn faults_of_a_part_are_reported_in_its_file() {
    let folder = folder();
    folder.write(
        "tree.ron",
        TREE.replace("radius: 1,", "radius: -1, radiu: 3,"),
    );
    let expected = [
        "main.ron:7:20: error[invalid-part]: `tree.ron` has 2 errors (geometry `tree`)",
        "tree.ron:4:44: error[out-of-range]: `radius` must be above 0, found `-1` (geometry `trunk`)",
        "tree.ron:4:48: error[unknown-field]: unknown field `radiu`, expected one of `center`, \
         `radius`, `color`, `texture`, `material`, `transform`, `name` (geometry `trunk`)",
    ];
    let (status, lines) = validate(&folder, "main.ron");
    assert_eq!(
        (status, lines),
        (Some(1), expected.map(str::to_owned).to_vec())
    );
    let done = strahl(&folder, "render main.ron -o out.png");
    done.failure(
        1,
        &[
            "main.ron:7:20",
            "`tree.ron` has 2 errors",
            "tree.ron:4:",
            "the first: ",
        ],
    );
    for format in ["json", "jsonl", "sarif", "github", "junit", "human"] {
        let done = strahl(
            &folder,
            &format!("validate main.ron --output-format {format}"),
        );
        let report = String::from_utf8(done.stdout).unwrap();
        for word in ["invalid-part", "out-of-range", "tree.ron"] {
            assert!(report.contains(word), "{format}: no {word:?} in {report}");
        }
        assert!(done.stderr.contains("1 file: 3 errors"), "{}", done.stderr);
    }
}

#[test]
fn a_part_in_a_folder_is_reported_once() {
    let folder = folder();
    let warning = r##"materials: {"paint": Matte(color: (2, 0, 0))}"##;
    let tree = TREE.replace(
        r##"materials: {"paint": Matte(color: "#804000")}"##,
        warning,
    );
    folder.write("tree.ron", tree);
    folder.write("zoo.ron", main(r#"Part(file: "tree.ron")"#));
    let found = |args| {
        let (status, lines) = validate(&folder, args);
        let clamped = lines.iter().filter(|line| line.contains("color-clamped"));
        assert_eq!(clamped.count(), 1, "{args}: {lines:#?}");
        (status, lines.len())
    };
    // No camera is needed where a scene names the file.
    assert_eq!(found("."), (Some(0), 1));
    assert_eq!(found("main.ron zoo.ron"), (Some(0), 1));
    assert_eq!(found("tree.ron main.ron"), (Some(0), 1));
    assert_eq!(found("zoo.ron tree.ron"), (Some(0), 1));
    let summary = strahl(&folder, "validate .").stderr;
    assert!(summary.contains("4 files: 1 warning"), "{summary}");
    // Alone it is a scene without a camera.
    let (status, lines) = validate(&folder, "tree.ron");
    assert_eq!(status, Some(1));
    assert!(lines[0].contains("missing field `camera`"), "{lines:#?}");

    let rendered = strahl(&folder, "render main.ron zoo.ron -o out/");
    assert_eq!(
        rendered.stderr.matches("color-clamped").count(),
        1,
        "{}",
        rendered.stderr
    );
}

#[test]
fn a_part_with_errors_needs_no_camera_either() {
    let folder = folder();
    folder.write("tree.ron", TREE.replace("radius", "radus"));
    let (status, lines) = validate(&folder, ".");
    assert_eq!(status, Some(1));
    assert!(
        lines
            .iter()
            .any(|line| line.contains("unknown field `radus`"))
    );
    let is_of_camera = |line: &String| line.contains("missing field `camera`");
    assert!(!lines.iter().any(is_of_camera), "{lines:#?}");
}

#[test]
fn a_part_is_fixed_before_the_scenes_that_name_it_are_checked() {
    let folder = folder();
    // `tree.ron` names a part itself, and sorts behind `main.ron`.
    folder.write("inner/leaf.json", LEAF.replace("center", "centre"));
    folder.write("tree.ron", TREE.replace("radius: 1", "radus: 1"));
    let errors = |args| strahl(&folder, args).stderr;
    assert_eq!(errors("validate ."), "3 files: 4 errors\n");
    let diff = "3 files: 4 errors (2 can be fixed by `--fix`)\n";
    assert_eq!(errors("validate --diff ."), diff);
    let diff = "1 file: 4 errors\n";
    assert_eq!(errors("validate main.ron"), diff);
    assert_eq!(errors("validate --diff main.ron"), diff);
    let fixed = strahl(&folder, "validate --fix .");
    assert_eq!(fixed.stderr, "3 files: no problems (2 fixed)\n");
    assert_eq!((fixed.status, &*fixed.stdout), (Some(0), &b""[..]));
    assert_eq!(errors("validate ."), "3 files: no problems\n");

    // A part that is not named on the command line stays as it is, and is reported.
    folder.write("tree.ron", TREE.replace("radius: 1", "radus: 1"));
    let (status, lines) = validate(&folder, "--fix main.ron inner/leaf.json");
    assert_eq!((status, lines.len()), (Some(1), 2), "{lines:#?}");
}

#[test]
fn a_folder_of_scenes_is_drawn_without_its_parts() {
    let folder = folder();
    let done = strahl(&folder, "render . -o out/");
    assert_eq!(done.status, Some(0), "{}", done.stderr);
    let pictures = fs::read_dir(folder.path("out"))
        .unwrap()
        .map(|entry| entry.unwrap().file_name());
    let pictures = pictures.filter(|name| name.to_string_lossy().ends_with(".png"));
    assert_eq!(pictures.collect::<Vec<_>>(), ["main.png"]);
    strahl(&folder, "render tree.ron -o a.png").failure(1, &["missing field `camera`"]);
}

#[test]
fn a_ring_is_shown_in_each_of_its_files() {
    let folder = Folder::new();
    folder.write("a.ron", main(r#"Part(file: "b.ron")"#));
    folder.write("b.ron", r#"(geometries: [Part(file: "./c.ron")])"#);
    folder.write("c.ron", r#"(geometries: [Part(file: "a.ron")])"#);
    let (status, lines) = validate(&folder, "a.ron");
    assert_eq!(status, Some(1));
    let ring = |place, ring| format!("{place}: error[part-ring]: a part of itself: {ring}");
    let expected = [
        ring("a.ron:5:29", "`a.ron` → `b.ron` → `./c.ron` → `a.ron`"),
        ring("b.ron:1:26", "`a.ron` → `b.ron` → `./c.ron` → `a.ron`"),
        ring("c.ron:1:26", "`a.ron` → `b.ron` → `./c.ron` → `a.ron`"),
    ];
    assert_eq!(lines, expected);
    // Each file of a folder has its own place in the ring.
    let (_, lines) = validate(&folder, ".");
    assert_eq!(
        lines
            .iter()
            .filter(|line| line.contains("part-ring"))
            .count(),
        3,
        "{lines:#?}"
    );
    // A scene outside of the ring.
    folder.write(
        "out.ron",
        main(r#"Part(file: "b.ron"), Part(file: "c.ron")"#),
    );
    let (_, lines) = validate(&folder, "out.ron");
    assert_eq!(lines.len(), 5, "{lines:#?}");
    assert!(lines[0].ends_with("`b.ron` has 1 error"), "{lines:#?}");
}

#[test]
fn parts_are_in_the_folder_of_the_file_that_names_them() {
    let folder = folder();
    folder.write(
        "inner/up.ron",
        r#"(geometries: [Part(file: "../tree.ron")])"#,
    );
    folder.write("main.ron", main(r#"Part(file: "inner/up.ron")"#));
    let (status, lines) = validate(&folder, "main.ron");
    assert_eq!(status, Some(1));
    assert!(
        lines[1].starts_with("inner/up.ron:1:26: error[outside-folder]"),
        "{lines:#?}"
    );
    assert_eq!(
        validate(&folder, "main.ron --allow-outside"),
        (Some(0), vec![])
    );
    let missing = main(r#"Part(file: "nothing.ron"), Part(file: "inner"), Part(file: "a.txt")"#);
    folder.write("main.ron", missing);
    let (_, lines) = validate(&folder, "main.ron");
    assert!(
        lines[0].contains("error[file-not-found]: `nothing.ron`: "),
        "{lines:#?}"
    );
    assert!(
        lines[1].contains("error[invalid-part]: `inner`: the extension"),
        "{lines:#?}"
    );
    assert!(
        lines[2].contains("error[invalid-part]: `a.txt`: the extension"),
        "{lines:#?}"
    );
}

#[test]
fn a_part_named_a_thousand_times_is_read_once() {
    let folder = folder();
    let named = r#"Part(file: "tree.ron"), "#.repeat(1000);
    folder.write("main.ron", main(&named));
    let info = strahl(&folder, "info main.ron --output-format json --size 2x2");
    assert_eq!(info.stderr.matches("error").count(), 0);
    let info: Value = serde_json::from_slice(&info.stdout).unwrap();
    assert_eq!(info["geometries"]["total"], 4000);
    assert_eq!(info["files"].as_array().unwrap().len(), 4);
    // Copies of copies would fill any memory.
    for level in 0..12 {
        let below = match level {
            0 => "tree.ron".to_owned(),
            _ => format!("level{}.ron", level - 1),
        };
        let named = format!("Part(file: \"{below}\"), ").repeat(10);
        folder.write(
            format!("level{level}.ron"),
            format!("(geometries: [{named}])"),
        );
    }
    folder.write("main.ron", main(r#"Part(file: "level11.ron")"#));
    let (status, lines) = validate(&folder, "main.ron");
    assert_eq!(status, Some(1));
    let limit = "copies of geometries, the maximum is 4194304";
    assert!(lines.iter().any(|line| line.contains(limit)), "{lines:#?}");
}

/// Writes a chain of parts, each of which names the one below twice, and returns its last file.
fn doubling(folder: &Folder, name: &str, levels: usize, lights: &str) -> String {
    let mut below = "tree.ron".to_owned();
    for level in 0..levels {
        let file = format!("{name}{level}.ron");
        let named = format!("Part(file: \"{below}\"{lights}), ").repeat(2);
        folder.write(&file, format!("(geometries: [{named}])"));
        below = file;
    }
    below
}

#[test]
fn copies_are_counted_over_all_files() {
    let folder = folder();
    // Each file alone is below the limit.
    let chain = |index: usize| {
        let file = doubling(&folder, &format!("chain{index}_"), 16, "");
        format!("Part(file: \"{file}\"), ")
    };
    let chains: Vec<_> = (0..17).map(chain).collect();
    folder.write("main.ron", main(&chains[..2].concat()));
    assert_eq!(validate(&folder, "main.ron").0, Some(0));
    folder.write("main.ron", main(&chains.concat()));
    let (status, lines) = validate(&folder, "main.ron");
    assert_eq!(status, Some(1));
    let limit = "copies of geometries, the maximum is 4194304";
    assert!(lines.iter().any(|line| line.contains(limit)), "{lines:#?}");
}

#[test]
fn copies_of_lights_are_counted() {
    let folder = Folder::new();
    folder.write(
        "tree.ron",
        r##"(lights: [Ambient(intensity: 1)], geometries: [])"##,
    );
    let last = doubling(&folder, "a", 20, ", lights: true");
    folder.write(
        "main.ron",
        main(&format!("Part(file: \"{last}\", lights: true)")),
    );
    let (status, lines) = validate(&folder, "main.ron");
    assert_eq!(status, Some(1));
    let limit = "copies of lights, the maximum is 65536";
    assert!(lines.iter().any(|line| line.contains(limit)), "{lines:#?}");
}

#[test]
fn the_depth_of_parts_has_a_limit() {
    let folder = Folder::new();
    for level in 0..40 {
        let named = format!("(geometries: [Part(file: \"{}.ron\")])", level + 1);
        folder.write(format!("{level}.ron"), named);
    }
    folder.write(
        "40.ron",
        r##"(geometries: [Sphere(center: (0, 0, 0), radius: 1, color: "#fff")])"##,
    );
    folder.write("main.ron", main(r#"Part(file: "9.ron")"#));
    assert_eq!(validate(&folder, "main.ron"), (Some(0), vec![]));
    folder.write("main.ron", main(r#"Part(file: "8.ron")"#));
    let (status, lines) = validate(&folder, "main.ron");
    assert_eq!(status, Some(1));
    let limit = "more than 32 parts are inside one another";
    assert!(lines.iter().any(|line| line.contains(limit)), "{lines:#?}");
    // Whatever was read before.
    folder.write(
        "main.ron",
        main(r#"Part(file: "9.ron"), Part(file: "8.ron")"#),
    );
    let (status, lines) = validate(&folder, "main.ron");
    assert_eq!((status, lines.len()), (Some(1), 2), "{lines:#?}");
    assert!(lines[1].contains(limit), "{lines:#?}");
}

#[test]
fn settings_and_tracks_do_not_lead_into_a_part() {
    let folder = folder();
    let inside = [
        "geometries[1].geometries[0].radius",
        "geometries.tree.materials.paint.color",
    ];
    for path in inside {
        let done = strahl(&folder, &format!("render main.ron -o a.png --set {path}=2"));
        let words = [
            "unknown-path",
            "leads into `tree.ron`",
            "change them in `tree.ron`",
        ];
        done.failure(2, &words);
        let track =
            format!("animation: (fps: 1, frames: 2, tracks: {{{path:?}: [(0, 1)]}}), geometries");
        folder.write("track.ron", main(MAIN).replace("geometries", &track));
        let (_, lines) = validate(&folder, "track.ron");
        assert!(
            lines
                .iter()
                .any(|line| line.contains("leads into `tree.ron`")),
            "{lines:#?}"
        );
    }
    // The part itself can be another one.
    let leaf = strahl(
        &folder,
        "info main.ron --set geometries.tree.file=\"inner/leaf.json\"",
    );
    assert!(
        String::from_utf8(leaf.quiet_success())
            .unwrap()
            .contains("geometries     3:")
    );
    strahl(
        &folder,
        "render main.ron -o a.png --set geometries.tree.radius=1",
    )
    .failure(2, &["unknown field `radius`"]);
}

#[test]
fn a_part_is_in_the_record_of_a_picture() {
    let folder = folder();
    let draw = || strahl(&folder, "render main.ron -o out/ --resume").stderr;
    let drawn = |stderr: &str| !stderr.contains("1 kept") && !stderr.contains("kept 1");
    assert!(drawn(&draw()));
    assert!(!drawn(&draw()), "{}", draw());
    // The file, a file that it names, and a name in it.
    folder.write("tree.ron", TREE.replace("#804000", "#804001"));
    assert!(drawn(&draw()));
    folder.write("inner/atoms.csv", ATOMS.replace("1.5", "1.6"));
    assert!(drawn(&draw()));
    folder.write("inner/leaf.json", LEAF.replace("0.7", "0.6"));
    assert!(drawn(&draw()));
    folder.write(
        "tree.ron",
        TREE.replace("#804000", "#804001").replace("trunk", "stem"),
    );
    assert!(drawn(&draw()));
    assert!(!drawn(&draw()));
}

#[test]
fn bands_of_parts_are_joined() {
    let folder = folder();
    for shard in ["0/3", "2/3", "1/3"] {
        strahl(
            &folder,
            &format!("render main.ron -o band.png --shard {shard} -q"),
        )
        .quiet_success();
    }
    strahl(&folder, "merge main.ron -o band.png").no_panic();
    let whole = strahl(&folder, "render main.ron -o - -q").quiet_success();
    assert!(fs::read(folder.path("band.png")).unwrap() == whole);
}

#[test]
fn formatting_and_conversion_leave_parts_alone() {
    let folder = folder();
    folder.write("tree.ron", "broken");
    strahl(&folder, "fmt main.ron").quiet_success();
    strahl(&folder, "convert main.ron main.json").quiet_success();
    let converted = fs::read_to_string(folder.path("main.json")).unwrap();
    assert!(
        converted.contains(r#"{"Part": {"file": "tree.ron", "name": "tree"}}"#),
        "{converted}"
    );
    folder.write("tree.ron", TREE);
    let [ron, json] = ["main.ron", "main.json"]
        .map(|scene| strahl(&folder, &format!("render {scene} -o - -q")).quiet_success());
    assert!(ron == json);
    let moved = strahl(&folder, "convert main.ron inner/main.json");
    assert!(
        moved.stderr.contains("the part `tree.ron` is not moved"),
        "{}",
        moved.stderr
    );
    // A part has no camera, which is no matter for its layout.
    strahl(&folder, "fmt tree.ron").quiet_success();
}

#[test]
fn lights_of_a_part_are_added_on_request() {
    let folder = folder();
    let lamp = r#"(lights: [Headlight(name: "lamp"), Ambient()], geometries: [])"#;
    folder.write("lamp.ron", lamp);
    folder.write(
        "main.ron",
        main(&format!("{MAIN} Part(file: \"lamp.ron\", lights: true)")),
    );
    let info = json(&folder, "info main.ron --output-format json");
    let lights = info["lighting"]["lights"].as_array().unwrap();
    assert_eq!((lights.len(), &lights[0]["name"]), (2, &json!("lamp")));
    // The scene is lit: --lights is for those that are not.
    strahl(&folder, "render main.ron -o a.png --lights headlight").failure(2, &["of its own"]);
    folder.write(
        "main.ron",
        main(&format!("{MAIN} Part(file: \"lamp.ron\")")),
    );
    let info = json(&folder, "info main.ron --output-format json");
    assert_eq!(info["lighting"], Value::Null);
    // Lights pass through a part that asks for them.
    folder.write(
        "through.ron",
        r#"(geometries: [Part(file: "lamp.ron", lights: true)])"#,
    );
    let through = main(&format!("{MAIN} Part(file: \"through.ron\", lights: true)"));
    folder.write("main.ron", through);
    let info = json(&folder, "info main.ron --output-format json");
    assert_eq!(info["lighting"]["lights"].as_array().unwrap().len(), 2);
}

#[test]
fn an_animation_moves_what_is_around_a_part() {
    let folder = folder();
    let animation = "animation: (fps: 1, frames: 2, tracks: {\"geometries.ball.radius\": [(0, 0.8), \
                     (1, 0.1)]}), geometries";
    folder.write("main.ron", main(MAIN).replacen("geometries", animation, 1));
    let frame = |number| {
        let args = format!("render main.ron -o {number}.png -q --frames {number}");
        strahl(&folder, &args).quiet_success();
        fs::read(folder.path(format!("{number}.png"))).unwrap()
    };
    folder.write(
        "small.ron",
        main(&MAIN.replacen("radius: 0.8", "radius: 0.1", 1)),
    );
    assert!(frame(1) == strahl(&folder, "render small.ron -o - -q").quiet_success());
    assert!(frame(0) != frame(1));
}

#[test]
fn parts_have_colors_by_value() {
    let folder = Folder::new();
    let table = |name: &str, column: &str| {
        format!(
            "Spheres(file: \"{name}.csv\", radius: 0.5, name: \"{name}\",
                color_by: (column: \"{column}\", map: Gray))"
        )
    };
    let [hot, far] = [table("hot", "energy"), table("far", "x")];
    folder.write("hot.csv", "x,y,z,energy\n0,0,0,5\n1,1,0,9\n");
    folder.write("far.csv", "x,y,z\n-1,0,0\n2,1,0\n");
    folder.write("inner.ron", format!("(geometries: [{far}])"));
    let ball = "Sphere(center: (0, -1, 0), radius: 0.2, color: \"#0f0\")";
    folder.write(
        "part.ron",
        format!("(geometries: [{ball}, {hot}, Part(file: \"inner.ron\")])"),
    );
    folder.write(
        "main.ron",
        main(&format!("{ball}, Part(file: \"part.ron\", name: \"both\")")),
    );
    folder.write("one.ron", main(&format!("{ball}, {ball}, {hot}, {far}")));
    let draw = |scene: &str| {
        strahl(&folder, &format!("render -q {scene}.ron -o {scene}.png")).quiet_success();
        fs::read(folder.path(format!("{scene}.png"))).unwrap()
    };
    assert_eq!(draw("main"), draw("one"));
    let info = json(&folder, "info main.ron --output-format json");
    let columns = &info["geometries"]["parts"][0]["color_by"];
    assert_eq!(
        (&columns[0]["data"], &columns[1]["data"]),
        (&json!([5.0, 9.0]), &json!([-1.0, 2.0]))
    );
    for (name, is_one) in [("hot", true), ("far", true), ("both", false), ("1", false)] {
        let done = strahl(
            &folder,
            &format!("legend main.ron -o {name}.svg --geometry {name}"),
        );
        assert_eq!(done.status == Some(0), is_one, "{name}");
    }
    assert!(
        fs::read_to_string(folder.path("hot.svg"))
            .unwrap()
            .contains(">energy<")
    );
}

#[test]
fn a_fit_camera_frames_parts() {
    let folder = folder();
    let fit = |geometries: &str| {
        let scene = main(geometries).replace(
            CAMERA,
            "image: (width: 32, height: 24), camera: Fit(from: (0, 0, 1)),",
        );
        folder.write("fit.ron", scene);
        json(&folder, "info fit.ron --output-format json")["cameras"][0].clone()
    };
    let listed = r##"
        Sphere(center: (-1, 0, 0), radius: 1, color: "#804000"),
        Sphere(center: (0, 1, 0), radius: 0.7, color: "#ffff00"),
        Sphere(center: (1, -1, 0), radius: 0.3, color: "#00ff00"),
        Sphere(center: (1.5, -1, 0), radius: 0.3, color: "#00ff00"),
    "##;
    let parts = fit("Part(file: \"tree.ron\")");
    assert!(parts["eye"].is_array(), "{parts}");
    let listed = fit(listed);
    for field in ["eye", "intrinsics", "extrinsics", "seen"] {
        assert_eq!(parts[field], listed[field], "{field}");
    }
}

#[test]
fn a_part_by_a_link_has_the_files_of_that_folder() {
    let folder = Folder::new();
    for name in ["common", "a", "b"] {
        fs::create_dir(folder.path(name)).unwrap();
    }
    let part = "(geometries: [Spheres(file: \"t.csv\", radius: 0.3, color: \"#f00\")])";
    folder.write("common/part.ron", part);
    folder.write("a/t.csv", "x,y,z\n-1,0,0\n");
    folder.write("b/t.csv", "x,y,z\n1,0,0\n2,0,0\n");
    for name in ["a", "b"] {
        let link = folder.path(format!("{name}/part.ron"));
        std::os::unix::fs::symlink("../common/part.ron", link).unwrap();
    }
    folder.write(
        "main.ron",
        main("Part(file: \"a/part.ron\"), Part(file: \"b/part.ron\")"),
    );
    let info = json(&folder, "info main.ron --output-format json");
    let parts = info["geometries"]["parts"].as_array().unwrap();
    let counts: Vec<_> = parts.iter().map(|part| &part["geometries"]).collect();
    assert_eq!(counts, [&json!(1), &json!(2)], "{info}");
    assert!(info.to_string().contains("b/t.csv"), "{info}");
}
