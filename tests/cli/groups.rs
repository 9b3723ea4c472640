//! Scenes with groups of geometries.

use std::fs;

use serde_json::{Value, json};

use crate::support::{Done, Folder, run};

const FRAME: &str = "image: (width: 32, height: 24),
    camera: Perspective(eye: (0, 0, 6), gaze: (0, 0, -1), fov: 60),";

const BALL: &str = r##"Sphere(center: (2, 1, 0), radius: 0.8, color: "#ff0000")"##;

const GROUPS: &str = r##"
        Group(name: "tree", geometries: [
            Sphere(center: (-1, 0, 0), radius: 1, color: "#804000", name: "trunk"),
            Group(geometries: [
                Sphere(center: (0, 1, 0), radius: 0.7, color: "#ffff00"),
                Spheres(file: "atoms.csv", radius: 0.3, color: "#00ff00", name: "atoms"),
            ]),
        ]),
"##;

const ATOMS: &str = "x,y,z\n1,-1,0\n1.5,-1,0\n";

fn main(geometries: &str) -> String {
    format!("(\n    {FRAME}\n    geometries: [{BALL},{geometries}],\n)\n")
}

/// A folder with `main.ron`.
fn folder() -> Folder {
    let folder = Folder::new();
    folder.write("main.ron", main(GROUPS));
    folder.write("atoms.csv", ATOMS);
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

#[test]
fn a_picture_of_groups_is_that_of_their_geometries() {
    let folder = folder();
    let listed = r##"
        Sphere(center: (-1, 0, 0), radius: 1, color: "#804000"),
        Sphere(center: (0, 1, 0), radius: 0.7, color: "#ffff00"),
        Sphere(center: (1, -1, 0), radius: 0.3, color: "#00ff00"),
        Sphere(center: (1.5, -1, 0), radius: 0.3, color: "#00ff00"),
    "##;
    folder.write("listed.ron", main(listed));
    for layer in ["", " --layers id", " --layers depth --depth-range 1,9"] {
        let draw = |scene| strahl(&folder, &format!("render {scene} -o - -q{layer}"));
        let picture = draw("main.ron").quiet_success();
        assert_eq!(picture, draw("listed.ron").quiet_success(), "{layer}");
    }
}

#[test]
fn geometries_are_named_with_their_groups() {
    let folder = folder();
    let pixel = json(&folder, "pixel main.ron 11,12 --output-format json");
    assert_eq!(pixel["hit"]["index"], 1);
    assert_eq!(pixel["hit"]["in_groups"], json!([0]));
    assert_eq!(pixel["hit"]["name"], "trunk");
    assert_eq!(pixel["hit"]["groups"], json!(["tree"]));
    assert_eq!(pixel["geometries"][0]["in_groups"], Value::Null);
    let row = &pixel["geometries"][4];
    assert_eq!(
        (&row["in_groups"], &row["row"]),
        (&json!([1, 1]), &json!(1))
    );
    let pixel = text(&folder, "pixel main.ron 11,12");
    let hit = "\n  [1].geometries[0] \"trunk\" in \"tree\" at t = ";
    assert!(pixel.contains(hit), "{pixel}");

    let report = json(&folder, "render main.ron -o main.png --report -");
    let of_id = |id| {
        let all = report["geometries"].as_array().unwrap();
        all.iter().find(|one| one["id"] == id).unwrap()
    };
    // Ids count the geometries in the order of the file.
    assert_eq!(of_id(0)["groups"], Value::Null);
    assert_eq!(of_id(2)["in_groups"], json!([1, 0]));
    assert_eq!(of_id(4)["name"], "atoms");

    let info = text(&folder, "info main.ron");
    let table = "  geometries[1].geometries[1].geometries[1] \"atoms\": 2 rows of \"atoms.csv\"";
    assert!(info.contains(table), "{info}");
    assert!(
        info.contains("geometries     5: 3 spheres, 2 rows of 1 table"),
        "{info}"
    );
    let info = json(&folder, "info main.ron --output-format json");
    assert_eq!(info["geometries"]["tables"][0]["in_groups"], json!([1, 1]));
}

#[test]
fn values_in_groups_are_set_by_index_and_by_name() {
    let folder = folder();
    let draw = |set: &str| {
        let mut command = folder.strahl(["render", "main.ron", "-o", "-", "-q"]);
        run(command.args(["--set", set])).quiet_success()
    };
    let red = main(GROUPS).replace("#804000", "#ff0000");
    folder.write("red.ron", red);
    let expected = strahl(&folder, "render red.ron -o - -q").quiet_success();
    for path in [
        "geometries[1].geometries[0]",
        "geometries.trunk",
        "geometries.tree.geometries[0]",
        "geometries[1].geometries.trunk",
        "geometries[\"tree\"].geometries[\"trunk\"]",
    ] {
        assert_eq!(draw(&format!("{path}.color=#ff0000")), expected, "{path}");
    }
    let bare = main(GROUPS).replace(GROUPS, "");
    folder.write("bare.ron", bare);
    let expected = strahl(&folder, "render bare.ron -o - -q").quiet_success();
    assert_eq!(
        draw("geometries.tree.geometries=[Group(geometries: [])]"),
        expected
    );
    for (set, message) in [
        (
            "geometries.trunc.color=#f00",
            "no geometry has the name `trunc`",
        ),
        (
            "geometries[1].geometries[7].color=#f00",
            "there is no geometry 7, the list has 2",
        ),
        ("geometries.tree.radius=2", "unknown field `radius`"),
        ("geometries.trunk.radius=-2", "`radius` must be above 0"),
    ] {
        let mut command = folder.strahl(["render", "main.ron", "-o", "-", "-q", "--set", set]);
        let done = run(&mut command);
        assert!(done.stderr.contains(message), "{set}: {}", done.stderr);
    }
}

#[test]
fn geometries_are_placed_by_all_their_groups() {
    let folder = folder();
    let groups = r##"
        Group(transform: (translate: (1, 2, 0)), geometries: [
            Group(name: "inner", transform: (scale: 0.5, translate: (-3, 0, 0)), geometries: [
                Sphere(center: (2, -4, 0), radius: 1, color: "#00ff00"),
                Spheres(file: "atoms.csv", radius: 0.5, color: "#0000ff"),
            ]),
        ])
    "##;
    folder.write("main.ron", main(groups));
    // The center is at 0.5·(2, -4, 0) + (-3, 0, 0) + (1, 2, 0), and the radius 0.5.
    let pixel = json(&folder, "pixel main.ron 12,12 --output-format json");
    assert_eq!(pixel["hit"]["in_groups"], json!([0, 0]));
    let point: Vec<f64> = serde_json::from_value(pixel["hit"]["point"].clone()).unwrap();
    let [x, y, z] = point[..] else {
        panic!("{point:?}")
    };
    let squared = (x + 1.0) * (x + 1.0) + y * y + z * z;
    assert!((squared - 0.25).abs() < 1e-12, "{point:?}");
    let draw = |scene: &str| strahl(&folder, &format!("render {scene} -o - -q")).quiet_success();
    // The numbers of these transforms are exact, and so is their product.
    let product = groups.replace(
        "(scale: 0.5, translate: (-3, 0, 0))",
        "(scale: 0.5, translate: (-2, 2, 0))",
    );
    folder.write(
        "product.ron",
        main(&product.replace("(translate: (1, 2, 0))", "(translate: (0, 0, 0))")),
    );
    assert_eq!(draw("main.ron"), draw("product.ron"));
    let equal = groups.replace(
        "Spheres(file: \"atoms.csv\", radius: 0.5, color: \"#0000ff\")",
        "Sphere(center: (2, -4, 0), radius: 1, color: \"#f00\")",
    );
    folder.write("equal.ron", main(&equal));
    let done = strahl(&folder, "validate equal.ron --output-format short");
    let found = String::from_utf8(done.stdout).unwrap();
    assert!(
        found.contains("equal to `geometries[1].geometries[0].geometries[0]`"),
        "{found}"
    );
}

// A group that moves, with a table and a geometry in it, needs as much room as these that move.
#[test]
fn a_camera_frames_moving_groups_in_all_frames() {
    let folder = folder();
    let scene = |geometries: &str, path: &str, keys: &str| {
        format!(
            "(image: (width: 32, height: 24), camera: Fit(from: (0, 0, 1)), geometries: [
            {geometries}],
            animation: (fps: 1, frames: 3, tracks: {{\"{path}\": {keys}}}))"
        )
    };
    let ball = r##"Sphere(center: (0, 0, 0), radius: 0.5, color: "#f00", name: "ball")"##;
    let still = r##", Sphere(center: (-1, 0, 0), radius: 0.5, color: "#0f0")"##;
    let group = format!(
        "Group(name: \"g\", transform: (translate: (0, 0, 0)), geometries: [{ball}]){still}"
    );
    let keys = "[(0, (0, 0, 0)), (2, (4, 1, 0))]";
    folder.write(
        "group.ron",
        scene(&group, "geometries.g.transform.translate", keys),
    );
    folder.write(
        "ball.ron",
        scene(&format!("{ball}{still}"), "geometries.ball.center", keys),
    );
    folder.write("one.csv", "x,y,z\n0,0,0\n");
    let table = group.replace(
        ball,
        "Spheres(file: \"one.csv\", radius: 0.5, color: \"#f00\")",
    );
    folder.write(
        "table.ron",
        scene(&table, "geometries.g.transform.translate", keys),
    );
    let eye = |name: &str| -> [f64; 3] {
        let info = json(&folder, &format!("info {name} --output-format json"));
        serde_json::from_value(info["cameras"][0]["eye"].clone()).unwrap()
    };
    let expected = eye("ball.ron");
    assert!((expected[0] - 1.5).abs() < 0.1, "{expected:?}");
    for name in ["group.ron", "table.ron"] {
        let found = eye(name);
        let near = found
            .iter()
            .zip(expected)
            .all(|(one, other)| (one - other).abs() < 1e-6);
        assert!(near, "{name}: {found:?} {expected:?}");
    }
    let draw = |name: &str| {
        strahl(
            &folder,
            &format!("render {name}.ron --frames 1 -o {name}-{{frame}}.png -q"),
        )
        .quiet_success();
        fs::read(folder.path(format!("{name}-1.png"))).unwrap()
    };
    assert_eq!(draw("group"), draw("table"));
}

#[test]
fn a_broken_group_is_reported_and_never_panics() {
    let folder = folder();
    let whole = main(GROUPS);
    let at = whole.find("Group").unwrap();
    for end in (at..whole.len()).step_by(13) {
        folder.write("cut.ron", &whole[..end]);
        strahl(&folder, "validate cut.ron").no_panic();
        let gap = whole[..end].to_owned() + &whole[(end + 5).min(whole.len())..];
        folder.write("gap.ron", gap);
        strahl(&folder, "validate gap.ron").no_panic();
    }
    fs::remove_file(folder.path("atoms.csv")).unwrap();
    let done = strahl(&folder, "validate main.ron --output-format short");
    let found = String::from_utf8(done.stdout).unwrap();
    assert!(found.contains("error[file-not-found]"), "{found}");
}
