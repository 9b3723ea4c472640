//! Behavior on a terminal.

use std::{
    io::{Read, Write},
    process::{Child, Stdio},
    sync::{Arc, Mutex},
    thread,
};

use crate::support::{Folder, LONG_SIZE, finish, has, long_scene, run, skip, until, wait};

/// A command on its own terminal, and its output so far.
struct Terminal {
    child: Child,
    shown: Arc<Mutex<Vec<u8>>>,
}

impl Terminal {
    /// Returns `None` if no program can create a terminal.
    fn open(folder: &Folder, command: &str) -> Option<Self> {
        let works = has("script") && {
            let mut trial = folder.shell("script -qefc 'exit 7' /dev/null");
            run(&mut trial).status == Some(7)
        };
        if !works {
            skip("no `script` of util-linux");
            return None;
        }
        let mut script = folder.shell("exec script -qefc \"$COMMAND\" /dev/null");
        let child = script
            .env("COMMAND", format!("exec \"$STRAHL\" {command}"))
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn();
        let mut child = child.unwrap();
        let shown = Arc::new(Mutex::new(Vec::new()));
        let mut stdout = child.stdout.take().unwrap();
        let sink = Arc::clone(&shown);
        thread::spawn(move || {
            let mut buffer = [0; 4096];
            while let Ok(count @ 1..) = stdout.read(&mut buffer) {
                sink.lock().unwrap().extend_from_slice(&buffer[..count]);
            }
        });
        Some(Self { child, shown })
    }

    fn shown(&self) -> String {
        String::from_utf8_lossy(&self.shown.lock().unwrap()).into_owned()
    }

    fn press(&mut self, key: u8) {
        let stdin = self.child.stdin.as_mut().unwrap();
        stdin.write_all(&[key]).unwrap();
        stdin.flush().unwrap();
    }

    fn wait(&mut self) -> Option<i32> {
        wait(&mut self.child, std::time::Duration::from_secs(60)).expect("it does not end")
    }
}

const CTRL_C: u8 = 3;
const CTRL_D: u8 = 4;

#[test]
fn a_bar_shows_after_a_while_and_ctrl_c_ends_it() {
    let folder = Folder::new();
    folder.write("long.ron", long_scene());
    for options in ["", "--progress always"] {
        let command = format!("render long.ron --size {LONG_SIZE} {options} -o a.png");
        let Some(mut terminal) = Terminal::open(&folder, &command) else {
            return;
        };
        until("a bar", || terminal.shown().contains('%'));
        assert!(terminal.shown().contains('['), "{}", terminal.shown());
        terminal.press(CTRL_C);
        assert_eq!(terminal.wait(), Some(130), "{}", terminal.shown());
        assert_eq!(folder.names(), ["long.ron"]);
    }
}

#[test]
fn no_bar_shows_if_turned_off() {
    let folder = Folder::new();
    folder.write("long.ron", long_scene());
    for options in ["--progress never", "-q", "-q --progress always"] {
        let command = format!("render long.ron --size {LONG_SIZE} {options} -o a.png");
        let Some(mut terminal) = Terminal::open(&folder, &command) else {
            return;
        };
        until("a temporary file", || folder.names().len() > 1);
        thread::sleep(std::time::Duration::from_millis(2500));
        assert_eq!(terminal.shown(), "", "{options}");
        terminal.press(CTRL_C);
        assert_eq!(terminal.wait(), Some(130));
    }
}

#[test]
fn short_work_shows_no_bar() {
    let folder = Folder::with_scenes();
    // On a busy machine even this may take longer than a second.
    let mut shown = String::new();
    for _ in 0..10 {
        let Some(mut terminal) = Terminal::open(&folder, "render scene.ron") else {
            return;
        };
        assert_eq!(terminal.wait(), Some(0), "{}", terminal.shown());
        shown = terminal.shown();
        if !shown.contains('%') {
            break;
        }
    }
    assert_eq!(shown, "wrote scene.png (32x24)\r\n");
    assert!(folder.path("scene.png").is_file());
    let mut quiet = Terminal::open(&folder, "render -q scene.ron").unwrap();
    assert_eq!(quiet.wait(), Some(0));
    assert_eq!(quiet.shown(), "");
}

#[test]
fn a_pipe_gets_no_bar_unless_requested() {
    let folder = Folder::new();
    folder.write("long.ron", long_scene());
    let render = |progress: &str| {
        let args = [
            "render",
            "long.ron",
            "--size",
            LONG_SIZE,
            "--progress",
            progress,
            "-o",
            "a.png",
        ];
        let mut command = folder.strahl(args);
        let child = command
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn();
        let mut child = child.unwrap();
        until("a temporary file", || {
            assert!(child.try_wait().unwrap().is_none(), "ended early");
            folder.names().len() > 1
        });
        thread::sleep(std::time::Duration::from_millis(2500));
        let id = child.id();
        run(&mut folder.shell(&format!("kill -INT {id}")));
        let done = finish(child, b"");
        assert_eq!(done.status, Some(130));
        assert!(done.stdout.is_empty());
        done.stderr
    };
    assert!(!render("auto").contains('%'));
    assert!(!render("never").contains('%'));
    let always = render("always");
    assert!(
        always.contains('%'),
        "no bar although it was asked for: {always:?}"
    );
}

#[test]
fn no_picture_goes_to_a_terminal() {
    let folder = Folder::with_scenes();
    for command in [
        "render scene.ron -o -",
        "render scene.ron -o - --image-format ppm",
    ] {
        let Some(mut terminal) = Terminal::open(&folder, command) else {
            return;
        };
        assert_eq!(terminal.wait(), Some(2));
        until("a message", || terminal.shown().ends_with('\n'));
        let shown = terminal.shown();
        assert!(
            shown.starts_with("error: ") && shown.contains("terminal"),
            "{shown}"
        );
        assert_eq!(shown.lines().count(), 1, "{shown}");
    }
}

#[test]
fn a_scene_can_be_typed() {
    let folder = Folder::new();
    let Some(mut terminal) = Terminal::open(&folder, "render - -o a.png") else {
        return;
    };
    until("a hint", || terminal.shown().contains("Ctrl-D"));
    for key in crate::support::RON.bytes() {
        terminal.press(key);
    }
    terminal.press(CTRL_D);
    assert_eq!(terminal.wait(), Some(0), "{}", terminal.shown());
    assert!(folder.path("a.png").is_file());
}
