//! `strahl diff` of two folders: pairs, the HTML page, updates and reports.

use std::fs;

use image::{Rgb, RgbImage};
use serde_json::{Value, json};

use crate::support::{Done, Folder, run};

fn picture(changed: u32) -> RgbImage {
    let mut picture =
        RgbImage::from_fn(
            24,
            20,
            |x, y| Rgb([x * 9, y * 9, 77].map(|part| part as u8)),
        );
    for x in 0..changed {
        picture.get_pixel_mut(x, 3).0[2] += 100;
    }
    picture
}

/// `golden/` and `new/` with pairs of every status.
fn folders() -> Folder {
    let folder = Folder::new();
    for side in ["golden/sub/.hidden", "new/sub/.hidden"] {
        fs::create_dir_all(folder.path(side)).unwrap();
    }
    let save = |changed: u32, name: &str| picture(changed).save(folder.path(name)).unwrap();
    save(0, "golden/same.png");
    save(0, "new/same.png");
    save(0, "golden/sub/far.png");
    save(9, "new/sub/far.png");
    save(0, "golden/near.png");
    save(1, "new/near.png");
    save(0, "golden/gone.png");
    save(0, "new/<script>&amp.png");
    save(0, "golden/sub/.hidden/a.png");
    RgbImage::new(3, 3)
        .save(folder.path("golden/size.png"))
        .unwrap();
    RgbImage::new(3, 4)
        .save(folder.path("new/size.png"))
        .unwrap();
    folder.write("golden/notes.txt", "a");
    folder.write("new/report.json", "{}");
    folder
}

fn diff(folder: &Folder, args: &[&str]) -> Done {
    run(folder.strahl(["diff", "golden", "new/"]).args(args))
}

#[track_caller]
fn text(done: Done, status: i32) -> String {
    let text = String::from_utf8(done.stdout).unwrap();
    assert_eq!((done.status, &*done.stderr), (Some(status), ""), "{text}");
    text
}

#[test]
fn pictures_are_paired_by_their_relative_paths() {
    let folder = folders();
    let text = text(diff(&folder, &["--max-different", "1"]), 1);
    let lines: Vec<_> = text.lines().collect();
    assert_eq!(
        lines,
        [
            "extra       <script>&amp.png: no golden picture",
            "missing     gone.png: no new picture",
            "within      near.png: 1 of 480 pixels, largest 100, mean 0.069, SSIM 0.9999, FLIP 0.0067, within the limits",
            "different   size.png: the sizes differ: 3x3 and 3x4",
            "different   sub/far.png: 9 of 480 pixels, largest 100, mean 0.625, SSIM 0.9667, FLIP 0.0327, beyond --max-different",
            "",
            "1 equal, 1 within the limits, 2 different, 1 missing, 1 extra (2 files are not pictures)",
        ]
    );
}

#[test]
fn unreadable_pictures_are_reported_and_the_others_compared() {
    let folder = folders();
    folder.write("new/near.png", "no picture");
    let done = diff(&folder, &[]);
    let text = String::from_utf8(done.stdout).unwrap();
    assert_eq!(done.status, Some(2), "{text}");
    assert!(
        text.contains("unreadable  new/near.png: is not a picture"),
        "{text}"
    );
    assert!(text.contains("different   sub/far.png"), "{text}");
    // Equal bytes are equal, whatever they mean.
    folder.write("golden/near.png", "no picture");
    assert_eq!(diff(&folder, &[]).status, Some(1));
}

#[test]
fn failing_pairs_have_heat_pictures() {
    let folder = folders();
    text(diff(&folder, &["-o", "heat/", "--max-different", "1"]), 1);
    let heat = image::open(folder.path("heat/sub/far.png")).unwrap();
    assert_eq!((heat.width(), heat.height()), (24, 20));
    assert_eq!(fs::read_dir(folder.path("heat")).unwrap().count(), 1);
    for inside in ["golden/heat", "new", "new/sub/heat/a"] {
        let done = diff(&folder, &["-o", inside]);
        assert_eq!(done.status, Some(2), "{inside}");
        assert!(
            done.stderr.contains("among the compared"),
            "{}",
            done.stderr
        );
    }
}

#[test]
fn the_page_is_self_contained() {
    let folder = folders();
    let names = ["a.exr", "b.pfm"];
    for (name, side, light) in [
        (0, "golden", 0.5),
        (0, "new", 9.0),
        (1, "golden", 0.5),
        (1, "new", f32::NAN),
    ] {
        let path = folder.path(side).join(names[name]);
        if name == 0 {
            image::Rgb32FImage::from_pixel(4, 4, Rgb([light; 3]))
                .save(path)
                .unwrap();
        } else {
            fs::write(
                path,
                [b"PF\n1 1\n-1\n", &[light.to_le_bytes(); 3].concat()[..]].concat(),
            )
            .unwrap();
        }
    }
    folder.write("new/sub/far.png", "\u{7f}");
    text(
        run(&mut folder.strahl([
            "diff",
            "golden/gone.png",
            "new/same.png",
            "--html",
            "one.html",
        ])),
        0,
    );
    let done = diff(&folder, &["--html", "report.html"]);
    assert_eq!(done.status, Some(2), "{}", done.stderr);
    let page = fs::read_to_string(folder.path("report.html")).unwrap();
    // `near`, `a.exr` and `b.pfm` have three pictures each, `size` has no heat picture.
    assert_eq!(
        page.matches("src=\"data:image/png;base64,iVBORw0KGgo")
            .count(),
        11
    );
    assert!(!page.contains("<script"), "{page}");
    for part in [
        "<li>&lt;script&gt;&amp;amp.png</li>",
        "<li>gone.png</li>",
        "<li>sub/far.png: new/sub/far.png: is not a picture",
        "<h2>near.png</h2>\n<p>1 of 480 pixels, largest 100",
        "the sizes differ: 3x3 and 3x4",
        "<img alt=\"heat of near.png\" src=",
        "color-scheme: light dark",
    ] {
        assert!(page.contains(part), "no {part:?} in {page}");
    }
    assert!(!page.contains("same.png"), "{page}");
    for url in ["http:", "https:", "href", "<link", "url("] {
        assert!(!page.contains(url), "{url}");
    }
    let done = diff(&folder, &["--html", "golden/same.png"]);
    assert_eq!(done.status, Some(2));
}

#[test]
fn update_copies_new_pictures() {
    let folder = folders();
    let messages = text(diff(&folder, &["--update", "--max-different", "1"]), 1);
    for line in [
        "added       <script>&amp.png: ",
        "missing     gone.png: ",
        "within      near.png: ",
        "updated     sub/far.png: ",
        " 1 missing, 1 extra; 3 updated (",
    ] {
        assert!(messages.contains(line), "no {line:?} in {messages}");
    }
    for (name, equal) in [
        ("sub/far.png", true),
        ("<script>&amp.png", true),
        ("near.png", false),
    ] {
        let [golden, new] =
            ["golden", "new"].map(|side| fs::read(folder.path(side).join(name)).unwrap());
        assert_eq!(golden == new, equal, "{name}");
    }
    // A picture without a counterpart is kept, and fails until it is removed by hand.
    fs::remove_file(folder.path("golden/gone.png")).unwrap();
    text(diff(&folder, &["--update"]), 0);
    assert!(text(diff(&folder, &[]), 0).starts_with("5 equal, 0 within the limits, 0 different,"));
    // The very first pictures.
    fs::rename(folder.path("golden"), folder.path("old")).unwrap();
    assert_eq!(diff(&folder, &[]).status, Some(2));
    text(diff(&folder, &["--update"]), 0);
    assert!(folder.path("golden/sub/far.png").is_file());
}

#[test]
fn update_copies_a_single_picture() {
    let folder = folders();
    let update = |a, b| run(&mut folder.strahl(["diff", a, b, "--update"]));
    let messages = text(update("golden/near.png", "new/near.png"), 0);
    assert!(
        messages.ends_with("\ngolden/near.png is now new/near.png\n"),
        "{messages}"
    );
    text(
        run(&mut folder.strahl(["diff", "golden/near.png", "new/near.png"])),
        0,
    );
    picture(5).save(folder.path("b.bmp")).unwrap();
    let done = update("golden/near.png", "b.bmp");
    assert_eq!(done.status, Some(2));
    assert!(done.stderr.contains("another format"), "{}", done.stderr);
}

#[test]
fn json_has_the_status_of_each_pair() {
    let folder = folders();
    let json: Value =
        serde_json::from_str(&text(diff(&folder, &["--output-format", "json"]), 1)).unwrap();
    assert_eq!(json["strahl"], "diff-folder/1");
    assert_eq!(
        json["summary"],
        json!({"equal": 1, "within_limits": 0, "different": 3, "missing": 1, "extra": 1, "unreadable": 0,
               "updated": 0, "skipped": 2})
    );
    let pictures = json["pictures"].as_array().unwrap();
    let far = pictures
        .iter()
        .find(|one| one["file"] == "sub/far.png")
        .unwrap();
    assert_eq!(far["result"], "different");
    assert_eq!(far["compared"]["failed"], json!(["equal"]));
    assert_eq!(far["compared"]["found"]["different"], 9);
}

#[test]
fn junit_has_a_test_for_each() {
    let folder = folders();
    for (args, tests, failures) in [
        (&["diff", "golden", "new"][..], 6, 5),
        (&["diff", "golden", "new", "--max-different", "1"], 6, 4),
        (&["diff", "golden/near.png", "new/near.png"], 1, 1),
    ] {
        let done = run(folder.strahl(args).args(["--output-format", "junit"]));
        let text = text(done, 1);
        assert_eq!(text.matches("<testcase ").count(), tests, "{text}");
        assert_eq!(text.matches("<failure ").count(), failures, "{text}");
        assert_eq!(text.matches(" time=\"0.").count(), 2 * tests, "{text}");
        assert!(!text.contains("<script"), "{text}");
    }
}

#[test]
fn contradictions_are_rejected() {
    let folder = folders();
    fs::create_dir(folder.path("empty")).unwrap();
    for (args, message) in [
        (&["golden/near.png", "new"][..], "is not a folder"),
        (&["golden", "new/near.png"], "is not a folder"),
        (&["empty", "empty"], "no pictures in empty or empty"),
        (&["golden", "new", "-o", "new/near.png"], "is a file"),
        (&["nothing", "new"], "`--update` creates it"),
    ] {
        let done = run(folder.strahl(["diff"]).args(args));
        assert_eq!(done.status, Some(2), "{args:?}: {}", done.stderr);
        assert!(done.stderr.contains(message), "{args:?}: {}", done.stderr);
    }
}
