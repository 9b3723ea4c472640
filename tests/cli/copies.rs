//! Scenes with copies of geometries.

use std::fs;

use serde_json::{Value, json};

use crate::support::{Done, Folder, run};

const FRAME: &str = "image: (width: 48, height: 32),
    camera: Perspective(eye: (0, 1, 9), gaze: (0, 0, -1), fov: 60),
    lights: [Directional(direction: (-1, -2, -1)), Ambient(intensity: 0.2)],";

const TREE: &str = r##"
            Cylinder(from: (0, 0, 0), to: (0, 1, 0), radius: 0.2, color: "#6b4423"),
            Cone(from: (0, 0.8, 0), to: (0, 3, 0), radius: 0.7, color: "#2e6b34"),"##;

const COPIES: &str = r#"
        Instances(of: "tree", name: "wood", transforms: [
            (translate: (2.5, 0, 0)),
            (translate: (-2.5, 0, 1), rotate: (axis: (0, 0, 1), angle: 20), scale: 1.2),
        ]),
        Instances(of: "tree", file: "trees.csv"),
"#;

const TABLE: &str = "x,y,z,scale,angle\n1,-2,2,0.5,30\n-1,-2,2,0.6,-45\n";

fn scene(geometries: &str) -> String {
    format!(
        "(\n    {FRAME}\n    geometries: [Group(name: \"tree\", geometries: [{TREE}]),{geometries}]\n)\n"
    )
}

/// A folder with `main.ron`.
fn folder() -> Folder {
    let folder = Folder::new();
    folder.write("main.ron", scene(COPIES));
    folder.write("trees.csv", TABLE);
    folder
}

fn strahl(folder: &Folder, args: &str) -> Done {
    run(&mut folder.strahl(args.split(' ')))
}

#[track_caller]
fn json(folder: &Folder, args: &str) -> Value {
    serde_json::from_slice(&strahl(folder, args).quiet_success()).unwrap()
}

#[test]
fn a_picture_of_copies_is_that_of_groups_in_their_places() {
    let folder = folder();
    let groups = [
        "translate: (2.5, 0, 0)",
        "translate: (-2.5, 0, 1), rotate: (axis: (0, 0, 1), angle: 20), scale: 1.2",
        "translate: (1, -2, 2), rotate: (axis: (0, 1, 0), angle: 30), scale: 0.5",
        "translate: (-1, -2, 2), rotate: (axis: (0, 1, 0), angle: -45), scale: 0.6",
    ];
    let group = |transform| format!("Group(transform: ({transform}), geometries: [{TREE}]),");
    folder.write("groups.ron", scene(&groups.map(group).concat()));
    for layer in ["", " --samples 4", " --layers depth --depth-range 1,12"] {
        let draw = |name| strahl(&folder, &format!("render {name} -o - -q{layer}"));
        let picture = draw("main.ron").quiet_success();
        assert_eq!(picture, draw("groups.ron").quiet_success(), "{layer}");
    }
}

#[test]
fn each_copy_has_an_id() {
    let folder = folder();
    let report = json(&folder, "render main.ron -o main.png --report -");
    let seen = report["geometries"].as_array().unwrap();
    let places: Vec<_> = seen
        .iter()
        .map(|one| json!([one["id"], one["geometry"], one["instance"], one["name"]]))
        .collect();
    let expected = [
        json!([0, 0, null, null]),
        json!([1, 0, null, null]),
        json!([2, 1, 0, "wood"]),
        json!([3, 1, 1, "wood"]),
        json!([4, 2, 0, null]),
        json!([5, 2, 1, null]),
    ];
    assert_eq!(places, expected);
    let inside = |id: usize| {
        let bounds: Vec<u64> = serde_json::from_value(seen[id]["box"].clone()).unwrap();
        let [x, y, width, height] = bounds[..] else {
            panic!("a box has four numbers");
        };
        (x + width / 2, 31 - (y + height / 2))
    };
    let (x, y) = inside(3);
    let pixel = json(
        &folder,
        &format!("pixel main.ron {x},{y} --output-format json"),
    );
    let hit = &pixel["hit"];
    assert_eq!(
        json!([hit["index"], hit["instance"], hit["name"]]),
        json!([1, 1, "wood"])
    );
    let missed = &pixel["geometries"][3];
    assert_eq!(
        json!([missed["index"], missed["instance"]]),
        json!([2, null])
    );

    let info = json(&folder, "info main.ron --output-format json");
    let lists = &info["geometries"]["instances"];
    assert_eq!(info["geometries"]["total"], 6);
    assert_eq!(
        json!([lists[0]["copies"], lists[0]["of"], lists[1]["first_id"]]),
        json!([2, "tree", 4])
    );
    assert_eq!(
        lists[1]["columns"],
        json!(["x", "y", "z", "scale", "angle"])
    );
}

#[test]
fn transforms_and_prototypes_move() {
    let folder = folder();
    let tracks = r#"animation: (frames: 2, tracks: {
        "geometries.wood.transforms[0].translate": [(0, (2.5, 0, 0)), (1, (2.5, 1, 0))],
        "geometries.tree.geometries[0].radius": [(0, 0.2), (1, 0.4)],
    }),"#;
    let moving = scene(COPIES).replace(
        "geometries: [Group",
        &format!("{tracks}\n    geometries: [Group"),
    );
    folder.write("moving.ron", moving);
    strahl(&folder, "render moving.ron -o {frame}.png -q").quiet_success();
    let frame = |number: usize| fs::read(folder.path(format!("{number}.png"))).unwrap();
    let still = |sets: &[&str]| {
        let mut command = folder.strahl(["render", "main.ron", "-o", "-", "-q"]);
        for set in sets {
            command.args(["--set", set]);
        }
        run(&mut command).quiet_success()
    };
    assert_eq!(frame(0), still(&[]));
    let part = 1.0 / 24.0;
    let shifted = format!("geometries.wood.transforms[0].translate=(2.5, {part:?}, 0)");
    let thick = format!(
        "geometries.tree.geometries[0].radius={:?}",
        0.2 + (0.4 - 0.2) * part
    );
    assert_eq!(frame(1), still(&[&shifted, &thick]));
}

#[test]
fn a_table_of_copies_is_a_file_that_the_scene_needs() {
    let folder = folder();
    strahl(&folder, "render main.ron -o main.png -q --depfile main.d").quiet_success();
    let depfile = fs::read_to_string(folder.path("main.d")).unwrap();
    assert!(depfile.contains("trees.csv"), "{depfile}");
    let draw = || strahl(&folder, "render main.ron -o out/ --resume").stderr;
    let kept = |stderr: &str| stderr.contains("1 kept") || stderr.contains("kept 1");
    assert!(!kept(&draw()));
    assert!(kept(&draw()));
    folder.write("trees.csv", TABLE.replace("0.5", "0.6"));
    assert!(!kept(&draw()));
    let other = scene(COPIES).replace("radius: 0.2", "radius: 0.3");
    folder.write("main.ron", other);
    assert!(!kept(&draw()), "what is copied is in the record");
    assert!(kept(&draw()));
}

/// Writes a chain of files, each with the next one as a part and a copy of it.
fn chain(folder: &Folder, files: usize) {
    let camera = "camera: Perspective(eye: (0, 0, 900), gaze: (0, 0, -1), fov: 40)";
    for file in 0..files {
        let inner = match file + 1 == files {
            true => "Sphere(center: (0, 0, 0), radius: 1, color: \"#ff0000\")".to_owned(),
            false => format!("Part(file: \"{}.ron\")", file + 1),
        };
        let copies = format!("Instances(of: \"all\", transforms: [(translate: ({file}, 1, 0))])");
        let geometries = format!("Group(name: \"all\", geometries: [{inner}]), {copies}");
        let text =
            format!("(image: (width: 4, height: 4), {camera}, geometries: [{geometries}])\n");
        folder.write(format!("{file}.ron"), text);
    }
}

// Each file doubles the shapes that a walk over all of them meets.
#[test]
fn copies_inside_of_copies_are_counted_over_all_files() {
    let folder = Folder::new();
    let limit = "copies of geometries, the maximum is 4194304";
    chain(&folder, 31);
    for command in ["validate", "info", "render -o x.png", "pixel"] {
        let args = match command {
            "pixel" => "pixel 0.ron 1,1".to_owned(),
            command => format!("{command} 0.ron"),
        };
        let done = strahl(&folder, &args);
        assert_eq!(done.status, Some(1), "{command}");
        let said = [&*done.stderr, &String::from_utf8_lossy(&done.stdout)].concat();
        let said = said.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(said.contains(limit), "{command}: {said}");
    }
    chain(&folder, 12);
    assert_eq!(strahl(&folder, "validate 0.ron").status, Some(0));
}

// No list shares what it holds with another.
#[test]
fn lists_of_copies_of_many_geometries_are_counted() {
    let folder = Folder::new();
    let ball = "Sphere(center: (0, 0, 0), radius: 1, color: \"#ff0000\"),".repeat(3000);
    let lists = "Instances(of: \"all\", transforms: [(translate: (3, 0, 0))]),".repeat(3000);
    let geometries = format!("Group(name: \"all\", geometries: [{ball}]), {lists}");
    folder.write("main.ron", format!("({FRAME} geometries: [{geometries}])"));
    let done = strahl(&folder, "validate main.ron --output-format short");
    let limit = "copies of geometries, the maximum is 4194304";
    assert!(String::from_utf8_lossy(&done.stdout).contains(limit));
    assert_eq!(done.status, Some(1));
}
