//! Scenes with faults, and scenes that only look faulty.

use crate::{
    fault_tables::{
        COLORS_RON, DIRECTIONS_RON, Fault, NAMES_JSON, NAMES_RON, NUMBERS_JSON, NUMBERS_RON,
        RANGES_RON, SHAPES_JSON, SHAPES_RON, VERSIONS_RON,
    },
    support::{Done, Folder, JSON, RON, run},
};

fn render(folder: &Folder, name: &str, text: &str) -> Done {
    folder.write(name, text);
    run(&mut folder.strahl(["render", name, "--size", "4x4", "-o", "out.png"]))
}

#[track_caller]
fn refused(name: &str, text: &str, faults: &[Fault]) {
    let folder = Folder::new();
    for (old, new, words) in faults {
        assert!(text.contains(old), "no {old:?}");
        let done = render(&folder, name, &text.replacen(old, new, 1));
        assert_eq!(done.status, Some(1), "{old:?} -> {new:?}: {}", done.stderr);
        for word in words.iter().filter(|word| !word.starts_with('[')) {
            assert!(
                done.stderr.contains(word),
                "no {word:?} for {new:?}: {}",
                done.stderr
            );
        }
        done.bad_scene(name, &[]);
    }
    assert_eq!(folder.names(), [name]);
}

#[track_caller]
fn accepted(name: &str, text: &str, changes: &[(&str, &str)]) {
    let folder = Folder::new();
    for (old, new) in changes {
        assert!(text.contains(old), "no {old:?}");
        let done = render(&folder, name, &text.replacen(old, new, 1));
        assert_eq!(done.status, Some(0), "{old:?} -> {new:?}: {}", done.stderr);
        assert_eq!(done.stderr, "", "{old:?} -> {new:?}");
    }
}

const CAMERA: &str = "eye: (0, 0, 0), gaze: (0, 0, -1), fov: 90";

#[test]
fn numbers_out_of_their_range() {
    refused("a.ron", RON, RANGES_RON);
    // A picture of 1000000 × 480 is within the limits.
    accepted("a.ron", RON, &[("width: 32, height: 24", "width: 1000000")]);
}

#[test]
fn the_size_of_a_scene_is_checked_without_an_option_too() {
    let folder = Folder::new();
    for (width, height) in [("0", "1"), ("1000001", "1"), ("1000000", "1000000")] {
        let size = format!("width: {width}, height: {height}");
        folder.write("a.ron", RON.replace("width: 32, height: 24", &size));
        run(&mut folder.strahl(["render", "a.ron"])).bad_scene("a.ron", &["[out-of-range]"]);
    }
}

#[test]
fn wrong_numbers() {
    refused("a.ron", RON, NUMBERS_RON);
    refused("a.json", JSON, NUMBERS_JSON);
}

#[test]
fn wrong_directions() {
    refused("a.ron", RON, DIRECTIONS_RON);
}

#[test]
fn wrong_colors() {
    refused("a.ron", RON, COLORS_RON);
    accepted(
        "a.ron",
        RON,
        &[
            ("\"#ff0000\"", "\"#F0a\""),
            ("\"#ff0000\"", "\"#FfAa00\""),
            ("\"#ff0000\"", "(1.0, 0, 1e0)"),
            ("\"#ff0000\"", "r\"#f00\""),
        ],
    );
}

#[test]
fn wrong_names() {
    refused("a.ron", RON, NAMES_RON);
    let folder = Folder::new();
    for name in ["a.ron", "a.json"] {
        let text = if name == "a.ron" { "()" } else { "{}" };
        render(&folder, name, text).bad_scene(name, &["camera"]);
    }
    refused("a.json", JSON, NAMES_JSON);
}

#[test]
fn wrong_structure() {
    refused("a.ron", RON, SHAPES_RON);
    refused("a.json", JSON, SHAPES_JSON);
    let folder = Folder::new();
    let list = "[null, null, {\"Perspective\": {}}, null, []]";
    render(&folder, "a.json", list).bad_scene("a.json", &[]);
    for text in ["5", "\"scene\"", "null", "true", "[]"] {
        render(&folder, "a.json", text).bad_scene("a.json", &[]);
    }
    for text in ["5", "\"scene\"", "None", "true", "[]", "Some(())"] {
        render(&folder, "a.ron", text).bad_scene("a.ron", &[]);
    }
}

#[test]
fn versions_and_allowed_warnings() {
    refused("a.ron", RON, VERSIONS_RON);
    accepted(
        "a.ron",
        RON,
        &[
            ("(\n    image", "(\n    version: 1,\n    image"),
            ("(\n    image", "(\n    allow: [],\n    image"),
            (
                "(\n    image",
                "(\n    allow: [\"eye-inside\", \"never-visible\"],\n    image",
            ),
            ("color: (0, 1, 0)", "color: (0, 1, 0), "),
        ],
    );
    let folder = Folder::new();
    let loud = RON.replace("(0, 1, 0))", "(0, 1.5, 0))");
    let done = render(&folder, "a.ron", &loud);
    assert_eq!(done.status, Some(0));
    assert!(
        done.stderr.contains("warning[color-clamped]"),
        "{}",
        done.stderr
    );
    let allowed = loud.replacen('(', "(allow: [\"color-clamped\"],", 1);
    render(&folder, "a.ron", &allowed).quiet_success();
}

#[test]
fn optional_fields_may_be_none() {
    accepted(
        "a.ron",
        RON,
        &[
            ("image: (width: 32, height: 24)", "image: None"),
            (
                "image: (width: 32, height: 24)",
                "image: (width: None, height: 5)",
            ),
            ("image: (width: 32, height: 24)", "image: ()"),
            ("background: (0, 0.2, 0.4)", "background: None"),
            ("gaze: (0, 0, -1)", "gaze: (0, 0, -1), look_at: None"),
            ("gaze: (0, 0, -1)", "gaze: None, look_at: (0, 0, -1)"),
            ("gaze: (0, 0, -1)", "gaze: (0, 0, -1), up: None"),
            (
                "(\n    image",
                "(\n    version: None, allow: None,\n    image",
            ),
            ("(\n    image", "Scene(\n    image"),
            ("image: (", "image: Image("),
            ("fov: 90", "fov: /* degrees */ 90.0 // so\n"),
        ],
    );
    accepted(
        "a.json",
        JSON,
        &[
            ("{\"width\": 32, \"height\": 24}", "null"),
            ("{\"width\": 32, \"height\": 24}", "{\"width\": null}"),
            ("[0, 0.2, 0.4]", "null"),
            ("\"gaze\"", "\"up\": null, \"look_at\": null, \"gaze\""),
            ("\"gaze\"", "\"gaze\": null, \"look_at\""),
            ("\"image\"", "\"version\": null, \"allow\": null, \"image\""),
            (
                "\"image\"",
                "\"$schema\": \"a.json\", \"version\": 1, \"image\"",
            ),
        ],
    );
}

#[test]
fn warnings_do_not_stop_rendering() {
    let folder = Folder::new();
    let sphere = "Sphere(center: (-1, 0, -3), radius: 0.5, color: \"#ff0000\"),";
    let camera = format!("Perspective({CAMERA})");
    let warnings = [
        ("empty-scene", format!("(camera: {camera}, geometries: [])")),
        ("duplicate-geometry", RON.replace(sphere, &sphere.repeat(2))),
        (
            "eye-inside",
            RON.replace("center: (-1, 0, -3)", "center: (0, 0, 0.1)"),
        ),
        (
            "eye-on-plane",
            RON.replace("point: (0, -1, 0)", "point: (5, 0, 5)"),
        ),
        ("color-clamped", RON.replace("0.2, 0.4", "-0.2, 0.4")),
    ];
    for (code, text) in warnings {
        let done = render(&folder, "a.ron", &text);
        assert_eq!(done.status, Some(0), "{}", done.stderr);
        assert!(done.stdout.is_empty());
        let warning = format!("warning[{code}]");
        assert!(done.stderr.contains(&warning), "no {code}: {}", done.stderr);
        assert!(done.stderr.contains("a.ron"), "{}", done.stderr);
    }
}

#[test]
fn every_fault_is_reported_in_one_run() {
    let text = RON
        .replace("radius: 0.5", "radius: -1")
        .replace("fov: 90", "fov: 180")
        .replace("normal: (0, 1, 0)", "normal: (0, 0, 0)")
        .replace("\"#ff0000\"", "\"red\"")
        .replace("width: 32", "widht: 32");
    let done = render(&Folder::new(), "a.ron", &text);
    let words = [
        "`widht`",
        "`fov` must",
        "`normal` has",
        "`radius` must",
        "`red` is",
    ];
    done.bad_scene("a.ron", &words);
    let mut places = words.map(|word| done.stderr.find(word).unwrap()).to_vec();
    let found = places.clone();
    places.sort_unstable();
    assert_eq!(
        places, found,
        "not in the order of the file: {}",
        done.stderr
    );
}

#[test]
fn a_fault_has_its_line_and_column() {
    let folder = Folder::new();
    let faults = [
        ("radius: 0.5", "radius: -1", "-1"),
        ("fov: 90", "fov: 180", "180"),
        ("\"#ff0000\"", "\"red\"", "\"red\""),
        ("radius: 0.5", "radios: 0.5", "radios"),
    ];
    for (old, new, needle) in faults {
        let text = RON.replace(old, new);
        let start = text.find(new).unwrap() + new.find(needle).unwrap();
        let line = text[..start].matches('\n').count() + 1;
        let column = start - text[..start].rfind('\n').unwrap();
        let place = format!("a.ron:{line}:{column}");
        render(&folder, "a.ron", &text).bad_scene("a.ron", &[&place]);
    }
}

/// The file, the text and the table of faults to apply to it.
const TABLES: &[(&str, &str, &[Fault])] = &[
    ("a.ron", RON, RANGES_RON),
    ("a.ron", RON, NUMBERS_RON),
    ("a.json", JSON, NUMBERS_JSON),
    ("a.ron", RON, DIRECTIONS_RON),
    ("a.ron", RON, COLORS_RON),
    ("a.ron", RON, NAMES_RON),
    ("a.json", JSON, NAMES_JSON),
    ("a.ron", RON, SHAPES_RON),
    ("a.json", JSON, SHAPES_JSON),
    ("a.ron", RON, VERSIONS_RON),
];

#[test]
fn a_fault_has_its_code() {
    let folder = Folder::new();
    let mut wrong = Vec::new();
    for (name, text, faults) in TABLES {
        for (old, new, words) in *faults {
            let stderr = render(&folder, name, &text.replacen(old, new, 1)).stderr;
            let codes = words.iter().filter(|word| word.starts_with('['));
            let missing = codes.filter(|code| !stderr.contains(*code));
            wrong.extend(missing.map(|code| format!("{new:?} is not {code}: {stderr}")));
        }
    }
    let roots = [
        (
            "a.ron",
            &["5", "\"scene\"", "None", "true", "[]", "Some(())"],
        ),
        (
            "a.json",
            &["5", "\"scene\"", "null", "true", "[]", "[null]"],
        ),
    ];
    for (name, texts) in roots {
        for text in texts {
            let stderr = render(&folder, name, text).stderr;
            if !stderr.contains("[wrong-type]") {
                wrong.push(format!("{text:?} is not [wrong-type]: {stderr}"));
            }
        }
    }
    for (name, text) in [("a.ron", "()"), ("a.json", "{}")] {
        let stderr = render(&folder, name, text).stderr;
        if !stderr.contains("[missing-field]") {
            wrong.push(format!("{text:?} is not [missing-field]: {stderr}"));
        }
    }
    assert!(
        wrong.is_empty(),
        "{} wrong codes:\n{}",
        wrong.len(),
        wrong.concat()
    );
}
