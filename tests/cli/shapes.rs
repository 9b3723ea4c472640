//! Every shape in every command.

use std::fs;

use serde_json::{Value, json};

use crate::support::{Folder, run};

/// A geometry, a setting that moves it, and a term of its equation.
const SHAPES: [(&str, &str, &str); 9] = [
    (
        "Rectangle(corner: (-1, -1, -4), edge_u: (2, 0, 0), edge_v: (0, 2, 0)",
        "corner=(-0.5, 0, -4)",
        "first_sum",
    ),
    (
        "Triangle(a: (-2, -1, -4), b: (2, -1, -4), c: (0, 2, -4)",
        "c=(0, -1.5, -4)",
        "sum",
    ),
    (
        "Box(min: (-1, -1, -5), max: (1, 1, -4)",
        "max[1]=-0.9",
        "x_to",
    ),
    (
        "Cylinder(from: (-1, 0, -5), to: (1, 0, -5), radius: 1",
        "radius=0.01",
        "discriminant",
    ),
    (
        "Cone(from: (0, -1, -5), to: (0, 2, -5), radius: 1, top_radius: 0.1",
        "to=(0, -0.9, -5)",
        "slope",
    ),
    (
        "Capsule(from: (-1, 0, -5), to: (1, 0, -5), radius: 1",
        "from=(90, 0, -5)",
        "side_discriminant",
    ),
    (
        "Ellipsoid(center: (0, 0, -5), axes: [(2, 0, 0), (0, 1, 0), (0, 0, 1)]",
        "axes[1]=(0, 0.01, 0)",
        "discriminant",
    ),
    (
        "Torus(center: (1, 0, -5), axis: (0, 0.2, 1), radius: 1, tube_radius: 0.5",
        "tube_radius=0.01",
        "alpha",
    ),
    (
        "Mesh(vertices: [(-2, -1, -4), (2, -1, -4), (0, 2, -4), (0, 0, -9)], \
         triangles: [(0, 1, 2), (1, 0, 3)]",
        "vertices[2]=(0, -1.5, -4)",
        "sum",
    ),
];

fn scene(shape: &str) -> Folder {
    let folder = Folder::new();
    folder.write(
        "scene.ron",
        format!(
            r##"(
    image: (width: 32, height: 24),
    camera: Perspective(eye: (0, 0, 0), gaze: (0, 0, -1), fov: 60),
    geometries: [
        {shape}, color: "#ff0000", name: "one"),
        Sphere(center: (0, 0, -30), radius: 25, color: "#00ff00"),
    ],
)"##
        ),
    );
    folder
}

fn text(folder: &Folder, args: &[&str]) -> String {
    String::from_utf8(run(&mut folder.strahl(args)).quiet_success()).unwrap()
}

fn data(folder: &Folder, args: &[&str]) -> Value {
    serde_json::from_str(&text(
        folder,
        &[args, &["--output-format", "json"]].concat(),
    ))
    .unwrap()
}

fn ppm(folder: &Folder, args: &[&str]) -> Vec<u8> {
    let args = [
        &["render", "scene.ron", "-o", "-", "--image-format", "ppm"],
        args,
    ]
    .concat();
    run(&mut folder.strahl(args)).quiet_success()
}

#[test]
fn each_shape_is_explained_counted_and_set() {
    for (shape, setting, term) in SHAPES {
        let folder = scene(shape);
        let name = shape.split('(').next().unwrap();
        let pixel = data(&folder, &["pixel", "scene.ron", "16,12"]);
        let terms = &pixel["geometries"][0];
        assert_eq!(terms["kind"], json!(name));
        assert!(!terms[term].is_null(), "{terms}");
        assert_eq!(pixel["hit"]["index"], json!(0), "{pixel}");
        assert_eq!(pixel["hit"]["t"], terms["t"]);
        let has_face = !["Rectangle", "Triangle", "Ellipsoid", "Torus"].contains(&name);
        assert_eq!(pixel["hit"]["face"].is_u64(), has_face, "{pixel}");
        let explained = text(&folder, &["pixel", "scene.ron", "16,12"]);
        assert!(
            explained.contains(&format!("  [0] \"one\" {name}, ")),
            "{explained}"
        );

        let info = data(&folder, &["info", "scene.ron"]);
        let plural = match name {
            "Box" => "boxes".to_owned(),
            "Mesh" => "meshes".to_owned(),
            "Torus" => "toruses".to_owned(),
            name => format!("{}s", name.to_lowercase()),
        };
        assert_eq!(info["geometries"][&plural], json!(1), "{info}");
        assert!(info["bounds"]["min"][2].as_f64() < Some(-50.0));

        let set = format!("geometries.one.{setting}");
        assert_ne!(ppm(&folder, &["--set", &set]), ppm(&folder, &[]), "{set}");
    }
}

#[test]
fn each_shape_moves_in_an_animation() {
    for (shape, setting, _) in SHAPES {
        if shape.starts_with("Ellipsoid") || shape.starts_with("Mesh") {
            continue;
        }
        let folder = scene(shape);
        let (path, value) = setting.split_once('=').unwrap();
        let field = path.split('[').next().unwrap();
        let is = shape.split(&format!("{field}: ")).nth(1).unwrap();
        let is = match is.strip_prefix('(') {
            Some(rest) => format!("({})", rest.split(')').next().unwrap()),
            None => is.split(',').next().unwrap().to_owned(),
        };
        let (from, path) = match path.contains('[') {
            true => ("1".to_owned(), path),
            false => (is, path),
        };
        let old = std::fs::read_to_string(folder.path("scene.ron")).unwrap();
        let body = old.trim_end().trim_end_matches(')');
        let track = format!("\"geometries.one.{path}\": [(0, {from}), (1, {value})]");
        let animation = format!("    animation: (fps: 1, frames: 2, tracks: {{{track}}}),\n)");
        folder.write("scene.ron", format!("{body}{animation}"));
        let args = ["render", "scene.ron", "-o", "-", "--image-format", "y4m"];
        let movie = run(&mut folder.strahl(args)).quiet_success();
        let head = movie.iter().position(|byte| *byte == b'\n').unwrap() + 1;
        let (first, last) = movie[head..].split_at((movie.len() - head) / 2);
        assert_ne!(first, last, "{track}");
    }
}

#[test]
fn all_faces_that_a_point_lies_on_are_told() {
    let floor = "Plane(name: \"floor\", point: (0, 0, -4), normal: (0, 0, 1), color: \"#fff\")";
    let cube = "Box(min: (-1, -1, -6), max: (1, 1, -4), color: \"#fff\")";
    let folder = scene(&format!(
        "{floor}, {cube}, Disc(center: (0, 0, -4), normal: (0, 0, 1), radius: 3"
    ));
    let pixel = text(&folder, &["pixel", "scene.ron", "16,12"]);
    assert!(
        pixel.contains("  also on      [1], face 5\n  also on      [2]"),
        "{pixel}"
    );
    let pixel = data(&folder, &["pixel", "scene.ron", "16,12"]);
    assert_eq!(pixel["hit"]["also_on"][0], json!({"index": 1, "face": 5}));
    // A gap of a billionth is one.
    let cube = cube.replace("-4)", "-4.000000001)");
    let folder = scene(&format!(
        "{floor}, {cube}, Disc(center: (0, 0, -4.1), normal: (0, 0, 1), radius: 3"
    ));
    let pixel = data(&folder, &["pixel", "scene.ron", "16,12"]);
    assert_eq!(pixel["hit"]["also_on"], Value::Null);
}

#[test]
fn the_groups_of_a_mesh_file_are_told() {
    let folder = scene(r#"Mesh(file: "wall.obj""#);
    let corners = "v -9 -9 -4\nv 9 -9 -4\nv 0 9 -4\nv 0 0 -9\n";
    let faces = "g wall left\nf 1 2 3\no roof\nf 1 2 4\nf 2 3 4\ng empty\n";
    folder.write("wall.obj", format!("{corners}{faces}"));
    let info = text(&folder, &["info", "scene.ron"]);
    let groups = "    group \"wall left\": 1 triangle\n    group \"roof\": 2 triangles\n";
    assert!(info.contains(groups) && !info.contains("empty"), "{info}");
    let pixel = text(&folder, &["pixel", "scene.ron", "16,12"]);
    let face = "  face         0, of the group \"wall left\"\n";
    assert!(pixel.contains(face), "{pixel}");
    let info = data(&folder, &["info", "scene.ron"]);
    let groups = &info["geometries"]["mesh_sizes"][0]["groups"];
    assert_eq!(groups[1], json!({"name": "roof", "triangles": 2}));
    let pixel = data(&folder, &["pixel", "scene.ron", "16,12"]);
    assert_eq!(pixel["hit"]["mesh_group"], "wall left");
    // Many groups are counted.
    let many: String = (0..23).map(|at| format!("g {at}\nf 1 2 3\n")).collect();
    folder.write("wall.obj", format!("{corners}{many}"));
    let info = text(&folder, &["info", "scene.ron"]);
    let end = "    group \"19\": 1 triangle\n    and 3 more groups\n";
    assert!(info.contains(end), "{info}");
}

#[test]
fn a_mesh_file_is_a_file_that_the_scene_needs() {
    let folder = scene(r#"Mesh(file: "wall.obj""#);
    let wall = |x: i32| format!("v -9 -9 -4\nv {x} -9 -4\nv 0 9 -4\nf 1 2 3\n");
    folder.write("wall.obj", wall(9));
    text(
        &folder,
        &["render", "scene.ron", "-o", "a.png", "--depfile", "a.d"],
    );
    let depfile = fs::read_to_string(folder.path("a.d")).unwrap();
    assert!(depfile.contains("wall.obj"), "{depfile}");
    let draw = || {
        let done = run(&mut folder.strahl(["render", "scene.ron", "-o", "out/", "--resume"]));
        assert_eq!(done.status, Some(0), "{}", done.stderr);
        !done.stderr.contains("1 kept")
    };
    assert!(draw());
    assert!(!draw());
    folder.write("wall.obj", wall(8));
    assert!(draw());
    assert!(!draw());
}

#[test]
fn a_solid_has_the_terms_of_its_parts() {
    let folder = scene(
        "Difference(of: Box(min: (-1, -1, -5), max: (1, 1, -4)), \
         minus: [Sphere(center: (0, 0, -4), radius: 0.5)]",
    );
    let text = text(&folder, &["pixel", "scene.ron", "16,12"]);
    for part in [
        "Solid, Difference(box 0, sphere 1)",
        "box 0: min = (-1.0, -1.0, -5.0)",
        "sphere 1: center c = (0.0, 0.0, -4.0)",
        "sphere 1: A = ",
        "out of sphere 1 at t",
    ] {
        assert!(text.contains(part), "no {part} in {text}");
    }
    let terms = &data(&folder, &["pixel", "scene.ron", "16,12"])["geometries"][0];
    assert_eq!(terms["form"], "Difference(box 0, sphere 1)");
    assert_eq!(terms["part_1_radius"], 0.5);
}

#[test]
fn an_open_tube_says_so() {
    let folder = scene("Cylinder(from: (-1, 0, -5), to: (1, 0, -5), radius: 1, capped: false");
    let text = text(&folder, &["pixel", "scene.ron", "20,15"]);
    assert!(
        text.contains("Cylinder, open, from a (-1.0, 0.0, -5.0)"),
        "{text}"
    );
}
