//! Orbiting cameras, through the public API.

use strahl::{Camera, Document, Scene, Syntax, Vec3, scene::Setting};

/// Returns a scene with orbiting cameras, with these fields of `orbit`.
fn with_orbit(orbit: &str) -> Scene {
    let text = format!(
        r##"(
            image: (width: 32, height: 24),
            camera: Perspective(eye: (3, 1, 5), look_at: (0.3, 0.2, 0.1), fov: 60),
            cameras: {{"side": Orthographic(eye: (5, 2, 0), gaze: (-1, 0, 0.5), scale: 3)}},
            geometries: [Sphere(center: (0, 0, 0), radius: 1, color: "#ff0000")],
            animation: (frames: 12, orbit: ({orbit})),
        )"##
    );
    Scene::from_text(text, Syntax::Ron).unwrap()
}

/// Returns the angle between two vectors, in radians.
fn angle(one: Vec3, other: Vec3) -> f64 {
    libm::atan2(one.cross(other).length(), one.dot(other))
}

fn assert_near(one: Vec3, other: Vec3) {
    assert!((one - other).length() < 1e-13, "{one} is not {other}");
}

// An earlier path went from distance 8.0 to 6.4 and back, by 0.29 to 5.85 degrees per frame.
#[test]
fn the_camera_orbits_at_constant_distance_and_speed() {
    let scene = Scene::from_path("scenes/orbit.ron").unwrap();
    let frames = scene.animation().unwrap().frames();
    let around = Vec3::new(0.0, 1.1, 0.0);
    let from = |number| scene.frame(number).unwrap().camera().eye() - around;
    let distance = from(0).length();
    let flat = |number| from(number) * Vec3::new(1.0, 0.0, 1.0);
    let step = std::f64::consts::TAU / f64::from(frames);
    for number in 0..frames {
        let relative = from(number).length() / distance - 1.0;
        assert!(relative.abs() < 1e-12, "frame {number}: {relative:e}");
        let next = angle(flat(number), flat((number + 1) % frames));
        assert!((next - step).abs() < 1e-12, "frame {number}: {next}");
    }
}

// Computed in Python from the equation in the manual, operation by operation.
#[test]
fn a_frame_is_exact() {
    let scene = Scene::from_path("scenes/orbit.ron").unwrap();
    let eye = scene.frame(8).unwrap().camera().eye();
    assert_eq!(eye.to_array(), [3.6999999999999997, 2.6, 6.408587988004847]);
}

#[test]
fn the_first_frame_is_the_scene_without_an_orbit() {
    let scene = with_orbit("around: (0.1, 0.2, 0.3), axis: (0.1, 0.7, 0.3), turns: 0.3");
    let still = scene.frame(0).unwrap();
    let text = r#"(camera: Perspective(eye: (3, 1, 5), look_at: (0.3, 0.2, 0.1), fov: 60), geometries: [])"#;
    let same = Scene::from_text(text, Syntax::Ron).unwrap();
    assert_eq!(still.camera(), same.camera());
    assert_eq!(scene.camera(), same.camera());
}

// About y by 90 degrees: (x, y, z) becomes (z, y, -x).
#[test]
fn every_camera_turns_with_all_its_vectors() {
    let scene = with_orbit("around: (0, 9, 0)");
    let quarter = scene.frame(3).unwrap();
    assert_near(quarter.camera().eye(), Vec3::new(5.0, 1.0, -3.0));
    let w = scene.camera().w();
    assert_near(quarter.camera().w(), Vec3::new(w.z, w.y, -w.x));
    let side = quarter.with_camera("side").unwrap();
    assert_near(side.camera().eye(), Vec3::new(0.0, 2.0, -5.0));
    assert_near(
        side.camera().w() * 1.25_f64.sqrt(),
        Vec3::new(-0.5, 0.0, -1.0),
    );
}

// Around x, the up direction turns as well, so the picture changes only by the world.
#[test]
fn up_turns_as_well() {
    let scene = with_orbit("around: (0, 0, 0), axis: (2, 0, 0)");
    let turned = scene.frame(3).unwrap();
    let of = |v: Vec3| Vec3::new(v.x, -v.z, v.y);
    for (one, other) in [
        (turned.camera().eye(), scene.camera().eye()),
        (turned.camera().u(), scene.camera().u()),
        (turned.camera().v(), scene.camera().v()),
        (turned.camera().w(), scene.camera().w()),
    ] {
        assert_near(one, of(other));
    }
}

#[test]
fn turns_set_number_and_direction() {
    let eye = |orbit: &str, number| with_orbit(orbit).frame(number).unwrap().camera().eye();
    let once = "around: (0, 0, 0)";
    assert_eq!(eye("around: (0, 0, 0), turns: 2", 3), eye(once, 6));
    assert_near(eye("around: (0, 0, 0), turns: -1", 3), eye(once, 9));
    assert_eq!(eye("around: (0, 0, 0), turns: 0", 5), eye(once, 0));
    // After a full turn, the camera is back in place to the last bit.
    assert_eq!(eye("around: (0.1, 0.3, 0.7), turns: 4", 3), eye(once, 0));
}

#[test]
fn frames_are_independent() {
    let scene = Scene::from_path("tests/valid/orbit.ron").unwrap();
    let cameras = |scene: &Scene| -> [Camera; 2] {
        let side = scene.clone().with_camera("side").unwrap();
        [*scene.camera(), *side.camera()]
    };
    let all: Vec<_> = (0..9).map(|number| scene.frame(number).unwrap()).collect();
    for number in 0..9 {
        let again = all[(number + 5) % 9].frame(number as u32).unwrap();
        assert_eq!(cameras(&again), cameras(&all[number]));
    }
    assert!(!std::ptr::eq(all[1].world(), all[2].world()));
}

#[test]
fn an_orbit_can_be_set() {
    let document = Document::from_path("tests/valid/orbit-alone.ron").unwrap();
    let setting = |text: &str| text.parse::<Setting>().unwrap();
    let eye = |settings: &[&str]| {
        let settings = settings.iter().map(|text| setting(text));
        let set = document.with(settings.collect::<Vec<_>>());
        let scene = Scene::try_from(set).unwrap();
        scene.frame(1).unwrap().camera().eye()
    };
    assert_ne!(eye(&["animation.orbit.turns=2"]), eye(&[]));
    assert_eq!(
        eye(&["animation.orbit.turns=2"]),
        eye(&["animation.orbit=(around: (0, 0, 0), turns: 2)"])
    );
    assert_ne!(eye(&["animation.orbit.axis=(1, 0, 0)"]), eye(&[]));
}
