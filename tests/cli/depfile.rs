//! `--depfile`: rules for make, read by make itself.

use std::{
    ffi::OsStr,
    fs::{self, File},
    os::unix::ffi::OsStrExt,
    path::Path,
    process::Command,
    time::{Duration, SystemTime},
};

use crate::support::{Folder, RON, has, run, skip};

/// A scene with a table.
fn scene(table: &str) -> String {
    format!(
        "(image: (width: 8, height: 6), camera: Perspective(eye: (0, 0, 0), gaze: (0, 0, -1), fov: \
         90), geometries: [Spheres(file: r##\"{table}\"##, radius: 1, color: \"#f00\")])"
    )
}

/// Makes a file older or newer than all others.
fn date(path: impl AsRef<Path>, seconds: u64) {
    let time = SystemTime::UNIX_EPOCH + Duration::from_secs(seconds);
    let file = File::options().append(true).open(path).unwrap();
    file.set_modified(time).unwrap();
}

/// Returns true if make would draw a picture again, the target of a depfile.
#[track_caller]
fn draws(folder: &Folder, picture: &str) -> bool {
    let rule = String::from_utf8_lossy(&fs::read(folder.path("o.d")).unwrap()).into_owned();
    folder.write("Makefile", "include o.d\n%.png: ; @echo draw\n");
    let mut make = Command::new("make");
    make.args(["-rR", "--no-print-directory"])
        .current_dir(folder.path(""));
    // An argument with `=` sets a variable. The first target is the default one, unless it has `%`.
    if !picture.contains('=') {
        make.args(["--", picture]);
    }
    let done = run(&mut make);
    assert_eq!((done.status, &*done.stderr), (Some(0), ""), "{rule}");
    let said = String::from_utf8_lossy(&done.stdout).into_owned();
    assert!(said == "draw\n" || said.contains("up to date"), "{said}");
    said == "draw\n"
}

#[test]
fn make_reads_the_names() {
    if !has("make") {
        return skip("make is not installed");
    }
    for name in [
        "a b", " a", "a#b", "a$b", "a$(b)", "a:b", "a:=b", "a=b", "=", "a;b", "a|b", "a%b", "%",
        "a*b", "a?b", "a[1]", "a]b", "(a)", "a~", "~a~", "a&", "a\\b", "a\\ b", "a\\#b", "a\\$b",
        "a\\:b", "a\\;b", "a\\|b", "a\\%b", "a\\*b", "a\\=b", "a\\\\ b", "a'b\"", "é",
    ] {
        let folder = Folder::new();
        let name = format!("./+{name}");
        let [source, table, picture] = ["ron", "csv", "png"].map(|end| format!("{name}.{end}"));
        folder.write(&source, scene(table.trim_start_matches("./")));
        folder.write(&table, "x,y,z\n0,0,-5\n");
        let args = ["render", &source, "-o", &picture, "-q", "--depfile", "o.d"];
        run(&mut folder.strahl(args)).quiet_success();
        // Patterns match these.
        let others = ["+a1.ron", "+a1.csv", "+aXb.ron", "+aXb.csv"];
        for (file, seconds) in [(&picture, 2000), (&source, 1000), (&table, 1000)] {
            date(folder.path(file), seconds);
        }
        others
            .iter()
            .for_each(|other| drop(folder.write(other, "")));
        assert!(!draws(&folder, &picture), "{name}: up to date");
        for source in [&source, &table] {
            date(folder.path(source), 3000);
            assert!(draws(&folder, &picture), "{name}: {source} is newer");
            date(folder.path(source), 1000);
            fs::rename(folder.path(source), folder.path("away")).unwrap();
            assert!(draws(&folder, &picture), "{name}: {source} is gone");
            fs::rename(folder.path("away"), folder.path(source)).unwrap();
        }
        fs::remove_file(folder.path(&picture)).unwrap();
        assert!(draws(&folder, &picture), "{name}: there is no picture");
    }
}

#[test]
fn names_need_not_be_text() {
    let folder = Folder::new();
    let name = |end: &str| [b"\xff.", end.as_bytes()].concat();
    let (source, picture) = (name("ron"), name("png"));
    if fs::write(folder.path(OsStr::from_bytes(&source)), RON).is_err() {
        return skip("the disk has only names of text");
    }
    let args = [
        b"render",
        &*source,
        b"-o",
        &picture,
        b"-q",
        b"--depfile",
        b"o.d",
    ];
    run(&mut folder.strahl(args.map(OsStr::from_bytes))).quiet_success();
    let rule = fs::read(folder.path("o.d")).unwrap();
    let expected = [&*picture, b": \\\n  ", &source, b"\n\n", &source, b":\n"];
    assert_eq!(rule, expected.concat());
}

#[test]
fn names_that_make_cannot_read_are_refused_before_drawing() {
    for (source, picture, word) in [
        ("a.ron", "a\nb.png", "'\\n'"),
        ("a.ron", "a\tb.png", "'\\t'"),
        ("a\rb.ron", "a.png", "'\\r'"),
        ("a.ron", "~a.png", "`~`"),
    ] {
        let folder = Folder::new();
        folder.write(source, RON);
        let args = ["render", source, "-o", picture, "--depfile", "o.d"];
        run(&mut folder.strahl(args)).one_line(2, &["make cannot read the name", word]);
        assert_eq!(folder.names(), [source]);
    }
    let folder = Folder::new();
    folder.write("a\tb.ron", RON);
    let args = ["info", "a\tb.ron", "--depfile", "-"];
    run(&mut folder.strahl(args)).one_line(2, &["make cannot read the name", "'\\t'"]);
}

#[test]
fn the_targets_are_the_files_that_are_written() {
    let folder = Folder::with_scenes();
    let rule = |args: &str| {
        let args = format!("render scene.ron -q --depfile o.d {args}");
        run(&mut folder.strahl(args.split(' '))).quiet_success();
        let rule = fs::read_to_string(folder.path("o.d")).unwrap();
        let (targets, _) = rule.split_once(": \\\n  scene.ron\n").unwrap();
        let targets = targets.split(" \\\n").map(str::to_owned);
        let targets: Vec<_> = targets.collect();
        for target in &targets {
            assert!(folder.path(target).exists(), "{args}: {target}");
        }
        targets.join(" ")
    };
    assert_eq!(rule("-o o.png"), "o.png");
    assert_eq!(rule("-o o.png --layers color,id"), "o.color.png o.id.png");
    assert_eq!(rule("-o o.npz --layers color,id"), "o.npz");
    assert_eq!(rule("-o p.png --shard 1/3"), "p.png.1-of-3.part");
    assert_eq!(
        rule("-o p.png --shard 0/2 --layers depth,id --depth-range 0,9"),
        "p.depth.png.0-of-2.part p.id.png.0-of-2.part"
    );
    let args = [
        "render",
        "scene.ron",
        "-o",
        "o.png",
        "--layers",
        "id",
        "--depfile",
        "o.id.png",
    ];
    run(&mut folder.strahl(args)).failure(2, &["o.id.png"]);
}
