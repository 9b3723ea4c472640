//! Readers that close the pipe, and outputs that are full.

use std::{fs, path::Path, process::Stdio};

use crate::support::{Done, Folder, RON, finish, run, skip};

/// Runs the program with a standard output that is no longer read.
fn into_closed_pipe(folder: &Folder, args: &[&str]) -> Done {
    let mut command = folder.strahl(args);
    // The shell ends at once, and with it the pipe's only reader.
    let mut reader = std::process::Command::new("true")
        .stdin(Stdio::piped())
        .spawn()
        .unwrap();
    let pipe = reader.stdin.take().unwrap();
    reader.wait().unwrap();
    let child = command
        .stdin(Stdio::piped())
        .stdout(pipe)
        .stderr(Stdio::piped())
        .spawn();
    // Otherwise the command would keep the pipe open.
    drop(command);
    finish(child.unwrap(), b"")
}

#[test]
fn a_picture_into_a_closed_pipe_is_an_error() {
    let folder = Folder::with_scenes();
    for format in ["png", "jpg", "bmp", "tiff", "ppm", "qoi", "webp"] {
        let args = ["render", "scene.ron", "-o", "-", "--image-format", format];
        into_closed_pipe(&folder, &args).one_line(2, &["<stdout>", "pipe"]);
    }
}

#[test]
fn a_large_picture_into_a_pipe_that_closes_is_an_error() {
    let folder = Folder::with_scenes();
    let script = "{ \"$STRAHL\" render scene.ron --size 1000x1000 -o - --image-format ppm
        echo \"status $?\" >&2; } | head -c 10 >/dev/null";
    let done = run(&mut folder.shell(script));
    let lines: Vec<&str> = done.stderr.lines().collect();
    assert_eq!(lines.len(), 2, "{}", done.stderr);
    assert!(lines[0].starts_with("error: <stdout>: "), "{}", done.stderr);
    assert_eq!(lines[1], "status 2");
}

#[test]
fn a_closed_pipe_is_fine_for_text() {
    let folder = Folder::with_scenes();
    let texts: [&[&str]; 8] = [
        &["pixel", "scene.ron", "1,1"],
        &["pixel", "scene.ron", "1,1", "--output-format", "json"],
        &["completions", "bash"],
        &["completions", "zsh"],
        &["help"],
        &["--help"],
        &["--version"],
        &["render", "--help"],
    ];
    for args in texts {
        let done = into_closed_pipe(&folder, args);
        assert_eq!(done.status, Some(0), "{args:?}: {}", done.stderr);
        assert_eq!(done.stderr, "", "{args:?}");
    }
    for script in [
        "\"$STRAHL\" pixel scene.ron 1,1 | head -1",
        "\"$STRAHL\" completions bash | head -1",
        "\"$STRAHL\" help | head -1",
        "\"$STRAHL\" help | true",
    ] {
        let done = run(&mut folder.shell(script));
        assert_eq!(done.stderr, "", "{script}");
    }
}

/// Returns a folder with scenes that have errors, warnings and neither, and a job with a failed
/// picture.
fn with_findings() -> Folder {
    let folder = Folder::with_scenes();
    for name in ["a", "b"] {
        fs::create_dir(folder.path(name)).unwrap();
    }
    folder.write("a/wrong.ron", RON.replace("radius: 0.5", "radius: -0.5"));
    folder.write("b/fine.ron", RON);
    folder.write("b/long.ron", RON.replace(": ", ":    "));
    let args = ["render", "a/wrong.ron", "b/fine.ron", "-o", "out/"];
    run(&mut folder.strahl(args));
    folder
}

#[test]
fn a_closed_pipe_keeps_the_status_of_the_findings() {
    let folder = with_findings();
    for format in [
        "human", "short", "json", "jsonl", "sarif", "github", "junit",
    ] {
        for (scene, status) in [("a", 1), ("b", 0), ("missing.ron", 2)] {
            let args = ["validate", "b", scene, "--output-format", format];
            let done = into_closed_pipe(&folder, &args);
            assert_eq!(
                done.status,
                Some(status),
                "{format} {scene}: {}",
                done.stderr
            );
        }
    }
    let others: [(&[&str], i32); 8] = [
        (&["validate", "a", "--diff"], 1),
        (&["fmt", "b", "--check"], 1),
        (&["fmt", "b", "--diff"], 1),
        (&["fmt", "b/long.ron", "b/missing.ron", "--check"], 2),
        (&["status", "out"], 1),
        (&["status", "out", "--output-format", "json"], 1),
        (
            &[
                "render",
                "a/wrong.ron",
                "b/fine.ron",
                "-o",
                "out/",
                "--report",
                "-",
            ],
            1,
        ),
        (&["info", "a/wrong.ron"], 1),
    ];
    for (args, status) in others {
        let done = into_closed_pipe(&folder, args);
        assert_eq!(done.status, Some(status), "{args:?}: {}", done.stderr);
    }
}

#[test]
fn a_closed_report_leaves_the_other_files() {
    let folder = Folder::with_scenes();
    let args = [
        "render",
        "scene.ron",
        "-o",
        "x.png",
        "--report",
        "-",
        "--depfile",
        "x.d",
    ];
    let done = into_closed_pipe(&folder, &args);
    assert_eq!((done.status, &*done.stderr), (Some(0), ""));
    assert_eq!(folder.names(), ["scene.json", "scene.ron", "x.d", "x.png"]);
}

#[test]
fn text_to_a_full_disk_is_exit_status_75() {
    if !Path::new("/dev/full").exists() {
        return skip("there is no /dev/full");
    }
    let folder = Folder::with_scenes();
    for command in ["pixel scene.ron 1,1", "completions bash"] {
        let script = format!("exec \"$STRAHL\" {command} >/dev/full");
        run(&mut folder.shell(&script)).one_line(75, &["<stdout>", "space"]);
    }
}

#[test]
fn help_to_a_full_disk_is_exit_status_75() {
    if !Path::new("/dev/full").exists() {
        return skip("there is no /dev/full");
    }
    let folder = Folder::new();
    for command in ["help", "--help", "--version", "help render"] {
        let script = format!("exec \"$STRAHL\" {command} >/dev/full");
        let done = run(&mut folder.shell(&script));
        assert_eq!(done.status, Some(75), "{command}");
    }
}

#[test]
fn messages_to_a_full_disk_change_nothing() {
    if !Path::new("/dev/full").exists() {
        return skip("there is no /dev/full");
    }
    let folder = Folder::with_scenes();
    folder.write("bad.ron", "(");
    folder.write(
        "loud.ron",
        crate::support::RON.replace("(0, 1, 0))", "(0, 9, 0))"),
    );
    let cases = [
        ("render bad.ron", 1),
        ("render missing.ron", 2),
        ("render loud.ron", 0),
        ("render --progress always scene.ron", 0),
        ("draw", 2),
    ];
    for (command, status) in cases {
        for closed in ["2>/dev/full", "2>&-", "2>&- >&- <&-"] {
            let script = format!("exec \"$STRAHL\" {command} {closed}");
            let done = run(&mut folder.shell(&script));
            assert_eq!(done.status, Some(status), "{script}");
        }
    }
    assert!(folder.path("loud.png").exists() && folder.path("scene.png").exists());
}

#[test]
fn a_closed_standard_input_is_an_empty_scene() {
    let folder = Folder::new();
    let done = run(&mut folder.shell("exec \"$STRAHL\" render - -o a.png <&-"));
    done.bad_scene("<stdin>", &["empty"]);
}

#[test]
fn a_folder_as_standard_input_is_rejected() {
    let folder = Folder::new();
    let done = run(&mut folder.shell("exec \"$STRAHL\" render - -o a.png <."));
    done.one_line(2, &["<stdin>", "folder"]);
}
