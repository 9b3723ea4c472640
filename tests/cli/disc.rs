//! A disc in every command, as the newest shape.

use serde_json::{Value, json};

use crate::support::{Folder, run};

const SCENE: &str = r##"(
    image: (width: 32, height: 24),
    camera: Perspective(eye: (0, 0, 0), gaze: (0, 0, -1), fov: 90),
    geometries: [
        Disc(center: (0, 0, -4), normal: (0, 0, 2), radius: 2, color: "#ff0000", name: "lid"),
        Sphere(center: (0, 0, -9), radius: 4, color: "#00ff00"),
    ],
    animation: (fps: 10, frames: 11, tracks: {"geometries.lid.radius": [(0, 2), (1, 1)]}),
)"##;

fn folder() -> Folder {
    let folder = Folder::new();
    folder.write("scene.ron", SCENE);
    folder
}

fn lines(folder: &Folder, args: &[&str]) -> String {
    String::from_utf8(run(&mut folder.strahl(args)).quiet_success()).unwrap()
}

fn number_of_pixels(folder: &Folder, args: &[&str]) -> usize {
    let args = [
        &["render", "scene.ron", "-o", "-", "--image-format", "ppm"],
        args,
    ]
    .concat();
    let ppm = run(&mut folder.strahl(args)).quiet_success();
    let pixels = &ppm[ppm.len() - 32 * 24 * 3..];
    let red = |pixel: &&[u8]| pixel[0] == 255;
    pixels.chunks(3).filter(red).count()
}

#[test]
fn a_disc_is_explained_number_by_number() {
    let folder = folder();
    let text = lines(&folder, &["pixel", "scene.ron", "16,12"]);
    let known =
        "  [0] \"lid\" Disc, center a (0.0, 0.0, -4.0), normal n (0.0, 0.0, 2.0), radius r 2.0\n";
    assert!(text.contains(known), "{text}");
    assert!(
        text.contains("      (a - o)·n = -8.0, d·n = -1.99"),
        "{text}"
    );
    assert!(text.contains("      |o + t·d - a|² = 0.05"), "{text}");
    assert!(text.contains(", r² = 4.0\n      t = 4.00"), "{text}");

    let args = ["pixel", "scene.ron", "0,0", "--output-format", "json"];
    let pixel: Value = serde_json::from_str(&lines(&folder, &args)).unwrap();
    let disc = &pixel["geometries"][0];
    assert_eq!((&disc["kind"], &disc["t"]), (&json!("Disc"), &Value::Null));
    assert_eq!(disc["center"], json!([0.0, 0.0, -4.0]));
    assert_eq!(disc["squared_radius"], json!(4.0));
    assert!(disc["squared_distance"].as_f64() > Some(4.0), "{disc}");
    assert_eq!(pixel["hit"], Value::Null);
}

#[test]
fn a_disc_is_counted_and_lies_within_its_bounds() {
    let folder = folder();
    let text = lines(&folder, &["info", "scene.ron"]);
    assert!(
        text.contains("geometries     2: 1 sphere, 1 disc\n"),
        "{text}"
    );
    let args = [
        "info",
        "scene.ron",
        "--set",
        "geometries[1].center[0]=9",
        "--output-format=json",
    ];
    let info: Value = serde_json::from_str(&lines(&folder, &args)).unwrap();
    assert_eq!(info["geometries"]["discs"], 1);
    assert_eq!(info["bounds"]["min"], json!([-2.0, -4.0, -13.0]));
    assert_eq!(info["bounds"]["max"], json!([13.0, 4.0, -4.0]));
}

#[test]
fn values_are_set_and_change_over_time() {
    let folder = folder();
    let whole = number_of_pixels(&folder, &[]);
    let half = number_of_pixels(
        &folder,
        &[
            "--set",
            "animation=null",
            "--set",
            "geometries.lid.radius=1",
        ],
    );
    assert!(
        0 < half && 3 * half < whole && whole < 5 * half,
        "{half} of {whole}"
    );
    let away = number_of_pixels(&folder, &["--set", "geometries.lid.normal=(0, 1, 1e-9)"]);
    assert_eq!(away, 0);
    let last = ["--frames", "10", "-o", "{frame}.png"];
    run(&mut folder.strahl([&["render", "scene.ron"][..], &last].concat())).quiet_success();
    assert!(folder.path("10.png").exists());
}

#[test]
fn a_disc_is_the_same_in_both_syntaxes() {
    let folder = folder();
    let before = number_of_pixels(&folder, &[]);
    run(&mut folder.strahl(["convert", "scene.ron", "scene.json"])).quiet_success();
    run(&mut folder.strahl(["convert", "scene.json", "scene.ron", "--force"])).quiet_success();
    assert_eq!(number_of_pixels(&folder, &[]), before);
    run(&mut folder.strahl(["fmt", "scene.ron", "scene.json"])).quiet_success();
    run(&mut folder.strahl(["fmt", "--check", "scene.ron", "scene.json"])).quiet_success();
}
