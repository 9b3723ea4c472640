//! `strahl watch`, and what `strahl validate --watch` shares with it.

use std::{
    fs,
    io::Read,
    os::unix::fs::symlink,
    process::{Child, Command, Stdio},
    sync::{Arc, Mutex},
    thread,
};

use crate::support::{Folder, RON, long_scene, run, until, wait};

/// A program that watches, and what it has printed so far.
pub(crate) struct Watching {
    child: Child,
    stdout: Arc<Mutex<String>>,
    stderr: Arc<Mutex<String>>,
}

fn collect(stream: Option<impl Read + Send + 'static>) -> Arc<Mutex<String>> {
    let text = Arc::new(Mutex::new(String::new()));
    let shared = Arc::clone(&text);
    thread::spawn(move || {
        let (mut stream, mut bytes) = (stream.unwrap(), [0; 4096]);
        while let Ok(count @ 1..) = stream.read(&mut bytes) {
            let new = String::from_utf8_lossy(&bytes[..count]);
            shared.lock().unwrap().push_str(&new);
        }
    });
    text
}

impl Watching {
    pub(crate) fn new(mut command: Command) -> Self {
        let mut child = command
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        Self {
            stdout: collect(child.stdout.take()),
            stderr: collect(child.stderr.take()),
            child,
        }
    }

    pub(crate) fn stdout(&self) -> String {
        self.stdout.lock().unwrap().clone()
    }

    pub(crate) fn stderr(&self) -> String {
        self.stderr.lock().unwrap().clone()
    }

    /// Does something, and waits until these words are printed on standard error after it.
    #[track_caller]
    pub(crate) fn expect(&mut self, words: &str, act: impl FnOnce()) {
        let before = self.stderr().len();
        act();
        until(&format!("{words:?} after: {}", self.stderr()), || {
            assert!(
                self.child.try_wait().unwrap().is_none(),
                "{}",
                self.stderr()
            );
            self.stderr()[before..].contains(words)
        });
    }

    /// Interrupts the program.
    #[track_caller]
    pub(crate) fn end(mut self) -> String {
        let id = self.child.id().to_string();
        assert!(
            Command::new("kill")
                .args(["-INT", &id])
                .status()
                .unwrap()
                .success()
        );
        let status = wait(&mut self.child, std::time::Duration::from_secs(60));
        assert_eq!(status, Some(Some(130)), "{}", self.stderr());
        assert!(!self.stderr().contains("panicked"), "{}", self.stderr());
        self.stderr()
    }
}

impl Drop for Watching {
    fn drop(&mut self) {
        // A test that failed leaves nothing running.
        let _ = self.child.kill();
    }
}

/// Starts to watch a scene; returns once it was drawn for the first time, or could not be.
fn watch(folder: &Folder, args: &[&str], words: &str) -> Watching {
    let mut watching = Watching::new(folder.strahl(["watch"].iter().chain(args)));
    until(&format!("the first {words:?}"), || {
        watching.stderr().contains(words)
    });
    assert!(watching.child.try_wait().unwrap().is_none());
    watching
}

#[test]
fn each_save_is_drawn_and_a_broken_scene_keeps_the_picture() {
    let folder = Folder::with_scenes();
    let args = [
        "scene.ron",
        "-o",
        "a.png",
        "--size",
        "40x30",
        "--samples",
        "4",
    ];
    let mut watching = watch(&folder, &args, "wrote a.png (40x30) in ");
    let picture = || fs::read(folder.path("a.png")).unwrap();
    let rendered = |scene: &str| {
        let args = [
            "render",
            scene,
            "-o",
            "b.png",
            "--size",
            "40x30",
            "--samples",
            "4",
        ];
        run(&mut folder.strahl(args)).quiet_success();
        fs::read(folder.path("b.png")).unwrap()
    };
    let first = picture();
    assert_eq!(first, rendered("scene.ron"));
    watching.expect("wrote a.png", || {
        folder.write("scene.ron", RON.replace("#ff0000", "#0000ff"));
    });
    let second = picture();
    assert!(second != first);
    assert_eq!(second, rendered("scene.ron"));
    watching.expect("waiting for changes", || {
        folder.write("scene.ron", RON.replace("radius", "radios"));
    });
    let stderr = watching.stderr();
    assert!(stderr.contains("error[unknown-field]"), "{stderr}");
    assert!(stderr.contains("scene.ron:"), "{stderr}");
    assert_eq!(picture(), second);
    watching.expect("wrote a.png", || {
        folder.write("scene.ron", RON);
    });
    assert_eq!(picture(), first);
    assert_eq!(watching.stdout(), "");
    watching.end();
    assert_eq!(
        folder.names(),
        ["a.png", "b.png", "scene.json", "scene.ron"]
    );
}

#[test]
fn editors_replace_remove_and_link_files() {
    let folder = Folder::with_scenes();
    let mut watching = watch(&folder, &["scene.ron"], "wrote scene.png");
    watching.expect("wrote scene.png", || {
        folder.write("new", RON);
        fs::rename(folder.path("new"), folder.path("scene.ron")).unwrap();
    });
    watching.expect("no such file", || {
        fs::remove_file(folder.path("scene.ron")).unwrap()
    });
    watching.expect("wrote scene.png", || {
        folder.write("scene.ron", RON);
    });
    fs::create_dir(folder.path("real")).unwrap();
    folder.write("real/other.ron", RON);
    watching.expect("wrote scene.png", || {
        symlink("real/other.ron", folder.path("link")).unwrap();
        fs::rename(folder.path("link"), folder.path("scene.ron")).unwrap();
    });
    watching.expect("wrote scene.png", || {
        folder.write("real/other.ron", RON);
    });
    watching.end();
}

#[test]
fn tables_are_watched_even_before_they_exist() {
    let folder = Folder::new();
    let table = "Spheres(file: \"data/atoms.csv\", radius: 1, color: \"#f00\"),\n]";
    folder.write("scene.ron", RON.replace("    ]", table));
    let mut watching = watch(&folder, &["scene.ron"], "waiting for changes");
    assert!(
        watching.stderr().contains("file-not-found"),
        "{}",
        watching.stderr()
    );
    watching.expect("waiting for changes", || {
        fs::create_dir(folder.path("data")).unwrap()
    });
    let mut pictures = Vec::new();
    for x in ["0", "1"] {
        watching.expect("wrote scene.png", || {
            folder.write("data/atoms.csv", format!("x,y,z\n{x},0,-5\n"));
        });
        pictures.push(fs::read(folder.path("scene.png")).unwrap());
    }
    // A write in two parts may be drawn twice, but in the end the picture is of the whole table.
    until("another picture", || {
        pictures[0] != fs::read(folder.path("scene.png")).unwrap()
    });
    watching.end();
}

#[test]
fn mesh_files_and_tables_of_copies_are_watched() {
    let folder = Folder::new();
    let more = "Mesh(file: \"wall.obj\", color: \"#0f0\", name: \"wall\"),\n\
                Instances(of: \"wall\", file: \"places.csv\"),\n]";
    folder.write("scene.ron", RON.replace("    ]", more));
    let wall = |x: i32| format!("v -1 -1 -4\nv {x} -1 -4\nv 0 1 -4\nf 1 2 3\n");
    let places = |x: f64| format!("x,y,z\n{x},0,0.5\n");
    folder.write("wall.obj", wall(1));
    folder.write("places.csv", places(0.5));
    let mut watching = watch(&folder, &["scene.ron"], "wrote scene.png");
    let picture = || fs::read(folder.path("scene.png")).unwrap();
    let first = picture();
    watching.expect("wrote scene.png", || {
        folder.write("wall.obj", wall(2));
    });
    until("another wall", || picture() != first);
    let second = picture();
    watching.expect("wrote scene.png", || {
        folder.write("places.csv", places(-0.5));
    });
    until("another place", || picture() != second);
    watching.end();
}

#[test]
fn a_configuration_takes_effect_when_it_changes() {
    let folder = Folder::new();
    let twice = "geometries: [\nSphere(center: (-1, 0, -3), radius: 0.5, color: \"#ff0000\"),";
    fs::create_dir(folder.path("deep")).unwrap();
    folder.write("deep/scene.ron", RON.replace("geometries: [", twice));
    folder.write("strahl.toml", "");
    let mut watching = watch(&folder, &["deep/scene.ron"], "wrote scene.png");
    assert!(watching.stderr().contains("warning[duplicate-geometry]"));
    watching.expect("error[duplicate-geometry]", || {
        folder.write("strahl.toml", "deny = [\"warnings\"]\n");
    });
    watching.expect("wrote scene.png", || {
        folder.write("deep/strahl.toml", "");
    });
    watching.expect("error[duplicate-geometry]", || {
        fs::remove_file(folder.path("deep/strahl.toml")).unwrap();
    });
    watching.end();
}

#[test]
fn a_fault_of_an_option_is_printed_each_time() {
    let folder = Folder::with_scenes();
    let args = ["scene.ron", "--set", "camera.fov=1000"];
    let mut watching = watch(&folder, &args, "waiting for changes");
    assert!(watching.stderr().contains("--set camera.fov"));
    watching.expect("--set camera.fov", || {
        folder.write("scene.ron", RON);
    });
    watching.end();
}

/// A scene that takes long at its own size.
fn large_scene() -> String {
    long_scene().replacen('(', "(image: (width: 60000, height: 60000),\n", 1)
}

#[test]
fn a_save_cancels_the_picture_in_flight() {
    let folder = Folder::new();
    folder.write("scene.ron", large_scene());
    let mut watching = Watching::new(folder.strahl(["watch", "scene.ron"]));
    until("a temporary file", || folder.names().len() > 1);
    watching.expect("wrote scene.png (32x24)", || {
        folder.write("scene.ron", RON);
    });
    assert!(
        !watching.stderr().contains("60000"),
        "{}",
        watching.stderr()
    );
    assert_eq!(folder.names(), ["scene.png", "scene.ron"]);
    watching.end();
}

#[test]
fn an_interrupt_leaves_the_old_picture_and_nothing_else() {
    let folder = Folder::new();
    folder.write("scene.ron", large_scene());
    folder.write("scene.png", "old");
    let watching = Watching::new(folder.strahl(["watch", "scene.ron"]));
    until("a temporary file", || folder.names().len() > 2);
    watching.end();
    assert_eq!(folder.names(), ["scene.png", "scene.ron"]);
    assert_eq!(fs::read(folder.path("scene.png")).unwrap(), b"old");
}

#[test]
fn a_burst_of_saves_is_few_pictures() {
    let folder = Folder::with_scenes();
    let mut watching = watch(&folder, &["scene.ron"], "wrote scene.png");
    watching.expect("wrote scene.png (8x6)", || {
        for _ in 0..500 {
            folder.write("scene.ron", RON);
        }
        folder.write("scene.ron", RON.replace("32", "8").replace("24", "6"));
    });
    let stderr = watching.end();
    assert!(stderr.lines().count() < 100, "{stderr}");
}

#[test]
fn a_full_disk_does_not_end_it() {
    let folder = Folder::new();
    folder.write("scene.ron", RON.replace("32", "4000").replace("24", "3000"));
    let mut watching = Watching::new(folder.shell("ulimit -f 8; exec $STRAHL watch scene.ron"));
    until("an error", || {
        watching.stderr().contains("waiting for changes")
    });
    assert!(
        watching.stderr().contains("error: scene.png"),
        "{}",
        watching.stderr()
    );
    watching.expect("wrote scene.png", || {
        folder.write("scene.ron", RON);
    });
    watching.end();
}

#[test]
fn it_ends_when_nobody_reads_it() {
    let folder = Folder::with_scenes();
    for args in [
        &["watch", "scene.ron"][..],
        &["validate", "--watch", "scene.ron"],
    ] {
        let mut command = folder.strahl(args);
        let child = command.stdout(Stdio::null()).stderr(Stdio::piped()).spawn();
        let (stdout, stderr) = (Arc::default(), Arc::default());
        let mut watching = Watching {
            child: child.unwrap(),
            stdout,
            stderr,
        };
        let mut first = [0];
        let mut pipe = watching.child.stderr.take().unwrap();
        pipe.read_exact(&mut first).unwrap();
        drop(pipe);
        let mut ended = None;
        until("the end", || {
            folder.write("scene.ron", RON);
            ended = watching.child.try_wait().unwrap();
            ended.is_some()
        });
        assert_eq!(ended.unwrap().code(), Some(0), "{args:?}");
    }
}

#[test]
fn a_wrong_command_ends_at_once() {
    let folder = Folder::with_scenes();
    folder.write("rows.csv", "camera.fov\n30\n");
    for (args, words) in [
        ("watch - -o a.png", "standard input"),
        ("watch scene.ron -o -", "-o"),
        ("watch scene.ron -o a.foo", ".foo"),
        ("watch scene.ron -o scene.ron", "scene.ron"),
        ("watch scene.ron -o missing/a.png", "missing"),
        ("watch scene.ron --camera x", "unknown camera"),
        ("watch scene.ron --set fog=1", "unknown field `fog`"),
        ("watch missing.ron", "missing.ron"),
        ("watch .", "folder"),
        ("watch scene.ron -o a.apng --frame 1", "--frame"),
        ("watch", "<SCENE>"),
        ("validate --watch -", "standard input"),
        ("validate --watch --files-from -", "standard input"),
        ("validate --watch --fix scene.ron", "--fix"),
        ("validate --watch --diff scene.ron", "--diff"),
        ("validate --watch --output-format junit scene.ron", "junit"),
        ("validate --watch --output-format sarif scene.ron", "sarif"),
        ("validate --watch --exclude [ .", "pattern"),
    ] {
        run(&mut folder.strahl(args.split(' '))).failure(2, &[words]);
    }
    let done = run(&mut folder.strahl(["validate", "--watch", "missing.ron"]));
    assert_eq!(done.status, Some(2));
    assert_eq!(folder.names(), ["rows.csv", "scene.json", "scene.ron"]);
}
