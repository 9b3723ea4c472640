//! `strahl pixel` of lit pictures and of those with outlines.

use serde_json::{Value, json};

use crate::support::{Folder, run};

const MATERIALS: [&str; 6] = [
    r##"Matte(color: "#b8860b")"##,
    r##"Phong(diffuse: "#b8860b", specular: "#ffe9a0", exponent: 20, reflection: "#404040")"##,
    r##"Mirror(color: "#ddeeff")"##,
    r##"Glass(color: "#ddffee", ior: 1.5)"##,
    r##"Flat(color: "#123456")"##,
    r##"Emissive(color: "#ff8800", intensity: 0.7)"##,
];

/// Returns a scene with a ball of this material, in an image with more fields.
fn scene(image: &str, material: &str) -> String {
    format!(
        r##"(
    image: (width: 24, height: 18, {image}),
    camera: Perspective(eye: (0, 1, 5), gaze: (0, -0.1, -1), fov: 50),
    background: "#dfe7ee",
    lights: [
        Ambient(),
        Headlight(intensity: 0.1),
        Directional(direction: (-1, -2, -1), intensity: 0.6),
        Point(position: (2, 3, 2), intensity: 6, color: "#ffddaa"),
        Spot(position: (-2, 4, 1), look_at: (0, 1, 0), angle: 40, intensity: 4),
    ],
    geometries: [
        Plane(point: (0, 0, 0), normal: (0, 1, 0), color: "#ffffff"),
        Sphere(center: (0, 1, 0), radius: 1, material: {material}, name: "ball"),
        Sphere(center: (1.4, 0.5, 1), radius: 0.5, material: Glass(ior: 1.3)),
    ],
    outlines: (color: "#202020"),
)"##
    )
}

fn explained(folder: &Folder, pixel: &str) -> Value {
    let args = ["pixel", "lit.ron", pixel, "--output-format=json"];
    let stdout = run(&mut folder.strahl(args)).quiet_success();
    serde_json::from_slice(&stdout).unwrap()
}

#[test]
fn a_lit_pixel_has_the_bytes_of_the_picture() {
    for material in MATERIALS {
        for image in ["", "samples: 4, exposure: 0.5, tone_mapping: Neutral"] {
            let folder = Folder::new();
            folder.write("lit.ron", scene(image, material));
            run(&mut folder.strahl(["render", "lit.ron", "-q"])).quiet_success();
            let picture = image::open(folder.path("lit.png")).unwrap().to_rgb8();
            for (x, y) in [
                (0, 0),
                (12, 8),
                (11, 10),
                (17, 5),
                (12, 2),
                (16, 10),
                (3, 17),
            ] {
                let value = explained(&folder, &format!("{x},{y}"));
                let expected = json!(picture.get_pixel(x, 17 - y).0);
                assert_eq!(value["byte"], expected, "{material} {image} {x},{y}");
            }
        }
    }
}

#[test]
fn a_lit_pixel_is_explained_step_by_step() {
    let folder = Folder::new();
    folder.write("lit.ron", scene("", MATERIALS[1]));
    let stdout = run(&mut folder.strahl(["pixel", "lit.ron", "12,9"])).quiet_success();
    let text = String::from_utf8(stdout).unwrap();
    for line in [
        "  ray of depth 0\n",
        "    hits [1] \"ball\" at t = ",
        "      light [3] point\n",
        "        n·l = ",
        "        r·v = ",
        "      material phong, L = lin(diffuse) · Σ I + ",
        "        exponent = 20.0\n",
        "        Σ I = ",
        "        ray of depth 1, leaves [1] \"ball\"\n",
        "\nlight of the pixel, the mean of 1\n",
    ] {
        assert!(text.contains(line), "{line:?} is missing in\n{text}");
    }
    let value = explained(&folder, "12,9");
    assert_eq!(value["strahl"], "pixel/1");
    let surface = &value["light"]["samples"][0]["steps"]["surface"];
    assert_eq!(surface["lights"].as_array().unwrap().len(), 5);
    let sum: f64 = surface["lights"]
        .as_array()
        .unwrap()
        .iter()
        .filter_map(|light| light["terms"]["light"][0].as_f64())
        .sum();
    assert!((sum - surface["terms"]["irradiance"][0].as_f64().unwrap()).abs() < 1e-12);
}

#[test]
fn an_inked_pixel_names_the_neighbor() {
    let folder = Folder::new();
    let text = scene("", MATERIALS[0]);
    let flat = text.split("    lights: [").next().unwrap().to_owned()
        + r##"geometries: [Sphere(center: (0, 1, 0), radius: 1, color: "#ff0000")], outlines: ())"##;
    for text in [text, flat] {
        folder.write("lit.ron", &text);
        let inked = (0..24).map(|x| explained(&folder, &format!("{x},9")));
        let inked: Vec<_> = inked
            .filter(|value| !value["light"]["samples"][0]["inked_by"].is_null())
            .collect();
        assert!(!inked.is_empty());
        let by = &inked[0]["light"]["samples"][0]["inked_by"];
        assert!(by["right"].is_i64() && by["up"].is_i64(), "{by}");
    }
}

#[test]
fn a_flat_pixel_has_no_light() {
    let folder = Folder::with_scenes();
    let args = ["pixel", "scene.ron", "8,12", "--output-format=json"];
    let stdout = run(&mut folder.strahl(args)).quiet_success();
    let value: Value = serde_json::from_slice(&stdout).unwrap();
    assert!(value.get("light").is_none(), "{value}");
}

/// Compares the bytes of pixels with those of the picture, at every edge and at some places between.
fn compare_pixels(folder: &Folder, name: &str, most: usize) {
    run(&mut folder.strahl(["render", name, "-q", "-o", "picture.png"])).quiet_success();
    let picture = image::open(folder.path("picture.png")).unwrap().to_rgb8();
    let (width, height) = picture.dimensions();
    let is_edge = |x: u32, y: u32| {
        let own = picture.get_pixel(x, y);
        (x + 1 < width && picture.get_pixel(x + 1, y) != own)
            || (y + 1 < height && picture.get_pixel(x, y + 1) != own)
    };
    let all = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
    let edges: Vec<_> = all.filter(|(x, y)| is_edge(*x, *y)).collect();
    assert!(!edges.is_empty(), "{name}");
    for (x, y) in edges.iter().step_by(edges.len().div_ceil(most)) {
        let pixel = format!("{x},{y}");
        let args = ["pixel", name, &pixel, "--from-top", "--output-format=json"];
        let stdout = run(&mut folder.strahl(args)).quiet_success();
        let value: Value = serde_json::from_slice(&stdout).unwrap();
        let bytes = picture.get_pixel(*x, *y).0;
        assert_eq!(value["byte"], json!(bytes), "{name} {pixel}");
        let stdout = run(&mut folder.strahl(&args[..4])).quiet_success();
        let text = String::from_utf8(stdout).unwrap();
        let [r, g, b] = bytes;
        let last = text.lines().last().unwrap();
        assert!(
            last.contains(&format!("({r}, {g}, {b})")),
            "{pixel}: {last}"
        );
    }
}

#[test]
fn a_flat_pixel_has_the_bytes_of_the_picture() {
    let folder = Folder::new();
    let orbit = std::fs::read_to_string("scenes/orbit.ron").unwrap();
    folder.write(
        "orbit.ron",
        orbit.replace("width: 480, height: 270", "width: 48, height: 27"),
    );
    compare_pixels(&folder, "orbit.ron", 120);
    let geometries = r##"
        Sphere(center: (0, 0, -3), radius: 1, color: "#f00"),
        Sphere(center: (0.3, 0.6, -2.5), radius: 0.6, color: "#ff0000"),
        Box(min: (-1.4, -0.8, -4), max: (-0.2, 0.4, -2.5), color: "#20c0ff"),"##;
    let motley = r##"
        Difference(
            of: Box(min: (0.6, -1, -4), max: (2, 0.2, -2.6), color: "#40ff40"),
            minus: [Sphere(center: (0.8, 0, -2.6), radius: 0.7, color: "#7f8081")],
        ),"##;
    for image in ["samples: 4", "samples: 9", "samples: 16"] {
        for (number, extra) in ["", motley].into_iter().enumerate() {
            for (outlined, more) in ["", "outlines: (width: 1.5),"].into_iter().enumerate() {
                let name = format!("{number}{outlined}.ron");
                folder.write(
                    &name,
                    format!(
                        r##"(image: (width: 40, height: 20, {image}), camera: Perspective(eye: (0, 0, 0), gaze: (0, 0, -1), fov: 90),
    background: "#7f8081", {more} geometries: [{geometries}{extra}])"##
                    ),
                );
                compare_pixels(&folder, &name, 25);
            }
        }
    }
}

#[test]
fn a_flat_pixel_names_its_samples() {
    let folder = Folder::new();
    folder.write(
        "s.ron",
        r##"(image: (width: 200, height: 100, samples: 4), camera: Perspective(eye: (0, 0, 0), gaze: (0, 0, -1), fov: 90),
    geometries: [Sphere(center: (0, 0, -3), radius: 1, color: "#f00")])"##,
    );
    let args = ["pixel", "s.ron", "96,32", "--from-top"];
    let text = String::from_utf8(run(&mut folder.strahl(args)).quiet_success()).unwrap();
    assert!(
        text.contains("\nsamples, from the top left\n  0 sees "),
        "{text}"
    );
    assert!(
        text.contains("\nlight of the pixel, the mean of 4\n"),
        "{text}"
    );
    assert!(!text.contains("exposed"), "{text}");
    assert!(text.contains("bytes          (188, 0, 0)"), "{text}");
}

/// Returns three numbers.
fn three(value: &Value) -> [f64; 3] {
    serde_json::from_value(value.clone()).unwrap()
}

/// Returns the sum of lights.
fn total(lights: impl IntoIterator<Item = [f64; 3]>) -> [f64; 3] {
    let add = |sum: [f64; 3], light: [f64; 3]| [0, 1, 2].map(|at| sum[at] + light[at]);
    lights.into_iter().fold([0.0; 3], add)
}

fn are_near(one: [f64; 3], other: [f64; 3]) -> bool {
    let is_near = |(one, other): (f64, f64)| (one - other).abs() <= 1e-12 * one.abs().max(1.0);
    one.into_iter().zip(other).all(is_near)
}

/// Asserts that the emitters at the end of a ray, which are few, are chosen in proportion to their weights.
#[track_caller]
fn assert_weights(ray: &Value) -> usize {
    let Some(emitters) = ray["emitters"].as_array() else {
        return 0;
    };
    let terms = ray["terms"].as_array().unwrap().iter();
    let mut sums = terms.filter(|term| term["name"] == "weights");
    let sum = sums.next().unwrap()["numbers"][0].as_f64().unwrap();
    let all = emitters.iter().chain([&ray["emitter"]]);
    let weights: Vec<_> = all
        .map(|of| {
            let [weight, part] = ["weight", "probability"].map(|name| of[name].as_f64().unwrap());
            assert!((weight - part * sum).abs() <= 1e-12 * sum, "{of}");
            weight
        })
        .collect();
    let of_all = weights[..emitters.len()].iter().sum::<f64>();
    assert!((of_all - sum).abs() <= 1e-12 * sum, "{of_all} {sum}");
    assert!(emitters.contains(&ray["emitter"]));
    emitters.len()
}

#[test]
fn the_paths_of_a_pixel_add_up_to_its_light() {
    let rough = [
        r##"Metal(color: "#ffd27f", roughness: 0.3)"##,
        r##"Glass(roughness: 0.4)"##,
    ];
    let (mut most_rays, mut most_emitters) = (0, 0);
    for material in MATERIALS.into_iter().chain(rough) {
        let folder = Folder::new();
        let lights =
            r##"lighting: Path(samples: 4, seed: 3), lights: [Environment(color: "#456"),"##;
        let text = scene("", material).replace("lights: [", lights);
        folder.write(
            "lit.ron",
            text.replace("outlines: (color: \"#202020\"),", ""),
        );
        for pixel in ["12,8", "12,2", "16,10", "3,17"] {
            let whole = explained(&folder, pixel);
            let light = three(&whole["light"]["light"]);
            let by_depth = whole["light"]["paths"]["by_depth"].as_array().unwrap();
            assert!(
                are_near(total(by_depth.iter().map(three)), light),
                "{material} {pixel}"
            );
            let paths = (0..4).map(|sample| {
                let sample = format!("--sample={sample}");
                let args = ["pixel", "lit.ron", pixel, &sample, "--output-format=json"];
                let stdout = run(&mut folder.strahl(args)).quiet_success();
                let value: Value = serde_json::from_slice(&stdout).unwrap();
                let path = &value["light"]["paths"]["path"];
                let rays = path["rays"].as_array().unwrap();
                most_rays = most_rays.max(rays.len());
                let emitters = rays.iter().map(assert_weights);
                most_emitters = emitters.fold(most_emitters, usize::max);
                let light = three(&path["light"]);
                let adds = total(rays.iter().map(|ray| three(&ray["adds"])));
                assert!(are_near(adds, light), "{material} {pixel} {sample}");
                light
            });
            let mean = total(paths).map(|sum| sum / 4.0);
            assert!(
                are_near(mean, light),
                "{material} {pixel} {mean:?} {light:?}"
            );
        }
    }
    assert!(
        most_rays > 4 && most_emitters == 5,
        "{most_rays} {most_emitters}"
    );
}

#[test]
fn only_paths_have_samples_to_tell() {
    let folder = Folder::new();
    folder.write("lit.ron", scene("", MATERIALS[0]));
    let done = run(&mut folder.strahl(["pixel", "lit.ron", "3,3", "--sample", "0"]));
    done.failure(2, &["--sample", "lighting: Path()"]);
}
