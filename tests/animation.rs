//! The frames of a scene, through the public API.

use strahl::{Color, Document, ErrorKind, ReadOptions, Scene, Shape, Syntax};

fn scene(text: &str) -> Scene {
    Scene::from_text(text, Syntax::Ron).unwrap()
}

/// A scene with tracks; the world has a ball of radius 1 and a wall.
fn with_tracks(tracks: &str) -> Scene {
    scene(&format!(
        r##"(
            image: (width: 32, height: 24),
            camera: Perspective(eye: (0, 0, 5), look_at: (0, 0, 0), fov: 60),
            cameras: {{"side": Perspective(eye: (9, 0, 0), gaze: (-1, 0, 0), fov: 60)}},
            geometries: [
                Sphere(center: (0, 0, 0), radius: 1, color: "#ff0000", name: "ball"),
                Plane(point: (0, -1, 0), normal: (0, 1, 0), color: "#00ff00"),
            ],
            animation: (fps: 10, frames: 21, tracks: {{{tracks}}}),
        )"##
    ))
}

fn pixels(scene: &Scene) -> Vec<u8> {
    scene.render().unwrap().pixels().to_vec()
}

fn radius(scene: &Scene, index: usize) -> f64 {
    match scene.world().geometries()[index].shape() {
        Shape::Sphere(sphere) => sphere.radius(),
        other => panic!("a sphere was expected, not {other:?}"),
    }
}

#[test]
fn a_scene_is_its_first_frame() {
    let scene = Scene::from_path("scenes/tracks.ron").unwrap();
    let animation = scene.animation().unwrap();
    assert_eq!((animation.fps(), animation.frames()), (24.0, 97));
    assert_eq!(animation.seconds(96), 4.0);
    let first = scene.frame(0).unwrap();
    assert_eq!(first.camera(), scene.camera());
    assert_eq!(first.world(), scene.world());
    assert_eq!(pixels(&first), pixels(&scene));
    assert_ne!(pixels(&scene.frame(30).unwrap()), pixels(&scene));
}

#[test]
fn a_track_overrides_the_value_of_the_file_from_the_first_frame() {
    let scene = with_tracks(r#""camera.eye": [(1, (0, 0, 7)), (2, (0, 0, 9))]"#);
    let eye = |frame: u32| scene.frame(frame).unwrap().camera().eye().z;
    assert_eq!([scene.camera().eye().z, eye(0), eye(10)], [7.0; 3]);
    assert_eq!((eye(15), eye(20)), (8.0, 9.0));
}

#[test]
fn frames_are_independent() {
    let tracks = r##"
        "camera.up": [(0, (0, 1, 0)), (2, (1, 1, 0), Smooth)],
        "geometries[0].center[0]": [(0, 0), (1, 1, Smooth), (2, 0.5, Smooth)],
        "geometries[1].color": [(0, "#00ff00"), (2, "#0000ff")],
        "background": [(0, "#000"), (2, (1, 1, 0.5))],
    "##;
    let scene = with_tracks(tracks);
    let forwards: Vec<_> = (0..21).map(|n| scene.frame(n).unwrap()).collect();
    for number in (0..21).rev() {
        // Every frame can be reached from any other.
        let again = forwards[(number as usize * 7) % 21].frame(number).unwrap();
        assert_eq!(again.camera(), forwards[number as usize].camera());
        assert_eq!(again.world(), forwards[number as usize].world());
    }
    let colors = forwards
        .iter()
        .map(|frame| frame.world().geometries()[1].color());
    let [first, .., last] = colors.collect::<Vec<_>>()[..] else {
        panic!("there are 21 frames");
    };
    assert_eq!(first, Color::new(0.0, 1.0, 0.0));
    assert_eq!(last, Color::new(0.0, 0.0, 1.0));
}

#[test]
fn unchanged_parts_are_shared() {
    let scene = with_tracks(r#""camera.eye": [(0, (0, 0, 5)), (2, (0, 0, 9))]"#);
    let frame = scene.frame(9).unwrap();
    assert!(std::ptr::eq(frame.world(), scene.world()));
    let moved = with_tracks(r#""geometries[0].radius": [(0, 1), (2, 3)]"#);
    assert!(std::ptr::eq(moved.clone().world(), moved.world()));
    assert_eq!(radius(&moved.frame(10).unwrap(), 0), 2.0);
    assert_eq!(radius(&moved, 0), 1.0);
    assert_eq!(moved.frame(10).unwrap().name(0), Some("ball"));
}

#[test]
fn a_selected_camera_is_kept() {
    let tracks = r#"
        "camera.fov": [(0, 60), (2, 30)],
        "cameras[\"side\"].eye": [(0, (9, 0, 0)), (2, (7, 0, 0))],
    "#;
    let scene = with_tracks(tracks).with_camera("side").unwrap();
    let frame = scene.frame(10).unwrap();
    assert_eq!(frame.camera().eye().x, 8.0);
    assert!(frame.has_camera());
    assert_eq!(frame.frame(20).unwrap().camera().eye().x, 7.0);
}

#[test]
fn frames_beyond_the_last_are_rejected() {
    let refused = |scene: &Scene, number| {
        let error = scene.frame(number).unwrap_err();
        assert_eq!(error.kind(), ErrorKind::Usage);
        error.to_string()
    };
    assert_eq!(
        refused(&with_tracks(""), 21),
        "there is no frame 21, the animation has 21: 0 to 20"
    );
    let still = Scene::from_path("scenes/sphere.ron").unwrap();
    assert_eq!(still.animation(), None);
    assert_eq!(pixels(&still.frame(0).unwrap()), pixels(&still));
    assert_eq!(
        refused(&still, 1),
        "there is no frame 1, the scene has no animation"
    );
}

#[test]
fn both_syntaxes_have_the_same_frames() {
    for path in [
        "scenes/tracks.ron",
        "scenes/orbit.ron",
        "tests/valid/animation.ron",
    ] {
        let json = Document::from_path(path).unwrap();
        let json = json.convert(Syntax::Json).unwrap().text;
        let twin = Scene::from_text(json, Syntax::Json).unwrap();
        let scene = Scene::from_path(path).unwrap();
        assert_eq!(twin.animation(), scene.animation());
        for number in 0..scene.animation().unwrap().frames() {
            let [one, other] = [&scene, &twin].map(|scene| scene.frame(number).unwrap());
            assert_eq!(one.camera(), other.camera());
            assert_eq!(one.world(), other.world());
        }
    }
}

#[test]
fn the_defaults_of_a_table_can_be_animated() {
    let folder = std::env::temp_dir().join(format!("strahl-frames-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    std::fs::write(folder.join("bare.csv"), "x,y,z\n0,0,0\n0,0,-9\n").unwrap();
    let some = "x,y,z,radius,r,g,b\n0,0,0,,1,0,0\n3,0,0,7,,,\n";
    std::fs::write(folder.join("some.csv"), some).unwrap();
    let text = r##"(
        camera: Perspective(eye: (0, 0, 99), gaze: (0, 0, -1), fov: 60),
        geometries: [
            Spheres(file: "bare.csv", radius: 1, color: "#ff0000", name: "bare"),
            Spheres(file: "some.csv", radius: 1, color: "#ff0000", name: "some"),
        ],
        animation: (fps: 1, frames: 3, tracks: {
            "geometries[\"bare\"].radius": [(0, 1), (2, 3)],
            "geometries[\"some\"].radius": [(0, 1), (2, 5)],
            "geometries[\"some\"].color": [(0, "#ff0000"), (2, "#0000ff", Step)],
        }),
    )"##;
    let options = ReadOptions::new().syntax(Syntax::Ron).folder(&folder);
    let document = Document::from_reader("frames", text.as_bytes(), &options).unwrap();
    std::fs::remove_dir_all(&folder).unwrap();
    assert_eq!(document.diagnostics(), []);
    let scene = Scene::try_from(document).unwrap();
    let radii = |number| {
        let frame = scene.frame(number).unwrap();
        [0, 1, 2, 3].map(|index| radius(&frame, index))
    };
    assert_eq!(radii(0), [1.0, 1.0, 1.0, 7.0]);
    assert_eq!(radii(1), [2.0, 2.0, 3.0, 7.0]);
    assert_eq!(radii(2), [3.0, 3.0, 5.0, 7.0]);
    assert_eq!(
        radii(0),
        [1.0, 1.0, 1.0, 7.0],
        "frames do not write over each other"
    );
    let last = scene.frame(2).unwrap();
    let colors = [2, 3].map(|index| last.world().geometries()[index].color());
    assert_eq!(
        colors,
        [Color::new(1.0, 0.0, 0.0), Color::new(0.0, 0.0, 1.0)]
    );
}

#[test]
fn several_threads_render_frames_of_one_scene() {
    fn is_shared<T: Send + Sync>(value: T) -> T {
        value
    }
    let scene = is_shared(with_tracks(
        r#""camera.eye": [(0, (0, 0, 5)), (2, (0, 0, 9))]"#,
    ));
    let pictures: Vec<_> = std::thread::scope(|scope| {
        let draw = |number| pixels(&scene.frame(number).unwrap());
        let threads: Vec<_> = [3, 3, 20].map(|n| scope.spawn(move || draw(n))).into();
        threads
            .into_iter()
            .map(|thread| thread.join().unwrap())
            .collect()
    });
    assert_eq!(pictures[0], pictures[1]);
    assert_ne!(pictures[0], pictures[2]);
}

/// A lit scene: a ball of gold and a ball of glass.
const LIT: &str = r##"(
    image: (width: 32, height: 24, exposure: -1),
    camera: Perspective(eye: (0, 0, 5), look_at: (0, 0, 0), fov: 60),
    lights: [Ambient(), Point(position: (0, 4, 4), intensity: 20, name: "key")],
    materials: {"gold": Phong(diffuse: "#b8860b")},
    outlines: (width: 1),
    geometries: [
        Sphere(center: (-1, 0, 0), radius: 1, material: Named("gold")),
        Sphere(center: (1, 0, 0), radius: 1, material: Glass()),
        Plane(point: (0, -1, 0), normal: (0, 1, 0), color: "#ffffff"),
    ],
)"##;

/// Returns the lit scene with one value set.
fn lit_with(setting: &str) -> Scene {
    let options = ReadOptions::new().syntax(Syntax::Ron);
    let options = options.set(setting.parse().unwrap());
    let document = Document::from_reader("lit.ron", LIT.as_bytes(), &options).unwrap();
    Scene::try_from(document).unwrap()
}

#[test]
fn lights_materials_and_the_picture_change_over_time() {
    for (path, keys, last) in [
        ("lights.key.intensity", "[(0, 20), (2, 2)]", "2"),
        (
            "lights[1].position",
            "[(0, (0, 4, 4)), (2, (4, 0, 4))]",
            "(4, 0, 4)",
        ),
        ("lights[1].position[0]", "[(0, 0), (2, 3)]", "3"),
        ("lights[0].color", r##"[(0, "#fff"), (2, "#00f")]"##, "#00f"),
        ("materials.gold.exponent", "[(0, 32), (2, 2)]", "2"),
        (
            "materials.gold.diffuse",
            r##"[(0, "#000"), (2, "#0f0")]"##,
            "#0f0",
        ),
        ("geometries[1].material.ior", "[(0, 1.5), (2, 1.1)]", "1.1"),
        ("image.exposure", "[(0, -1), (2, 1)]", "1"),
        ("outlines.width", "[(0, 1), (2, 3)]", "3"),
    ] {
        let animation = format!("(fps: 10, frames: 21, tracks: {{\"{path}\": {keys}}})");
        let moving = lit_with(&format!("animation={animation}"));
        let frame = |number| pixels(&moving.frame(number).unwrap());
        assert_eq!(frame(0), pixels(&moving), "{path}");
        assert_ne!(frame(10), frame(0), "{path}");
        // At the last key, the picture is that of a file with this value.
        assert_eq!(
            frame(20),
            pixels(&lit_with(&format!("{path}={last}"))),
            "{path}"
        );
    }
}
