//! Ctrl-C and other signals.

use std::{
    fs,
    os::unix::process::ExitStatusExt,
    process::{Child, Command, Stdio},
    thread,
    time::{Duration, Instant},
};

use crate::support::{Folder, LONG_SIZE, RON, finish, long_scene, run, until, wait};

/// Two seconds by the contract, plus some for a busy machine.
const SOON: Duration = Duration::from_secs(8);

fn signal(child: &Child, name: &str) {
    let id = child.id().to_string();
    let sent = Command::new("kill")
        .args([&format!("-{name}"), &id])
        .status();
    assert!(sent.unwrap().success());
}

fn spawn(mut command: Command) -> Child {
    command
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap()
}

fn with_long_scene() -> Folder {
    let folder = Folder::new();
    folder.write("long.ron", long_scene());
    folder
}

/// Starts a long render into `output`.
fn begun(folder: &Folder, output: &str) -> Child {
    let before = folder.names().len();
    let args = ["render", "long.ron", "--size", LONG_SIZE, "-o", output];
    let mut child = spawn(folder.strahl(args));
    until("a temporary file", || {
        assert!(child.try_wait().unwrap().is_none(), "ended early");
        folder.names().len() > before
    });
    child
}

#[test]
fn an_interrupted_render_leaves_nothing() {
    for name in ["INT", "TERM"] {
        for output in ["new.png", "new.ppm"] {
            let folder = with_long_scene();
            let child = begun(&folder, output);
            thread::sleep(Duration::from_millis(200));
            let start = Instant::now();
            signal(&child, name);
            let done = finish(child, b"");
            assert!(start.elapsed() < SOON, "{:?}", start.elapsed());
            assert_eq!(done.status, Some(130), "{}", done.stderr);
            assert!(done.stderr.lines().count() <= 1, "{}", done.stderr);
            done.no_panic();
            assert_eq!(folder.names(), ["long.ron"]);
        }
    }
}

#[test]
fn a_killed_render_leaves_the_old_picture_and_the_next_one_clears_up() {
    let folder = with_long_scene();
    folder.write("old.png", "old");
    for wait in [0, 50, 300] {
        let mut child = begun(&folder, "old.png");
        thread::sleep(Duration::from_millis(wait));
        signal(&child, "KILL");
        child.wait().unwrap();
        assert_eq!(fs::read(folder.path("old.png")).unwrap(), b"old");
        let names = folder.names();
        let left = names.iter().filter(|name| name.ends_with(".tmp")).count();
        assert_eq!((left, names.len()), (1, 3), "{names:?}");
        let args = ["render", "long.ron", "--size", "8x8", "-o", "old.png"];
        run(&mut folder.strahl(args)).quiet_success();
        assert_eq!(folder.names(), ["long.ron", "old.png"]);
        folder.write("old.png", "old");
    }
}

#[test]
fn an_interrupted_render_leaves_the_old_picture() {
    for name in ["INT", "TERM"] {
        let folder = with_long_scene();
        folder.write("old.png", "old");
        let child = begun(&folder, "old.png");
        signal(&child, name);
        let done = finish(child, b"");
        assert_eq!(done.status, Some(130), "{}", done.stderr);
        assert_eq!(fs::read(folder.path("old.png")).unwrap(), b"old");
        assert_eq!(folder.names(), ["long.ron", "old.png"]);
    }
}

#[test]
fn repeated_interrupts_count_as_one() {
    let folder = with_long_scene();
    let child = begun(&folder, "new.png");
    let id = child.id();
    let many = format!("for n in 1 2 3 4 5 6 7 8 9; do kill -INT {id}; done 2>/dev/null");
    run(&mut folder.shell(&many));
    let done = finish(child, b"");
    assert_eq!(done.status, Some(130), "{}", done.stderr);
    done.no_panic();
    assert_eq!(folder.names(), ["long.ron"]);
}

#[test]
fn an_interrupt_at_any_time_leaves_nothing() {
    let folder = with_long_scene();
    for round in 0..12_u32 {
        // Several processes at once, so that the system suspends each at places that it would
        // otherwise run through.
        let children: Vec<Child> = (0..8)
            .map(|n| {
                let output = format!("{n}.png");
                let args = ["render", "long.ron", "--size", "300x300", "-o", &output];
                spawn(folder.strahl(args))
            })
            .collect();
        thread::sleep(Duration::from_millis(6) * round);
        for mut child in children {
            signal(&child, "TERM");
            let status = child.wait().unwrap();
            // Until the program has set up its handler, the default one ends it.
            assert!(
                status.code() == Some(130) || status.signal() == Some(15) || status.success(),
                "{status}"
            );
        }
        let left: Vec<String> = folder.names();
        let left: Vec<&String> = left.iter().filter(|name| name.starts_with('.')).collect();
        assert!(left.is_empty(), "{left:?} in round {round}");
    }
}

/// Waits until the program handles SIGINT itself.
fn until_set_up(child: &Child) {
    let about = format!("/proc/{}/status", child.id());
    if !fs::exists(&about).unwrap_or(false) {
        return thread::sleep(Duration::from_secs(3));
    }
    until("a handler", || {
        let text = fs::read_to_string(&about).unwrap();
        let caught = text.lines().find_map(|line| line.strip_prefix("SigCgt:"));
        let caught = u64::from_str_radix(caught.unwrap().trim(), 16).unwrap();
        caught & 0b10 != 0
    });
}

#[test]
fn an_interrupt_ends_the_wait_for_standard_input() {
    for name in ["INT", "TERM"] {
        let folder = Folder::new();
        let mut child = spawn(folder.strahl(["render", "-", "-o", "a.png"]));
        until_set_up(&child);
        signal(&child, name);
        // The pipe to the program stays open throughout.
        let stdin = child.stdin.take();
        assert_eq!(wait(&mut child, SOON), Some(Some(130)), "{name}");
        drop(stdin);
        assert_eq!(folder.names(), [""; 0]);
    }
}

#[test]
fn an_interrupt_ends_the_wait_for_a_named_pipe() {
    let folder = Folder::with_scenes();
    let made = Command::new("mkfifo").arg(folder.path("fifo.png")).status();
    if !made.is_ok_and(|status| status.success()) {
        return crate::support::skip("there is no mkfifo");
    }
    let args = ["render", "scene.ron", "-o", "fifo.png"];
    let mut child = spawn(folder.strahl(args));
    until_set_up(&child);
    thread::sleep(Duration::from_millis(200));
    signal(&child, "INT");
    assert_eq!(wait(&mut child, SOON), Some(Some(130)));
    assert_eq!(folder.names(), ["fifo.png", "scene.json", "scene.ron"]);
}

#[test]
fn an_interrupted_picture_on_standard_output_is_exit_status_130() {
    let folder = with_long_scene();
    let args = ["render", "long.ron", "--size", LONG_SIZE, "-o", "-"];
    let mut child = spawn(folder.strahl(args));
    until_set_up(&child);
    thread::sleep(Duration::from_millis(500));
    signal(&child, "INT");
    assert_eq!(wait(&mut child, SOON), Some(Some(130)));
}

#[test]
fn a_killed_render_leaves_the_old_picture() {
    let folder = with_long_scene();
    folder.write("old.png", "old");
    let mut child = begun(&folder, "old.png");
    child.kill().unwrap();
    assert_eq!(child.wait().unwrap().signal(), Some(9));
    assert_eq!(fs::read(folder.path("old.png")).unwrap(), b"old");
    // Leftover files do not block the next picture.
    folder.write("scene.ron", RON);
    run(&mut folder.strahl(["render", "scene.ron", "-o", "old.png"])).quiet_success();
    assert!(fs::read(folder.path("old.png")).unwrap() != b"old");
}

#[test]
fn two_renders_of_one_picture_do_not_mix() {
    let folder = Folder::with_scenes();
    folder.write("other.ron", RON.replace("#ff0000", "#0000ff"));
    let picture = |scene: &str| {
        let args = ["render", scene, "--size", "300x200", "-o", "-"];
        run(&mut folder.strahl(args)).quiet_success()
    };
    let pictures = [picture("scene.ron"), picture("other.ron")];
    let children: Vec<Child> = (0..8)
        .map(|n| {
            let scene = if n % 2 == 0 { "scene.ron" } else { "other.ron" };
            spawn(folder.strahl(["render", scene, "--size", "300x200", "-o", "same.png"]))
        })
        .collect();
    for child in children {
        finish(child, b"").quiet_success();
    }
    let same = fs::read(folder.path("same.png")).unwrap();
    assert!(pictures.contains(&same));
    assert_eq!(
        folder.names(),
        ["other.ron", "same.png", "scene.json", "scene.ron"]
    );
}
