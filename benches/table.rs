//! Measures reading a million spheres from a table against the same spheres as JSON:
//! `RAYON_NUM_THREADS=1 cargo bench --bench table`.
//!
//! Each figure is a ratio of medians of alternating runs; on Linux, of CPU times of the thread,
//! which exclude the work of other threads. The measured work is what `strahl validate` and
//! `strahl render` do before they build the world: read the file and check every number. The other
//! column is `serde_json` reading the JSON text into simple types, without checks.

use std::{
    fmt::Write as _,
    fs,
    hint::black_box,
    path::{Path, PathBuf},
};

use strahl::Document;

mod common;
use common::{Ball, Density, balls, bare, take_turns_on_core};

const COUNT: usize = 1_000_000;
const RUNS: usize = 7;

fn main() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("bench-table");
    fs::create_dir_all(&folder).expect("a folder");
    let spheres: Vec<Ball> = balls(COUNT, Density::Dense).collect();
    let json = json(&folder, &spheres);
    let text = fs::read_to_string(&json).expect("the scene");
    println!("{COUNT} spheres, JSON of {} bytes", text.len());
    println!(
        "{:<32} {:>10} {:>10} {:>7} {:>10} {:>7}",
        "", "table", "JSON", "ratio", "bare JSON", "ratio"
    );
    for (what, name, bytes) in [
        ("npy, f8, (N, 7)", "a.npy", npy(&spheres, "<f8", 7)),
        ("npy, f4, (N, 7)", "b.npy", npy(&spheres, "<f4", 7)),
        ("npy, f4, (N, 3)", "c.npy", npy(&spheres, "<f4", 3)),
        ("ply, double", "d.ply", ply(&spheres, ["double", "double"])),
        (
            "ply, double and float",
            "e.ply",
            ply(&spheres, ["double", "float"]),
        ),
        ("ply, float", "f.ply", ply(&spheres, ["float", "float"])),
        ("csv, seven columns", "g.csv", csv(&spheres)),
    ] {
        fs::write(folder.join(name), bytes).expect("the table");
        let geometry = format!("Spheres(file: \"{name}\", radius: 0.01, color: \"#fff\")");
        let scene = folder.join(name).with_extension("ron");
        fs::write(&scene, format!("({CAMERA}, geometries: [{geometry}])")).expect("the scene");
        let (table, whole) = take_turns_on_core(RUNS, || read(&scene), || read(&json));
        let bare = || {
            let text = fs::read_to_string(&json).expect("the scene");
            serde_json::from_str::<bare::Scene>(&text).expect("spheres")
        };
        let (again, bare) = take_turns_on_core(RUNS, || read(&scene), bare);
        println!(
            "{what:<32} {:>7.1} ms {:>7.1} ms {:>7.3} {:>7.1} ms {:>7.3}",
            table * 1e3,
            whole * 1e3,
            table / whole,
            bare * 1e3,
            again / bare,
        );
    }
    fs::remove_dir_all(&folder).expect("the folder goes");
}

const CAMERA: &str = "camera: Perspective(eye: (0, 0, 4), gaze: (0, 0, -1), fov: 40)";

fn read(scene: &Path) -> Document {
    let document = Document::from_path(scene).expect("a scene");
    assert!(!document.has_errors());
    black_box(document)
}

fn json(folder: &Path, spheres: &[Ball]) -> PathBuf {
    let mut text = String::from(
        "{\"camera\": {\"Perspective\": {\"eye\": [0, 0, 4], \"gaze\": [0, 0, -1], \"fov\": \
         40}}, \"geometries\": [\n",
    );
    for (index, ball) in spheres.iter().enumerate() {
        let comma = if index == 0 { "" } else { ",\n" };
        let (center, radius, color) = (ball.center, ball.radius, ball.color);
        write!(
            text,
            "{comma}{{\"Sphere\": {{\"center\": {center:?}, \"radius\": {radius:?}, \"color\": \
             {color:?}}}}}"
        )
        .expect("text");
    }
    text += "\n]}\n";
    let path = folder.join("twin.json");
    fs::write(&path, text).expect("the scene");
    path
}

/// The fields x, y, z, radius, r, g, b.
fn numbers(ball: &Ball) -> [f64; 7] {
    let ([x, y, z], [r, g, b]) = (ball.center, ball.color);
    [x, y, z, ball.radius, r, g, b]
}

fn npy(spheres: &[Ball], descr: &str, columns: usize) -> Vec<u8> {
    let rows = spheres.len();
    let header =
        format!("{{'descr': '{descr}', 'fortran_order': False, 'shape': ({rows}, {columns}), }}\n");
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend((header.len() as u16).to_le_bytes());
    bytes.extend(header.bytes());
    for number in spheres
        .iter()
        .flat_map(|ball| numbers(ball).into_iter().take(columns))
    {
        if descr == "<f4" {
            bytes.extend((number as f32).to_le_bytes());
        } else {
            bytes.extend(number.to_le_bytes());
        }
    }
    bytes
}

/// Writes center and radius in the first type, the color in the second.
fn ply(spheres: &[Ball], [kind, color]: [&str; 2]) -> Vec<u8> {
    let mut text = format!(
        "ply\nformat binary_little_endian 1.0\nelement vertex {}\n",
        spheres.len()
    );
    for (index, name) in ["x", "y", "z", "radius", "red", "green", "blue"]
        .iter()
        .enumerate()
    {
        let kind = if index < 4 { kind } else { color };
        writeln!(text, "property {kind} {name}").expect("text");
    }
    text += "end_header\n";
    let mut bytes = text.into_bytes();
    for ball in spheres {
        for (index, number) in numbers(ball).into_iter().enumerate() {
            let kind = if index < 4 { kind } else { color };
            if kind == "double" {
                bytes.extend(number.to_le_bytes());
            } else {
                bytes.extend((number as f32).to_le_bytes());
            }
        }
    }
    bytes
}

fn csv(spheres: &[Ball]) -> Vec<u8> {
    let mut text = String::from("x,y,z,radius,r,g,b\n");
    for ball in spheres {
        let [x, y, z, radius, r, g, b] = numbers(ball);
        writeln!(text, "{x:?},{y:?},{z:?},{radius:?},{r:?},{g:?},{b:?}").expect("text");
    }
    text.into_bytes()
}
