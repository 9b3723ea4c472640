//! Scenes with several cameras: selection and picture names.

use std::fs;

use strahl::diagnostic::{Code, describe};

use crate::support::{Folder, run};

const SCENE: &str = r##"(
    image: (width: 16, height: 12),
    CAMERA
    cameras: {
        "front": Perspective(eye: (0, 0, 9), gaze: (0, 0, -1), fov: 60),
        "top": Orthographic(eye: (0, 9, 0), gaze: (0, -1, 0), up: (0, 0, -1), scale: 4),
    },
    geometries: [Sphere(center: (0, 0, 0), radius: 1, color: "#ff0000")],
)"##;
const CAMERA: &str = "camera: Perspective(eye: (3, 0, 9), gaze: (0, 0, -1), fov: 60),";

/// A folder with one scene that has `camera` and `cameras`, and one that has only `cameras`.
fn folder() -> Folder {
    let folder = Folder::new();
    folder.write("both.ron", SCENE.replace("CAMERA", CAMERA));
    folder.write("named.ron", SCENE.replace("CAMERA", ""));
    folder
}

fn picture(folder: &Folder, args: &[&str]) -> Vec<u8> {
    let all = [&["render", "-o", "-", "--image-format", "ppm"], args].concat();
    run(&mut folder.strahl(all)).quiet_success()
}

#[test]
fn each_camera_renders_its_view() {
    let folder = folder();
    let own = picture(&folder, &["both.ron"]);
    let front = picture(&folder, &["both.ron", "--camera", "front"]);
    let top = picture(&folder, &["both.ron", "--camera", "top"]);
    assert!(own != front && front != top && top != own);
    assert_eq!(picture(&folder, &["named.ron", "--camera=front"]), front);

    let all = ["render", "named.ron", "--all-cameras", "-q", "-o"];
    let done = run(&mut folder.strahl([&all[..], &["{camera}/x_{camera}.ppm"]].concat()));
    assert!(done.quiet_success().is_empty());
    assert_eq!(fs::read(folder.path("front/x_front.ppm")).unwrap(), front);
    let done = run(&mut folder.strahl([&all[..], &["x_{camera}.ppm"]].concat()));
    assert!(done.quiet_success().is_empty());
    assert_eq!(fs::read(folder.path("x_front.ppm")).unwrap(), front);
    assert_eq!(fs::read(folder.path("x_top.ppm")).unwrap(), top);
}

#[test]
fn pictures_have_the_names_of_scene_and_camera() {
    let folder = folder();
    let done = run(&mut folder.strahl(["render", "both.ron", "--all-cameras", "-q"]));
    assert!(done.quiet_success().is_empty());
    let scenes = ["both.ron", "named.ron"];
    let names = ["both_front.png", "both_top.png"];
    assert_eq!(
        folder.names(),
        [&scenes[..1], &names, &scenes[1..]].concat()
    );
    let done = run(&mut folder.strahl(["render", "named.ron", "--camera=top"]));
    assert!(done.quiet_success().is_empty());
    let done =
        run(&mut folder.strahl(["render", "named.ron", "--camera=top", "-o", "{camera}.png"]));
    assert!(done.quiet_success().is_empty());
    let top = fs::read(folder.path("both_top.png")).unwrap();
    assert_eq!(fs::read(folder.path("named.png")).unwrap(), top);
    assert_eq!(fs::read(folder.path("top.png")).unwrap(), top);
}

#[test]
fn a_scene_without_a_camera_of_its_own_needs_an_option() {
    let folder = folder();
    let done = run(&mut folder.strahl(["render", "named.ron"]));
    done.one_line(2, &["--camera", "--all-cameras", "`front`, `top`"]);
    let done = run(&mut folder.strahl(["pixel", "named.ron", "1,1"]));
    done.one_line(2, &["--camera", "`front`, `top`"]);
    let pixel = ["pixel", "named.ron", "1,1", "--camera=top"];
    let text = String::from_utf8(run(&mut folder.strahl(pixel)).quiet_success()).unwrap();
    assert!(text.contains("camera, Orthographic"), "{text}");
}

#[test]
fn impossible_requests_are_rejected_before_rendering() {
    let folder = folder();
    folder.write(
        "one.ron",
        "(camera: Orthographic(eye: (0, 0, 0), gaze: (0, 0, 1), scale: 1), geometries: [])",
    );
    let all = ["render", "--all-cameras", "-q", "-o"];
    for (args, messages) in [
        (&["a.png", "both.ron"][..], &["a.png", "{camera}"][..]),
        (&["-", "both.ron"], &["standard output"]),
        (&["{camera}.gif", "both.ron"], &[".gif", ".png"]),
        (&["{camera}.png", "one.ron"], &["no `cameras`"]),
    ] {
        run(&mut folder.strahl([&all[..], args].concat())).one_line(2, messages);
    }
    fs::create_dir(folder.path("top.png")).unwrap();
    let done = run(&mut folder.strahl([&all[..], &["{camera}.png", "both.ron"]].concat()));
    done.one_line(2, &["top.png", "folder"]);
    assert!(!folder.path("front.png").exists());
}

#[test]
#[cfg(unix)]
fn two_pictures_with_one_target_are_rejected() {
    let folder = folder();
    folder.write("top.png", "old");
    std::os::unix::fs::symlink("top.png", folder.path("front.png")).unwrap();
    let args = [
        "render",
        "both.ron",
        "--all-cameras",
        "-q",
        "-o",
        "{camera}.png",
    ];
    run(&mut folder.strahl(args)).one_line(2, &["front.png", "top.png", "same file"]);
    assert_eq!(fs::read(folder.path("top.png")).unwrap(), b"old");
}

/// Checks the page of a code for options: a scene, a command and its output.
pub(crate) fn the_page_shows_what_is_printed(code: Code) {
    let page = describe(code);
    let part = |from: &str, to: &str| {
        let (_, rest) = page.split_once(from).unwrap();
        rest.split_once(to).unwrap().0.to_owned()
    };
    let folder = Folder::new();
    folder.write("scene.ron", part("```ron\n", "```"));
    let command = part("\n`strahl ", "` prints:");
    let args = command.split(' ').map(|arg| arg.trim_matches('\''));
    let done = run(&mut folder.strahl(args));
    assert_eq!(done.status, Some(2));
    assert_eq!(done.stderr, part("```text\n", "```"));
    assert_eq!(folder.names(), ["scene.ron"]);
}

#[test]
fn an_unknown_name_matches_its_page() {
    the_page_shows_what_is_printed(Code::UnknownName);
}
