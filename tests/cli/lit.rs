//! Lit pictures: `--lights`, `--look`, `--outlines`, `new --lit`, `new --path`, and values of lights by `--set` and `--params`.

use std::fs;

use serde_json::{Value, json};

use crate::support::{Folder, RON, run};

/// Draws a scene without any message, and returns the picture.
fn picture(folder: &Folder, scene: &str, options: &[&str]) -> Vec<u8> {
    let args = ["render", scene, "-o", "-", "--image-format", "ppm"];
    run(&mut folder.strahl(args.iter().chain(options))).quiet_success()
}

/// A folder with a flat scene, and the same with other fields before its geometries.
fn folder(fields: &str) -> Folder {
    let folder = Folder::new();
    folder.write("flat.ron", RON);
    folder.write(
        "lit.ron",
        RON.replace("geometries", &format!("{fields} geometries")),
    );
    folder
}

#[test]
fn lights_and_outlines_are_as_in_the_file() {
    for (fields, options) in [
        ("lights: [Headlight()],", &["--lights", "headlight"][..]),
        ("outlines: (),", &["--outlines"]),
        (
            "lights: [Headlight()], outlines: (),",
            &["--lights", "headlight", "--outlines"],
        ),
        (
            "lights: [Headlight(intensity: 0.5)],",
            &["--lights", "headlight", "--set", "lights[0].intensity=0.5"],
        ),
        (
            "outlines: (width: 4),",
            &["--outlines", "--set", "outlines.width=4"],
        ),
    ] {
        let folder = folder(fields);
        let expected = picture(&folder, "lit.ron", &[]);
        assert_ne!(expected, picture(&folder, "flat.ron", &[]), "{options:?}");
        assert_eq!(
            expected,
            picture(&folder, "flat.ron", options),
            "{options:?}"
        );
    }
    // A scene keeps its own outlines.
    let folder = folder("outlines: (width: 3),");
    let own = picture(&folder, "lit.ron", &[]);
    assert_eq!(own, picture(&folder, "lit.ron", &["--outlines"]));
}

#[test]
fn a_lit_scene_takes_no_other_lights() {
    let folder = folder("lights: [],");
    let lights = ["--lights", "headlight"];
    let one = ["render", "lit.ron", "-o", "a.png"];
    let done = run(&mut folder.strahl(one.iter().chain(&lights)));
    done.one_line(2, &["lit.ron", "--lights"]);
    // Of several scenes the others are drawn.
    let many = ["render", ".", "-o", "out/"];
    let done = run(&mut folder.strahl(many.iter().chain(&lights)));
    done.failure(2, &["lit.ron", "--lights"]);
    assert!(folder.path("out/flat.png").exists() && !folder.path("out/lit.png").exists());
}

#[test]
fn a_look_replaces_all_light() {
    let options = ["--look", "studio", "--samples", "2"];
    let flat = picture(&folder(""), "flat.ron", &options);
    for fields in [
        "",
        "lights: [Point(position: (0, 1, 0))], lighting: Direct(max_depth: 3),",
    ] {
        let folder = folder(fields);
        let text = fs::read_to_string(folder.path("lit.ron")).unwrap();
        let sampled = text.replace("height: 24", "height: 24, samples: 4");
        assert_ne!(sampled, text);
        folder.write("lit.ron", sampled);
        assert_eq!(picture(&folder, "lit.ron", &options), flat, "{fields}");
        for written in ["out.ron", "out.json"] {
            let convert = ["convert", "--look", "studio", "lit.ron", written];
            assert_eq!(run(&mut folder.strahl(convert)).status, Some(0));
            let drawn = picture(&folder, written, &["--samples", "2", "--quiet"]);
            assert_eq!(drawn, flat, "{fields} {written}");
        }
    }
}

#[test]
fn a_look_loses_neither_comments_nor_tracks_unasked() {
    let folder = folder("lights: [/* mine */ Point(position: (0, 1, 0), name: \"lamp\")],");
    let convert = ["convert", "--look", "studio", "lit.ron", "out.ron"];
    let done = run(&mut folder.strahl(convert));
    done.failure(2, &["1 comment, the first in line", "--force"]);
    assert!(!folder.path("out.ron").exists());
    let forced = run(&mut folder.strahl(convert.into_iter().chain(["--force"])));
    assert_eq!(forced.status, Some(0));
    let track = "lights: [Point(position: (0, 1, 0), name: \"lamp\")], animation: (frames: 2, \
        tracks: {\"lights.lamp.intensity\": [(0, 1), (1, 2)]}),";
    let folder = self::folder(track);
    run(&mut folder.strahl(convert)).failure(2, &["`lights.lamp.intensity`", "remove the track"]);
    let options = [
        "--look",
        "studio",
        "--samples",
        "1",
        "--frames",
        "1",
        "-o",
        "{frame}.ppm",
        "-q",
    ];
    let args = ["render", "lit.ron"].into_iter().chain(options);
    run(&mut folder.strahl(args)).quiet_success();
}

#[test]
fn each_row_of_a_table_sets_a_light() {
    let fields = "lights: [Point(position: (0, 1, 0), name: \"lamp\")], \
        materials: {\"shiny\": Phong(diffuse: \"#888\")},";
    let folder = folder(fields);
    let table = "id,lights.lamp.intensity,materials.shiny.exponent,lighting.max_depth\n\
        a,1,3,2\nb,5,40,3\n";
    folder.write("rows.csv", table);
    let args = [
        "render", "lit.ron", "--params", "rows.csv", "-o", "{id}.ppm", "--quiet",
    ];
    run(&mut folder.strahl(args)).quiet_success();
    let of_row = |id: &str| fs::read(folder.path(format!("{id}.ppm"))).unwrap();
    assert_eq!(
        of_row("a"),
        picture(&folder, "lit.ron", &["--set", "lights.lamp.intensity=1"])
    );
    assert_eq!(
        of_row("b"),
        picture(&folder, "lit.ron", &["--set", "lights.lamp.intensity=5"])
    );
    assert_ne!(of_row("a"), of_row("b"));
    folder.write("wrong.csv", "id,lights.lmap.intensity\na,1\n");
    let args = [
        "render",
        "lit.ron",
        "--params",
        "wrong.csv",
        "-o",
        "{id}.ppm",
    ];
    let done = run(&mut folder.strahl(args));
    assert_ne!(done.status, Some(0));
    assert!(done.stderr.contains("`lamp`"), "{}", done.stderr);
}

#[test]
fn a_new_lit_scene_is_drawn_without_a_warning() {
    for (option, size) in [
        ("--lit", &["--size", "16x12"][..]),
        ("--path", &["--size", "16x12", "--samples", "4"]),
    ] {
        let folder = Folder::new();
        for scene in ["new.ron", "new.json"] {
            run(&mut folder.strahl(["new", option, scene])).quiet_success();
            let done = run(&mut folder.strahl(["validate", "--deny", "warnings", scene]));
            assert_eq!(done.status, Some(0), "{}", done.stderr);
        }
        let both = ["new.ron", "new.json"].map(|scene| picture(&folder, scene, size));
        assert_eq!(both[0], both[1], "{option}");
        let done = run(&mut folder.strahl(["new", option, "-"]));
        assert_eq!(done.stdout, fs::read(folder.path("new.ron")).unwrap());
    }
}

#[test]
fn info_tells_paths_and_the_sizes_of_lights() {
    let folder = folder(
        "lighting: Path(samples: 4), lights: [Point(position: (0, 9, 0), radius: 0.5, intensity: 90), \
         Directional(direction: (0, -1, 0), angle: 2), Directional(direction: (0, -1, 0))],",
    );
    let info = run(&mut folder.strahl(["info", "lit.ron"])).quiet_success();
    let info = String::from_utf8(info).unwrap();
    let lines: Vec<_> = info
        .lines()
        .skip_while(|line| !line.starts_with("lights"))
        .take(4)
        .collect();
    let color = "color (1.0, 1.0, 1.0), intensity";
    assert_eq!(
        lines,
        [
            "lights         3, depth 32, by paths".to_owned(),
            format!("  lights[0]: point, {color} 90.0, radius 0.5, shadows"),
            format!("  lights[1]: directional, {color} 1.0, angle 2.0, shadows"),
            format!("  lights[2]: directional, {color} 1.0, shadows"),
        ]
    );
}

#[test]
fn info_lists_lights_and_materials() {
    let folder =
        folder("lights: [Ambient(), Point(position: (0, 9, 0), intensity: 40, name: \"lamp\")],");
    let json = |scene: &str| -> Value {
        let args = ["info", scene, "--output-format", "json"];
        serde_json::from_slice(&run(&mut folder.strahl(args)).quiet_success()).unwrap()
    };
    let white = [1.0, 1.0, 1.0];
    let lights = json!([
        {"kind": "ambient", "name": null, "color": white, "intensity": 0.2, "shadows": false},
        {"kind": "point", "name": "lamp", "color": white, "intensity": 40.0, "shadows": true},
    ]);
    let info = json("lit.ron");
    assert_eq!(
        info["lighting"],
        json!({"transport": "direct", "max_depth": 8, "lights": lights})
    );
    assert_eq!(info["materials"], json!({"matte": 2}));
    let info = json("flat.ron");
    assert_eq!(
        (&info["lighting"], &info["materials"]),
        (&Value::Null, &json!({"matte": 2}))
    );
    let done = run(&mut folder.strahl(["info", "lit.ron"]));
    let text = String::from_utf8(done.stdout).unwrap();
    assert!(text.contains("lights[1] \"lamp\": point"), "{text}");
}

#[test]
fn numpy_arrays_of_a_lit_picture_hold_its_linear_light() {
    let folder = folder("lights: [Headlight(intensity: 40)],");
    let array = |scene: &str, options: &[&str]| {
        let args = ["render", scene, "-o", "-", "--image-format", "npy"];
        let array = run(&mut folder.strahl(args.iter().chain(options))).quiet_success();
        let start = array.iter().position(|byte| *byte == b'\n').unwrap();
        (
            String::from_utf8_lossy(&array[..start]).into_owned(),
            array[start + 1..].to_vec(),
        )
    };
    let (header, light) = array("lit.ron", &[]);
    assert!(header.contains("<f4"), "{header}");
    let (channels, _) = light.as_chunks::<4>();
    let brightest = channels.iter().map(|channel| f32::from_le_bytes(*channel));
    assert!(brightest.fold(0.0, f32::max) > 1.0, "not clamped");
    for (scene, options) in [("flat.ron", &[][..]), ("lit.ron", &["--bits", "8"])] {
        let (header, _) = array(scene, options);
        assert!(header.contains("|u1"), "{header}");
    }
}
