//! Compression and palettes.

use std::{fmt::Write, fs, io::Cursor};

use png::{BitDepth, ColorType, Decoder, Transformations};

use crate::support::{Folder, RON, run};

/// A decoded picture file: color type, depth, palette, and the pixels as red, green, blue.
#[derive(Debug, PartialEq)]
struct Png {
    color: ColorType,
    depth: BitDepth,
    palette: Option<Vec<u8>>,
    pixels: Vec<u8>,
}

fn decode(file: &[u8]) -> Png {
    let mut decoder = Decoder::new(Cursor::new(file));
    decoder.set_transformations(Transformations::EXPAND);
    let mut reader = decoder.read_info().unwrap();
    let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
    reader.next_frame(&mut pixels).unwrap();
    let info = reader.info();
    Png {
        color: info.color_type,
        depth: info.bit_depth,
        palette: info.palette.as_ref().map(|palette| palette.to_vec()),
        pixels,
    }
}

/// Returns the file that `strahl render scene.ron` writes with these arguments.
fn render(folder: &Folder, args: &str) -> Vec<u8> {
    let mut command = folder.strahl(["render", "scene.ron", "-o", "a.png"]);
    run(command.args(args.split_whitespace())).quiet_success();
    fs::read(folder.path("a.png")).unwrap()
}

/// Returns a scene of this many colors: the background and balls, of which the last is visible.
fn balls(colors: usize) -> String {
    let mut scene =
        "(camera: Perspective(eye: (0, 0, 0), gaze: (0, 0, -1), fov: 90), geometries: [\n"
            .to_owned();
    for ball in 1..colors {
        let z = if ball + 1 == colors { -4.0 } else { -9.0 };
        writeln!(
            scene,
            "Sphere(center: (0, 0, {z:?}), radius: 1, color: \"#{ball:06x}\"),"
        )
        .unwrap();
    }
    scene + "])\n"
}

#[test]
fn every_way_of_writing_gives_the_same_pixels() {
    let folder = Folder::with_scenes();
    for size in ["1x1", "9x1", "101x67", "300x200"] {
        let expected = decode(&render(&folder, &format!("--size {size}")));
        assert_eq!(
            (expected.color, expected.depth),
            (ColorType::Rgb, BitDepth::Eight)
        );
        for options in [
            "--compression fast",
            "--compression small",
            "--palette never",
            "--palette auto",
            "--compression small --palette auto",
        ] {
            let found = decode(&render(&folder, &format!("--size {size} {options}")));
            assert!(found.pixels == expected.pixels, "{size} {options}");
        }
    }
}

#[test]
fn any_number_of_threads_writes_the_same_bytes() {
    let folder = Folder::with_scenes();
    // Enough rows for more than one band.
    let size = "--size 900x700";
    for options in ["", "--compression small", "--palette auto"] {
        let expected = render(&folder, &format!("{size} {options} --threads 1"));
        for threads in [2, 3, 16] {
            let args = format!("{size} {options} --threads {threads}");
            assert!(render(&folder, &args) == expected, "{args}");
        }
    }
}

#[test]
fn small_is_smaller() {
    let folder = Folder::with_scenes();
    let of = |options: &str| render(&folder, &format!("--size 640x480 {options}")).len();
    assert_eq!(of(""), of("--compression fast"));
    let (fast, small, palette) = (of(""), of("--compression small"), of("--palette auto"));
    assert!(small < fast && palette < fast, "{small} {palette} {fast}");
}

#[test]
fn a_palette_is_in_the_order_of_the_file() {
    let folder = Folder::with_scenes();
    let indexed = decode(&render(&folder, "--palette auto"));
    assert_eq!(
        (indexed.color, indexed.depth),
        (ColorType::Indexed, BitDepth::Two)
    );
    let expected = [[0, 51, 102], [0, 255, 0], [255, 0, 0]];
    assert_eq!(indexed.palette.unwrap(), expected.as_flattened());
    // Invisible colors have an entry as well, so the kind of file follows from the scene alone.
    folder.write("scene.ron", RON.replace("(-1, 0, -3)", "(-1, 0, 3)"));
    let unseen = decode(&render(&folder, "-q --palette auto"));
    assert_eq!(unseen.palette.unwrap(), expected.as_flattened());
}

#[test]
fn more_than_256_colors_have_no_palette() {
    let folder = Folder::new();
    for (colors, kind) in [(256, ColorType::Indexed), (257, ColorType::Rgb)] {
        folder.write("scene.ron", balls(colors));
        let auto = render(&folder, "-q --size 40x30 --palette auto");
        let never = render(&folder, "-q --size 40x30");
        assert_eq!(decode(&auto).color, kind, "{colors}");
        assert_eq!(decode(&never).color, ColorType::Rgb);
        assert_eq!(decode(&auto).pixels, decode(&never).pixels);
        assert_eq!(auto == never, kind == ColorType::Rgb);
    }
}

#[test]
fn png_options_are_rejected_for_other_formats() {
    let folder = Folder::with_scenes();
    for option in [
        "--compression small",
        "--compression fast",
        "--palette auto",
    ] {
        for target in ["-o a.jpg", "-o - --image-format jpg"] {
            // Reported before anything is read.
            let line = format!("render missing.ron {target} {option}");
            let done = run(&mut folder.strahl(line.split_whitespace()));
            done.one_line(2, &[option.split(' ').next().unwrap(), "png", "jpg"]);
        }
    }
    let line = "render scene.ron -o a.jpg --palette never";
    run(&mut folder.strahl(line.split_whitespace())).quiet_success();
    for option in ["--compression=best", "--palette=always"] {
        run(&mut folder.strahl(["render", "scene.ron", option])).failure(2, &["possible values"]);
    }
}
