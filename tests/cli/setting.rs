//! `--set`: values given on the command line.

use std::fs;

use strahl::diagnostic::Code;

use crate::{
    cameras::the_page_shows_what_is_printed,
    support::{Folder, run},
};

const RON: &str = r##"(
    image: (width: 16, height: 12),
    camera: Perspective(eye: (0, 0, 0), gaze: (0, 0, -1), fov: 90),
    cameras: {"top": Orthographic(eye: (0, 9, 0), gaze: (0, -1, 0), up: (0, 0, -1), scale: 4)},
    geometries: [
        Plane(point: (0, -1, 0), normal: (0, 1, 0), color: "#00ff00"),
        Sphere(center: (0, 0, -3), radius: 0.5, color: "#ff0000", name: "ball"),
    ],
)"##;

/// A folder with the same scene in both syntaxes.
fn folder() -> Folder {
    let folder = Folder::new();
    folder.write("a.ron", RON);
    let done = run(&mut folder.strahl(["convert", "a.ron", "a.json"]));
    assert_eq!(done.status, Some(0));
    folder
}

fn picture(folder: &Folder, scene: &str, settings: &[&str]) -> Vec<u8> {
    let mut args = vec!["render", scene, "-o", "-", "--image-format", "ppm"];
    settings
        .iter()
        .for_each(|setting| args.extend(["--set", setting]));
    run(&mut folder.strahl(args)).quiet_success()
}

#[test]
fn a_set_value_is_the_same_as_one_in_the_file() {
    let folder = folder();
    for (settings, [from, to]) in [
        (&["camera.fov=60"][..], ["fov: 90", "fov: 60"]),
        (
            &["geometries[1].color=\"#0f0\""],
            ["\"#ff0000\"", "\"#0f0\""],
        ),
        (&["geometries[\"ball\"].radius=2"], ["0.5", "2"]),
        (&["geometries.ball.center[2]=-2"], ["0, -3)", "0, -2)"]),
        (&["image.width=20"], ["16", "20"]),
        (
            &["background=\"#00f\""],
            ["image", "background: \"#00f\", image"],
        ),
        (&["camera.up=null"], ["x", "x"]),
        (
            &["image=null", "image.width=12", "image.height=8"],
            ["16, height: 12", "12, height: 8"],
        ),
        (&["camera.fov=40", "camera.fov=60"], ["fov: 90", "fov: 60"]),
    ] {
        folder.write("b.ron", RON.replace(from, to));
        let expected = picture(&folder, "b.ron", &[]);
        assert!(
            picture(&folder, "a.ron", settings) == expected,
            "{settings:?}"
        );
        assert!(
            picture(&folder, "a.json", settings) == expected,
            "{settings:?}"
        );
    }
}

#[test]
fn null_removes_a_field_for_its_alternative() {
    let folder = folder();
    folder.write(
        "b.ron",
        RON.replacen("gaze: (0, 0, -1)", "look_at: (1, 0, -3)", 1),
    );
    let expected = picture(&folder, "b.ron", &[]);
    let ron = ["camera.gaze=None", "camera.look_at=(1, 0, -3)"];
    assert!(picture(&folder, "a.ron", &ron) == expected);
    let json = ["camera.look_at=[1, 0, -3]", "camera.gaze=null"];
    assert!(picture(&folder, "a.json", &json) == expected);
    let done = run(&mut folder.strahl(["render", "a.ron", "--set", ron[1], "-q"]));
    assert_eq!(done.status, Some(1));
}

#[test]
fn values_are_checked_at_their_position() {
    let folder = folder();
    let before = fs::read(folder.path("a.ron")).unwrap();
    for (scene, setting, messages) in [
        (
            "a.ron",
            "camera.fov=400",
            "1:12: error[out-of-range]: `fov` must be above 0 and below 180 degrees, found `400`",
        ),
        (
            "a.json",
            "camera.fov = 400",
            "1:14: error[out-of-range]: `fov` must be above 0 and below 180 degrees, found `400`",
        ),
        (
            "a.ron",
            "geometries[0].normal=(0, 0, 0)",
            "1:22: error[zero-vector]: `normal` has no direction, its squared length is 0",
        ),
        (
            "a.ron",
            "geometries[1]=Sphere(center: (0, 0), radius: 1, color: \"#f00\")",
            "1:30: error[wrong-type]: expected 3 numbers in round brackets, found a tuple of 2",
        ),
        (
            "a.ron",
            "cameras.top.scale=0",
            "1:19: error[out-of-range]: `scale` must be above 0, found `0`",
        ),
        (
            "a.json",
            "cameras[\"top\"].scale=\"4\"",
            "1:22: error[wrong-type]: expected a number, found the string `\"4\"`",
        ),
        ("a.json", "background=(0, 0, 0)", "1:12: error[syntax]: "),
        // One number of a vector.
        (
            "a.ron",
            "camera.gaze[2]=0",
            "1:16: error[zero-vector]: `gaze` has no direction, its squared length is 0",
        ),
        (
            "a.json",
            "cameras.top.up[2] = 0",
            "1:21: error[zero-vector]: `up` has no direction, its squared length is 0",
        ),
    ] {
        for (command, more) in [("validate", "--output-format=short"), ("render", "-q")] {
            let done = run(&mut folder.strahl([command, scene, more, "--set", setting]));
            assert_eq!(done.status, Some(1), "{setting}: {done:?}");
            let stdout = String::from_utf8(done.stdout).unwrap();
            let path = setting.split('=').next().unwrap().trim();
            let messages = in_file(scene, &format!("{path}:{messages}"));
            assert!(
                command == "render" || stdout.contains(&messages),
                "{stdout}"
            );
        }
    }
    assert_eq!(fs::read(folder.path("a.ron")).unwrap(), before);
    assert_eq!(folder.names(), ["a.json", "a.ron"]);
}

#[test]
fn a_number_of_a_range_is_reported_at_its_position() {
    let folder = Folder::new();
    folder.write("a.csv", "x,y,z,e\n0,0,0,1\n");
    let range = "geometries: [Spheres(file: \"a.csv\", radius: 1, name: \"t\", \
                 color_by: (column: \"e\", range: (0, 1)))]";
    folder.write("a.ron", format!("(camera: Fit(), {range})"));
    let setting = "geometries.t.color_by.range[1]=-1";
    let args = ["validate", "a.ron", "--output-format=short", "--set"];
    let done = run(&mut folder.strahl(args.into_iter().chain([setting])));
    assert_eq!(done.status, Some(1));
    let message = "geometries.t.color_by.range[1]:1:32: error[out-of-range]: `range` must rise, \
                   found `0` to `-1`";
    let stdout = String::from_utf8(done.stdout).unwrap();
    assert!(stdout.starts_with(&in_file("a.ron", message)), "{stdout}");
}

#[test]
fn the_angle_of_a_camera_without_projection_can_be_set() {
    let folder = Folder::new();
    let ball = "geometries: [Sphere(center: (0, 0, 0), radius: 1, color: \"#f00\")]";
    let fov = |args: &[&str]| {
        let done = run(&mut folder.strahl(["info"].iter().chain(args)));
        let info = String::from_utf8(done.quiet_success()).unwrap();
        assert!(info.contains("fov 2α       60.0 degrees"), "{info}");
    };
    folder.write("a.ron", format!("(camera: Fit(), {ball})"));
    run(&mut folder.strahl(["convert", "a.ron", "a.json"])).quiet_success();
    folder.write("b.ron", format!("({ball})"));
    fov(&["a.ron", "--set", "camera.projection.fov=60"]);
    fov(&["a.json", "--set", "camera.projection.fov=60"]);
    let args = ["render", "b.ron", "--fit", "-o", "-", "--size=8x8"];
    let done = run(&mut folder.strahl(
        args.into_iter()
            .chain(["--set", "camera.projection.fov=60"]),
    ));
    done.quiet_success();
    let args = ["validate", "a.ron", "--set", "camera.projection.scale=2"];
    let done = run(&mut folder.strahl(args));
    assert_eq!(done.status, Some(2));
    let report = String::from_utf8(done.stdout).unwrap();
    assert!(
        report.contains("unknown field `scale`, expected one of `fov`"),
        "{report}"
    );
}

#[test]
fn what_another_field_stands_in_place_of_is_not_made() {
    let folder = Folder::new();
    let ball = "Sphere(center: (0, 0, 0), radius: 1, color: \"#f00\")";
    folder.write("a.ron", format!("(camera: Fit(), geometries: [{ball}])"));
    let args = [
        "validate",
        "a.ron",
        "--set",
        "geometries[0].material.ior=1.5",
    ];
    let done = run(&mut folder.strahl(args));
    assert_eq!(done.status, Some(2));
    let report = String::from_utf8(done.stdout).unwrap();
    assert!(report.contains("`material` is not given"), "{report}");
}

/// Returns the report of `PATH:LINE:COLUMN: SEVERITY[CODE]: MESSAGE` for tools: at the start of the
/// scene.
fn in_file(scene: &str, messages: &str) -> String {
    let (place, rest) = messages.split_once(": ").unwrap();
    let (code, message) = rest.split_once(": ").unwrap();
    format!("{scene}:1:1: {code}: --set {place}: {message}")
}

#[test]
fn conflicts_are_reported_at_the_set_value() {
    let folder = folder();
    let second = "geometries[0].name=\"ball\"";
    for (scene, settings, messages) in [
        (
            "a.ron",
            &[second][..],
            "geometries[0].name:1:20: error[duplicate-name]: the name `ball` is given twice; the \
             other is `geometries[1].name`",
        ),
        (
            "a.json",
            &["camera.look_at=[0, 0, -1]"],
            "camera.look_at:1:1: error[gaze-or-look-at]: `gaze` and `look_at` are both given, \
             expected one of them; the other is `camera.gaze`",
        ),
        (
            "a.json",
            &["camera.gaze=null"],
            "camera.gaze:1:1: error[gaze-or-look-at]: neither `gaze` nor `look_at` is given",
        ),
        (
            "a.ron",
            &["camera=null", "cameras[\"top\"]=None"],
            "cameras[\"top\"]:1:1: error[missing-field]: there is no camera",
        ),
    ] {
        let args = ["validate", scene, "--output-format=short"];
        let set = settings.iter().flat_map(|setting| ["--set", setting]);
        let done = run(&mut folder.strahl(args.into_iter().chain(set)));
        assert_eq!(done.status, Some(1), "{settings:?}: {done:?}");
        let stdout = String::from_utf8(done.stdout).unwrap();
        assert!(stdout.contains(&in_file(scene, messages)), "{stdout}");
    }
}

const SHAPES: &str = r##"(
    camera: Perspective(eye: (0, 0, 9), gaze: (0, 0, -1), fov: 90),
    geometries: [
        Box(min: (0, 0, 0), max: (1, 1, 1), color: "#f00"),
        Cylinder(from: (0, 0, 0), to: (0, 1, 0), radius: 1, color: "#f00"),
        Rectangle(corner: (0, 0, 0), edge_u: (1, 0, 0), edge_v: (0, 1, 0), color: "#f00"),
        Triangle(a: (0, 0, 0), b: (1, 0, 0), c: (0, 1, 0), color: "#f00"),
        Ellipsoid(center: (0, 0, 0), axes: [(1, 0, 0), (0, 2, 0), (0, 0, 3)], color: "#f00"),
        Disc(center: (0, 0, 0), normal: (0, 0, 1), radius: 1, color: "#f00"),
    ],
)"##;

#[test]
fn fields_that_clash_are_reported_at_the_set_one() {
    let folder = Folder::new();
    folder.write("a.ron", SHAPES);
    for (setting, column, message) in [
        (
            "geometries[0].min[1]=2",
            22,
            "error[out-of-range]: `max` must be above `min`, which is `2`, found `1`; the other is \
             `geometries[0].max[1]`",
        ),
        (
            "geometries[0].min=(0, 2, 0)",
            23,
            "error[out-of-range]: `max` must be above `min`, which is `2`, found `1`; the other is \
             `geometries[0].max[1]`",
        ),
        (
            "geometries[1].from=(0, 1, 0)",
            20,
            "error[zero-vector]: `from` and `to` are the same point: the cylinder has no length; \
             the other is `geometries[1].to`",
        ),
        (
            "geometries[1].from[1]=1",
            23,
            "error[zero-vector]: `from` and `to` are the same point: the cylinder has no length; \
             the other is `geometries[1].to`",
        ),
        (
            "geometries[2].edge_u=(0, 2, 0)",
            22,
            "error[parallel-vectors]: `edge_u` and `edge_v` are parallel, so that the rectangle has \
             no area; the other is `geometries[2].edge_v`",
        ),
        (
            "geometries[3].a=(2, -1, 0)",
            17,
            "error[parallel-vectors]: `a`, `b` and `c` lie on one line: the triangle has no area; \
             the others are `geometries[3].c`, `geometries[3].b`",
        ),
        (
            "geometries[4].axes[1][1]=0",
            26,
            "error[zero-vector]: this axis has no direction, its squared length is 0 or not finite \
             in an f64",
        ),
        (
            "geometries[4].axes[0]=(1, 1, 0)",
            23,
            "error[out-of-range]: `axes[0]` and `axes[1]` must be perpendicular to each other; the \
             other is `geometries[4].axes[1]`",
        ),
        (
            "geometries[5].normal[2]=0",
            25,
            "error[zero-vector]: `normal` has no direction, its squared length is 0",
        ),
    ] {
        let args = ["validate", "a.ron", "--output-format=short", "--set"];
        let done = run(&mut folder.strahl(args.into_iter().chain([setting])));
        let (path, value) = setting.split_once('=').unwrap();
        let expected = in_file("a.ron", &format!("{path}:1:{column}: {message}"));
        let stdout = String::from_utf8(done.stdout).unwrap();
        assert_eq!(stdout.lines().next(), Some(&*expected), "{setting}");
        let table = format!("{path}\n\"{value}\"\n");
        folder.write("t.csv", table);
        let args = [
            "validate",
            "a.ron",
            "--output-format=short",
            "--params=t.csv",
        ];
        let done = run(&mut folder.strahl(args));
        let stdout = String::from_utf8(done.stdout).unwrap();
        let (code, message) = message.split_once(": ").unwrap();
        let expected = format!("t.csv:2:1: {code}: column `{path}`: {message}");
        assert_eq!(stdout.lines().next(), Some(&*expected), "{setting}");
    }
}

#[test]
fn a_camera_can_be_removed() {
    let folder = Folder::new();
    let camera = |name, scale| {
        format!("\"{name}\": Orthographic(eye: (0, 0, 9), gaze: (0, 0, -1), scale: {scale})")
    };
    let all = [camera("a", 1), camera("b", 2), camera("c", 3)];
    let scene = |cameras: &[String]| {
        let cameras = cameras.join(", ");
        format!("(cameras: {{{cameras}}}, geometries: [], allow: [\"empty-scene\"])")
    };
    folder.write("all.ron", scene(&all));
    folder.write("one.ron", scene(&all[..1]));
    for name in ["all", "one"] {
        let done =
            run(&mut folder.strahl(["convert", &format!("{name}.ron"), &format!("{name}.json")]));
        assert_eq!(done.status, Some(0));
    }
    let cameras = |file: &str, removed: &str| {
        let set = format!("cameras[\"{removed}\"]=null");
        let args = ["info", file, "--output-format=json", "--set", &set];
        let done = run(&mut folder.strahl(args));
        let info = String::from_utf8(done.stdout).unwrap();
        let has = |name: &&str| info.contains(&format!("\"{name}\""));
        let left: Vec<_> = ["a", "b", "c"].into_iter().filter(has).collect();
        (done.status, left.concat())
    };
    for ending in ["ron", "json"] {
        for (removed, left) in [("a", "bc"), ("b", "ac"), ("c", "ab")] {
            let found = cameras(&format!("all.{ending}"), removed);
            assert_eq!(found, (Some(0), left.to_owned()), "{ending}");
        }
        let found = cameras(&format!("one.{ending}"), "a");
        assert_eq!(found, (Some(1), String::new()), "{ending}");
        assert_eq!(cameras(&format!("all.{ending}"), "d").0, Some(2));
    }
}

#[test]
fn an_unknown_path_is_a_usage_error() {
    let folder = folder();
    for (setting, messages) in [
        ("camera.fow=60", "did you mean `fov`?"),
        ("camera.scale=60", "unknown field `scale`"),
        ("geometries[7].radius=1", "the indices are 0 to 1"),
        ("geometries.bal.radius=1", "did you mean `ball`?"),
        ("geometries[0].radius=1", "unknown field `radius`"),
        ("cameras.tip.scale=1", "did you mean `top`?"),
        ("camera.eye[3]=1", "there are 3"),
        ("background[0]=1", "`background` is not given"),
        ("camra.fov=1", "did you mean `camera`?"),
    ] {
        for scene in ["a.ron", "a.json"] {
            let done = run(&mut folder.strahl(["pixel", scene, "1,1", "--set", setting]));
            assert_eq!(done.status, Some(2), "{setting}");
            assert!(
                done.stderr.starts_with("error[unknown-path]: "),
                "{}",
                done.stderr
            );
            assert!(done.stderr.contains(messages), "{setting}: {}", done.stderr);
            let done = run(&mut folder.strahl(["validate", scene, "--set", setting]));
            assert_eq!(done.status, Some(2), "{setting}");
        }
    }
    for setting in [
        "camera.fov",
        "=1",
        "geometries[x]=1",
        "geometries[99999999999999999999]=1",
    ] {
        let done = run(&mut folder.strahl(["render", "a.ron", "--set", setting]));
        assert_eq!(done.status, Some(2), "{setting}");
        assert!(done.stderr.contains("PATH=VALUE"), "{}", done.stderr);
    }
}

#[test]
fn a_fault_in_the_file_can_be_corrected() {
    let folder = Folder::new();
    folder.write("a.ron", RON.replace("fov: 90", "fov: 400"));
    let set = |settings: &[&str]| {
        let args = settings.iter().flat_map(|setting| ["--set", setting]);
        run(&mut folder.strahl(["validate", "a.ron"].into_iter().chain(args)))
    };
    assert_eq!(set(&[]).status, Some(1));
    assert_eq!(set(&["camera.fov=90"]).status, Some(0));
    assert_eq!(set(&["camera.fov=90", "geometries=[]"]).status, Some(0));
    assert_eq!(
        set(&["camera.fov=90", "allow=[\"empty-scene\"]", "geometries=[]"]).stdout,
        b""
    );
}

#[test]
fn an_unknown_path_matches_its_page() {
    the_page_shows_what_is_printed(Code::UnknownPath);
}

#[test]
fn a_text_needs_no_quotes() {
    let folder = Folder::new();
    let scene = "(image: (width: 8, height: 8), camera: Fit(), geometries: [\
                 Spheres(file: \"a.csv\", radius: 1, color: \"#f00\", name: \"x\")])";
    folder.write("a.ron", scene);
    run(&mut folder.strahl(["convert", "a.ron", "a.json"]));
    folder.write("a.csv", "x,y,z\n0,0,0\n");
    folder.write("my file.2.csv", "x,y,z\n0,0,0\n1,1,1\n");
    for scene in ["a.ron", "a.json"] {
        let quoted = [
            "geometries[0].file=\"my file.2.csv\"",
            "geometries[0].name=\"5\"",
        ];
        let bare = [
            "geometries[0].file = my file.2.csv ",
            "geometries[0].name=5",
        ];
        assert!(picture(&folder, scene, &quoted) == picture(&folder, scene, &bare));
        folder.write(
            "t.csv",
            "id,geometries[0].file\none,a.csv\ntwo,my file.2.csv\n",
        );
        let args = ["render", scene, "--params", "t.csv", "-o", "{id}.ppm"];
        assert_eq!(run(&mut folder.strahl(args)).status, Some(0));
        let two = fs::read(folder.path("two.ppm")).unwrap();
        assert!(two == picture(&folder, scene, &quoted));
        for (setting, expected) in [
            // The place of a fault is the word.
            (
                "geometries[0].file= b.csv",
                "--set geometries[0].file:1:21: `b.csv`: no such file",
            ),
            ("camera.margin=b.csv", "expected a number"),
            ("geometries[0].radius=one", "expected a number"),
        ] {
            let args = [
                "validate",
                scene,
                "--output-format",
                "short",
                "--set",
                setting,
            ];
            let done = run(&mut folder.strahl(args));
            let all = String::from_utf8(done.stdout).unwrap();
            assert_eq!(done.status, Some(1), "{all}");
            assert!(all.contains(expected), "{scene} {setting}: {all}");
            assert!(!all.contains("r#"), "{all}");
        }
    }
}
