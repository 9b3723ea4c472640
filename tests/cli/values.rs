//! Colors by value: `strahl legend`, and what `info` and `pixel` say about them.

use std::fs;

use serde_json::{Value, json};

use crate::support::{Folder, run};

const TABLE: &str = "x,y,z,radius,energy\n0,0,-3,0.5,-1\n2,0,-5,0.5,0.5\n-2,0,-5,0.5,\n";

fn folder(color_by: &str, more: &str) -> Folder {
    let folder = Folder::new();
    folder.write("atoms.csv", TABLE);
    let scene = format!(
        "(
    image: (width: 40, height: 30),
    camera: Perspective(eye: (0, 0, 0), gaze: (0, 0, -1), fov: 60),
    geometries: [
        Spheres(file: \"atoms.csv\", color_by: ({color_by}), name: \"atoms\"),{more}
    ],
)
"
    );
    folder.write("scene.ron", scene);
    folder
}

const ENERGY: &str = "column: \"energy\", map: Gray, missing: \"#00ff00\"";

#[test]
fn a_legend_has_the_colors_of_the_scene() {
    let folder = folder(ENERGY, "");
    run(&mut folder.strahl(["legend", "scene.ron", "-o", "legend.png"])).quiet_success();
    let picture = image::open(folder.path("legend.png")).unwrap().to_rgb8();
    // The bar begins at the left margin: white is above, black below, all grays between.
    let column: Vec<_> = (0..picture.height())
        .map(|y| picture.get_pixel(20, y).0)
        .collect();
    let bar: Vec<_> = column.iter().filter(|[r, g, b]| r == g && g == b).collect();
    assert!(bar.contains(&&[128; 3]) && bar.contains(&&[64; 3]));
    assert!(column.contains(&[0, 255, 0]), "the color of missing values");
    let again = run(&mut folder.strahl(["legend", "scene.ron", "-o", "again.PNG"]));
    again.quiet_success();
    let read = |name| fs::read(folder.path(name)).unwrap();
    assert_eq!(read("legend.png"), read("again.PNG"));
}

#[test]
fn an_svg_is_a_text_with_ticks() {
    let folder = folder(ENERGY, "");
    let args = [
        "legend",
        "scene.ron",
        "-o",
        "a.svg",
        "--label",
        "a < b & \u{e9}",
        "--horizontal",
    ];
    run(&mut folder.strahl(args)).quiet_success();
    let svg = fs::read_to_string(folder.path("a.svg")).unwrap();
    for part in [
        "<svg ",
        ">a &lt; b &amp; \u{e9}</text>",
        ">-1.0</text>",
        ">0.4</text>",
        "#ffffff",
    ] {
        assert!(svg.contains(part), "no {part} in {svg}");
    }
}

#[test]
fn a_picture_of_a_legend_has_all_letters_of_its_label() {
    let folder = folder(ENERGY, "");
    let legend = |label: &str, output: &str| {
        let args = ["legend", "scene.ron", "-o", output, "--label", label];
        run(&mut folder.strahl(args))
    };
    for (label, letter) in [
        ("σ / MPa", "σ"),
        ("CO₂", "₂"),
        ("m s⁻¹", "⁻"),
        ("Ω", "Ω"),
        ("速度", "速"),
        ("λ", "λ"),
    ] {
        let message = format!("no letter `{letter}` for its label `{label}`; write an svg file");
        legend(label, "a.png").one_line(2, &["a.png", &message]);
        assert!(!folder.path("a.png").exists());
        legend(label, "a.svg").quiet_success();
        let svg = fs::read_to_string(folder.path("a.svg")).unwrap();
        assert!(svg.contains(label), "{svg}");
    }
    let draw = |label: &str| {
        legend(label, "a.png").quiet_success();
        fs::read(folder.path("a.png")).unwrap()
    };
    // Signs of the same look, whatever they are called.
    for (label, equal) in [
        ("μm", "µm"),
        ("\u{212b}", "Å"),
        ("t / \u{2212}1\u{a0}°C", "t / -1 °C"),
    ] {
        assert!(draw(label) == draw(equal), "{label}");
    }
    draw("kg·m²·s³ ± 5 × é ß ½");
}

#[test]
fn several_scales_need_a_choice() {
    let more = "Spheres(file: \"atoms.csv\", color_by: (column: \"x\")),";
    let folder = folder(ENERGY, more);
    let done = run(&mut folder.strahl(["legend", "scene.ron", "-o", "a.svg"]));
    assert_eq!(done.status, Some(2));
    assert!(
        done.stderr.contains("`--geometry`: `atoms`, `1`"),
        "{}",
        done.stderr
    );
    let column = |geometry: &str| {
        let args = ["legend", "scene.ron", "-o", "a.svg", "--geometry", geometry];
        let done = run(&mut folder.strahl(args));
        assert_eq!(done.status, Some(0), "{}", done.stderr);
        fs::read_to_string(folder.path("a.svg")).unwrap()
    };
    assert!(column("atoms").contains(">energy</text>"));
    assert!(column("0").contains(">energy</text>"));
    assert!(column("1").contains(">x</text>"));
    let args = ["legend", "scene.ron", "-o", "a.svg", "--geometry", "atom"];
    assert_eq!(run(&mut folder.strahl(args)).status, Some(2));
}

#[test]
fn scenes_without_values_have_no_legend() {
    let folder = Folder::with_scenes();
    let done = run(&mut folder.strahl(["legend", "scene.ron", "-o", "a.png"]));
    assert_eq!(done.status, Some(2));
    assert!(done.stderr.contains("color_by"), "{}", done.stderr);
}

#[test]
fn info_and_pixel_tell_values() {
    let folder = folder(ENERGY, "");
    let json = |args: &[&str]| -> Value {
        let done = run(&mut folder.strahl(args));
        serde_json::from_slice(&done.quiet_success()).unwrap()
    };
    let info = json(&["info", "scene.ron", "--output-format", "json"]);
    let values = json!({
        "column": "energy", "range": [-1.0, 0.5], "data": [-1.0, 0.5], "missing": 1,
    });
    assert_eq!(info["geometries"]["tables"][0]["color_by"], values);
    let set = "geometries[0].color_by.range=(-2, 0)";
    let args = [
        "pixel",
        "scene.ron",
        "20,15",
        "--output-format",
        "json",
        "--set",
        set,
    ];
    let pixel = json(&args);
    let value = json!({
        "column": "energy", "value": -1.0, "range": [-2.0, 0.0], "position": 0.5,
    });
    assert_eq!(pixel["hit"]["value"], value);
    assert_eq!(pixel["byte"], json!([128, 128, 128]));
    let other = json!({"column": "energy", "value": null, "range": [-2.0, 0.0], "position": null});
    assert_eq!(pixel["geometries"][2]["value"], other);
    let human = run(&mut folder.strahl(["pixel", "scene.ron", "20,15"])).quiet_success();
    let human = String::from_utf8(human).unwrap();
    assert!(
        human.contains("\"energy\" = -1.0 of -1.0 to 0.5, at 0.0 of the map"),
        "{human}"
    );
}

#[test]
fn resumed_pictures_know_their_values() {
    let folder = folder(ENERGY, "");
    let draw = || {
        let args = [
            "render",
            "scene.ron",
            "-o",
            "out/",
            "--resume",
            "--samples",
            "1",
        ];
        run(&mut folder.strahl(args));
        fs::read(folder.path("out/scene.png")).unwrap()
    };
    let first = draw();
    folder.write("atoms.csv", TABLE.replace("0.5,0.5\n", "0.5,-3\n"));
    assert_ne!(draw(), first);
}

#[test]
fn a_legend_never_replaces_what_it_is_made_of() {
    let folder = folder(ENERGY, "");
    for (scene, output) in [("scene.ron", "atoms.csv"), ("scene.ron", "scene.ron")] {
        let before = fs::read(folder.path(output)).unwrap();
        let done = run(&mut folder.strahl(["legend", scene, "-o", output]));
        done.one_line(2, &["a legend is a file of svg, png"]);
        assert_eq!(fs::read(folder.path(output)).unwrap(), before);
    }
    // Numpy arrays are tables, and pictures as well.
    folder.write(
        "table.npy",
        fs::read("tests/valid/tables/numpy-structured-xyz-radius-color.npy").unwrap(),
    );
    folder.write(
        "array.ron",
        "(camera: Fit(), geometries: [Spheres(file: \"table.npy\", radius: 1, color_by: (column: \"x\"))])",
    );
    let before = fs::read(folder.path("table.npy")).unwrap();
    let done = run(&mut folder.strahl(["legend", "array.ron", "-o", "table.npy"]));
    assert_eq!(done.status, Some(2));
    assert!(
        done.stderr
            .contains("table.npy: the picture would overwrite its scene")
    );
    assert_eq!(fs::read(folder.path("table.npy")).unwrap(), before);
}

#[test]
fn a_legend_goes_to_standard_output() {
    let folder = folder(ENERGY, "");
    run(&mut folder.strahl(["legend", "scene.ron", "-o", "legend.png"])).quiet_success();
    let stdout = run(&mut folder.strahl(["legend", "scene.ron", "-o", "-"])).quiet_success();
    assert_eq!(stdout, fs::read(folder.path("legend.png")).unwrap());
}

#[test]
fn a_legend_has_a_form_that_holds_it() {
    let folder = folder(ENERGY, "");
    for output in ["a.exr", "a.npz", "a.gif", "a"] {
        let done = run(&mut folder.strahl(["legend", "scene.ron", "-o", output]));
        done.one_line(2, &["a legend is a file of svg, png", "`-` for PNG"]);
    }
    let args = ["legend", "scene.ron", "-o", "a.png", "--size", "60x60"];
    run(&mut folder.strahl(args)).one_line(2, &["a.png", "needs at least"]);
}

#[test]
fn tables_in_parts_have_names() {
    let folder = Folder::new();
    folder.write("atoms.csv", "x,y,z,radius\n0,0,-3,0.5\n2,0,-5,0.25\n");
    let table = |column: &str, more: &str| {
        format!("Spheres(file: \"atoms.csv\", color_by: (column: \"{column}\"){more}),")
    };
    let part = table("radius", "") + &table("x", ", name: \"far\"");
    folder.write("part.ron", format!("(geometries: [{part}])"));
    let scene = "(camera: Fit(), geometries: [
        Part(file: \"part.ron\"),
        Part(file: \"part.ron\", transform: (translate: (9, 0, 0)), name: \"right\"),
    ])";
    folder.write("scene.ron", scene);
    let legend = |geometry: &str| {
        let args = ["legend", "scene.ron", "-o", "a.svg", "--geometry", geometry];
        run(&mut folder.strahl(args))
    };
    let done = run(&mut folder.strahl(["legend", "scene.ron", "-o", "a.svg"]));
    done.one_line(
        2,
        &["choose one by `--geometry`: `0.0`, `0.far`, `right.0`, `right.far`"],
    );
    legend("right").one_line(2, &["choose one by `--geometry`: `right.0`, `right.far`"]);
    for (geometry, column) in [
        ("0.0", "radius"),
        ("0.far", "x"),
        ("right.0", "radius"),
        ("right.1", "x"),
        ("1.far", "x"),
    ] {
        assert_eq!(legend(geometry).status, Some(0), "{geometry}");
        let svg = fs::read_to_string(folder.path("a.svg")).unwrap();
        assert!(svg.contains(&format!(">{column}</text>")), "{geometry}");
    }
}
