//! Every image format.

use std::{fs, time::Duration, time::Instant};

use image::ImageFormat;

use crate::support::{Folder, run};

const FORMATS: [(&str, ImageFormat); 9] = [
    ("png", ImageFormat::Png),
    ("jpg", ImageFormat::Jpeg),
    ("jpeg", ImageFormat::Jpeg),
    ("bmp", ImageFormat::Bmp),
    ("tiff", ImageFormat::Tiff),
    ("tif", ImageFormat::Tiff),
    ("ppm", ImageFormat::Pnm),
    ("qoi", ImageFormat::Qoi),
    ("webp", ImageFormat::WebP),
];

#[test]
fn every_format_is_written_and_holds_the_same_pixels() {
    let folder = Folder::with_scenes();
    // Odd, so that rows need padding in formats that pad them.
    for size in ["101x67", "1x1", "1x9", "9x1"] {
        let render = |output: &str| {
            let args = ["render", "scene.ron", "--size", size, "-o", output];
            let stdout = run(&mut folder.strahl(args)).quiet_success();
            assert!(stdout.is_empty());
            fs::read(folder.path(output)).unwrap()
        };
        let png = image::load_from_memory(&render("reference.png"))
            .unwrap()
            .to_rgb8();
        for (ending, format) in FORMATS {
            let bytes = render(&format!("picture.{ending}"));
            assert_eq!(image::guess_format(&bytes).unwrap(), format, "{ending}");
            let image = image::load_from_memory_with_format(&bytes, format).unwrap();
            let image = image.to_rgb8();
            assert_eq!(image.dimensions(), png.dimensions(), "{ending}");
            if format != ImageFormat::Jpeg {
                assert!(image == png, "{ending} {size}");
            }
        }
    }
}

#[test]
fn the_extension_may_be_in_upper_case() {
    let folder = Folder::with_scenes();
    for (name, format) in [("A.PNG", ImageFormat::Png), ("b.b.Jpeg", ImageFormat::Jpeg)] {
        run(&mut folder.strahl(["render", "scene.ron", "-o", name])).quiet_success();
        let bytes = fs::read(folder.path(name)).unwrap();
        assert_eq!(image::guess_format(&bytes).unwrap(), format);
    }
}

#[test]
fn standard_output_takes_every_format() {
    let folder = Folder::with_scenes();
    for (name, format) in FORMATS {
        let file = format!("picture.{name}");
        run(&mut folder.strahl(["render", "scene.ron", "-o", &file])).quiet_success();
        let args = ["render", "scene.ron", "-o", "-", "--image-format", name];
        let stdout = run(&mut folder.strahl(args)).quiet_success();
        assert_eq!(image::guess_format(&stdout).unwrap(), format, "{name}");
        assert!(stdout == fs::read(folder.path(&file)).unwrap(), "{name}");
    }
    let args = ["render", "scene.ron", "-o", "-"];
    let stdout = run(&mut folder.strahl(args)).quiet_success();
    assert_eq!(image::guess_format(&stdout).unwrap(), ImageFormat::Png);
    assert!(!folder.names().contains(&"-".to_owned()));
}

#[test]
fn jpeg_is_close_to_the_original() {
    let folder = Folder::with_scenes();
    for name in ["a.png", "a.jpg"] {
        let args = ["render", "scene.ron", "--size", "320x240", "-o", name];
        run(&mut folder.strahl(args)).quiet_success();
    }
    let open = |name: &str| image::open(folder.path(name)).unwrap().to_rgb8();
    let (png, jpg) = (open("a.png"), open("a.jpg"));
    let both = png.iter().zip(jpg.iter());
    let far: u64 = both.map(|(a, b)| u64::from(a.abs_diff(*b))).sum();
    assert!(far < 4 * 320 * 240 * 3, "{far}");
}

#[test]
fn unsupported_pictures_are_rejected_before_rendering() {
    let folder = Folder::with_scenes();
    let start = Instant::now();
    // Each of these would take minutes to render.
    let too_large = [
        ("jpg", "65536x60000", "65535"),
        ("jpeg", "60000x65536", "65535"),
        ("webp", "16384x1000000", "16383"),
        ("webp", "1000000x16384", "16383"),
        ("bmp", "100000x100000", "4 GiB"),
        ("qoi", "100000x100000", "400000000"),
    ];
    for (ending, size, limit) in too_large {
        let file = format!("picture.{ending}");
        folder.write(&file, "old");
        let args = ["render", "scene.ron", "--size", size, "-o", &file];
        run(&mut folder.strahl(args)).one_line(2, &[&file, size, limit]);
        assert_eq!(fs::read(folder.path(&file)).unwrap(), b"old");
        let format = ["--image-format", ending];
        let args = ["render", "scene.ron", "--size", size, "-o", "-"];
        let done = run(folder.strahl(args).args(format));
        done.one_line(2, &["<stdout>", size, limit]);
    }
    assert!(start.elapsed() < Duration::from_secs(60));
}

#[test]
fn the_largest_sides_of_a_format_are_written() {
    let folder = Folder::with_scenes();
    let largest = [
        ("jpg", (65_535, 1)),
        ("webp", (16_383, 1)),
        ("webp", (1, 16_383)),
        ("png", (1_000_000, 1)),
        ("png", (1, 1_000_000)),
    ];
    for (ending, (width, height)) in largest {
        let (file, size) = (format!("picture.{ending}"), format!("{width}x{height}"));
        let args = ["render", "scene.ron", "--size", &size, "-o", &file];
        run(&mut folder.strahl(args)).quiet_success();
        let image = image::open(folder.path(&file)).unwrap();
        assert_eq!((image.width(), image.height()), (width, height));
    }
    for (ending, size) in [("jpg", "65536x1"), ("webp", "16384x1"), ("webp", "1x16384")] {
        let file = format!("too-large.{ending}");
        let args = ["render", "scene.ron", "--size", size, "-o", &file];
        run(&mut folder.strahl(args)).one_line(2, &[&file, size]);
        assert!(!folder.path(&file).exists());
    }
}

#[cfg(target_os = "linux")]
#[test]
fn out_of_memory_is_a_temporary_error() {
    let folder = Folder::with_scenes();
    let script =
        "ulimit -v 2000000 && exec \"$STRAHL\" render scene.ron --size 60000x60000 -o a.jpg";
    let done = run(&mut folder.shell(script));
    done.one_line(75, &["a.jpg", "60000x60000", "memory"]);
    assert_eq!(folder.names(), ["scene.json", "scene.ron"]);
}
