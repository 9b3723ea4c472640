//! Untrusted folders, names and inputs, and runs that end for external reasons.

use std::{fs, os::unix::fs::symlink, process::Stdio, thread};

use serde_json::{Value, json};

use crate::{
    attacks::with_memory,
    support::{Done, Folder, LONG_SIZE, RON, finish, long_scene, run, until},
};

const SHA: &str = "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855";

/// Memory limit in KiB: enough for the program and little more.
const LITTLE: u32 = 400_000;

fn plan(shard: u32, shards: u32, total: u64, pictures: &[&str]) -> Value {
    json!({"plan": {"version": "0.1.0", "shard": shard, "shards": shards, "total": total, "pictures": pictures}})
}

fn done(picture: &str, files: &[&str]) -> Value {
    let files: Vec<_> = files
        .iter()
        .map(|file| json!({"file": file, "bytes": 0, "sha256": SHA}))
        .collect();
    json!({"done": {"picture": picture, "hash": "x", "files": files}})
}

fn record(folder: &Folder, lines: &[Value]) {
    let lines: Vec<_> = lines.iter().map(|line| format!("{line}\n")).collect();
    fs::create_dir_all(folder.path("out/.strahl")).unwrap();
    folder.write("out/.strahl/0-of-1-0.jsonl", lines.concat());
}

fn status(folder: &Folder, more: &[&str]) -> Done {
    with_memory(folder, LITTLE, &[&["status", "out"], more].concat())
}

#[test]
fn records_about_files_elsewhere_are_ignored() {
    let folder = Folder::new();
    folder.write("x.png", "");
    let outside = folder.path("x.png");
    for file in ["../x.png", outside.to_str().unwrap(), "y/../../x.png", ""] {
        record(
            &folder,
            &[plan(0, 1, 1, &["x.png"]), done("x.png", &[file])],
        );
        let messages = status(&folder, &[]);
        assert_eq!(messages.status, Some(1), "{messages:?}");
        let text = String::from_utf8(messages.stdout).unwrap();
        assert!(
            text.starts_with("0 of 1 pictures are done\n1 missing\n"),
            "{text}"
        );
    }
    record(&folder, &[plan(0, 1, 1, &["x.png"]), done("x.png", &[])]);
    assert_eq!(status(&folder, &[]).status, Some(1), "no files at all");
    record(
        &folder,
        &[
            plan(0, 1, 1, &["../x.png"]),
            done("../x.png", &["../x.png"]),
        ],
    );
    status(&folder, &[]).one_line(2, &["no record"]);
}

#[test]
fn impossible_numbers_in_records_are_survived() {
    let folder = Folder::new();
    record(&folder, &[plan(0, u32::MAX, 5, &["x.png"])]);
    let messages = status(&folder, &[]);
    assert_eq!((messages.status, &*messages.stderr), (Some(1), ""));
    let text = String::from_utf8(messages.stdout).unwrap();
    assert!(text.contains("\n4294967294 parts not started\n"), "{text}");
    assert_eq!(
        status(&folder, &["--output-format", "json"]).status,
        Some(1)
    );
    let skipped = json!({"skipped": "x.png"});
    for plan in [
        plan(0, 1, 0, &["x.png"]),
        plan(3, 2, 1, &[]),
        plan(0, 0, 1, &[]),
    ] {
        record(&folder, &[plan, skipped.clone()]);
        status(&folder, &[]).one_line(2, &["no record"]);
    }
    record(
        &folder,
        &[
            plan(0, 1, 1, &["x.png"]),
            skipped.clone(),
            json!({"skipped": "y"}),
        ],
    );
    assert_eq!(status(&folder, &[]).status, Some(0));
    folder.write("out/x.png.0-of-4294967295.part", "");
    folder.write("s.ron", RON);
    let done = with_memory(&folder, LITTLE, &["merge", "s.ron", "-o", "out/x.png"]);
    done.one_line(1, &["missing: 1/4294967295", "and 4294967284 more"]);
}

#[test]
fn a_record_that_is_a_link_or_a_device_is_refused() {
    let folder = Folder::with_scenes();
    folder.write("precious", "text\n");
    let render = [
        "render",
        "scene.ron",
        "scene.json",
        "-o",
        "out/{scene}-{id}.png",
    ];
    folder.write("t.csv", "id\n1\n2\n");
    let render = [&render[..], &["--params", "t.csv"]].concat();
    let render = [&render[..1], &render[1..2], &render[3..]].concat();
    fs::create_dir_all(folder.path("out/.strahl")).unwrap();
    let place = folder.path("out/.strahl/0-of-1-0.jsonl");
    for target in ["../../precious", "/dev/zero", "../../new"] {
        symlink(target, &place).unwrap();
        status(&folder, &[]).one_line(2, &["0-of-1-0.jsonl", "not a link"]);
        let drawn = run(&mut folder.strahl(&render));
        drawn.failure(2, &["not a link"]);
        fs::remove_file(&place).unwrap();
    }
    assert_eq!(fs::read(folder.path("precious")).unwrap(), b"text\n");
    assert!(!folder.path("new").exists());
    fs::remove_dir(folder.path("out/.strahl")).unwrap();
    fs::create_dir(folder.path("elsewhere")).unwrap();
    symlink("../elsewhere", folder.path("out/.strahl")).unwrap();
    run(&mut folder.strahl(&render)).failure(2, &[".strahl", "is not a folder"]);
    status(&folder, &[]).one_line(2, &[".strahl", "is not a folder"]);
    assert_eq!(fs::read_dir(folder.path("elsewhere")).unwrap().count(), 0);
}

#[test]
fn binary_and_overlong_lines_are_rejected() {
    let folder = Folder::new();
    let good = format!("{}\n", plan(0, 1, 1, &["x.png"]));
    fs::create_dir_all(folder.path("out/.strahl")).unwrap();
    let bytes = [b"\xff\xfe\n{\"plan\":\n[[[[\n", good.as_bytes()].concat();
    let place = folder.write("out/.strahl/0-of-1-0.jsonl", bytes);
    assert_eq!(status(&folder, &[]).status, Some(1));
    // Longer than any allowed line, and not stored on disk.
    fs::File::create(place).unwrap().set_len(1 << 40).unwrap();
    with_memory(&folder, 1_000_000, &["status", "out"]).one_line(2, &["line is longer than"]);
}

#[test]
fn a_record_counts_only_for_the_files_of_this_run() {
    let folder = Folder::new();
    folder.write("a.ron", RON);
    folder.write("b.ron", RON);
    let render = ["render", "a.ron", "b.ron", "-o", "out/", "--resume"];
    fs::create_dir(folder.path("out")).unwrap();
    assert_eq!(run(&mut folder.strahl(render)).status, Some(0));
    let place = folder.path("out/.strahl/0-of-1-0.jsonl");
    let text = fs::read_to_string(&place).unwrap();
    // It claims that the picture of `a` is in `b.png`, which exists.
    fs::write(
        &place,
        text.replace("\"file\":\"a.png\"", "\"file\":\"b.png\""),
    )
    .unwrap();
    fs::remove_file(folder.path("out/a.png")).unwrap();
    assert_eq!(run(&mut folder.strahl(render)).status, Some(0));
    assert!(folder.path("out/a.png").exists());
}

#[test]
fn control_characters_in_names_are_escaped() {
    let folder = Folder::new();
    let name = "a\u{1b}[31m\u{202e}b.ron";
    folder.write(name, format!("  {RON}"));
    let harmless = |done: &Done| {
        let text = format!("{}{}", String::from_utf8_lossy(&done.stdout), done.stderr);
        assert!(!text.contains(['\u{1b}', '\u{202e}']), "{text:?}");
        assert!(text.contains("a␛[31m\u{fffd}b"), "{text:?}");
    };
    let drawn = format!("{name}.png");
    for args in [
        vec!["fmt", "--check", name],
        vec!["fmt", "--check", "."],
        vec!["convert", name, "a\u{1b}[31m\u{202e}b"],
        vec!["diff", name, name],
        vec![
            "render",
            name,
            "-o",
            "a\u{1b}[31m\u{202e}b/x.png",
            "--crop",
            "0,0,900,900",
        ],
        vec!["new", name],
        vec!["validate", "--files-from", "a\u{1b}[31m\u{202e}b"],
        vec![
            "render",
            name,
            "--params",
            "a\u{1b}[31m\u{202e}b.csv",
            "-o",
            "{id}.png",
        ],
    ] {
        let done = run(&mut folder.strahl(&args));
        assert_ne!(done.status, Some(0), "{args:?}");
        harmless(&done);
    }
    record(&folder, &[plan(0, 1, 1, &[&drawn])]);
    harmless(&status(&folder, &[]));
    let failed = json!({"failed": {"picture": "x.png", "error": "a\u{1b}[31m\u{202e}b"}});
    record(&folder, &[plan(0, 1, 1, &["x.png"]), failed]);
    harmless(&status(&folder, &[]));
}

#[test]
fn long_lines_of_tables_are_refused() {
    let folder = Folder::new();
    let table = [&[b','; 40 << 20][..], b"\n1,2,3,4\n"].concat();
    folder.write("t.csv", &table);
    let scene = RON.replace("geometries: [", "geometries: [ Spheres(file: \"t.csv\"), ");
    folder.write("s.ron", scene);
    let done = with_memory(
        &folder,
        LITTLE,
        &["validate", "s.ron", "--output-format", "short"],
    );
    assert_eq!(done.status, Some(1), "{}", done.stderr);
    let text = String::from_utf8(done.stdout).unwrap();
    assert!(text.contains("line 1: longer than 1 MiB"), "{text}");
    folder.write("plain.ron", RON);
    let args = ["render", "plain.ron", "--params", "t.csv", "-o", "{id}.png"];
    with_memory(&folder, LITTLE, &args).one_line(2, &["t.csv", "longer than 1 MiB"]);
}

#[test]
fn endless_lists_and_tables_are_rejected() {
    let folder = Folder::new();
    folder.write("s.ron", RON);
    let zero = ["validate", "--files-from", "/dev/zero"];
    with_memory(&folder, LITTLE, &zero).one_line(2, &["/dev/zero", "longer than 1 MiB"]);
    symlink("/dev/zero", folder.path("z.csv")).unwrap();
    symlink("/dev/zero", folder.path("z.jsonl")).unwrap();
    for table in ["z.csv", "z.jsonl"] {
        let args = ["render", "s.ron", "--params", table, "-o", "{id}.png"];
        with_memory(&folder, LITTLE, &args).one_line(2, &[table, "is a device, not a file"]);
    }
    let script = "ulimit -v 900000; yes | \"$STRAHL\" validate --files-from -";
    run(&mut folder.shell(script)).one_line(2, &["longer than 64 MiB"]);
    // A pipe works like a file.
    let script = "echo s.ron | \"$STRAHL\" validate --files-from - --output-format short";
    assert_eq!(run(&mut folder.shell(script)).status, Some(0));
}

#[test]
fn a_lost_terminal_leaves_no_file_and_nohup_continues() {
    let folder = Folder::new();
    folder.write("long.ron", long_scene());
    let has_begun = || folder.names().iter().any(|name| name.ends_with(".tmp"));
    // The tests themselves may run under nohup, which only `env` on Linux can undo.
    let env = if cfg!(target_os = "linux") {
        "env --default-signal=HUP"
    } else {
        ""
    };
    for nohup in [false, true] {
        let args = [
            "render", "long.ron", "--size", LONG_SIZE, "-o", "x.png", "-q",
        ];
        let start = if nohup {
            "trap '' HUP; exec"
        } else {
            &format!("exec {env}")
        };
        let mut command = folder.shell(&format!("{start} \"$STRAHL\" \"$@\""));
        command.arg("strahl").args(args);
        let (stdin, stdout, stderr) = (Stdio::piped(), Stdio::piped(), Stdio::piped());
        let child = command.stdin(stdin).stdout(stdout).stderr(stderr).spawn();
        let child = child.unwrap();
        until("the picture has begun", has_begun);
        let send = |signal: &str| {
            let kill = format!("kill -{signal} {}", child.id());
            run(&mut folder.shell(&kill)).quiet_success();
        };
        send("HUP");
        if nohup {
            thread::sleep(std::time::Duration::from_millis(300));
            assert!(has_begun(), "ended by a signal that is ignored");
            send("TERM");
        }
        let done = finish(child, b"");
        assert_eq!(done.status, Some(130), "{}", done.stderr);
        assert_eq!(folder.names(), ["long.ron"]);
    }
}

#[test]
fn a_file_larger_than_allowed_leaves_no_file() {
    let folder = Folder::with_scenes();
    let script = "ulimit -f 8; exec \"$STRAHL\" render scene.ron --size 900x900 -o x.bmp";
    run(&mut folder.shell(script)).one_line(75, &["x.bmp", "file too large"]);
    assert_eq!(folder.names(), ["scene.json", "scene.ron"]);
}

#[cfg(target_os = "linux")]
#[test]
fn a_picture_for_a_closed_output_is_an_error() {
    let folder = Folder::with_scenes();
    let script = "\"$STRAHL\" render scene.ron -o - >&-";
    run(&mut folder.shell(script)).one_line(2, &["<stdout>", "closed"]);
    let script = "\"$STRAHL\" render scene.ron -o - >/dev/null";
    run(&mut folder.shell(script)).quiet_success();
}

#[test]
fn low_memory_does_not_crash() {
    let folder = Folder::with_scenes();
    let kib = [45_000, 60_000, 80_000];
    let sizes = ["640x480", "3000x3000"];
    for (kib, size) in kib.iter().flat_map(|kib| sizes.map(|size| (*kib, size))) {
        for threads in ["0", "8", "1000"] {
            let mut args = vec!["render", "scene.ron", "-o", "x.png", "--size", size];
            if threads != "0" {
                args.extend(["--threads", threads]);
            }
            let done = with_memory(&folder, kib, &args);
            assert!(
                matches!(done.status, Some(0 | 75)),
                "{kib} {size} {threads}: {done:?}"
            );
        }
    }
}

#[test]
fn merging_leaves_only_the_picture() {
    let folder = Folder::new();
    folder.write("s.ron", RON);
    let render = |shard| {
        let args = ["render", "s.ron", "-q", "-o", "a.png", "--shard", shard];
        run(&mut folder.strahl(args)).quiet_success();
    };
    for _ in 0..5 {
        for shard in ["0/3", "1/3", "2/3"] {
            render(shard);
        }
        let merge = |_| {
            let child = folder
                .strahl(["merge", "s.ron", "-o", "a.png", "-q"])
                .stdin(Stdio::piped())
                .stdout(Stdio::piped())
                .stderr(Stdio::piped())
                .spawn();
            child.unwrap()
        };
        let both = [0, 1].map(merge);
        for child in both {
            finish(child, b"").quiet_success();
        }
        assert_eq!(folder.names(), ["a.png", "s.ron"]);
    }
    let again = run(&mut folder.strahl(["merge", "s.ron", "-o", "a.png"]));
    assert_eq!(again.status, Some(0));
    assert!(again.stderr.contains("no bands"), "{}", again.stderr);
}

#[test]
fn all_cameras_of_one_scene_need_no_record() {
    let folder = Folder::new();
    let scene = RON.replace(
        "camera: Perspective(eye: (0, 0, 0), gaze: (0, 0, -1), fov: 90),",
        "cameras: {\"a\": Perspective(eye: (0, 0, 0), gaze: (0, 0, -1), fov: 90), \
         \"b\": Perspective(eye: (0, 0, 1), gaze: (0, 0, -1), fov: 90)},",
    );
    folder.write("s.ron", scene);
    let args = [
        "render",
        "s.ron",
        "--all-cameras",
        "-q",
        "-o",
        "{camera}.png",
    ];
    run(&mut folder.strahl(args)).quiet_success();
    assert_eq!(folder.names(), ["a.png", "b.png", "s.ron"]);
}

#[test]
fn more_threads_than_cores_can_use_are_not_started() {
    let folder = Folder::with_scenes();
    let args = [
        "render",
        "scene.ron",
        "-o",
        "x.png",
        "--timings=json",
        "--threads",
    ];
    let cores = thread::available_parallelism().unwrap().get();
    for (asked, started) in [("3", 3), ("1024", 16.max(4 * cores))] {
        let done = run(folder.strahl(args).arg(asked));
        let timings: Value = serde_json::from_str(&done.stderr).unwrap();
        assert_eq!(timings["threads"], started);
    }
}
