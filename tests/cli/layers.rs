//! Samples, crops and layers of pictures.

use std::fs;

use crate::support::{Folder, run};

const EDGE: &str = r##"(
    image: (width: 24, height: 16),
    camera: Perspective(eye: (0, 0, 5), gaze: (0, 0, -1), fov: 40),
    background: (0, 0, 0),
    geometries: [
        Sphere(center: (0, 0, 0), radius: 1, color: "#ffffff", name: "ball"),
    ],
)"##;

fn folder() -> Folder {
    let folder = Folder::with_scenes();
    fs::write(folder.path("edge.ron"), EDGE).unwrap();
    folder
}

fn draw(folder: &Folder, output: &str, options: &[&str]) -> Vec<u8> {
    let args = ["render", "edge.ron", "-o", output];
    run(&mut folder.strahl(args.iter().chain(options))).quiet_success();
    fs::read(folder.path(output)).unwrap()
}

#[test]
fn an_edge_pixel_has_the_mean_light() {
    let folder = folder();
    let bytes = draw(&folder, "a.png", &["--samples", "4"]);
    let image = image::load_from_memory(&bytes).unwrap().to_rgb8();
    let mut seen: Vec<u8> = image.pixels().map(|pixel| pixel.0[0]).collect();
    seen.sort_unstable();
    seen.dedup();
    // No light, a quarter, a half, three quarters, and full light.
    assert_eq!(seen, [0, 137, 188, 225, 255]);
    let one = draw(&folder, "b.png", &["--samples", "1"]);
    assert_eq!(one, draw(&folder, "c.png", &[]));
    assert_ne!(one, bytes);
}

#[test]
fn the_scene_can_set_samples() {
    let folder = folder();
    let bytes = draw(&folder, "a.png", &["--samples", "9"]);
    let text = EDGE.replace("height: 16", "height: 16, samples: 9");
    fs::write(folder.path("edge.ron"), text).unwrap();
    assert_eq!(draw(&folder, "b.png", &[]), bytes);
    assert_ne!(draw(&folder, "c.png", &["--samples", "1"]), bytes);
}

#[test]
fn samples_that_are_not_squares_and_crops_outside_are_rejected() {
    let folder = folder();
    for (options, words) in [
        (["--samples", "5"], ["4", "9"]),
        (["--samples", "x"], ["square", "16"]),
        (["--crop", "20,0,5,5"], ["20,0,5,5", "24x16"]),
        (["--crop", "1,2,3"], ["X,Y,W,H", "0,0,64,64"]),
        (["--crop", "0,0,0,5"], ["1 to", "0x5"]),
        (["--bits", "7"], ["8, 16", "32"]),
        (["--layers", "depht"], ["depth", "normal"]),
        (["--layers", "depth"], ["--depth-range", "npy"]),
        (["--layers", "position"], ["png", "npy"]),
        (["--depth-range", "3,1"], ["smaller", "first"]),
        (["--quality", "80"], ["jpg", "png"]),
        (["--compression", "zips"], ["png", "exr"]),
    ] {
        let args = ["render", "edge.ron", "-o", "a.png"];
        let done = run(&mut folder.strahl(args.iter().chain(&options)));
        assert_eq!(done.status, Some(2), "{options:?}: {}", done.stderr);
        for word in words {
            assert!(done.stderr.contains(word), "{options:?}: {}", done.stderr);
        }
        assert!(!folder.path("a.png").exists());
    }
}

#[test]
fn a_crop_equals_that_part_of_the_whole_picture_in_every_format() {
    let folder = folder();
    for ending in ["png", "tiff", "webp"] {
        let open = |name: String, options: &[&str]| {
            let bytes = draw(&folder, &name, options);
            image::load_from_memory(&bytes).unwrap().to_rgba16()
        };
        let options = ["--samples", "16", "--transparent"];
        let whole = open(format!("a.{ending}"), &options);
        let crop = [&options[..], &["--crop", "5,3,11,9"]].concat();
        let part = open(format!("b.{ending}"), &crop);
        let view = image::imageops::crop_imm(&whole, 5, 3, 11, 9).to_image();
        assert!(view == part, "{ending}");
        assert!(whole.pixels().any(|pixel| pixel.0[3] == 0));
        assert!(whole.pixels().any(|pixel| (1..65535).contains(&pixel.0[3])));
        // Straight alpha: the white of the ball is not darker at its edge.
        let mut seen = whole.pixels().filter(|pixel| pixel.0[3] > 0);
        assert!(seen.all(|pixel| pixel.0[..3] == [65535; 3]), "{ending}");
    }
}

#[test]
fn each_layer_has_its_own_file_in_single_layer_formats() {
    let folder = folder();
    let layers = "color,depth,z,normal,id,coverage";
    let args = ["render", "edge.ron", "-o", "a.png", "--layers", layers];
    let range = ["--depth-range", "0,10"];
    run(&mut folder.strahl(args.iter().chain(&range))).quiet_success();
    assert!(!folder.path("a.png").exists());
    let gray = |layer: &str| {
        let bytes = fs::read(folder.path(format!("a.{layer}.png"))).unwrap();
        image::load_from_memory(&bytes).unwrap().to_luma16()
    };
    for layer in ["depth", "z"] {
        let image = gray(layer);
        // The ball begins at 4 of 10 units; the background has the largest depth.
        assert_eq!(image.get_pixel(0, 0).0, [65535], "{layer}");
        let middle = f64::from(image.get_pixel(12, 8).0[0]) / 65535.0 * 10.0;
        assert!((middle - 4.0).abs() < 0.05, "{layer}: {middle}");
    }
    let decoder = png::Decoder::new(
        fs::File::open(folder.path("a.id.png"))
            .map(std::io::BufReader::new)
            .unwrap(),
    );
    let mut reader = decoder.read_info().unwrap();
    let mut ids = vec![0; reader.output_buffer_size().unwrap()];
    reader.next_frame(&mut ids).unwrap();
    assert_eq!(reader.info().color_type, png::ColorType::Indexed);
    assert_eq!(reader.info().palette.as_ref().unwrap()[..3], [0, 0, 0]);
    assert!(ids.iter().any(|byte| *byte != 0));
}

#[test]
fn equal_pictures_are_equal_files_and_metadata_is_optional() {
    let folder = folder();
    for ending in ["png", "exr", "tiff", "npz"] {
        let name = |stem: &str| format!("{stem}.{ending}");
        let options = ["--samples", "16"];
        let one = draw(
            &folder,
            &name("a"),
            &[&options[..], &["--threads", "1"]].concat(),
        );
        let other = draw(
            &folder,
            &name("b"),
            &[&options[..], &["--threads", "3"]].concat(),
        );
        assert!(one == other, "{ending}");
    }
    let about = draw(&folder, "c.png", &["--metadata"]);
    assert_ne!(about, draw(&folder, "d.png", &[]));
    let words = String::from_utf8_lossy(&about).into_owned();
    assert!(
        words.contains(concat!("strahl ", env!("CARGO_PKG_VERSION"))),
        "{words}"
    );
}

#[cfg(unix)]
#[test]
fn a_picture_does_not_overwrite_a_table_of_its_scene() {
    let folder = folder();
    let text = EDGE.replace(
        "geometries: [",
        "geometries: [Spheres(file: \"a.csv\", radius: 1, color: \"#fff\"),",
    );
    fs::write(folder.path("edge.ron"), text).unwrap();
    fs::write(folder.path("a.csv"), "x,y,z\n0,0,1\n").unwrap();
    draw(&folder, "b.npy", &[]);
    std::os::unix::fs::symlink("a.csv", folder.path("c.npy")).unwrap();
    let done = run(&mut folder.strahl(["render", "edge.ron", "-o", "c.npy"]));
    done.one_line(2, &["c.npy", "overwrite", "a.csv"]);
    assert_eq!(fs::read(folder.path("a.csv")).unwrap(), b"x,y,z\n0,0,1\n");
}

#[test]
fn several_layers_of_a_single_layer_format_do_not_fit_into_one_stream() {
    let folder = folder();
    let args = [
        "render",
        "edge.ron",
        "-o",
        "-",
        "--layers",
        "color,coverage",
    ];
    let done = run(&mut folder.strahl(args));
    assert_eq!(done.status, Some(2));
    assert!(done.stderr.contains("exr"), "{}", done.stderr);
    let done = run(&mut folder.strahl(args.iter().chain(&["--image-format", "exr"])));
    assert_eq!(done.status, Some(0), "{}", done.stderr);
}

#[test]
fn alpha_is_what_hides_the_background_in_glass_and_mirrors_too() {
    let folder = Folder::new();
    for (material, more, alpha) in [
        // A glass ball alone: what passes and what is mirrored ends in the background.
        ("Glass()", "", 0),
        ("Mirror()", "", 0),
        // 1 - lin(0.50196) = 0.78414
        (r##"Mirror(color: "#808080")"##, "", 200),
        (
            r##"Phong(diffuse: "#fff", reflection: "#808080")"##,
            "",
            200,
        ),
        (r##"Matte(color: "#fff")"##, "", 255),
        (r##"Flat(color: "#fff")"##, "", 255),
        // Both sides of the glass reflect: 1 - 2F/(1+F) = 0.92308 for F = 0.04.
        (
            "Glass()",
            r##", Plane(point: (0, 0, -3), normal: (0, 0, 1), color: "#fff")"##,
            235,
        ),
        (
            "Mirror()",
            r##", Plane(point: (0, 0, 9), normal: (0, 0, 1), color: "#fff")"##,
            255,
        ),
    ] {
        folder.write(
            "alpha.ron",
            format!(
                r##"(image: (width: 9, height: 9), camera: Perspective(eye: (0, 0, 4), gaze: (0, 0, -1), fov: 40),
    background: "#0000ff", lights: [Ambient()],
    geometries: [Sphere(center: (0, 0, 0), radius: 1, material: {material}){more}])"##
            ),
        );
        let args = ["render", "alpha.ron", "-q", "-o", "a.png", "--transparent"];
        run(&mut folder.strahl(args)).quiet_success();
        let picture = image::open(folder.path("a.png")).unwrap().to_rgba8();
        let [r, _, b, found] = picture.get_pixel(4, 4).0;
        assert!(found.abs_diff(alpha) <= 1, "{material}{more}: {found}");
        assert!(alpha == 0 || r == b, "{material}{more}: blue shows");
    }
}
