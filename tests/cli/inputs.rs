//! Files that are not scenes.

use std::{
    fs::{self, File},
    io::{Seek, SeekFrom, Write},
    time::{Duration, Instant},
};

use crate::support::{Folder, JSON, RON, run, run_with};

#[test]
fn a_missing_file_is_named() {
    let folder = Folder::new();
    for scene in ["missing.ron", "no/such/folder/a.json", "missing"] {
        for command in [vec!["render", scene], vec!["pixel", scene, "0,0"]] {
            let done = run(&mut folder.strahl(command));
            assert_eq!(done.status, Some(2));
            done.one_line(2, &[scene]);
        }
    }
    let done = run(&mut folder.strahl(["render", "missing.ron"]));
    done.one_line(2, &["missing.ron: no such file"]);
    assert_eq!(folder.names(), [""; 0]);
}

#[test]
fn a_folder_is_not_a_scene() {
    let folder = Folder::new();
    fs::create_dir(folder.path("scene.ron")).unwrap();
    fs::create_dir(folder.path("scenes")).unwrap();
    for scene in ["scene.ron", "scenes", "scenes/", "."] {
        let done = run(&mut folder.strahl(["render", scene, "-o", "a.png"]));
        done.one_line(2, &[scene, "folder"]);
        let done = run(&mut folder.strahl(["render", scene]));
        done.one_line(2, &[scene, "folder"]);
        let done = run(&mut folder.strahl(["pixel", scene, "0,0"]));
        done.one_line(2, &[scene, "folder"]);
    }
    assert_eq!(folder.names(), ["scene.ron", "scenes"]);
}

#[test]
fn a_path_through_a_file_is_refused() {
    let folder = Folder::with_scenes();
    let done = run(&mut folder.strahl(["render", "scene.ron/deeper.ron"]));
    done.one_line(2, &["deeper.ron"]);
    let done = run(&mut folder.strahl(["render", "scene.ron", "-o", "scene.ron/a.png"]));
    done.one_line(2, &["a.png"]);
}

#[test]
fn an_empty_name_is_refused() {
    let folder = Folder::with_scenes();
    for args in [vec!["render", ""], vec!["render", "scene.ron", "-o", ""]] {
        let done = run(&mut folder.strahl(args));
        done.failure(2, &[]);
    }
}

#[test]
fn an_empty_file_is_reported_as_empty() {
    let folder = Folder::new();
    for name in ["empty.ron", "empty.json"] {
        for text in ["", "\n", " \t\r\n", "\u{feff}", "\u{feff}\n"] {
            folder.write(name, text);
            run(&mut folder.strahl(["render", name])).bad_scene(name, &["[syntax]", "empty"]);
        }
    }
    for format in ["ron", "json"] {
        let args = ["render", "-", "--input-format", format, "-o", "a.png"];
        run(&mut folder.strahl(args)).bad_scene("<stdin>", &["[syntax]", "empty"]);
    }
    folder.write("comment.ron", "// nothing\n/* at all */\n");
    run(&mut folder.strahl(["render", "comment.ron"])).bad_scene("comment.ron", &["[syntax]"]);
    assert_eq!(folder.names(), ["comment.ron", "empty.json", "empty.ron"]);
}

#[test]
fn an_unknown_extension_is_rejected() {
    let folder = Folder::new();
    for name in ["scene.txt", "scene", "scene.ron.bak", "ron", ".ron"] {
        folder.write(name, RON);
        let done = run(&mut folder.strahl(["render", name, "-o", "a.png"]));
        done.one_line(2, &[name, ".ron", ".json"]);
        let args = ["render", name, "-o", "a.png", "--input-format", "ron"];
        run(&mut folder.strahl(args)).quiet_success();
        fs::remove_file(folder.path("a.png")).unwrap();
    }
}

#[test]
fn the_wrong_extension_is_a_fault_of_the_scene() {
    let folder = Folder::new();
    folder.write("a.json", RON);
    folder.write("a.ron", JSON);
    for name in ["a.json", "a.ron"] {
        run(&mut folder.strahl(["render", name])).bad_scene(name, &[]);
    }
    let args = ["render", "a.json", "--input-format", "ron"];
    run(&mut folder.strahl(args)).quiet_success();
}

#[test]
fn random_bytes_are_not_text() {
    let folder = Folder::new();
    let mut late = RON
        .replace(",\n)", &format!(",\n)\n// {}", "x".repeat(6000)))
        .into_bytes();
    late[5000] = 0;
    let rubbish: Vec<u8> = (0..20_000_u32).map(|n| ((n * n) >> 3) as u8).collect();
    for name in ["rubbish.ron", "rubbish.json"] {
        for bytes in [&b"\0"[..], b"\0\0\0\0", &late, &rubbish] {
            folder.write(name, bytes);
            run(&mut folder.strahl(["render", name])).bad_scene(name, &["[syntax]", "text"]);
            let args = ["render", "-", "-o", "a.png"];
            let done = run_with(&mut folder.strahl(args), bytes);
            done.bad_scene("<stdin>", &["[syntax]", "text"]);
        }
    }
    assert_eq!(folder.names(), ["rubbish.json", "rubbish.ron"]);
}

#[test]
fn only_utf_8_is_text() {
    let folder = Folder::new();
    for bad in [
        &b"\xff"[..],
        b"\xc3",
        b"\xc3(",
        b"\xed\xa0\x80",
        b"\xc0\x80",
        b"\xf5\x80\x80\x80",
    ] {
        for text in [RON, JSON] {
            let name = if text == RON { "bad.ron" } else { "bad.json" };
            folder.write(name, [text.as_bytes(), bad].concat());
            run(&mut folder.strahl(["render", name])).bad_scene(name, &["[syntax]", "UTF-8"]);
            folder.write(name, [bad, text.as_bytes()].concat());
            run(&mut folder.strahl(["render", name])).bad_scene(name, &["[syntax]", "UTF-8"]);
        }
    }
}

#[test]
fn utf_16_is_named() {
    let folder = Folder::new();
    for mark in [&b""[..], b"\xff\xfe", b"\xfe\xff"] {
        let order = |unit: u16| {
            if mark == b"\xfe\xff" {
                unit.to_be_bytes()
            } else {
                unit.to_le_bytes()
            }
        };
        let body: Vec<u8> = RON.encode_utf16().flat_map(order).collect();
        folder.write("wide.ron", [mark, &body].concat());
        let done = run(&mut folder.strahl(["render", "wide.ron"]));
        let words: &[&str] = if mark.is_empty() {
            &["UTF-8"]
        } else {
            &["UTF-16", "UTF-8"]
        };
        done.bad_scene("wide.ron", words);
    }
}

#[test]
fn a_byte_order_mark_and_crlf_change_nothing() {
    let folder = Folder::with_scenes();
    let expected = run(&mut folder.strahl(["render", "scene.ron", "-o", "-"])).quiet_success();
    for (name, text) in [("other.ron", RON), ("other.json", JSON)] {
        for start in ["", "\u{feff}"] {
            for end in ["\n", "\r\n"] {
                folder.write(name, format!("{start}{}", text.replace('\n', end)));
                let done = run(&mut folder.strahl(["render", name, "-o", "-"]));
                assert!(done.quiet_success() == expected, "{name}");
            }
        }
        // One byte order mark, and only at the start.
        folder.write(name, format!("\u{feff}\u{feff}{text}"));
        run(&mut folder.strahl(["render", name])).bad_scene(name, &["[syntax]"]);
    }
}

fn sparse(folder: &Folder, name: &str, begin: &[u8]) {
    let mut file = File::create(folder.path(name)).unwrap();
    file.write_all(begin).unwrap();
    file.seek(SeekFrom::Start(0)).unwrap();
    file.set_len(4 << 30).unwrap();
}

#[test]
fn four_gigabytes_of_zeros_are_rejected_at_once() {
    let folder = Folder::new();
    let mut text = RON.to_owned();
    text += &"// and so on\n".repeat(8192 / 13 + 1);
    text.truncate(8192);
    sparse(&folder, "zeros.ron", b"");
    sparse(&folder, "text.ron", text.as_bytes());
    sparse(&folder, "blank.json", &[b' '; 8192]);
    for name in ["zeros.ron", "text.ron", "blank.json"] {
        let start = Instant::now();
        #[cfg(target_os = "linux")]
        let mut command = folder.shell(&format!(
            "ulimit -v 1000000 && exec \"$STRAHL\" render {name}"
        ));
        #[cfg(not(target_os = "linux"))]
        let mut command = folder.strahl(["render", name]);
        run(&mut command).bad_scene(name, &["[syntax]", "text"]);
        assert!(start.elapsed() < Duration::from_secs(20), "{name}");
    }
}

#[cfg(unix)]
#[test]
fn a_device_is_read_no_further_than_needed() {
    let folder = Folder::new();
    let start = Instant::now();
    let args = [
        "render",
        "/dev/zero",
        "--input-format",
        "ron",
        "-o",
        "a.png",
    ];
    run(&mut folder.strahl(args)).bad_scene("/dev/zero", &["[syntax]"]);
    let args = [
        "render",
        "/dev/null",
        "--input-format",
        "json",
        "-o",
        "a.png",
    ];
    run(&mut folder.strahl(args)).bad_scene("/dev/null", &["[syntax]", "empty"]);
    assert!(start.elapsed() < Duration::from_secs(20));
}

#[test]
fn deep_nesting_is_a_fault_and_not_a_crash() {
    const DEPTH: usize = 100_000;
    let folder = Folder::new();
    let start = Instant::now();
    let ron_places = [
        "",
        "(allow: ",
        "(geometries: ",
        "(camera: ",
        "(background: ",
        "(unknown: ",
    ];
    let ron_brackets = ["[", "(", "{", "Some(", "(a: ", "Sphere(center: (", "{0: "];
    for (place, bracket) in combinations(&ron_places, &ron_brackets) {
        folder.write("deep.ron", format!("{place}{}", bracket.repeat(DEPTH)));
        run(&mut folder.strahl(["render", "deep.ron"])).bad_scene("deep.ron", &[]);
    }
    let json_places = [
        "",
        "{\"allow\": ",
        "{\"geometries\": ",
        "{\"background\": ",
        "{\"unknown\": ",
    ];
    for (place, bracket) in combinations(&json_places, &["[", "{\"a\": ", "[{\"Sphere\": "]) {
        folder.write("deep.json", format!("{place}{}", bracket.repeat(DEPTH)));
        run(&mut folder.strahl(["render", "deep.json"])).bad_scene("deep.json", &[]);
    }
    let closed = format!("(geometries: {}{})", "[".repeat(DEPTH), "]".repeat(DEPTH));
    folder.write("deep.ron", closed);
    run(&mut folder.strahl(["render", "deep.ron"])).bad_scene("deep.ron", &[]);
    let done = run(&mut folder.strahl(["pixel", "deep.ron", "0,0"]));
    done.bad_scene("deep.ron", &[]);
    assert!(start.elapsed() < Duration::from_secs(120));
}

fn combinations<'a>(
    places: &'a [&str],
    brackets: &'a [&str],
) -> impl Iterator<Item = (&'a str, &'a str)> {
    let pairs = |place| brackets.iter().map(move |bracket| (place, *bracket));
    places.iter().copied().flat_map(pairs)
}

#[test]
fn nested_comments_end_or_are_a_fault() {
    const DEPTH: usize = 100_000;
    let folder = Folder::new();
    folder.write("deep.ron", format!("{}{RON}", "/*".repeat(DEPTH)));
    run(&mut folder.strahl(["render", "deep.ron"])).bad_scene("deep.ron", &["[syntax]"]);
    let comment = format!("{}{}", "/*".repeat(DEPTH), "*/".repeat(DEPTH));
    let inside = RON.replace("color: ", &format!("color: {comment}"));
    for text in [format!("{comment}{RON}"), inside] {
        folder.write("deep.ron", text);
        run(&mut folder.strahl(["render", "deep.ron"])).quiet_success();
    }
}

#[test]
fn one_long_line_is_read() {
    let folder = Folder::new();
    let sphere = |x| format!("Sphere(center: ({x}, 0, -3), radius: 1, color: (0, 0, 0)),");
    let spheres: String = (0..50_000).map(sphere).collect();
    let bad = "Sphere(center: (0, 0, -3), radius: x, color: (0, 0, 0))";
    let start = RON.replace('\n', " ");
    let start = start.split("Plane").next().unwrap();
    folder.write("long.ron", format!("{start}{spheres}{bad}])"));
    let done = run(&mut folder.strahl(["render", "long.ron"]));
    done.bad_scene("long.ron", &[]);
    assert!(
        done.stderr.len() < 4000,
        "a report of {} bytes",
        done.stderr.len()
    );

    let name = "x".repeat(1_000_000);
    for text in [format!("({name}: 1)"), format!("(\"{name}\")"), name] {
        folder.write("long.ron", text);
        let done = run(&mut folder.strahl(["render", "long.ron"]));
        done.bad_scene("long.ron", &[]);
    }
}
