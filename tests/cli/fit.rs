//! Cameras that frame the scene: pictures measured pixel by pixel, `--fit`, and the camera that a
//! `Fit` becomes.

use std::fs;

use strahl::Scene;

use crate::support::{Folder, JSON, run};

const SCENE: &str = r##"( // a cluster
    image: (width: 80, height: 60), // small
    camera: Fit(from: (1, 0.5, 1)), // framed
    background: "#102030",
    geometries: [
        Sphere(center: (0, 0, 0), radius: 1, color: "#ff0000", name: "ball"),
        Sphere(center: (2, 0.5, -3), radius: 0.5, color: "#00ff00"),
        Disc(center: (-1, 2, 0.5), normal: (1, 1, 0), radius: 0.7, color: "#0000ff"),
    ],
)
"##;

const ANIMATION: &str = "
    animation: (frames: 6, fps: 1, ANIMATION),
)
";

fn animated(animation: &str) -> String {
    SCENE.replace("\n)\n", &ANIMATION.replace("ANIMATION", animation))
}

/// Returns the file of a picture; of a frame, where one is asked for.
fn picture(folder: &Folder, args: &[&str]) -> Vec<u8> {
    let frame = args.iter().position(|arg| *arg == "--frames");
    let frame = frame.map(|at| args[at + 1]);
    let name = frame.map_or("picture.ppm", |_| "picture-{frame}.ppm");
    run(&mut folder.strahl([&["render", "-q", "-o", name], args].concat())).quiet_success();
    fs::read(folder.path(name.replace("{frame}", frame.unwrap_or_default()))).unwrap()
}

/// Draws a picture and returns its free pixels on the left, on the right, at the top and at the
/// bottom.
fn margins(folder: &Folder, args: &[&str]) -> [usize; 4] {
    let picture = image::load_from_memory(&picture(folder, args))
        .unwrap()
        .to_rgb8();
    let background = image::Rgb([0x10, 0x20, 0x30]);
    let (width, height) = picture.dimensions();
    let is_free = |mut pixels: Box<dyn Iterator<Item = (u32, u32)>>| {
        pixels.all(|(x, y)| *picture.get_pixel(x, y) == background)
    };
    let column = |x: u32| is_free(Box::new((0..height).map(move |y| (x, y))));
    let row = |y: u32| is_free(Box::new((0..width).map(move |x| (x, y))));
    [
        (0..width).take_while(|x| column(*x)).count(),
        (0..width).rev().take_while(|x| column(*x)).count(),
        (0..height).take_while(|y| row(*y)).count(),
        (0..height).rev().take_while(|y| row(*y)).count(),
    ]
}

/// Asserts that opposite margins are equal, and that a pair is `part` of its side.
#[track_caller]
fn framed([left, right, top, bottom]: [usize; 4], (width, height): (usize, usize), part: f64) {
    assert!(left.abs_diff(right) <= 1, "{left} {right}");
    assert!(top.abs_diff(bottom) <= 1, "{top} {bottom}");
    let rest = |free: usize, side: usize| free as f64 - part * side as f64;
    let (across, down) = (rest(left, width), rest(top, height));
    assert!(
        across.min(down).abs() <= 1.0,
        "{left} of {width}, {top} of {height}"
    );
}

#[test]
fn everything_is_seen_with_the_margin_free() {
    let folder = Folder::new();
    folder.write("scene.ron", SCENE);
    for (projection, part) in [
        ("", 0.05),
        ("camera.projection=Perspective(fov: 110)", 0.05),
        ("camera.projection=Orthographic()", 0.05),
        ("camera.margin=0.2", 0.2),
        ("camera.margin=0", 0.0),
    ] {
        for (width, height) in [(400, 300), (500, 100), (100, 500)] {
            let size = format!("{width}x{height}");
            let set = if projection.is_empty() {
                "version=1"
            } else {
                projection
            };
            let found = margins(&folder, &["scene.ron", "--size", &size, "--set", set]);
            framed(found, (width, height), part);
        }
    }
}

#[test]
fn the_union_of_all_frames_is_framed_by_one_camera() {
    let folder = Folder::new();
    let tracks = r#"tracks: {"geometries.ball.center": [(0, (0, 0, 0)), (5, (9, 1, -2))]}"#;
    folder.write("move.ron", animated(tracks));
    folder.write("orbit.ron", animated("orbit: (around: (1, 0, 0))"));
    for scene in ["move.ron", "orbit.ron"] {
        let frames: Vec<_> = (0..6)
            .map(|frame| {
                let frame = frame.to_string();
                margins(&folder, &[scene, "--size", "400x300", "--frames", &frame])
            })
            .collect();
        let least = |side: usize| frames.iter().map(|frame| frame[side]).min().unwrap();
        framed([0, 1, 2, 3].map(least), (400, 300), 0.05);
    }
    let scene = Scene::from_path(folder.path("move.ron")).unwrap();
    let last = scene.frame(5).unwrap();
    assert_eq!(scene.camera(), last.camera());
    // An orbit keeps the distance.
    let scene = Scene::from_path(folder.path("orbit.ron")).unwrap();
    let around = strahl::Vec3::X;
    let distance = |scene: &Scene| (scene.camera().eye() - around).length();
    let turned = scene.frame(2).unwrap();
    assert!((distance(&scene) - distance(&turned)).abs() < 1e-12);
    assert!((scene.camera().eye() - turned.camera().eye()).length() > 1.0);
}

#[test]
fn the_direction_the_angle_and_the_margin_change_over_time() {
    let folder = Folder::new();
    let scene = animated(
        r#"tracks: {
            "camera.from": [(0, (1, 0, 0)), (5, (0, 0.5, 1))],
            "camera.margin": [(0, 0), (5, 0.25)],
            "camera.projection.fov": [(0, 20), (5, 70)],
        }"#,
    );
    let scene = scene.replace("(1, 0.5, 1)", "(1, 0, 0), projection: Perspective(fov: 20)");
    folder.write("scene.ron", scene);
    for (frame, part) in [("0", 0.0), ("2", 0.1), ("5", 0.25)] {
        let found = margins(
            &folder,
            &["scene.ron", "--size", "400x300", "--frames", frame],
        );
        framed(found, (400, 300), part);
    }
    folder.write(
        "given.ron",
        animated(r#"tracks: {"camera.projection.fov": [(0, 20)]}"#),
    );
    let done = run(&mut folder.strahl(["validate", "given.ron"]));
    assert_eq!(done.status, Some(1));
    let report = String::from_utf8(done.stdout).unwrap();
    assert!(report.contains("`projection` is not given"), "{report}");
}

#[test]
fn fit_frames_whatever_camera_a_scene_has() {
    let folder = Folder::new();
    let (start, end) = (
        SCENE.find("    camera").unwrap(),
        SCENE.find("    background").unwrap(),
    );
    let with = |camera: &str| [&SCENE[..start], camera, &SCENE[end..]].concat();
    folder.write("none.ron", with(""));
    folder.write(
        "far.ron",
        with("camera: Perspective(eye: (0, 0, 99), gaze: (0, 0, 1), fov: 60),"),
    );
    folder.write(
        "flat.ron",
        with("camera: Orthographic(eye: (0, 0, 9), gaze: (0, 0, -1), scale: 1),"),
    );
    let tracks = r#"tracks: {"camera.eye": [(0, (0, 0, 9))]}"#;
    let moved = animated(tracks).replace(
        "Fit(from: (1, 0.5, 1))",
        "Perspective(eye: (0, 0, 9), gaze: (0, 0, -1), fov: 5)",
    );
    folder.write("moved.ron", moved);
    for scene in ["none.ron", "far.ron", "flat.ron", "moved.ron"] {
        for fit in ["--fit", "--fit=0,1,0", "--fit=(-1, 0.5, -2)"] {
            let found = margins(&folder, &[scene, fit, "--size", "400x300"]);
            framed(found, (400, 300), 0.05);
        }
    }
    let eye = |args: &[&str]| {
        let args = [&["info", "--output-format", "json"], args].concat();
        let found = run(&mut folder.strahl(args)).quiet_success();
        let found: serde_json::Value = serde_json::from_slice(&found).unwrap();
        found["cameras"][0].clone()
    };
    let (default, told) = (
        eye(&["far.ron", "--fit"]),
        eye(&["far.ron", "--fit=1,0.6,1"]),
    );
    assert_eq!(default, told);
    assert_eq!(default["fov_degrees"], 60.0);
    assert_eq!(eye(&["flat.ron", "--fit"])["kind"], "Orthographic");
    assert_eq!(eye(&["none.ron", "--fit"])["fov_degrees"], 35.0);
    assert_eq!(default["fit"], true);
    for wrong in [
        "--fit=0,0,0",
        "--fit=1,2",
        "--fit=a",
        "--fit=1,nan,0",
        "--fit=1e200,0,0",
    ] {
        let done = run(&mut folder.strahl(["render", "far.ron", wrong]));
        done.failure(2, &["--fit", "direction"]);
    }
    let empty = with("").replace(
        "Sphere(",
        "Plane(point: (0, 0, 0), normal: (0, 1, 0), color: \"#fff\"), // ",
    );
    let empty = empty.replace("Disc(", "// ");
    folder.write("planes.ron", empty);
    let done = run(&mut folder.strahl(["render", "planes.ron", "--fit"]));
    done.bad_scene("planes.ron", &["cannot-fit"]);
}

#[test]
fn an_explicit_camera_draws_the_same_picture() {
    let folder = Folder::new();
    folder.write("scene.ron", SCENE);
    folder.write("orbit.ron", animated("orbit: (around: (1, 0, 0))"));
    let picture = |args: &[&str]| picture(&folder, args);
    for projection in ["Fit(", "Fit(projection: Orthographic(), "] {
        folder.write("scene.ron", SCENE.replace("Fit(", projection));
        let convert = ["convert", "--explicit-camera", "scene.ron", "explicit.ron"];
        run(&mut folder.strahl(convert)).quiet_success();
        let text = fs::read_to_string(folder.path("explicit.ron")).unwrap();
        assert!(!text.contains("Fit"), "{text}");
        for kept in ["// a cluster", "// small", "), // framed"] {
            assert!(text.contains(kept), "{text}");
        }
        assert_eq!(picture(&["scene.ron"]), picture(&["explicit.ron"]));
        let convert = [
            "convert",
            "--explicit-camera",
            "--force",
            "scene.ron",
            "explicit.json",
        ];
        run(&mut folder.strahl(convert)).quiet_success();
        assert_eq!(picture(&["scene.ron"]), picture(&["explicit.json"]));
    }
    let convert = ["convert", "--explicit-camera", "orbit.ron", "explicit.ron"];
    run(&mut folder.strahl(convert)).quiet_success();
    let frame = ["orbit.ron", "--frames", "4"];
    assert_eq!(picture(&frame), picture(&["explicit.ron", "--frames", "4"]));

    folder.write("inside.ron", SCENE.replace("Fit(", "Fit(/* mine */ "));
    let convert = ["convert", "--explicit-camera", "inside.ron", "out.ron"];
    run(&mut folder.strahl(convert)).one_line(2, &["1 comment", "--force"]);
    let tracks = r#"tracks: {"camera.margin": [(0, 0)]}"#;
    folder.write(
        "track.ron",
        animated(tracks).replace("(1, 0.5, 1)", "(1, 0.5, 1), margin: 0"),
    );
    let convert = ["convert", "--explicit-camera", "track.ron", "out.ron"];
    run(&mut folder.strahl(convert)).one_line(2, &["`camera.margin`"]);
    assert!(!folder.path("out.ron").exists());
    // Without the option nothing is framed, and nothing has to be.
    run(&mut folder.strahl(["convert", "scene.ron", "--force", "same.json"])).quiet_success();
    let same = fs::read_to_string(folder.path("same.json")).unwrap();
    assert!(same.contains("\"Fit\"") && JSON != same, "{same}");
}

#[test]
fn bands_and_resumed_pictures_are_those_of_their_size() {
    let folder = Folder::new();
    folder.write("scene.ron", SCENE);
    let options = ["scene.ron", "--fit=0,0,1", "--size", "90x40", "-o"];
    run(&mut folder.strahl([&["render", "-q"], &options[..], &["whole.png"]].concat()))
        .quiet_success();
    for shard in ["0/2", "1/2"] {
        let args = [
            &["render", "-q", "--shard", shard],
            &options[..],
            &["part.png"],
        ]
        .concat();
        run(&mut folder.strahl(args)).quiet_success();
    }
    run(&mut folder.strahl([&["merge", "-q"], &options[..], &["part.png"]].concat()))
        .quiet_success();
    let read = |name: &str| fs::read(folder.path(name)).unwrap();
    assert_eq!(read("whole.png"), read("part.png"));
    let scene = Scene::from_path(folder.path("scene.ron")).unwrap();
    let options = strahl::RenderOptions::new();
    let hash = |size: &str| {
        let options = options.clone().size(size.parse().unwrap());
        scene.hash("a.png", &options).unwrap()
    };
    assert_ne!(hash("90x40"), hash("40x90"));
    let crop = [
        "render",
        "-q",
        "scene.ron",
        "--fit=0,0,1",
        "--size",
        "90x40",
    ];
    let crop = [&crop[..], &["--crop", "10,5,30,20", "-o", "crop.png"]].concat();
    run(&mut folder.strahl(crop)).quiet_success();
    let whole = image::load_from_memory(&read("whole.png"))
        .unwrap()
        .to_rgb8();
    let crop = image::load_from_memory(&read("crop.png"))
        .unwrap()
        .to_rgb8();
    assert_eq!(
        image::imageops::crop_imm(&whole, 10, 5, 30, 20).to_image(),
        crop
    );
}
