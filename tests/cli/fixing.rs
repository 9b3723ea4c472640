//! `strahl validate --fix` and `--diff`.

use std::fs;

use crate::support::{Folder, run, run_with};

const BROKEN: &str = "\
(
    camera: Perspective(eye: (0, 0, 0), gaze: [0, 0, -1], fov: \"60\"),
    backgruond: (255, 128, 0), // sky
    geometries: [
        Spere(center: (0, 0, -3) radius: 1, color: #ff0000), // a ball
        Sphere(center: (0, 0, -5), radius: 1, radius: 1, colour: '#0f0'),
        Plane(point: (0, -1, 0), normal: (0, 1, 0), color: “#00ff00”), // floor
        Plane(point: (0, -1, 0), normal: (0, 1, 0), color: \"#00ff00\"), // again
    ],
    allow: [\"never-visibel\"],
)
";
const FIXED: &str = "\
(
    camera: Perspective(eye: (0, 0, 0), gaze: (0, 0, -1), fov: 60),
    background: \"#ff8000\", // sky
    geometries: [
        Sphere(center: (0, 0, -3), radius: 1, color: \"#ff0000\"), // a ball
        Sphere(center: (0, 0, -5), radius: 1, color: \"#0f0\"),
        Plane(point: (0, -1, 0), normal: (0, 1, 0), color: \"#00ff00\"), // floor
        // again
    ],
    allow: [\"never-visible\"],
)
";

#[test]
fn fix_applies_certain_corrections() {
    let folder = Folder::new();
    let path = folder.write("a.ron", BROKEN);
    let done = run(&mut folder.strahl(["validate", "--fix", "a.ron"]));
    assert_eq!(done.status, Some(0));
    assert_eq!(done.stderr, "1 file: no problems (13 fixed)\n");
    assert_eq!(fs::read_to_string(&path).unwrap(), FIXED);
    let again = run(&mut folder.strahl(["validate", "--fix", "a.ron"]));
    assert_eq!(again.stderr, "1 file: no problems\n");
    assert_eq!(folder.names(), ["a.ron"]);
}

#[test]
fn diff_shows_corrections_without_writing() {
    let folder = Folder::new();
    let path = folder.write("a.ron", BROKEN);
    let done = run(&mut folder.strahl(["validate", "--diff", "a.ron"]));
    assert_eq!(done.status, Some(1));
    let diff = String::from_utf8(done.stdout).unwrap();
    assert!(diff.starts_with("--- a.ron\n+++ a.ron\n@@ "), "{diff}");
    assert!(diff.contains("-    backgruond: (255, 128, 0), // sky\n"));
    assert!(diff.contains("+    background: \"#ff8000\", // sky\n"));
    assert_eq!(fs::read_to_string(&path).unwrap(), BROKEN);

    let done = run_with(
        &mut folder.strahl(["validate", "--diff", "-"]),
        BROKEN.as_bytes(),
    );
    assert!(
        String::from_utf8(done.stdout)
            .unwrap()
            .starts_with("--- <stdin>\n")
    );
    run_with(&mut folder.strahl(["validate", "--fix", "-"]), b"").one_line(2, &["--diff"]);
}

#[test]
fn json_is_fixed_as_well() {
    let folder = Folder::new();
    let text = "{camera: {\"Perspective\": {\"eye\": [0, 0, 0], 'gaze': [0, 0, -1], \"fov\": 60,}},\n \
                \"geometries\": [{\"Spher\": {\"center\": [0, 0, -3], \"radius\": \"1\", \"color\": [255, 0, 0]}}],\n \
                animation: None}";
    let path = folder.write("a.json", text);
    let done = run(&mut folder.strahl(["validate", "--fix", "a.json"]));
    assert_eq!(done.status, Some(0), "{}", done.stderr);
    let expected = "{\"camera\": {\"Perspective\": {\"eye\": [0, 0, 0], \"gaze\": [0, 0, -1], \"fov\": 60}},\n \
                    \"geometries\": [{\"Sphere\": {\"center\": [0, 0, -3], \"radius\": 1, \"color\": \"#ff0000\"}}],\n \
                    \"animation\": null}";
    assert_eq!(fs::read_to_string(&path).unwrap(), expected);
}

#[test]
fn names_from_other_programs_are_replaced() {
    let folder = Folder::new();
    let text =
        "(camera: PerspectiveCamera(position: (0, 0, 9), target: (0, 0, 0), fov: 60), objects: [])";
    let path = folder.write("a.ron", text);
    run(&mut folder.strahl(["validate", "--fix", "a.ron"]));
    let expected =
        "(camera: Perspective(eye: (0, 0, 9), look_at: (0, 0, 0), fov: 60), geometries: [])";
    assert_eq!(fs::read_to_string(&path).unwrap(), expected);
}

#[test]
fn square_brackets_are_added_and_removed() {
    let folder = Folder::new();
    let ball = "Sphere(center: (0, 0, -3), radius: 1, color: \"#f00\")";
    let json = r##"{"Sphere": {"center": [0, 0, -3], "radius": 1, "color": "#f00"}}"##;
    for (name, start, end, [before, after]) in [
        (
            "a.ron",
            "(camera: Perspective(eye: (0, 0, 0), gaze: (0, 0, -1), fov: 60), geometries: ",
            ")",
            [
                format!("Difference(of: [ {ball}, ], minus: {ball})"),
                format!("[Difference(of: {ball}, minus: [{ball}])]"),
            ],
        ),
        (
            "a.json",
            r#"{"camera": {"Perspective": {"eye": [0, 0, 0], "gaze": [0, 0, -1], "fov": 60}}, "geometries": "#,
            "}",
            [
                format!(r#"[{{"Difference": {{"of": [{json}], "minus": {json}}}}}]"#),
                format!(r#"[{{"Difference": {{"of": {json}, "minus": [{json}]}}}}]"#),
            ],
        ),
        (
            "comment.ron",
            "(camera: Perspective(eye: (0, 0, 0), gaze: (0, 0, -1), fov: 60), geometries: ",
            ")",
            [
                format!("[Difference(of: [{ball} /* a */], minus: [{ball}])]"),
                format!("[Difference(of: [{ball} /* a */], minus: [{ball}])]"),
            ],
        ),
    ] {
        let path = folder.write(name, format!("{start}{before}{end}"));
        run(&mut folder.strahl(["validate", "--fix", name]));
        run(&mut folder.strahl(["validate", "--fix", name]));
        let fixed = fs::read_to_string(&path).unwrap();
        assert_eq!(fixed, format!("{start}{after}{end}"));
    }
    // A shape that is not a solid is never what is meant inside of one.
    let text = "(camera: Perspective(eye: (0, 0, 0), gaze: (0, 0, -1), fov: 60), geometries: \
                [Union(of: [Disk(center: (0, 0, -3), normal: (0, 0, 1), radius: 1)], color: \"#f00\")])";
    let path = folder.write("disk.ron", text);
    run(&mut folder.strahl(["validate", "--fix", "disk.ron"]));
    assert_eq!(fs::read_to_string(&path).unwrap(), text);
}

#[test]
fn a_variant_without_fields_gets_its_brackets() {
    let folder = Folder::new();
    let fit = |camera: &str| format!("(camera: Fit(projection: {camera}), geometries: [])");
    let fit_json = |camera: &str| {
        format!(r#"{{"camera": {{"Fit": {{"projection": {camera}}}}}, "geometries": []}}"#)
    };
    for (name, text, help, fixed) in [
        (
            "a.ron",
            fit("Orthographic"),
            "write `Orthographic()`\n",
            fit("Orthographic()"),
        ),
        (
            "a.json",
            fit_json("\"Orthographic\""),
            "write `{\"Orthographic\": {}}`\n",
            fit_json("{\"Orthographic\": {}}"),
        ),
    ] {
        let path = folder.write(name, text);
        let done = run(&mut folder.strahl(["validate", name]));
        let report = String::from_utf8(done.stdout).unwrap();
        assert!(report.contains(help), "{report}");
        run(&mut folder.strahl(["validate", "--fix", name]));
        assert_eq!(fs::read_to_string(&path).unwrap(), fixed);
    }
}

#[test]
fn uncertain_corrections_are_not_applied() {
    let folder = Folder::new();
    for text in [
        // Two values for one field, a color with a comment, fields without a certain replacement.
        "(camera: Orthographic(eye: (0, 0, 9), gaze: (0, 0, -1), scale: 1, scale: 2), geometries: [])",
        "(camera: Orthographic(eye: (0, 0, 9), gaze: (0, 0, -1), scale: 1), geometries: [], background: (255, /* g */ 0, 0))",
        "(camera: Orthographic(eye: (0, 0, 9), gaze: (0, 0, -1), size: 1), geometries: [])",
        "(camera: Perspective(eye: (0, 0, 9), gaze: (0, 0, -1), half_angle: 30), geometries: [])",
    ] {
        let path = folder.write("a.ron", text);
        run(&mut folder.strahl(["validate", "--fix", "a.ron"]));
        assert_eq!(fs::read_to_string(&path).unwrap(), text);
    }
}

#[test]
fn reports_carry_the_edits() {
    let folder = Folder::new();
    folder.write("a.ron", BROKEN);
    let done = run(&mut folder.strahl(["validate", "--output-format", "json", "a.ron"]));
    let text = String::from_utf8(done.stdout).unwrap();
    let comma = r#""fix": {"is_safe": true, "edits": [{"line": 5, "column": 33, "end_line": 5, "end_column": 33, "text": ","}]}"#;
    assert!(text.contains(comma), "{text}");
}
