//! Options that contradict each other, have no effect, or report progress.

use std::fs;

use crate::support::{Folder, RON, run};

fn refused(folder: &Folder, args: &str, words: &[&str]) {
    let done = run(&mut folder.strahl(args.split_whitespace()));
    done.one_line(2, words);
}

#[test]
fn a_format_that_contradicts_the_extension_is_rejected() {
    let folder = Folder::with_scenes();
    let words = ["y.png", "--image-format jpg"];
    refused(
        &folder,
        "render scene.ron -o y.png --image-format jpg",
        &words,
    );
    assert!(!folder.path("y.png").exists());
    let equal = "render scene.ron -o y.JPG --image-format jpeg";
    run(&mut folder.strahl(equal.split(' '))).quiet_success();
}

#[test]
fn options_without_effect_are_rejected() {
    let folder = Folder::with_scenes();
    for (args, words) in [
        ("--transparent -o a.jpg", ["jpg", "RGBA"]),
        (
            "--transparent --layers depth -o a.exr",
            ["--transparent has no effect", "depth"],
        ),
        ("--bits 16 -o a.jpg", ["jpg", "16-bit"]),
        (
            "--bits 16 --layers depth -o a.npy",
            ["--bits has no effect", "depth"],
        ),
        (
            "--bits 16 --layers id,normal -o a.exr",
            ["--bits has no effect", "exr"],
        ),
        (
            "--depth-range 1,9 --layers depth -o a.exr",
            ["--depth-range has no effect", "exr"],
        ),
        ("--palette auto -o a.jpg", ["--palette auto", "png"]),
        ("--quality 5 -o a.png", ["--quality", "jpg"]),
        ("--compression small -o a.jpg", ["--compression", "jpg"]),
        ("--metadata -o a.ppm", ["ppm", "metadata"]),
    ] {
        refused(&folder, &format!("render scene.ron {args}"), &words);
    }
    // One of several files is enough.
    for args in [
        "--transparent --layers color,depth --depth-range 1,9 -o a.png",
        "--bits 16 --layers color,id -o a.png",
        "--bits 8 -o a.jpg",
    ] {
        let args = format!("render scene.ron {args}");
        run(&mut folder.strahl(args.split(' '))).quiet_success();
    }
}

#[test]
fn a_picture_without_a_palette_says_why() {
    let folder = Folder::with_scenes();
    let warned = |args: &str, why: &str| {
        let args = format!("render scene.ron --palette auto -o a.png {args}");
        let done = run(&mut folder.strahl(args.split_whitespace()));
        assert_eq!(done.status, Some(0));
        if why.is_empty() {
            assert_eq!(done.stderr, "");
        } else {
            assert!(
                done.stderr
                    .starts_with("warning: the picture is not indexed: ")
            );
            assert!(done.stderr.contains(why), "{}", done.stderr);
        }
    };
    warned("", "");
    warned("--samples 4", "samples");
    warned("--transparent", "alpha");
    warned("--samples 4 -q", "");
}

#[test]
fn lit_pictures_have_no_palette() {
    let folder = Folder::with_scenes();
    for option in ["--lights=headlight", "--outlines"] {
        let args = [
            "render",
            "scene.ron",
            "--palette=auto",
            "-o",
            "a.png",
            option,
        ];
        let done = run(&mut folder.strahl(args));
        assert_eq!(done.status, Some(2));
        assert!(
            done.stderr.contains("--palette auto is for flat pictures"),
            "{}",
            done.stderr
        );
        assert!(!folder.path("a.png").exists());
    }
}

#[test]
fn formats_named_for_layers_support_them() {
    let folder = Folder::with_scenes();
    let formats = "png jpg bmp tiff ppm pfm qoi webp hdr exr npy npz";
    let mut named = 0;
    for layer in [
        "color", "depth", "z", "position", "normal", "id", "coverage",
    ] {
        for options in ["", "--transparent", "--bits 16", "--bits 32"] {
            if layer != "color" && !options.is_empty() {
                continue;
            }
            for format in formats.split(' ') {
                let draw = |format: &str| {
                    let args = format!("render scene.ron --layers {layer} {options} -o a.{format}");
                    run(&mut folder.strahl(args.split_whitespace()))
                };
                let done = draw(format);
                let Some((_, known)) = done.stderr.split_once("supported by ") else {
                    continue;
                };
                for known in known.trim_end().split(", ") {
                    named += 1;
                    let again = draw(known);
                    assert_eq!(again.status, Some(0), "{}{}", done.stderr, again.stderr);
                }
            }
        }
    }
    assert!(named > 30, "{named}");
}

#[test]
fn pixels_can_be_counted_from_the_top() {
    let folder = Folder::with_scenes();
    let pixel = |args: &[&str]| {
        let done = run(&mut folder.strahl([&["pixel", "scene.ron"], args].concat()));
        String::from_utf8(done.quiet_success()).unwrap()
    };
    assert_eq!(pixel(&["3,23", "--from-top"]), pixel(&["3,0"]));
    assert_ne!(pixel(&["3,23"]), pixel(&["3,0"]));
}

#[test]
fn a_diff_shows_what_fmt_would_change() {
    let folder = Folder::new();
    folder.write("tidy.ron", RON);
    run(&mut folder.strahl(["fmt", "tidy.ron"])).quiet_success();
    assert!(
        run(&mut folder.strahl(["fmt", "--diff", "tidy.ron"]))
            .quiet_success()
            .is_empty()
    );
    let tidy = fs::read_to_string(folder.path("tidy.ron")).unwrap();
    let wide = tidy.replace("fov: 90", "fov:    90");
    folder.write("wide.ron", &wide);
    let done = run(&mut folder.strahl(["fmt", "--diff", "wide.ron"]));
    assert_eq!(done.status, Some(1));
    let diff = String::from_utf8(done.stdout).unwrap();
    assert!(
        diff.starts_with("--- wide.ron\n+++ wide.ron\n@@ "),
        "{diff}"
    );
    let changed = |mark: char| diff.lines().filter(|line| line.starts_with(mark)).count();
    assert_eq!((changed('-'), changed('+')), (2, 2), "{diff}");
    assert_eq!(fs::read_to_string(folder.path("wide.ron")).unwrap(), wide);
}

#[test]
fn shells_complete_names() {
    let folder = Folder::new();
    for shell in ["bash", "zsh", "fish"] {
        let script = run(&mut folder.strahl(["completions", shell])).quiet_success();
        let script = String::from_utf8(script).unwrap();
        for name in ["never-visible", "position", "webp", "y4m"] {
            assert!(script.contains(name), "{shell}: {name}");
        }
    }
}

#[test]
fn the_help_of_render_has_sections_and_examples() {
    let folder = Folder::new();
    let help = run(&mut folder.strahl(["render", "--help"])).quiet_success();
    let help = String::from_utf8(help).unwrap();
    for heading in ["Scene:", "Output:", "Picture:", "Run:", "Examples:"] {
        assert!(
            help.lines().any(|line| line == heading),
            "{heading} in {help}"
        );
    }
}

#[test]
fn shards_split_the_pictures_of_all_cameras() {
    let folder = Folder::new();
    let cameras = ["a", "b", "c"]
        .map(|name| format!("\"{name}\": Perspective(eye: (0, 0, 0), gaze: (0, 0, -1), fov: 90)"));
    let scene = format!(
        "(image: (width: 8, height: 8), cameras: {{{}}}, geometries: [Sphere(center: (0, 0, -3), \
         radius: 0.5, color: \"#ff0000\")])",
        cameras.join(", ")
    );
    folder.write("scene.ron", scene);
    let draw = |part: &str| {
        let args = format!("render scene.ron --all-cameras -o out/ --shard {part} --resume");
        let done = run(&mut folder.strahl(args.split(' ')));
        assert_eq!(done.status, Some(0), "{}", done.stderr);
        done.stderr
    };
    let drawn = |name: &str| folder.path(format!("out/scene_{name}.png")).exists();
    assert!(draw("0/2").contains("2 drawn"));
    assert_eq!([drawn("a"), drawn("b"), drawn("c")], [true, false, true]);
    assert_eq!(run(&mut folder.strahl(["status", "out"])).status, Some(1));
    assert!(draw("1/2").contains("1 drawn"));
    assert!(drawn("b"));
    let done = run(&mut folder.strahl(["status", "out"]));
    assert_eq!(done.quiet_success(), b"3 of 3 pictures are done\n");
    assert!(draw("0/2").contains("2 kept"));
}
