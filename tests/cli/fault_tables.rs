//! Faults of scenes: each changes one place of [`crate::support::RON`] or
//! [`crate::support::JSON`].

/// The replaced text, the replacement, and words of the message; a word in brackets is the code of
/// the fault.
pub(crate) type Fault = (&'static str, &'static str, &'static [&'static str]);

pub(crate) const RANGES_RON: &[Fault] = &[
    (
        "radius: 0.5",
        "radius: -1",
        &["[out-of-range]", "radius", "-1"],
    ),
    ("radius: 0.5", "radius: 0", &["[out-of-range]", "radius"]),
    ("radius: 0.5", "radius: -0.0", &["[out-of-range]", "radius"]),
    ("fov: 90", "fov: 180", &["[out-of-range]", "fov", "180"]),
    ("fov: 90", "fov: 0", &["[out-of-range]", "fov"]),
    ("fov: 90", "fov: -90", &["[out-of-range]", "fov"]),
    ("fov: 90", "fov: 1e300", &["[out-of-range]", "fov"]),
    (
        "width: 32",
        "width: 0",
        &["[out-of-range]", "width", "1000000"],
    ),
    (
        "height: 24",
        "height: 1000001",
        &["[out-of-range]", "height", "1000001"],
    ),
    (
        "width: 32, height: 24",
        "width: 1000000, height: 1000000",
        &["[out-of-range]", "2^34"],
    ),
    (
        "width: 32",
        "width: 99999999999999999999",
        &["[out-of-range]"],
    ),
    ("width: 32", "width: -1", &["[out-of-range]"]),
    ("width: 32", "width: 640.5", &["[wrong-type]"]),
    ("width: 32", "width: 640.5", &["[wrong-type]"]),
];

pub(crate) const NUMBERS_RON: &[Fault] = &[
    ("radius: 0.5", "radius: NaN", &["[not-finite]", "radius"]),
    ("radius: 0.5", "radius: inf", &["[not-finite]", "radius"]),
    ("radius: 0.5", "radius: 1e999", &["[not-finite]", "radius"]),
    ("fov: 90", "fov: NaN", &["[not-finite]", "fov"]),
    (
        "eye: (0, 0, 0)",
        "eye: (0, inf, 0)",
        &["[not-finite]", "eye"],
    ),
    (
        "gaze: (0, 0, -1)",
        "gaze: (0, 0, -inf)",
        &["[not-finite]", "gaze"],
    ),
    (
        "gaze: (0, 0, -1)",
        "look_at: (0, 0, NaN)",
        &["[not-finite]", "look_at"],
    ),
    (
        "normal: (0, 1, 0)",
        "normal: (0, -1e999, 0)",
        &["[not-finite]", "normal"],
    ),
    (
        "color: (0, 1, 0)",
        "color: (0, NaN, 0)",
        &["[not-finite]", "color"],
    ),
    (
        "background: (0, 0.2",
        "background: (inf, 0.2",
        &["[not-finite]", "background"],
    ),
];

pub(crate) const NUMBERS_JSON: &[Fault] = &[
    ("\"radius\": 0.5", "\"radius\": NaN", &["[syntax]"]),
    ("\"radius\": 0.5", "\"radius\": 1e999", &["[not-finite]"]),
    ("\"radius\": 0.5", "\"radius\": Infinity", &["[syntax]"]),
    ("\"radius\": 0.5", "\"radius\": null", &[]),
    ("\"radius\": 0.5", "\"radius\": \"0.5\"", &[]),
    ("\"radius\": 0.5", "\"radius\": .5", &["[syntax]"]),
    ("\"radius\": 0.5", "\"radius\": +5", &["[syntax]"]),
    ("\"radius\": 0.5", "\"radius\": 0x5", &["[syntax]"]),
    ("\"radius\": 0.5", "\"radius\": 05", &["[syntax]"]),
];

pub(crate) const DIRECTIONS_RON: &[Fault] = &[
    (
        "gaze: (0, 0, -1)",
        "gaze: (0, 0, 0)",
        &["[zero-vector]", "gaze"],
    ),
    (
        "gaze: (0, 0, -1)",
        "gaze: (0, -0.0, 1e-200)",
        &["[zero-vector]", "gaze"],
    ),
    (
        "gaze: (0, 0, -1)",
        "gaze: (1e200, 0, 0)",
        &["[zero-vector]", "gaze"],
    ),
    (
        "gaze: (0, 0, -1)",
        "look_at: (0, 0, 0)",
        &["[zero-vector]", "look_at"],
    ),
    (
        "normal: (0, 1, 0)",
        "normal: (0, 0, 0)",
        &["[zero-vector]", "normal"],
    ),
    (
        "gaze: (0, 0, -1)",
        "gaze: (0, 0, -1), up: (0, 0, 0)",
        &["[zero-vector]", "up"],
    ),
    (
        "gaze: (0, 0, -1)",
        "gaze: (0, 0, -1), up: (0, 0, 5)",
        &["[parallel-vectors]", "up"],
    ),
    (
        "gaze: (0, 0, -1)",
        "gaze: (0, -3, 0)",
        &["[parallel-vectors]", "default"],
    ),
    (
        "gaze: (0, 0, -1)",
        "look_at: (0, 7, 0)",
        &["[parallel-vectors]", "default"],
    ),
    (
        "gaze: (0, 0, -1),",
        "",
        &["[gaze-or-look-at]", "gaze", "look_at"],
    ),
    ("gaze: (0, 0, -1)", "gaze: None", &["[gaze-or-look-at]"]),
    (
        "gaze: (0, 0, -1)",
        "gaze: (0, 0, -1), look_at: (0, 0, -1)",
        &["[gaze-or-look-at]", "both"],
    ),
];

pub(crate) const COLORS_RON: &[Fault] = &[
    ("\"#ff0000\"", "\"red\"", &["[invalid-color]", "red"]),
    (
        "\"#ff0000\"",
        "\"#ff000080\"",
        &["[invalid-color]", "#ff000080"],
    ),
    ("\"#ff0000\"", "\"\"", &["[invalid-color]"]),
    ("\"#ff0000\"", "\"ff0000\"", &["[invalid-color]"]),
    ("\"#ff0000\"", "\"#ff000g\"", &["[invalid-color]"]),
    ("\"#ff0000\"", "\"#éé\"", &["[invalid-color]"]),
    ("\"#ff0000\"", "\"#+f+f+f\"", &["[invalid-color]"]),
    ("\"#ff0000\"", "Foo(1, 0, 0)", &["[wrong-type]"]),
    ("\"#ff0000\"", "[1, 0, 0]", &["[wrong-type]"]),
    ("\"#ff0000\"", "(1, 0)", &["[wrong-type]"]),
    ("\"#ff0000\"", "(1, 0, 0, 1)", &["[wrong-type]"]),
    ("\"#ff0000\"", "(r: 1, g: 0, b: 0)", &["[wrong-type]"]),
    ("\"#ff0000\"", "1", &["[wrong-type]"]),
    ("\"#ff0000\"", "Some(\"#ff0000\")", &["[wrong-type]"]),
    ("\"#ff0000\"", "None", &["[one-of]"]),
    ("\"#ff0000\"", "'r'", &["[wrong-type]"]),
];

pub(crate) const NAMES_RON: &[Fault] = &[
    ("radius", "radios", &["[unknown-field]", "radios", "radius"]),
    (
        "fov: 90",
        "fov: 90, angle: 45",
        &["[unknown-field]", "angle"],
    ),
    (
        "fov: 90",
        "fov: 90, alpha: 45",
        &["[unknown-field]", "alpha"],
    ),
    (
        "fov: 90",
        "fov: 90, scale: 1",
        &["[unknown-field]", "scale"],
    ),
    (
        "background",
        "Background",
        &["[unknown-field]", "Background"],
    ),
    ("Sphere(", "sphere(", &["[unknown-variant]", "sphere"]),
    (
        "Sphere(",
        "Cube(",
        &["[unknown-variant]", "Cube", "expected one of 20", "`Box`"],
    ),
    (
        "Perspective(",
        "Fisheye(",
        &["[unknown-variant]", "Fisheye"],
    ),
    (
        "radius: 0.5",
        "radius: 0.5, radius: 0.5",
        &["[duplicate-field]", "radius"],
    ),
    (
        "background",
        "geometries: [], background",
        &["[duplicate-field]", "geometries"],
    ),
    ("radius: 0.5,", "", &["[missing-field]", "radius"]),
    ("fov: 90", "", &["[missing-field]", "fov"]),
    ("eye: (0, 0, 0),", "", &["[missing-field]", "eye"]),
    ("normal: (0, 1, 0),", "", &["[missing-field]", "normal"]),
];

pub(crate) const NAMES_JSON: &[Fault] = &[
    (
        "\"background\"",
        "\"$Schema\": \"a\", \"background\"",
        &["[unknown-field]"],
    ),
    (
        "\"background\"",
        "\"background\": null, \"background\"",
        &["[duplicate-field]"],
    ),
    (
        "\"radius\": 0.5",
        "\"radius\": 0.5, \"radius\": 1",
        &["[duplicate-field]"],
    ),
];

pub(crate) const SHAPES_RON: &[Fault] = &[
    (
        "Sphere(center: (-1, 0, -3)",
        "Sphere((center: (-1, 0, -3)",
        &[],
    ),
    ("eye: (0, 0, 0)", "eye: Some((0, 0, 0))", &[]),
    (
        "gaze: (0, 0, -1)",
        "gaze: Some((0, 0, -1))",
        &["[wrong-type]"],
    ),
    (
        "image: (width: 32",
        "image: (width: Some(32)",
        &["[wrong-type]"],
    ),
    ("eye: (0, 0, 0)", "eye: [0, 0, 0]", &["[wrong-type]"]),
    ("eye: (0, 0, 0)", "eye: Vec3(0, 0, 0)", &["[wrong-type]"]),
    (
        "eye: (0, 0, 0)",
        "eye: (x: 0, y: 0, z: 0)",
        &["[wrong-type]", "write the values alone, without names"],
    ),
    (
        "Sphere(center: (-1, 0, -3), radius: 0.5, color: \"#ff0000\")",
        "Spheres(file: \"a.csv\", color_by: (column: \"e\", range: (min: 0, max: 1)))",
        &["[wrong-type]", "write the values alone, without names"],
    ),
    ("eye: (0, 0, 0)", "eye: (0, 0)", &["[wrong-type]"]),
    ("eye: (0, 0, 0)", "eye: (0, 0, 0, 0)", &["[wrong-type]"]),
    ("eye: (0, 0, 0)", "eye: \"0, 0, 0\"", &["[wrong-type]"]),
    ("eye: (0, 0, 0)", "eye: None", &["[wrong-type]"]),
    ("fov: 90", "fov: \"90\"", &["[wrong-type]"]),
    ("fov: 90", "fov: 'a'", &["[wrong-type]"]),
    ("fov: 90", "fov: true", &["[wrong-type]"]),
    ("fov: 90", "fov: (90)", &["[wrong-type]"]),
    ("fov: 90", "fov: 90°", &[]),
    ("image: (", "image: Picture(", &["[wrong-type]"]),
    (
        "image: (width: 32, height: 24)",
        "image: (32, 24)",
        &["[wrong-type]"],
    ),
    (
        "image: (width: 32, height: 24)",
        "image: [32, 24]",
        &["[wrong-type]"],
    ),
    ("geometries: [", "geometries: (", &[]),
    ("camera: Perspective", "camera: ", &["[wrong-type]"]),
    ("(\n    image", "World(\n    image", &["[wrong-type]"]),
    ("(\n    image", "[(\n    image", &[]),
    ("    ],\n)", "    ],\n", &["[syntax]"]),
    ("    ],\n)", "    ],\n) trailing", &["[syntax]"]),
    ("    ],\n)", "    ],\n))", &["[syntax]"]),
    ("    ],\n)", "    ],\n)()", &["[syntax]"]),
    ("    ],\n)", "    ],\n) /* open", &["[syntax]"]),
    ("fov: 90", "fov 90", &["[syntax]"]),
    ("fov: 90", "fov = 90", &["[syntax]"]),
    ("\"#ff0000\"", "\"#ff0000", &["[syntax]"]),
];

pub(crate) const SHAPES_JSON: &[Fault] = &[
    (
        "{\"width\": 32, \"height\": 24}",
        "[32, 24]",
        &["[wrong-type]"],
    ),
    ("{\"width\": 32, \"height\": 24}", "5", &["[wrong-type]"]),
    (
        "{\"center\": [-1, 0, -3], \"radius\": 0.5, \"color\": \"#ff0000\"}",
        "[[-1, 0, -3], 0.5, \"#ff0000\"]",
        &["[wrong-type]"],
    ),
    (
        "{\"eye\": [0, 0, 0], \"gaze\": [0, 0, -1], \"fov\": 90}",
        "[[0, 0, 0], [0, 0, -1], null, null, 90]",
        &["[wrong-type]"],
    ),
    (
        "\"eye\": [0, 0, 0]",
        "\"eye\": {\"x\": 0, \"y\": 0, \"z\": 0}",
        &["[wrong-type]"],
    ),
    ("\"eye\": [0, 0, 0]", "\"eye\": null", &["[wrong-type]"]),
    ("{\"Plane\":", "{\"Sphere\": {}, \"Plane\":", &[]),
    ("\"background\"", "// no\n\"background\"", &["[syntax]"]),
    ("\"background\"", "background", &["[syntax]"]),
    ("\"background\"", "'background'", &["[syntax]"]),
    ("    ]\n}", "    ],\n}", &["[syntax]"]),
    ("    ]\n}", "    ]\n} {}", &["[syntax]"]),
    ("    ]\n}", "    ]\n}}", &["[syntax]"]),
    ("    ]\n}", "    ]\n", &["[syntax]"]),
];

pub(crate) const VERSIONS_RON: &[Fault] = &[
    (
        "(\n    image",
        "(\n    version: 2,\n    image",
        &["[unsupported-version]", "2"],
    ),
    (
        "(\n    image",
        "(\n    version: 0,\n    image",
        &["[unsupported-version]", "0"],
    ),
    (
        "(\n    image",
        "(\n    version: 1.5,\n    image",
        &["[wrong-type]"],
    ),
    ("(\n    image", "(\n    version: \"1\",\n    image", &[]),
    ("(\n    image", "(\n    version: -1,\n    image", &[]),
    (
        "(\n    image",
        "(\n    allow: [\"eye-indise\"],\n    image",
        &["eye-indise"],
    ),
    (
        "(\n    image",
        "(\n    allow: [\"out-of-range\"],\n    image",
        &["out-of-range"],
    ),
    (
        "(\n    image",
        "(\n    allow: \"eye-inside\",\n    image",
        &[],
    ),
    (
        "(\n    image",
        "(\n    allow: (\"eye-inside\"),\n    image",
        &[],
    ),
    ("(\n    image", "(\n    allow: [5],\n    image", &[]),
];
