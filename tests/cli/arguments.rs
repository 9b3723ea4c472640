//! Arguments of the command line.

use std::{fs, time::Instant};

use crate::support::{Folder, RON, run, run_with};

#[test]
fn a_wrong_size_is_refused() {
    let folder = Folder::with_scenes();
    for size in [
        "0x5",
        "5x0",
        "1000001x1",
        "1000000x1000000",
        "99999999999999999999x1",
    ] {
        let done = run(&mut folder.strahl(["render", "scene.ron", "--size", size]));
        done.failure(2, &["--size", size, "1000000 pixels"]);
    }
    for size in [
        "abc", "5x", "x5", "", "5", "5x5x5", "5.0x5", "-5x5", "5 x 5", "0x10x5", "٣x٣",
    ] {
        let size_option = format!("--size={size}");
        let done = run(&mut folder.strahl(["render", "scene.ron", &size_option]));
        done.failure(2, &["--size", "640x480"]);
    }
    assert_eq!(folder.names(), ["scene.json", "scene.ron"]);
}

#[test]
fn the_size_on_the_command_line_takes_precedence() {
    let folder = Folder::with_scenes();
    run(&mut folder.strahl(["render", "scene.ron", "--size", "7X5"])).quiet_success();
    let image = image::open(folder.path("scene.png")).unwrap();
    assert_eq!((image.width(), image.height()), (7, 5));
}

#[test]
fn the_default_output_is_in_the_current_folder() {
    let folder = Folder::new();
    fs::create_dir(folder.path("deep")).unwrap();
    folder.write("deep/my.scene.ron", RON);
    run(&mut folder.strahl(["render", "deep/my.scene.ron"])).quiet_success();
    assert_eq!(folder.names(), ["deep", "my.scene.png"]);
    assert_eq!(fs::read_dir(folder.path("deep")).unwrap().count(), 1);
}

#[test]
fn any_number_of_threads_writes_the_same_bytes() {
    let folder = Folder::with_scenes();
    let picture = |threads: &str| {
        let args = [
            "render",
            "scene.ron",
            "--size",
            "400x300",
            "--threads",
            threads,
            "-o",
            "-",
        ];
        run(&mut folder.strahl(args)).quiet_success()
    };
    let one = picture("1");
    for threads in ["2", "16", "200"] {
        assert!(picture(threads) == one, "{threads} threads");
    }
}

#[test]
fn a_wrong_number_of_threads_is_refused() {
    let folder = Folder::with_scenes();
    for threads in ["0", "1025", "99999", "-1", "many", "1.5", ""] {
        let threads = format!("--threads={threads}");
        let done = run(&mut folder.strahl(["render", "scene.ron", &threads]));
        done.failure(2, &["--threads"]);
    }
    assert_eq!(folder.names(), ["scene.json", "scene.ron"]);
}

#[test]
fn wrong_usage_is_exit_status_2() {
    let folder = Folder::with_scenes();
    let wrong: [&[&str]; 15] = [
        &["diff"],
        &["diff", "a.png"],
        &["info"],
        &["render"],
        &["draw", "scene.ron"],
        &["render", "scene.ron", "--quick"],
        &["render", "scene.ron", "--progress", "often"],
        &["render", "scene.ron", "--input-format", "yaml"],
        &["render", "scene.ron", "-o", "-", "--image-format", "gif"],
        &["render", "scene.ron", "-o"],
        &["render", "scene.ron", "-o", "a.png", "-o", "b.png"],
        &["pixel", "scene.ron"],
        &["pixel", "scene.ron", "1"],
        &["pixel", "scene.ron", "1,2,3"],
        &["completions", "dos"],
    ];
    for args in wrong {
        let done = run(&mut folder.strahl(args));
        done.failure(2, &["error: "]);
    }
    let done = run(&mut folder.strahl([""; 0]));
    done.failure(2, &["Usage: strahl"]);
    assert_eq!(folder.names(), ["scene.json", "scene.ron"]);
}

#[test]
fn wrong_values_list_the_valid_ones() {
    let folder = Folder::with_scenes();
    let done = run(&mut folder.strahl(["render", "scene.ron", "--input-format", "yaml"]));
    done.failure(2, &["yaml", "ron", "json"]);
    let done = run(&mut folder.strahl(["render", "scene.ron", "--image-format", "gif"]));
    done.failure(2, &["gif", "png", "webp"]);
    let done = run(&mut folder.strahl(["completions", "dos"]));
    done.failure(2, &["dos", "bash", "fish"]);
    let done = run(&mut folder.strahl(["pixel", "scene.ron", "middle"]));
    done.failure(2, &["middle", "320,240"]);
}

#[test]
fn a_pixel_must_be_inside_the_picture() {
    let folder = Folder::with_scenes();
    for pixel in ["32,0", "0,24", "4294967295,0"] {
        let done = run(&mut folder.strahl(["pixel", "scene.ron", pixel]));
        done.one_line(2, &[pixel, "31,23"]);
    }
    for pixel in ["4294967296,0", "1,", ",1", "a,b", "1.0,2"] {
        let done = run(&mut folder.strahl(["pixel", "scene.ron", pixel]));
        done.failure(2, &[pixel]);
    }
    let done = run(&mut folder.strahl(["pixel", "scene.ron", "-1,0"]));
    done.failure(2, &["-1"]);
    for pixel in ["0,0", "31,23"] {
        let stdout = run(&mut folder.strahl(["pixel", "scene.ron", pixel])).quiet_success();
        assert!(!stdout.is_empty());
    }
}

#[test]
fn a_pixel_as_json_is_json() {
    let folder = Folder::with_scenes();
    for scene in ["scene.ron", "scene.json"] {
        let args = ["pixel", scene, "3,4", "--output-format", "json"];
        let stdout = run(&mut folder.strahl(args)).quiet_success();
        let value: serde_json::Value = serde_json::from_slice(&stdout).unwrap();
        assert_eq!((&value["x"], &value["y"]), (&3.into(), &4.into()));
    }
}

#[test]
fn a_pixel_has_the_bytes_of_the_picture() {
    let folder = Folder::with_scenes();
    run(&mut folder.strahl(["render", "scene.ron"])).quiet_success();
    let image = image::open(folder.path("scene.png")).unwrap().to_rgb8();
    for (x, y) in [(0, 0), (8, 12), (10, 11), (31, 23)] {
        let pixel = format!("{x},{y}");
        let args = ["pixel", "scene.ron", &pixel, "--output-format=json"];
        let stdout = run(&mut folder.strahl(args)).quiet_success();
        let value: serde_json::Value = serde_json::from_slice(&stdout).unwrap();
        let expected = serde_json::json!(image.get_pixel(x, 23 - y).0);
        assert_eq!(value["byte"], expected, "{pixel}");
    }
}

#[test]
fn help_and_version_are_results() {
    let folder = Folder::new();
    let wanted: [&[&str]; 7] = [
        &["help"],
        &["--help"],
        &["-h"],
        &["--version"],
        &["help", "render"],
        &["render", "--help"],
        &["pixel", "-h"],
    ];
    for args in wanted {
        let stdout = run(&mut folder.strahl(args)).quiet_success();
        assert!(
            stdout.starts_with(b"strahl") || stdout.len() > 100,
            "{args:?}"
        );
    }
    let help = run(&mut folder.strahl(["help"])).quiet_success();
    let help = String::from_utf8(help).unwrap();
    for command in [
        "render",
        "info",
        "pixel",
        "diff",
        "completions",
        "man",
        "130",
        "75",
    ] {
        assert!(help.contains(command), "{command}");
    }
}

#[test]
fn every_shell_has_completions() {
    let folder = Folder::new();
    for shell in ["bash", "elvish", "fish", "powershell", "zsh"] {
        let stdout = run(&mut folder.strahl(["completions", shell])).quiet_success();
        let script = String::from_utf8(stdout).unwrap();
        assert!(script.contains("image-format"), "{shell}");
    }
    assert_eq!(folder.names(), [""; 0]);
}

#[test]
fn the_manual_goes_into_a_folder() {
    let folder = Folder::new();
    run(&mut folder.strahl(["man", "new/man1"])).quiet_success();
    let page = fs::read_to_string(folder.path("new/man1/strahl-render.1")).unwrap();
    assert!(page.contains("image\\-format"));
    run(&mut folder.strahl(["man", "new/man1"])).quiet_success();

    folder.write("file", "old");
    for target in ["file", "file/man1"] {
        run(&mut folder.strahl(["man", target])).one_line(2, &[target]);
    }
    assert_eq!(fs::read(folder.path("file")).unwrap(), b"old");
}

#[test]
fn a_scene_from_standard_input() {
    let folder = Folder::with_scenes();
    let expected = run(&mut folder.strahl(["render", "scene.ron", "-o", "-"])).quiet_success();
    let json = fs::read(folder.path("scene.json")).unwrap();
    let ron = fs::read(folder.path("scene.ron")).unwrap();
    for (text, format) in [(&ron, "ron"), (&json, "json")] {
        let plain = &mut folder.strahl(["render", "-", "-o", "-"]);
        assert!(
            run_with(plain, text).quiet_success() == expected,
            "{format}"
        );
        let args = ["render", "--input-format", format, "-", "-o", "-"];
        assert!(run_with(&mut folder.strahl(args), text).quiet_success() == expected);
        let args = ["render", "-", "-o", "new.png"];
        let stdout = run_with(&mut folder.strahl(args), text).quiet_success();
        assert!(stdout.is_empty());
        assert!(fs::read(folder.path("new.png")).unwrap() == expected);
    }
    // JSON is still recognized after a byte order mark and blank lines.
    let marked = [b"\xef\xbb\xbf\r\n\t ", json.as_slice()].concat();
    let done = run_with(&mut folder.strahl(["render", "-", "-o", "-"]), &marked);
    assert!(done.quiet_success() == expected);

    for (text, format) in [(&json, "ron"), (&ron, "json")] {
        let args = ["render", "--input-format", format, "-", "-o", "-"];
        run_with(&mut folder.strahl(args), text).bad_scene("<stdin>", &[]);
    }
}

#[test]
fn a_scene_from_standard_input_needs_an_output() {
    let folder = Folder::new();
    let done = run_with(&mut folder.strahl(["render", "-"]), RON.as_bytes());
    done.one_line(2, &["standard input", "-o"]);
    assert_eq!(folder.names(), [""; 0]);
}

#[test]
fn a_pixel_of_a_scene_from_standard_input() {
    let folder = Folder::new();
    let done = run_with(&mut folder.strahl(["pixel", "-", "1,2"]), RON.as_bytes());
    assert!(!done.quiet_success().is_empty());
    let done = run_with(&mut folder.strahl(["pixel", "-", "1,2"]), b"");
    done.bad_scene("<stdin>", &["empty"]);
}

#[test]
fn contradictions_are_rejected_before_the_scene_is_read() {
    let folder = Folder::with_scenes();
    let start = Instant::now();
    // This pipe is never closed: a program that reads it would wait.
    let mut command = folder.strahl(["render", "-", "-o", "picture.gif"]);
    let child = command
        .stdin(std::process::Stdio::piped())
        .stdout(std::process::Stdio::piped())
        .stderr(std::process::Stdio::piped())
        .spawn();
    let mut child = child.unwrap();
    let status = crate::support::wait(&mut child, std::time::Duration::from_secs(60));
    assert_eq!(status, Some(Some(2)), "after {:?}", start.elapsed());
}

#[test]
fn warnings_do_not_prevent_rendering() {
    let folder = Folder::new();
    let text = RON.replace("(0, 1, 0))", "(0, 255, 0))");
    folder.write("loud.ron", &text);
    let done = run(&mut folder.strahl(["render", "loud.ron"]));
    assert_eq!(done.status, Some(0));
    assert!(done.stdout.is_empty());
    for word in ["loud.ron", "warning[color-clamped]", "255"] {
        assert!(done.stderr.contains(word), "{}", done.stderr);
    }
    assert_eq!(folder.names(), ["loud.png", "loud.ron"]);
    for quiet in ["-q", "--quiet"] {
        run(&mut folder.strahl(["render", "loud.ron", quiet])).quiet_success();
    }
    let done = run(&mut folder.strahl(["render", "missing.ron", "-q"]));
    done.one_line(2, &["missing.ron"]);
    folder.write("bad.ron", RON.replace("0.5", "-0.5"));
    let done = run(&mut folder.strahl(["render", "bad.ron", "-q"]));
    done.bad_scene("bad.ron", &["radius"]);
}

#[test]
fn suggestions_for_other_spellings() {
    let folder = Folder::new();
    folder.write("fig.ron", RON);
    folder.write("fig.rno", RON);
    for (args, words) in [
        (&["fig.ron"][..], "use 'strahl render fig.ron'"),
        (&["render", "fig.rno"], "did you mean `.ron`?"),
        (&["validate", "fig.rno"], "did you mean `.ron`?"),
        (
            &["render", "fig.ron", "-o", "x.xyz"],
            "for movies .y4m and .apng",
        ),
        (
            &["render", "fig.ron", "--set", "background=#ggg"],
            "`#ggg` is not a color",
        ),
        (
            &["render", "fig.ron", "--set", "image.width=#fff"],
            "found the string `\"#fff\"`",
        ),
    ] {
        let done = run(&mut folder.strahl(args));
        let messages = String::from_utf8(done.stdout).unwrap() + &done.stderr;
        assert!(matches!(done.status, Some(1 | 2)), "{args:?}: {messages}");
        assert!(messages.contains(words), "{args:?}: {messages}");
    }
    let render = [
        "render",
        "fig.ron",
        "--set",
        "background=#0f0",
        "-o",
        "a.png",
        "-q",
    ];
    assert_eq!(run(&mut folder.strahl(render)).status, Some(0));
    let quoted = [
        "render",
        "fig.ron",
        "--set",
        "background=\"#0f0\"",
        "-o",
        "b.png",
        "-q",
    ];
    assert_eq!(run(&mut folder.strahl(quoted)).status, Some(0));
    let bytes = |name| std::fs::read(folder.path(name)).unwrap();
    assert!(bytes("a.png") == bytes("b.png"));
}

#[test]
fn explain_alone_lists_the_codes() {
    let done = run(&mut Folder::new().strahl(["explain"]));
    let text = String::from_utf8(done.stdout).unwrap();
    assert_eq!(text.lines().count(), strahl::diagnostic::Code::ALL.len());
    assert!(text.contains("\nunknown-field "), "{text}");
}
