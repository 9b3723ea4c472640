//! What people type: one fault, a help that names what to write, and a fix that gives a valid scene.

use crate::{scene::document::Document, text::syntax::Syntax};

/// A scene with something wrong in it.
fn scene(syntax: Syntax, fields: &str, geometry: &str) -> String {
    match syntax {
        Syntax::Ron => format!(
            "(\n    camera: Perspective(eye: (0, 0, 9), gaze: (0, 0, -1), fov: 40),\n    {fields}\n    \
             geometries: [{geometry}],\n)\n"
        ),
        Syntax::Json => format!(
            "{{\"camera\": {{\"Perspective\": {{\"eye\": [0, 0, 9], \"gaze\": [0, 0, -1], \
             \"fov\": 40}}}},\n{fields}\n\"geometries\": [{geometry}]}}\n"
        ),
    }
}

const BALL: &str = "Sphere(center: (0, 0, 0), radius: 1, color: \"#f00\")";
const BALL_JSON: &str = r##"{"Sphere": {"center": [0, 0, 0], "radius": 1, "color": "#f00"}}"##;

/// Checks that a text has one fault with the help, at the place, and that its fix gives a scene without
/// faults that contains `fixed`.
fn check(text: &str, syntax: Syntax, place: &str, help: &str, fixed: Option<&str>) {
    let mut document = Document::from_text("a", text, syntax);
    let [fault] = document.diagnostics() else {
        panic!("{:#?}\nin {text}", document.diagnostics());
    };
    let found = fault.help.clone().unwrap_or_default();
    assert!(found.contains(help), "{fault:#?}\nin {text}");
    assert_eq!(&text[fault.range.clone()], place, "{fault:#?}\nin {text}");
    let cured = document.fixed();
    match (fixed, cured) {
        (None, None) => {}
        (Some(fixed), Some((cured, _))) => {
            assert!(cured.contains(fixed), "{cured}");
            let document = Document::from_text("a", &*cured, syntax);
            assert_eq!(document.diagnostics(), [], "{cured}");
        }
        (_, cured) => panic!("fixed: {cured:?}\nin {text}"),
    }
}

fn ball(field: &str) -> String {
    let fields = [
        ("center", "(0, 0, 0)"),
        ("radius", "1"),
        ("color", "\"#f00\""),
    ];
    let name = field.split(':').next().unwrap();
    let fields = fields.iter().filter(|(other, _)| *other != name);
    let fields: String = fields
        .map(|(name, value)| format!("{name}: {value}, "))
        .collect();
    format!("Sphere({fields}{field})")
}

#[test]
fn values_of_a_field() {
    for (field, place, help, fixed) in [
        (
            "color: red",
            "red",
            "did you mean `\"#ff0000\"`?",
            Some("color: \"#ff0000\""),
        ),
        (
            "color: \"Orange\"",
            "\"Orange\"",
            "did you mean `#ffa500`?",
            Some("color: \"#ffa500\""),
        ),
        (
            "color: rgb(255, 128, 0)",
            "rgb(255, 128, 0)",
            "did you mean `\"#ff8000\"`?",
            Some("color: \"#ff8000\""),
        ),
        (
            "color: \"rgb(255, 128, 0)\"",
            "\"rgb(255, 128, 0)\"",
            "did you mean `#ff8000`?",
            Some("color: \"#ff8000\""),
        ),
        (
            "color: hsl(120, 0.5, 0.5)",
            "hsl(120, 0.5, 0.5)",
            "did you mean `\"#40bf40\"`?",
            Some("color: \"#40bf40\""),
        ),
        (
            "color: \"hsl(120, 50%, 50%)\"",
            "\"hsl(120, 50%, 50%)\"",
            "did you mean `#40bf40`?",
            Some("color: \"#40bf40\""),
        ),
        (
            "color: rgba(255, 128, 0, 0.5)",
            "rgba(255, 128, 0, 0.5)",
            "a color has no alpha: write `\"#ff8000\"`",
            None,
        ),
        (
            "color: \"rgba(255, 128, 0, 0.5)\"",
            "\"rgba(255, 128, 0, 0.5)\"",
            "a color has no alpha: write `#ff8000`",
            None,
        ),
        (
            "color: rgb(1, 0, 0)",
            "rgb(1, 0, 0)",
            "write the three numbers alone, without names: `(1, 0, 0)`",
            Some("color: (1, 0, 0)"),
        ),
        (
            "color: Color(1, 0, 0.5)",
            "Color(1, 0, 0.5)",
            "write the three numbers alone, without names: `(1, 0, 0.5)`",
            Some("color: (1, 0, 0.5)"),
        ),
        (
            "color: Rgb(r: 1, g: 0, b: 0.5)",
            "Rgb(r: 1, g: 0, b: 0.5)",
            "write the three numbers alone",
            Some("color: (1, 0, 0.5)"),
        ),
        (
            "color: \"reddish\"",
            "\"reddish\"",
            "color names are not supported",
            None,
        ),
        (
            "center: Vec3(1, 0, 0)",
            "Vec3(1, 0, 0)",
            "write the values alone, without names: `(1, 0, 0)`",
            Some("center: (1, 0, 0)"),
        ),
        (
            "center: (x: 1, y: 0, z: 0)",
            "(x: 1, y: 0, z: 0)",
            "write the values alone",
            Some("center: (1, 0, 0)"),
        ),
        (
            "radius: 1/2",
            "1/2",
            "arithmetic is not evaluated; write `0.5`",
            Some("radius: 0.5"),
        ),
        ("radius: 0.5*2", "0.5*2", "write `1`", Some("radius: 1")),
        ("radius: 2-0.5", "2-0.5", "write `1.5`", Some("radius: 1.5")),
        (
            "radius: 1 + 0.5",
            "1 + 0.5",
            "write `1.5`",
            Some("radius: 1.5"),
        ),
        (
            "radius: pi/2",
            "pi/2",
            "arithmetic is not evaluated; write `1.5707963267948966`",
            Some("radius: 1.5707963267948966"),
        ),
        ("radius: (1+2)/3", "(1+2)/3", "write `1`", Some("radius: 1")),
        (
            "radius: pi",
            "pi",
            "write `3.14159",
            Some("radius: 3.14159"),
        ),
        (
            "radius: sqrt(2)",
            "sqrt(2)",
            "functions are not evaluated",
            None,
        ),
    ] {
        let text = scene(Syntax::Ron, "", &ball(field));
        check(&text, Syntax::Ron, place, help, fixed);
    }
}

/// As in `ron`, CR alone is white space, but does not end a comment.
#[test]
fn lines_that_end_with_cr() {
    let fields = "lights: [ // one\nAmbient(intensity: 1)],";
    let text = scene(Syntax::Ron, fields, BALL);
    let help = "save the file with the line ends LF or CRLF";
    check(
        &text.replace('\n', "\r"),
        Syntax::Ron,
        "//",
        help,
        Some(fields),
    );
    let text = format!("// one\n{text}").replace('\n', "\r");
    check(&text, Syntax::Ron, "//", help, Some("// one\n("));
}

#[test]
fn values_of_the_scene() {
    for (fields, place, help, fixed) in [
        (
            "background: Gradient(from: \"#000\", to: \"#fff\"),",
            "Gradient(from: \"#000\", to: \"#fff\")",
            "gradients are not supported",
            None,
        ),
        (
            "background: [(0, 0, 0), (1, 1, 1)],",
            "[(0, 0, 0), (1, 1, 1)]",
            "gradients are not supported",
            None,
        ),
        (
            "background: (top: \"#000\", bottom: \"#fff\"),",
            "(top: \"#000\", bottom: \"#fff\")",
            "gradients are not supported",
            None,
        ),
        (
            "background: sky_blue,",
            "sky_blue",
            "did you mean `\"#87ceeb\"`?",
            Some("background: \"#87ceeb\""),
        ),
        (
            "lights: [Ambient(0.2)],",
            "Ambient(0.2)",
            "write `Ambient(intensity: 0.2)`",
            Some("Ambient(intensity: 0.2)"),
        ),
        (
            "lights: [Ambient(0.2, color: \"#fff\")],",
            "0.2",
            "write `intensity: 0.2`",
            Some("Ambient(intensity: 0.2, color: \"#fff\")"),
        ),
        (
            "lights: [Point((0, 3, 3))],",
            "Point((0, 3, 3))",
            "write `Point(position: (0, 3, 3))`",
            Some("Point(position: (0, 3, 3))"),
        ),
        ("image: (width: 64.5),", "64.5", "", None),
    ] {
        let text = scene(Syntax::Ron, fields, BALL);
        check(&text, Syntax::Ron, place, help, fixed);
    }
}

#[test]
fn geometries() {
    let other = "Sphere(center: (1, 0, 0), radius: 1)";
    let combined = format!("Union([{BALL}, {other}], color: \"#f00\")");
    let list = format!("[{BALL}, {other}]");
    let of = format!("Union(of: [{BALL}, {other}], color: \"#f00\")");
    let turned = format!("Group(transform: (rotate: (0, 45, 0)), geometries: [{BALL}])");
    let turned_twice = format!("Group(transform: (rotate: (30, 45, 0)), geometries: [{BALL}])");
    let about = format!("Group(transform: (rotate: 45), geometries: [{BALL}])");
    for (geometry, place, help, fixed) in [
        (&*combined, &*list, "write `of: [Sphere", Some(&*of)),
        (
            "Sphere((0, 0, 0), 1, \"#f00\")",
            "Sphere((0, 0, 0), 1, \"#f00\")",
            "write `Sphere(center: (0, 0, 0), radius: 1, color: \"#f00\")`",
            Some(BALL),
        ),
        (
            "Sphere((0, 0, 0), radius: 1, color: \"#f00\")",
            "(0, 0, 0)",
            "write `center: (0, 0, 0)`",
            Some(BALL),
        ),
        (
            "Sphere(center: (0, 0, 0), radius: 1, material: Matte(\"#f00\"))",
            "Matte(\"#f00\")",
            "write `Matte(color: \"#f00\")`",
            None,
        ),
        (
            "(type: \"Sphere\", center: (0, 0, 0), radius: 1, color: \"#f00\")",
            "(type: \"Sphere\", center: (0, 0, 0), radius: 1, color: \"#f00\")",
            "the name stands before the bracket: `Sphere(…)`",
            Some(BALL),
        ),
        (
            "(center: (0, 0, 0), radius: 1, color: \"#f00\")",
            "(center: (0, 0, 0), radius: 1, color: \"#f00\")",
            "write its name before the bracket: `Sphere(…)`",
            Some(BALL),
        ),
        (
            &*turned,
            "(0, 45, 0)",
            "write `(axis: (0, 1, 0), angle: 45)`",
            Some("rotate: (axis: (0, 1, 0), angle: 45)"),
        ),
        (
            &*turned_twice,
            "(30, 45, 0)",
            "a rotation has one axis",
            None,
        ),
        (
            &*about,
            "45",
            "such as `(axis: (0, 1, 0), angle: 45)`",
            None,
        ),
        (
            "Box(min: (1, 2, 3), max: (-1, -2, -3), color: \"#f00\")",
            "(-1, -2, -3)",
            "write `min: (-1, -2, -3), max: (1, 2, 3)`",
            Some("Box(min: (-1, -2, -3), max: (1, 2, 3), color: \"#f00\")"),
        ),
        (
            "Box(min: (-1, 2e0, -3), max: (1, -2, 3), color: \"#f00\")",
            "-2",
            "write `min: (-1, -2, -3), max: (1, 2, 3)`",
            Some("Box(min: (-1, -2, -3), max: (1, 2e0, 3), color: \"#f00\")"),
        ),
    ] {
        let text = scene(Syntax::Ron, "", geometry);
        if geometry.contains("material") {
            // A matte surface is lit.
            let text = scene(Syntax::Ron, "lights: [Ambient()],", geometry);
            let fixed = Some("material: Matte(color: \"#f00\")");
            check(&text, Syntax::Ron, place, help, fixed);
        } else {
            check(&text, Syntax::Ron, place, help, fixed);
        }
    }
}

#[test]
fn objects() {
    let tagged = r##"{"type": "Sphere", "center": [0, 0, 0], "radius": 1, "color": "#f00"}"##;
    let last = r##"{"center": [0, 0, 0], "radius": 1, "color": "#f00", "kind": "sphere"}"##;
    let beside = r##"{"Sphere": {"center": [0, 0, 0], "radius": 1}, "color": "#f00"}"##;
    let key = "a variant is an object with one key, its name: `{\"Sphere\": {…}}`";
    check(
        &scene(Syntax::Json, "", tagged),
        Syntax::Json,
        tagged,
        key,
        Some(BALL_JSON),
    );
    check(
        &scene(Syntax::Json, "", last),
        Syntax::Json,
        last,
        key,
        Some(BALL_JSON),
    );
    let into = "write `\"color\"` into the object of `Sphere`";
    check(
        &scene(Syntax::Json, "", beside),
        Syntax::Json,
        beside,
        into,
        None,
    );
    let text = scene(Syntax::Json, "\"lights\": [{\"Ambient\": 0.2}],", BALL_JSON);
    let fixed = Some("{\"Ambient\": {\"intensity\": 0.2}}");
    check(
        &text,
        Syntax::Json,
        "0.2",
        "write `{\"Ambient\": {\"intensity\": 0.2}}`",
        fixed,
    );
    let text = scene(
        Syntax::Json,
        "\"background\": {\"r\": 0, \"g\": 0.5, \"b\": 1},",
        BALL_JSON,
    );
    let place = "{\"r\": 0, \"g\": 0.5, \"b\": 1}";
    check(
        &text,
        Syntax::Json,
        place,
        "write the three numbers alone",
        Some("[0, 0.5, 1]"),
    );
}

#[test]
fn an_unclosed_bracket_at_the_end_of_a_line() {
    let scene = |line: &str| {
        format!(
            "(\n    camera: Perspective(eye: (0, 0, 9), gaze: (0, 0, -1), fov: 40),\n    \
             geometries: [\n        {line}\n        {BALL},\n    ],\n)\n"
        )
    };
    for line in [
        "Sphere(center: (0, 0, 3), radius: 1, color: (1, 0, 0),",
        "Sphere(center: (0, 0, 3), radius: 1, color: \"#f00\",",
        "Box(\n            min: (0, 0, 3,\n            max: (1, 1, 4),\n            color: \"#f00\",\n        ),",
    ] {
        let text = scene(line);
        let document = Document::from_text("a.ron", &*text, Syntax::Ron);
        let [fault] = document.diagnostics() else {
            panic!("{:#?}", document.diagnostics());
        };
        assert_eq!(fault.message, "`(` is not closed");
        let at = if line.starts_with("Box") {
            "(0, 0, 3,\n"
        } else {
            "(center"
        };
        assert_eq!(fault.range.start, text.find(at).unwrap(), "{line}");
        assert_eq!(fault.labels.len(), 1);
    }
}

#[test]
fn whole_floats() {
    let fields = "image: (width: 64.0, height: 4.8e1, samples: 4.), version: 1.0,";
    let text = scene(Syntax::Ron, fields, BALL);
    let document = Document::from_text("a.ron", text, Syntax::Ron);
    assert_eq!(document.diagnostics(), []);
    let ints = scene(
        Syntax::Ron,
        "image: (width: 64, height: 48, samples: 4), version: 1,",
        BALL,
    );
    let ints = Document::from_text("b.ron", ints, Syntax::Ron);
    let json = |document: Document| document.convert(Syntax::Json).unwrap().text;
    assert_eq!(json(document), json(ints));
    let mesh = "Mesh(vertices: [(0, 0, 0), (1, 0, 0), (0, 1, 0)], triangles: [(0.0, 1, 2.0)], \
                color: \"#f00\")";
    let document = Document::from_text("a.ron", scene(Syntax::Ron, "", mesh), Syntax::Ron);
    assert_eq!(document.diagnostics(), []);
    for (value, code) in [
        ("64.5", "wrong-type"),
        ("-64.0", "out-of-range"),
        ("1e300", "out-of-range"),
        ("inf", "wrong-type"),
    ] {
        let text = scene(Syntax::Ron, &format!("image: (width: {value}),"), BALL);
        let document = Document::from_text("a.ron", text, Syntax::Ron);
        let codes: Vec<_> = document
            .diagnostics()
            .iter()
            .map(|fault| fault.code.name())
            .collect();
        assert_eq!(codes, [code], "{value}");
        let set = Document::from_text("b.ron", scene(Syntax::Ron, "", BALL), Syntax::Ron);
        let set = |value: &str| set.with([format!("image.width={value}").parse().unwrap()]);
        assert!(set(value).has_errors(), "{value}");
        assert!(!set("64.0").has_errors());
    }
}

#[test]
fn fields_of_other_programs_are_written_as_here() {
    for (geometry, fixed) in [
        (
            "Box(center: (1, 2, 3), size: (2, 1, 4), color: \"#0f0\")",
            "Box(min: (0, 1.5, 1), max: (2, 2.5, 5), ",
        ),
        (
            "Cube(side: 3, center: (0, 0, 0), color: \"#0f0\")",
            "Box(max: (1.5, 1.5, 1.5), min: (-1.5, -1.5, -1.5), ",
        ),
        (
            "Cylinder(center: (3, 1, 0), height: 2, radius: 1, color: \"#0f0\")",
            "(from: (3, 0, 0), to: (3, 2, 0), ",
        ),
        (
            "Cylinder(base: (0, 0, 0), cap: (0, 1, 0), r: 1, color: \"#0f0\")",
            "(from: (0, 0, 0), to: (0, 1, 0), radius: 1",
        ),
        (
            "Group(geometries: [Sphere(c: (0, 0, 0), r: 1, color: \"#0f0\")], translate: (0, 1, 0))",
            "transform: (translate: (0, 1, 0)))",
        ),
        (
            "Sphere(center: (0, 0, 0), radius: 1, material: Lambert(diffuse: \"#f00\"))",
            "Matte(color: \"#f00\")",
        ),
    ] {
        let text = scene(Syntax::Ron, "", geometry);
        let mut document = Document::from_text("a", &*text, Syntax::Ron);
        let (cured, _) = document.fixed().unwrap();
        assert!(cured.contains(fixed), "{cured}");
        let document = Document::from_text("a", &*cured, Syntax::Ron);
        assert_eq!(document.diagnostics(), [], "{cured}");
    }
    // Nothing is written where a number would be lost or a comment.
    for geometry in [
        "Box(center: (0, 0, 0), size: (1, 1), color: \"#0f0\")",
        "Box(center: (0, 0, 0 /* here */), size: 1, color: \"#0f0\")",
        "Group(geometries: [], translate: (0, 1, 0), scale: 2)",
    ] {
        let text = scene(Syntax::Ron, "", geometry);
        assert!(
            Document::from_text("a", &*text, Syntax::Ron)
                .fixed()
                .is_none(),
            "{geometry}"
        );
    }
}

#[test]
fn a_broken_value_hides_no_other_fault() {
    use crate::diagnostic::Code;
    let faults = |text: &str, syntax| {
        let document = Document::from_text("a", text, syntax);
        let faults = document.diagnostics().iter();
        let faults = faults.map(|fault| (fault.code, text[fault.range.clone()].to_owned()));
        faults.collect::<Vec<_>>()
    };
    let of = |code: Code, place: &str| (code, place.to_owned());
    let unknown = || of(Code::UnknownField, "colour_of");
    for (value, place) in [
        ("1/2", "1/2"),
        ("50%", "%"),
        ("0.5*x", "*"),
        ("2*sqrt(2)", "*"),
        ("50% + 3%", "%"),
        ("2^3", "^"),
        ("1.2.3", "1.2.3"),
        ("60deg", "60deg"),
    ] {
        let other = "Sphere(center: (0, 0, 0), radius: 1, color: \"#f00\", colour_of: 1)";
        let balls = format!("{}, {other}", ball(&format!("radius: {value}")));
        let text = scene(Syntax::Ron, "", &balls);
        let expected = [of(Code::Syntax, place), unknown()];
        assert_eq!(faults(&text, Syntax::Ron), expected, "{text}");
    }
    // A call is one value.
    for value in ["hsl(120, 50%, 50%)", "rgb(1/2, 50%, 0)"] {
        let text = scene(Syntax::Ron, "", &ball(&format!("color: {value}")));
        assert_eq!(faults(&text, Syntax::Ron), [of(Code::WrongType, value)]);
    }
    let json = scene(
        Syntax::Json,
        "",
        r##"{"Sphere": {"center": [0, 1/2, 5%], "radius": 0, "color": "#f00"}}"##,
    );
    let places = [
        ("1/2", Code::Syntax),
        ("%", Code::Syntax),
        ("0", Code::OutOfRange),
    ];
    let expected = places.map(|(place, code)| of(code, place));
    assert_eq!(faults(&json, Syntax::Json), expected);
    // Around a missing bracket, nothing is known.
    let text = scene(Syntax::Ron, "", "Sphere(radius: 1/2, colour_of: 1");
    let found = faults(&text, Syntax::Ron);
    assert!(
        found.iter().all(|(code, _)| *code == Code::Syntax),
        "{found:?}"
    );
}
