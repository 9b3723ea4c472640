//! `strahl info` and `strahl render --report`, compared with the plain loop and the layers of
//! pictures.

use std::{collections::BTreeMap, fs};

use serde_json::{Value, json};
use strahl::{Scene, Vec3};

use crate::support::{Folder, JSON, RON, run, run_with};

const TABLE: &str = "x,y,z,radius\n-1.2,0.5,-4,0.4\n0,1,9,0.5\n1.5,0.2,-2,0.3\n";

const PERSPECTIVE: &str =
    "Perspective(eye: (0.5, 1, 3), look_at: (0, 0, -3), up: (0.1, 1, 0), fov: 50)";
const SQUARE: &str = "Orthographic(eye: (0.5, 1, 3), gaze: (-0.1, -0.2, -1), scale: 4)";
const STRETCHED: &str =
    "Orthographic(eye: (0.5, 1, 3), gaze: (-0.1, -0.2, -1), scale: 4, stretch: true)";
const CAMERAS: [&str; 3] = [PERSPECTIVE, SQUARE, STRETCHED];

/// A folder with `scene.ron` and its table: a floor, a ball, three rows of which one is behind the
/// camera, and a ball in front of the first.
fn folder(camera: &str) -> Folder {
    let folder = Folder::new();
    folder.write("balls.csv", TABLE);
    let scene = format!(
        "(
    image: (width: 37, height: 29, samples: 4),
    camera: {camera},
    background: (0, 0.2, 0.4),
    geometries: [
        Plane(point: (0, -1, 0), normal: (0, 1, 0), color: (0, 1, 0), name: \"floor\"),
        Sphere(center: (0, 0, -3), radius: 0.9, color: (1, 0, 0)),
        Spheres(file: \"balls.csv\", color: (1, 1, 0), name: \"balls\"),
        Sphere(center: (0.3, 0.2, -1.5), radius: 0.3, color: (0, 0, 1), name: \"small\"),
    ],
)
"
    );
    folder.write("scene.ron", scene);
    folder
}

fn info(folder: &Folder, args: &[&str]) -> Value {
    let args = [&["info", "scene.ron", "--output-format", "json"], args].concat();
    serde_json::from_slice(&run(&mut folder.strahl(args)).quiet_success()).unwrap()
}

/// Returns the expected report by tracing one ray after another: the id of each visible geometry,
/// with its pixel count, box and depths.
fn plain_loop(folder: &Folder, [left, top, across, down]: [u32; 4]) -> Vec<Value> {
    let scene = Scene::from_path(folder.path("scene.ron")).unwrap();
    let (width, height) = (scene.size().width(), scene.size().height());
    let mut seen: BTreeMap<usize, Vec<(u32, u32, f64)>> = BTreeMap::new();
    for row in top..top + down {
        for column in left..left + across {
            let y = f64::from(height - 1 - row);
            let ray = scene.camera().ray_for(width, height, column.into(), y);
            if let Some((id, hit)) = scene.world().hit(&ray) {
                seen.entry(id).or_default().push((column, row, hit.t));
            }
        }
    }
    let places = [
        json!([0, null, "floor"]),
        json!([1, null, null]),
        json!([2, 0, "balls"]),
        json!([2, 1, "balls"]),
        json!([2, 2, "balls"]),
        json!([3, null, "small"]),
    ];
    let entry = |(id, pixels): (usize, Vec<(u32, u32, f64)>)| {
        let columns = || pixels.iter().map(|pixel| pixel.0);
        let rows = || pixels.iter().map(|pixel| pixel.1);
        let (x, y) = (columns().min().unwrap(), rows().min().unwrap());
        let (right, bottom) = (columns().max().unwrap(), rows().max().unwrap());
        let depths = || pixels.iter().map(|pixel| pixel.2);
        json!({
            "id": id,
            "geometry": places[id][0],
            "row": places[id][1],
            "name": places[id][2],
            "pixels": pixels.len(),
            "box": [x, y, right - x + 1, bottom - y + 1],
            "depth": [depths().reduce(f64::min).unwrap(), depths().reduce(f64::max).unwrap()],
        })
    };
    seen.into_iter().map(entry).collect()
}

const WHOLE: [u32; 4] = [0, 0, 37, 29];

#[test]
fn a_report_matches_the_plain_loop() {
    for camera in CAMERAS {
        let folder = folder(camera);
        let expected = plain_loop(&folder, WHOLE);
        assert!((4..6).contains(&expected.len()), "all but the row behind");
        for more in ["--threads=1", "--threads=5", "--samples=1", "--samples=9"] {
            let args = ["render", "scene.ron", "--report", "report.json", more];
            run(&mut folder.strahl(args)).quiet_success();
            let text = fs::read_to_string(folder.path("report.json")).unwrap();
            let report: Value = serde_json::from_str(&text).unwrap();
            let image = json!({"width": 37, "height": 29, "crop": null, "camera": null});
            let expected =
                json!({"strahl": "report/1", "format": 1, "image": image, "geometries": expected});
            assert_eq!(report, expected, "{camera} {more}");
            assert_eq!(
                text.lines().count(),
                7 + report["geometries"].as_array().unwrap().len()
            );
        }
    }
}

#[test]
fn a_crop_counts_pixels_of_the_whole_picture() {
    let folder = folder(PERSPECTIVE);
    let args = ["render", "scene.ron", "--report=-", "--crop", "15,9,8,7"];
    let stdout = run(&mut folder.strahl(args)).quiet_success();
    let report: Value = serde_json::from_slice(&stdout).unwrap();
    assert_eq!(report["image"]["crop"], json!([15, 9, 8, 7]));
    assert_eq!(report["image"]["width"], 37);
    let expected = plain_loop(&folder, [15, 9, 8, 7]);
    assert!(expected.len() > 1);
    assert_eq!(report["geometries"], Value::Array(expected));
}

#[test]
fn a_report_may_be_empty() {
    let folder = Folder::new();
    let text = RON
        .replace("(0, 0, -1)", "(0, 1, 0)")
        .replace("fov", "up: (0, 0, 1), fov")
        .replace("image:", "allow: [\"nothing-visible\"],\n    image:");
    folder.write("scene.ron", text);
    let args = ["render", "scene.ron", "--report", "-"];
    let stdout = run(&mut folder.strahl(args)).quiet_success();
    let report: Value = serde_json::from_slice(&stdout).unwrap();
    assert_eq!(report["geometries"], json!([]));
    let info = info(&folder, &[]);
    let camera = &info["cameras"][0];
    assert_eq!((&camera["seen"], &camera["unseen"]), (&json!(0), &json!(2)));
    assert_eq!(
        (&camera["nearest"], &camera["farthest"]),
        (&Value::Null, &Value::Null)
    );
}

#[test]
fn a_report_does_not_change_the_picture() {
    let folder = folder(PERSPECTIVE);
    run(&mut folder.strahl(["render", "scene.ron", "-o", "a.png"])).quiet_success();
    let args = ["render", "scene.ron", "-o", "b.png", "--report", "b.json"];
    run(&mut folder.strahl(args)).quiet_success();
    let read = |name| fs::read(folder.path(name)).unwrap();
    assert!(read("a.png") == read("b.png"));
}

#[test]
fn an_impossible_report_is_rejected_before_rendering() {
    let folder = folder(PERSPECTIVE);
    fs::create_dir(folder.path("folder")).unwrap();
    let names = folder.names();
    for (report, words) in [
        ("folder", "is a folder"),
        ("missing/a.json", "no such file or folder"),
        ("scene.ron", "overwrite \"scene.ron\""),
        ("./folder/../scene.ron", "overwrite \"scene.ron\""),
        ("balls.csv", "overwrite \"balls.csv\""),
        ("./out.png", "overwrite \"out.png\""),
    ] {
        let args = ["render", "scene.ron", "-o", "out.png", "--report", report];
        run(&mut folder.strahl(args)).one_line(2, &[report, words]);
    }
    let layer = "render scene.ron -o out.npy --layers depth,id --report out.id.npy";
    let done = run(&mut folder.strahl(layer.split(' ')));
    done.one_line(2, &["overwrite \"out.id.npy\""]);
    let both = "render scene.ron -o - --report -";
    run(&mut folder.strahl(both.split(' '))).one_line(2, &["standard output"]);
    assert_eq!(folder.names(), names);
}

#[test]
fn an_old_report_survives_a_failure() {
    let folder = folder(PERSPECTIVE);
    folder.write("bad.ron", RON.replace("0.5", "-0.5"));
    folder.write("report.json", "old");
    let args = ["render", "bad.ron", "--report", "report.json"];
    run(&mut folder.strahl(args)).bad_scene("bad.ron", &["radius"]);
    let args = [
        "render",
        "scene.ron",
        "--crop",
        "0,0,99,9",
        "--report",
        "report.json",
    ];
    run(&mut folder.strahl(args)).one_line(2, &["0,0,99,9"]);
    assert_eq!(fs::read(folder.path("report.json")).unwrap(), b"old");
}

/// Returns the numbers of an `.npy` file of f64 or u32.
fn array(folder: &Folder, name: &str) -> Vec<f64> {
    let bytes = fs::read(folder.path(name)).unwrap();
    let start = 10 + usize::from(u16::from_le_bytes([bytes[8], bytes[9]]));
    let numbers = &bytes[start..];
    if bytes[..start].windows(3).any(|part| part == b"<u4") {
        let numbers = numbers.as_chunks().0.iter();
        return numbers
            .map(|bytes| u32::from_le_bytes(*bytes).into())
            .collect();
    }
    let numbers = numbers.as_chunks().0.iter();
    numbers.map(|bytes| f64::from_le_bytes(*bytes)).collect()
}

fn matrix<const N: usize>(matrix: &Value) -> Option<[[f64; N]; 3]> {
    serde_json::from_value::<Vec<Vec<f64>>>(matrix.clone())
        .ok()
        .map(|rows| {
            let rows: Vec<_> = rows
                .into_iter()
                .map(|row| row.try_into().unwrap())
                .collect();
            rows.try_into().unwrap()
        })
}

/// Multiplies a matrix of three rows by a point whose fourth coordinate is 1.
fn times(matrix: [[f64; 4]; 3], p: Vec3) -> Vec3 {
    let row = |row: [f64; 4]| row[0] * p.x + row[1] * p.y + row[2] * p.z + row[3];
    matrix.map(row).into()
}

#[test]
fn the_matrices_lead_from_positions_to_pixels() {
    for camera in CAMERAS {
        let folder = folder(camera);
        let args = "render scene.ron -o out.npy --layers depth,z,position,id";
        run(&mut folder.strahl(args.split(' '))).quiet_success();
        let [depth, z, position, id] =
            ["depth", "z", "position", "id"].map(|name| array(&folder, &format!("out.{name}.npy")));
        let info = &info(&folder, &[])["cameras"][0];
        let extrinsics = matrix::<4>(&info["extrinsics"]).unwrap();
        let k = matrix::<3>(&info["intrinsics"]);
        assert_eq!(k.is_some(), camera == PERSPECTIVE);
        assert_eq!(info["affine"].is_null(), camera == PERSPECTIVE);
        let project = |point: Vec3| {
            let seen = times(extrinsics, point);
            match k {
                Some(k) => {
                    let [x, y, w] = k.map(|row| Vec3::from(row).dot(seen));
                    (x / w, y / w)
                }
                None => {
                    let pixel = times(matrix(&info["affine"]).unwrap(), point);
                    assert_eq!(pixel.z, 1.0);
                    (pixel.x, pixel.y)
                }
            }
        };
        let mut count = 0;
        for pixel in (0..depth.len()).filter(|pixel| depth[*pixel].is_finite()) {
            let point = Vec3::from_slice(&position[3 * pixel..]);
            let (column, row) = project(point);
            let error = (column - (pixel % 37) as f64).abs() + (row - (pixel / 37) as f64).abs();
            assert!(error < 1e-9, "{camera}: {column},{row} for pixel {pixel}");
            assert!((times(extrinsics, point).z - z[pixel]).abs() < 1e-9 * z[pixel]);
            count += 1;
        }
        assert!(count > 300, "{camera}: {count}");
        // The pixel at the unobstructed center of a ball shows the ball, nearer by its radius.
        let (center, radius) = (Vec3::new(0.3, 0.2, -1.5), 0.3);
        let (column, row) = project(center);
        let pixel = row.round() as usize * 37 + column.round() as usize;
        assert_eq!(id[pixel], 6.0, "ids of .npy files count from 1");
        let nearer = times(extrinsics, center).z - z[pixel];
        assert!(
            (0.2..=0.31).contains(&nearer),
            "{camera}: {nearer} of {radius}"
        );
    }
}

#[test]
fn info_lists_the_contents_of_a_scene() {
    let folder = folder(PERSPECTIVE);
    let info = info(&folder, &[]);
    assert_eq!(info["format"], 1);
    assert_eq!(info["version"], env!("CARGO_PKG_VERSION"));
    let bytes = |name| fs::metadata(folder.path(name)).unwrap().len();
    let files = json!([
        {"file": "scene.ron", "bytes": bytes("scene.ron"), "used_by": []},
        {"file": "balls.csv", "bytes": bytes("balls.csv"), "used_by": ["scene.ron"]},
    ]);
    assert_eq!(info["files"], files);
    assert_eq!(
        info["image"],
        json!({"width": 37, "height": 29, "samples": 4})
    );
    assert_eq!(info["background"], json!([0.0, 0.2, 0.4]));
    let table = json!({
        "geometry": 2, "name": "balls", "file": "balls.csv", "rows": 3, "first_id": 2,
        "columns": ["x", "y", "z", "radius"],
    });
    let geometries = json!({"total": 6, "planes": 1, "spheres": 2, "discs": 0, "rectangles": 0, "triangles": 0, "boxes": 0,
        "cylinders": 0, "cones": 0, "capsules": 0, "ellipsoids": 0, "toruses": 0, "meshes": 0, "solids": 0, "tables": [table],
        "parts": []});
    assert_eq!(info["geometries"], geometries);
    let (min, max) = (
        [-1.2 - 0.4, 0.0 - 0.9, -4.0 - 0.4],
        [1.5 + 0.3, 1.0 + 0.5, 9.0 + 0.5],
    );
    assert_eq!(info["bounds"], json!({"min": min, "max": max}));

    let [camera] = &info["cameras"].as_array().unwrap()[..] else {
        panic!("{info}");
    };
    assert_eq!(
        (&camera["name"], &camera["kind"]),
        (&Value::Null, &json!("Perspective"))
    );
    assert_eq!(camera["eye"], json!([0.5, 1.0, 3.0]));
    assert_eq!(camera["gaze"], json!([-0.5, -1.0, -6.0]));
    assert_eq!(camera["up"], json!([0.1, 1.0, 0.0]));
    assert_eq!(camera["fov_degrees"], 50.0);
    let report = plain_loop(&folder, WHOLE);
    assert_eq!(camera["seen"], report.len());
    assert_eq!(camera["unseen"], 6 - report.len());
    for (name, index) in [("nearest", 0), ("farthest", 1)] {
        let depth = |entry: &&Value| entry["depth"][index].as_f64().unwrap();
        let order = |a: &&Value, b: &&Value| depth(a).total_cmp(&depth(b));
        let entries = report.iter();
        let expected = if index == 0 {
            entries.min_by(order)
        } else {
            entries.max_by(order)
        };
        let expected = expected.unwrap();
        for field in ["id", "geometry", "row", "name"] {
            assert_eq!(camera[name][field], expected[field], "{name} {field}");
        }
        assert_eq!(camera[name]["depth"], expected["depth"][index]);
    }
}

#[test]
fn the_size_can_be_an_argument() {
    let folder = folder(SQUARE);
    let info = info(&folder, &["--size", "5x3", "--threads", "1"]);
    assert_eq!(
        (&info["image"]["width"], &info["image"]["height"]),
        (&json!(5), &json!(3))
    );
    let camera = &info["cameras"][0];
    // The two steps from the first row to the last span 4 units.
    assert_eq!(
        (&camera["scale"], &camera["stretch"]),
        (&json!(4.0), &json!(false))
    );
    let affine = matrix::<4>(&camera["affine"]).unwrap();
    let right = Vec3::from_slice(&affine[0]);
    assert!((right.length() - 0.5).abs() < 1e-15, "{right}");
    for args in [
        ["--size", "0x3"],
        ["--threads", "0"],
        ["--output-format", "xml"],
    ] {
        let done = run(folder.strahl(["info", "scene.ron"]).args(args));
        done.failure(2, &args);
    }
}

#[test]
fn the_default_output_is_lines() {
    let folder = folder(PERSPECTIVE);
    let text = run(&mut folder.strahl(["info", "scene.ron"])).quiet_success();
    let text = String::from_utf8(text).unwrap();
    for line in [
        "files          \"scene.ron\", ",
        "               \"balls.csv\", 54 bytes\n",
        "picture        37x29, 4 samples per pixel\n",
        "geometries     6: 1 plane, 2 spheres, 3 rows of 1 table\n",
        "  geometries[2] \"balls\": 3 rows of \"balls.csv\", columns x, y, z, radius\n",
        "camera, Perspective\n",
        "  eye e        (0.5, 1.0, 3.0)\n",
        "  fov 2α       50.0 degrees\n",
        "  seen         5 of 6\n",
        "  farthest     geometries[0] \"floor\" at t = ",
    ] {
        assert!(text.contains(line), "no {line:?} in {text}");
    }
}

#[test]
fn standard_input_can_be_a_scene() {
    let folder = Folder::new();
    let args = ["info", "-", "--output-format", "json"];
    let stdout = run_with(&mut folder.strahl(args), JSON.as_bytes()).quiet_success();
    let info: Value = serde_json::from_slice(&stdout).unwrap();
    assert_eq!(
        info["files"],
        json!([{"file": "<stdin>", "bytes": JSON.len(), "used_by": []}])
    );
    assert_eq!(info["geometries"]["total"], 2);
}

#[test]
fn faults_are_shown_as_in_other_commands() {
    let folder = Folder::new();
    folder.write("bad.ron", RON.replace("0.5", "-0.5"));
    run(&mut folder.strahl(["info", "bad.ron"])).bad_scene("bad.ron", &["out-of-range", "-0.5"]);
    run(&mut folder.strahl(["info", "missing.ron"])).one_line(2, &["missing.ron"]);
    folder.write(
        "empty.ron",
        "(camera: Perspective(eye: (0, 0, 0), gaze: (0, 0, -1), fov: 90), geometries: [])",
    );
    let done = run(&mut folder.strahl(["info", "empty.ron"]));
    assert_eq!(done.status, Some(0));
    assert!(done.stderr.contains("empty-scene"), "{}", done.stderr);
    let text = String::from_utf8(done.stdout).unwrap();
    assert!(text.contains("bounds         none"), "{text}");
}

/// Two named cameras and one without a name: the second sees only the floor.
fn several() -> Folder {
    let folder = folder(PERSPECTIVE);
    let text = fs::read_to_string(folder.path("scene.ron")).unwrap();
    let away = "Orthographic(eye: (0, 5, 50), gaze: (0, -1, 1), scale: 2)";
    let cameras = format!("cameras: {{\"flat\": {SQUARE}, \"away\": {away}}},\n    background");
    folder.write("scene.ron", text.replace("background", &cameras));
    folder
}

#[test]
fn info_lists_every_camera() {
    let folder = several();
    let cameras = &info(&folder, &[])["cameras"];
    let of = |field: &str| {
        let cameras = cameras.as_array().unwrap().iter();
        cameras
            .map(|camera| camera[field].clone())
            .collect::<Vec<_>>()
    };
    assert_eq!(of("name"), [Value::Null, json!("flat"), json!("away")]);
    assert_eq!(of("kind"), ["Perspective", "Orthographic", "Orthographic"]);
    assert_eq!(of("seen"), [5, 5, 1]);
    assert_eq!(of("unseen"), [1, 1, 5]);
    let farthest = of("farthest");
    assert_eq!(farthest[2]["name"], "floor");
    assert!(farthest[0]["depth"] != farthest[1]["depth"]);
    let text = run(&mut folder.strahl(["info", "scene.ron"])).quiet_success();
    let text = String::from_utf8(text).unwrap();
    assert!(text.contains("\ncamera \"away\", Orthographic\n"), "{text}");
    let set = info(&folder, &["--set", "cameras.away.scale=8"]);
    assert_eq!(set["cameras"][2]["scale"], 8.0);
}

#[test]
fn an_animation_is_listed() {
    let folder = Folder::new();
    folder.write("m.ron", crate::many::MOVING);
    let text = run(&mut folder.strahl(["info", "m.ron"])).quiet_success();
    assert!(
        String::from_utf8(text)
            .unwrap()
            .contains("animation      3 frames, 2 per second, frame 0 shown\n")
    );
    let json = run(&mut folder.strahl(["info", "m.ron", "--output-format=json"])).quiet_success();
    let json: Value = serde_json::from_slice(&json).unwrap();
    assert_eq!(
        json["animation"],
        serde_json::json!({"fps": 2.0, "frames": 3, "frame": 0})
    );
}

#[test]
fn each_camera_has_its_own_report() {
    let folder = several();
    let args = "render scene.ron --all-cameras -q --report {camera}.json";
    run(&mut folder.strahl(args.split(' '))).quiet_success();
    let read =
        |name| -> Value { serde_json::from_slice(&fs::read(folder.path(name)).unwrap()).unwrap() };
    let (flat, away) = (read("flat.json"), read("away.json"));
    assert_eq!(flat["image"]["camera"], "flat");
    assert_eq!(away["image"]["camera"], "away");
    assert_eq!(flat["geometries"].as_array().unwrap().len(), 5);
    assert_eq!(away["geometries"][0]["pixels"], 37 * 29);
    let one = "render scene.ron --camera flat --report flat.again";
    run(&mut folder.strahl(one.split(' '))).quiet_success();
    assert_eq!(read("flat.again"), flat);
    // Without a placeholder for the camera, it is the report of the run.
    let args = [
        "render",
        "scene.ron",
        "--all-cameras",
        "-q",
        "--report",
        "-",
    ];
    let report = run(&mut folder.strahl(args)).quiet_success();
    let report: Value = serde_json::from_slice(&report).unwrap();
    assert_eq!(report["pictures"].as_array().unwrap().len(), 2);
}
