//! Files with unusual names.

use std::fs;

use crate::support::{Folder, JSON, RON, run};

#[test]
fn unusual_names_work() {
    let folder = Folder::new();
    let stems = [
        " ",
        "a b",
        "  two  spaces ",
        "日本語 🙂",
        "e\u{301}",
        "$HOME",
        "*",
        "a'b\"c",
        "...",
    ];
    let stems = stems
        .into_iter()
        .filter(|stem| cfg!(unix) || !stem.contains(['*', '"', '.']));
    for stem in stems {
        let (scene, picture) = (format!("{stem}.ron"), format!("{stem}.png"));
        folder.write(&scene, RON);
        run(&mut folder.strahl(["render", &scene])).quiet_success();
        fs::remove_file(folder.path(&picture)).unwrap();
        run(&mut folder.strahl(["render", &scene, "-o", &picture])).quiet_success();
        assert!(folder.path(&picture).is_file(), "{stem:?}");
    }
}

#[test]
fn a_leading_dash_follows_two_dashes() {
    let folder = Folder::new();
    folder.write("-o.ron", RON);
    run(&mut folder.strahl(["render", "--", "-o.ron"])).quiet_success();
    assert_eq!(folder.names(), ["-o.png", "-o.ron"]);
    run(&mut folder.strahl(["render", "-o=-x.png", "--", "-o.ron"])).quiet_success();
    run(&mut folder.strahl(["render", "--output=--y.png", "./-o.ron"])).quiet_success();
    assert!(folder.path("-x.png").exists() && folder.path("--y.png").exists());
}

#[test]
fn scene_extensions_ignore_case() {
    let folder = Folder::new();
    for (name, text) in [("a.RON", RON), ("b.Json", JSON), ("c.JSON", JSON)] {
        folder.write(name, text);
        run(&mut folder.strahl(["render", name])).quiet_success();
    }
    let pictures = folder
        .names()
        .into_iter()
        .filter(|name| name.ends_with(".png"));
    assert_eq!(pictures.count(), 3);
}

#[test]
fn names_that_are_too_long_are_rejected() {
    let folder = Folder::with_scenes();
    for length in [300, 5000] {
        let name = "x".repeat(length);
        let (scene, picture) = (format!("{name}.ron"), format!("{name}.png"));
        run(&mut folder.strahl(["render", &scene])).one_line(2, &["xxx.ron"]);
        let done = run(&mut folder.strahl(["render", "scene.ron", "-o", &picture]));
        done.one_line(2, &["xxx.png"]);
    }
    assert_eq!(folder.names(), ["scene.json", "scene.ron"]);
}

#[cfg(unix)]
#[test]
fn the_longest_possible_file_name_works() {
    let folder = Folder::with_scenes();
    // 255 bytes; the temporary file next to it must not need more.
    let picture = format!("{}.png", "x".repeat(251));
    folder.write(&picture, "old");
    run(&mut folder.strahl(["render", "scene.ron", "-o", &picture])).quiet_success();
    assert_eq!(folder.names().len(), 3);
    assert!(fs::read(folder.path(&picture)).unwrap() != b"old");
}

#[cfg(target_os = "linux")]
#[test]
fn a_name_need_not_be_utf_8() {
    use std::{
        ffi::{OsStr, OsString},
        os::unix::ffi::OsStrExt,
    };

    let folder = Folder::new();
    let scene = OsStr::from_bytes(b"a\xff\xfeb.ron");
    folder.write(scene, RON);
    run(&mut folder.strahl([OsStr::new("render"), scene])).quiet_success();
    assert!(folder.path(OsStr::from_bytes(b"a\xff\xfeb.png")).is_file());

    let picture = OsString::from(OsStr::from_bytes(b"\xf0\x90.jpg"));
    let args = [OsStr::new("render"), scene, OsStr::new("-o"), &picture];
    run(&mut folder.strahl(args)).quiet_success();
    assert!(folder.path(&picture).is_file());

    let missing = OsStr::from_bytes(b"missing\xff.ron");
    run(&mut folder.strahl([OsStr::new("render"), missing])).one_line(2, &["missing"]);
    let ending = OsStr::from_bytes(b"a.p\xffng");
    let args = [OsStr::new("render"), scene, OsStr::new("-o"), ending];
    run(&mut folder.strahl(args)).one_line(2, &[".png"]);
    assert_eq!(folder.names().len(), 3);
}

/// An escape in a name could recolor the terminal, and a line feed could make it look like two
/// messages.
#[cfg(unix)]
#[test]
fn a_name_cannot_write_to_the_terminal() {
    let folder = Folder::with_scenes();
    for part in [
        "a\nerror: b",
        "\u{1b}[31mred",
        "\u{7}\r",
        "\u{9b}31m",
        "\u{202e}ver",
    ] {
        let scene = format!("{part}.ron");
        let missing = run(&mut folder.strahl(["render", &scene]));
        missing.one_line(2, &[".ron"]);
        harmless(&missing.stderr);

        let picture = format!("{part}/a.png");
        let no_folder = run(&mut folder.strahl(["render", "scene.ron", "-o", &picture]));
        no_folder.one_line(2, &["a.png"]);
        harmless(&no_folder.stderr);

        folder.write(&scene, RON.replace("0.5", "-0.5"));
        let faulty = run(&mut folder.strahl(["render", &scene]));
        faulty.bad_scene(".ron", &["radius"]);
        harmless(&faulty.stderr);
    }
}

#[test]
fn a_scene_cannot_write_to_the_terminal() {
    let folder = Folder::new();
    for part in ["\u{1b}[31m", "\u{7}", "\u{9b}", "\u{202e}"] {
        let scenes = [
            RON.replace("#ff0000", &format!("#ff{part}0000")),
            format!("(\"{part}\": 1)"),
            format!("(camera: {part})"),
            part.to_owned(),
        ];
        for text in scenes {
            folder.write("evil.ron", text);
            let done = run(&mut folder.strahl(["render", "evil.ron"]));
            done.bad_scene("evil.ron", &[]);
            harmless(&done.stderr);
        }
        let escaped = part
            .replace('\u{1b}', "\\u001b")
            .replace('\u{7}', "\\u0007");
        let scenes = [
            JSON.replace("#ff0000", &escaped),
            JSON.replace("\"radius\"", &format!("\"ra{escaped}dius\"")),
            JSON.replace("\"Sphere\"", &format!("\"{escaped}\"")),
        ];
        for text in scenes {
            folder.write("evil.json", text);
            let done = run(&mut folder.strahl(["render", "evil.json"]));
            done.bad_scene("evil.json", &[]);
            harmless(&done.stderr);
        }
    }
}

#[track_caller]
fn harmless(text: &str) {
    let evil = |c: &char| (c.is_control() && *c != '\n') || ('\u{202a}'..='\u{202e}').contains(c);
    let evil: Vec<char> = text.chars().filter(evil).collect();
    assert!(evil.is_empty(), "{evil:?} in {text:?}");
}
