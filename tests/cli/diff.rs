//! `strahl diff` of two pictures.

use std::fs;

use image::{Rgb, RgbImage};
use serde_json::Value;

use crate::support::{Done, Folder, run};

/// `a.png`, `equal.png`, `near.png` with one pixel a step brighter, `far.png` with two inverted,
/// and `small.png`.
fn pictures() -> Folder {
    let folder = Folder::with_scenes();
    let colors = |x: u32, y: u32| Rgb([x * 9, y * 9, 77].map(|part| part as u8));
    let picture = RgbImage::from_fn(24, 20, colors);
    let save = |picture: &RgbImage, name: &str| picture.save(folder.path(name)).unwrap();
    save(&picture, "a.png");
    save(&picture, "equal.png");
    save(&picture, "equal.bmp");
    let mut near = picture.clone();
    near.get_pixel_mut(7, 4).0[2] += 1;
    save(&near, "near.png");
    let mut far = picture.clone();
    for (x, y) in [(20, 3), (5, 16)] {
        let pixel = far.get_pixel_mut(x, y);
        pixel.0 = pixel.0.map(|part| 255 - part);
    }
    save(&far, "far.png");
    save(&RgbImage::new(24, 19), "small.png");
    folder
}

fn diff(folder: &Folder, args: &[&str]) -> Done {
    run(folder.strahl(["diff"]).args(args))
}

/// Returns the standard output of a run, which must have this status and an empty standard error.
#[track_caller]
fn text(done: Done, status: i32) -> String {
    assert_eq!((done.status, &*done.stderr), (Some(status), ""));
    String::from_utf8(done.stdout).unwrap()
}

#[track_caller]
fn json(folder: &Folder, args: &[&str], status: i32) -> Value {
    let args = [args, &["--output-format", "json"]].concat();
    serde_json::from_str(&text(diff(folder, &args), status)).unwrap()
}

#[test]
fn equal_pictures_succeed_and_others_fail() {
    let folder = pictures();
    for other in ["a.png", "equal.png", "equal.bmp"] {
        let text = text(diff(&folder, &["a.png", other]), 0);
        assert!(text.ends_with("\nequal\n"), "{text}");
        assert!(text.contains("PSNR        infinite"), "{text}");
    }
    let near = text(diff(&folder, &["a.png", "near.png"]), 1);
    for line in [
        "size        24x20\n",
        "different   1 of 480 pixels, 0.21 %\n",
        "first       7,4 ",
        "within      7,4,1,1 ",
        "largest     1\n",
        "\n\ndifferent\n",
    ] {
        assert!(near.contains(line), "no {line:?} in {near}");
    }
}

#[test]
fn json_holds_every_number() {
    let folder = pictures();
    let far = json(&folder, &["a.png", "far.png"], 1);
    assert_eq!(far["format"], 1);
    assert_eq!(far["a"]["file"], "a.png");
    assert_eq!(
        (&far["b"]["width"], &far["b"]["height"]),
        (&24.into(), &20.into())
    );
    assert_eq!(far["failed"], serde_json::json!(["equal"]));
    let found = &far["found"];
    assert_eq!(found["equal"], false);
    assert_eq!(found["values"], "display");
    assert_eq!(found["pixels"], 480);
    assert_eq!(found["different"], 2);
    assert_eq!(found["first"], serde_json::json!([20, 3]));
    assert_eq!(found["bounds"], serde_json::json!([5, 3, 16, 14]));
    // 255 - 2 * 27 in the green channel of the first picture.
    assert_eq!(found["max_delta"], 201.0);
    let sum = (105 + 201 + 101 + 165 + 33 + 101) as f64;
    assert_eq!(found["mean_delta"], sum / (3.0 * 480.0));
    let psnr = found["psnr"].as_f64().unwrap();
    assert!((20.0..40.0).contains(&psnr), "{psnr}");
    assert!(found["ssim"].as_f64().unwrap() < 1.0);
    assert!(found["flip"].as_f64().unwrap() > 0.0);

    let equal = json(&folder, &["a.png", "equal.png"], 0);
    assert_eq!(equal["failed"], serde_json::json!([]));
    assert_eq!(equal["found"]["equal"], true);
    assert_eq!(
        (&equal["found"]["psnr"], &equal["found"]["first"]),
        (&Value::Null, &Value::Null)
    );
}

#[test]
fn limits_decide_if_given() {
    let folder = pictures();
    for (other, limits, broken) in [
        ("near.png", &["--max-different", "1"][..], &[][..]),
        ("near.png", &["--max-different", "0"], &["max_different"]),
        ("near.png", &["--max-delta", "1"], &[]),
        ("near.png", &["--max-delta", "0.5"], &["max_delta"]),
        (
            "near.png",
            &[
                "--min-ssim",
                "0.999",
                "--max-flip",
                "0.01",
                "--min-psnr",
                "60",
            ],
            &[],
        ),
        ("near.png", &["--min-ssim", "1"], &["min_ssim"]),
        ("far.png", &["--max-flip", "0.0001"], &["max_flip"]),
        ("far.png", &["--min-psnr", "60"], &["min_psnr"]),
        (
            "far.png",
            &["--max-different", "2", "--max-delta", "200"],
            &["max_delta"],
        ),
        (
            "far.png",
            &["--max-different", "1", "--max-delta", "9"],
            &["max_different", "max_delta"],
        ),
        (
            "equal.png",
            &["--min-ssim", "1", "--max-flip", "0", "--min-psnr", "999"],
            &[],
        ),
    ] {
        let args = [&["a.png", other], limits].concat();
        let status = i32::from(!broken.is_empty());
        let report = json(&folder, &args, status);
        assert_eq!(report["failed"], serde_json::json!(broken), "{args:?}");
        let text = text(diff(&folder, &args), status);
        let names = broken
            .iter()
            .map(|name| format!("--{}", name.replace('_', "-")));
        for name in names {
            assert!(text.contains(&name), "no {name} in {text}");
        }
    }
}

#[test]
fn different_sizes_fail_whatever_the_limits() {
    let folder = pictures();
    let args = [
        "a.png",
        "small.png",
        "--max-different",
        "9999",
        "-o",
        "heat.png",
    ];
    let text = text(diff(&folder, &args), 1);
    assert!(text.contains("24x20 and 24x19"), "{text}");
    let report = json(&folder, &["a.png", "small.png"], 1);
    assert_eq!(report["failed"], serde_json::json!(["size"]));
    assert_eq!(report["found"], Value::Null);
    assert_eq!(report["b"]["height"], 19);
    assert!(!folder.path("heat.png").exists());
}

#[test]
fn a_heat_picture_is_written_in_any_format() {
    let folder = pictures();
    for name in ["heat.png", "heat.WEBP", "heat.ppm"] {
        text(diff(&folder, &["a.png", "far.png", "-o", name]), 1);
        let heat = image::open(folder.path(name)).unwrap().to_rgb8();
        assert_eq!(heat.dimensions(), (24, 20));
        assert!(heat.get_pixel(20, 3).0[0] > 100 && heat.get_pixel(23, 19).0[0] < 20);
    }
    // The same bytes for any number of threads.
    for threads in ["1", "3"] {
        let args = ["a.png", "far.png", "-o", "again.png", "--threads", threads];
        text(diff(&folder, &args), 1);
        let [one, other] = ["heat.png", "again.png"].map(|name| fs::read(folder.path(name)));
        assert!(one.unwrap() == other.unwrap());
    }
}

#[test]
fn unreadable_and_unwritable_files_are_reported() {
    let folder = pictures();
    folder.write("text.png", "no picture");
    let whole = fs::read(folder.path("far.png")).unwrap();
    fs::write(folder.path("half.png"), &whole[..whole.len() / 2]).unwrap();
    for (args, words) in [
        (
            &["a.png", "missing.png"][..],
            &["missing.png", "no such file"][..],
        ),
        (&["missing.png", "a.png"], &["missing.png"]),
        (&["a.png", "."], &["folder"]),
        (&["a.png", "text.png"], &["text.png", "not a picture"]),
        (&["a.png", "half.png"], &["half.png", "png"]),
        (
            &["a.png", "far.png", "-o", "far.png"],
            &["far.png", "overwrite"],
        ),
        (
            &["a.png", "far.png", "-o", "./a.png"],
            &["a.png", "overwrite"],
        ),
        (
            &["a.png", "far.png", "-o", "heat.gif"],
            &["heat.gif", ".png"],
        ),
        (&["a.png", "far.png", "-o", "."], &["folder"]),
        (&["a.png", "far.png", "-o", "no/heat.png"], &["no/heat.png"]),
    ] {
        diff(&folder, args).one_line(2, words);
    }
    assert!(fs::read(folder.path("far.png")).unwrap() == whole);
    for limit in [
        &["--max-delta", "nan"][..],
        &["--max-delta", "inf"],
        &["--max-delta=-1"],
        &["--min-ssim", "1.5"],
        &["--max-flip", "nan"],
        &["--max-different", "0.5"],
    ] {
        let args = [&["a.png", "far.png"], limit].concat();
        diff(&folder, &args).failure(2, &[limit[0].split('=').next().unwrap()]);
    }
}

#[test]
fn a_rendered_picture_equals_itself_in_another_format() {
    let folder = pictures();
    for name in ["scene.png", "scene.qoi", "scene.tiff"] {
        run(&mut folder.strahl(["render", "scene.ron", "-o", name])).quiet_success();
        text(diff(&folder, &["scene.png", name]), 0);
    }
    run(&mut folder.strahl(["render", "scene.ron", "-o", "scene.jpg"])).quiet_success();
    text(diff(&folder, &["scene.png", "scene.jpg"]), 1);
    text(
        diff(&folder, &["scene.png", "scene.jpg", "--min-psnr", "20"]),
        0,
    );
}

#[cfg(unix)]
#[test]
fn a_closed_pipe_does_not_make_pictures_equal() {
    let folder = pictures();
    for (other, status) in [("far.png", 1), ("equal.png", 0)] {
        let script = format!("{{ \"$STRAHL\" diff a.png {other}; echo $? >&2; }} | true");
        let done = run(&mut folder.shell(&script));
        assert_eq!(done.stderr, format!("{status}\n"));
    }
}
