//! The output of a `main` that returns an error: `Error: ` and its `Debug`.

use strahl::{
    Document, ReadOptions, Scene, Size, Syntax, diagnostic::Code, film::Samples, jobs::Shard,
    render::Layer, scene::Setting,
};

const WRONG: &str = "(
    camera: Perspective(eye: (0, 0, 0), gaze: (0, 0, -1), fov: 400),
    background: (2, 0, 0),
    geometries: [Sphere(center: (0, 0, -3), radius: -1, color: \"red\")],
)";

#[test]
fn a_scene_error_lists_every_fault_with_its_position() {
    let error = Document::from_text("mine.ron", WRONG, Syntax::Ron);
    let error = Scene::try_from(error).unwrap_err();
    let messages = format!("{error:?}");
    let lines: Vec<_> = messages.lines().collect();
    assert_eq!(
        lines
            .iter()
            .map(|line| line.split(": ").next().unwrap())
            .collect::<Vec<_>>(),
        [
            "mine.ron:2:64",
            "help",
            "mine.ron:4:53",
            "mine.ron:4:64",
            "help",
            "mine.ron:3:18",
            "help"
        ],
        "{messages}"
    );
    assert!(
        lines[0].starts_with("mine.ron:2:64: error[out-of-range]: "),
        "{messages}"
    );
    assert!(
        lines[5].starts_with("mine.ron:3:18: warning[color-clamped]: "),
        "{messages}"
    );
    assert!(!messages.contains("Inner"), "{messages}");
}

#[test]
fn an_error_of_a_setting_names_the_setting() {
    let text = "(camera: Orthographic(gaze: (0, 0, -1), eye: (0, 0, 9), scale: 2), geometries: [])";
    let options = ReadOptions::new().syntax(Syntax::Ron);
    let options = options.set("camera.scale=-1".parse().unwrap());
    let document = Document::from_reader("mine.ron", text.as_bytes(), &options).unwrap();
    let messages = format!("{:?}", Scene::try_from(document).unwrap_err());
    assert!(
        messages.starts_with("camera.scale:1:14: error[out-of-range]: "),
        "{messages}"
    );
    assert!(messages.contains("\nmine.ron:1:"), "{messages}");
}

#[test]
fn long_lists_of_faults_are_truncated() {
    // Of equal spheres, all but the first are reported too, unless their radius is not known.
    for (radius, more) in [("-1", 1899), ("'x'", 900)] {
        let sphere = format!("Sphere(center: (0, 0, -3), radius: {radius}, color: \"#fff\"),\n");
        let text = format!(
            "(camera: Orthographic(gaze: (0, 0, -1), eye: (0, 0, 9), scale: 2), geometries: [\n{}])",
            sphere.repeat(1000)
        );
        let messages = format!("{:?}", Scene::from_text(text, Syntax::Ron).unwrap_err());
        assert_eq!(messages.lines().count(), 101, "{messages}");
        assert!(
            messages.ends_with(&format!("\n… and {more} more")),
            "{messages}"
        );
    }
}

#[test]
fn other_errors_are_as_they_are_displayed() {
    fn check(error: impl std::error::Error) {
        assert_eq!(format!("{error:?}"), error.to_string());
    }
    check(Scene::from_path("no-such.ron").unwrap_err());
    check(Size::new(0, 1).unwrap_err());
    check(Samples::new(3).unwrap_err());
    check("x".parse::<Setting>().unwrap_err());
    check("3/2".parse::<Shard>().unwrap_err());
    check("x".parse::<Code>().unwrap_err());
    check("x".parse::<Layer>().unwrap_err());
    check("x".parse::<strahl::report::OutputFormat>().unwrap_err());
    check(
        strahl::PerspectiveCamera::new(
            strahl::Vec3::ZERO,
            strahl::Vec3::ZERO,
            strahl::Vec3::Y,
            1.0,
        )
        .unwrap_err(),
    );
}

#[test]
fn an_unknown_camera_has_a_suggestion() {
    let text = "(cameras: {\"front\": Orthographic(gaze: (0, 0, -1), eye: (0, 0, 9), scale: 2)}, geometries: [])";
    let scene = Scene::from_text(text, Syntax::Ron).unwrap();
    let messages = format!("{:?}", scene.with_camera("frnt").unwrap_err());
    assert!(
        messages.contains("\nhelp: did you mean `front`?"),
        "{messages}"
    );
}
