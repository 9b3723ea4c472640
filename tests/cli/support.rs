//! Helpers that run the program and check its results.

use std::{
    ffi::OsStr,
    fs,
    io::{Read, Write},
    path::{Path, PathBuf},
    process::{Child, Command, Stdio},
    thread,
    time::{Duration, Instant},
};

use tempfile::TempDir;

/// The program under test.
pub(crate) const STRAHL: &str = env!("CARGO_BIN_EXE_strahl");

/// No run takes this long, even on a slow machine.
const PATIENCE: Duration = Duration::from_secs(180);

/// A scene without any fault.
pub(crate) const RON: &str = r##"(
    image: (width: 32, height: 24),
    camera: Perspective(eye: (0, 0, 0), gaze: (0, 0, -1), fov: 90),
    background: (0, 0.2, 0.4),
    geometries: [
        Plane(point: (0, -1, 0), normal: (0, 1, 0), color: (0, 1, 0)),
        Sphere(center: (-1, 0, -3), radius: 0.5, color: "#ff0000"),
    ],
)
"##;

/// The same scene as [`RON`].
pub(crate) const JSON: &str = r##"{
    "image": {"width": 32, "height": 24},
    "camera": {"Perspective": {"eye": [0, 0, 0], "gaze": [0, 0, -1], "fov": 90}},
    "background": [0, 0.2, 0.4],
    "geometries": [
        {"Plane": {"point": [0, -1, 0], "normal": [0, 1, 0], "color": [0, 1, 0]}},
        {"Sphere": {"center": [-1, 0, -3], "radius": 0.5, "color": "#ff0000"}}
    ]
}
"##;

/// Returns a scene that takes long at any realistic size.
#[cfg(unix)]
pub(crate) fn long_scene() -> String {
    let mut scene = String::from(
        "(camera: Perspective(eye: (0, 0, 0), gaze: (0, 0, -1), fov: 90), geometries: [\n",
    );
    for index in 0..4000_u32 {
        let (x, y, z) = (index % 61, index * 7 % 53, index * 13 % 97);
        let (x, y, z) = (
            f64::from(x) - 30.0,
            f64::from(y) - 26.0,
            -40.0 - f64::from(z),
        );
        scene += &format!(
            "Sphere(center: ({x:?}, {y:?}, {z:?}), radius: 0.7, color: (0.5, 0.25, 1)),\n"
        );
    }
    scene + "])\n"
}

/// The size at which [`long_scene`] renders far longer than any test waits.
#[cfg(unix)]
pub(crate) const LONG_SIZE: &str = "100000x100000";

/// A temporary folder for one test.
pub(crate) struct Folder(TempDir);

impl Folder {
    pub(crate) fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    /// A folder with `scene.ron` and `scene.json` in it.
    pub(crate) fn with_scenes() -> Self {
        let folder = Self::new();
        folder.write("scene.ron", RON);
        folder.write("scene.json", JSON);
        folder
    }

    pub(crate) fn path(&self, name: impl AsRef<Path>) -> PathBuf {
        self.0.path().join(name)
    }

    pub(crate) fn write(&self, name: impl AsRef<Path>, bytes: impl AsRef<[u8]>) -> PathBuf {
        let path = self.path(name);
        fs::write(&path, bytes).unwrap();
        path
    }

    /// Returns every name in the folder, including hidden ones.
    pub(crate) fn names(&self) -> Vec<String> {
        let entries = fs::read_dir(self.0.path()).unwrap();
        let mut names: Vec<String> = entries
            .map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned())
            .collect();
        names.sort();
        names
    }

    /// Returns the command that runs the program with these arguments in this folder.
    pub(crate) fn strahl<A: AsRef<OsStr>>(&self, args: impl IntoIterator<Item = A>) -> Command {
        let mut command = Command::new(STRAHL);
        command.args(args);
        self.inside(command)
    }

    /// Returns the command that runs a shell script in this folder, where `$STRAHL` is the program.
    #[cfg(unix)]
    pub(crate) fn shell(&self, script: &str) -> Command {
        let mut command = Command::new("sh");
        command.arg("-c").arg(script).env("STRAHL", STRAHL);
        self.inside(command)
    }

    fn inside(&self, mut command: Command) -> Command {
        command
            .current_dir(self.0.path())
            .env_remove("NO_COLOR")
            .env_remove("CLICOLOR_FORCE")
            .env("RUST_BACKTRACE", "1");
        command
    }
}

/// The result of a run.
#[derive(Debug)]
pub(crate) struct Done {
    /// The exit status; `None` if a signal ended the program.
    pub(crate) status: Option<i32>,
    pub(crate) stdout: Vec<u8>,
    pub(crate) stderr: String,
}

/// Runs a command to its end, without anything on standard input.
#[track_caller]
pub(crate) fn run(command: &mut Command) -> Done {
    run_with(command, b"")
}

/// Runs a command to its end, with `input` on standard input.
#[track_caller]
pub(crate) fn run_with(command: &mut Command, input: &[u8]) -> Done {
    let child = command
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    finish(child, input)
}

/// Waits for the end of a child whose three streams are pipes.
#[track_caller]
pub(crate) fn finish(mut child: Child, input: &[u8]) -> Done {
    let (stdin, stdout, stderr) = (child.stdin.take(), child.stdout.take(), child.stderr.take());
    let input = input.to_owned();
    // The program may end before it has read all input.
    let feeder = thread::spawn(move || stdin.map(|mut stdin| stdin.write_all(&input)));
    let stdout = thread::spawn(move || read_all(stdout));
    let stderr = thread::spawn(move || read_all(stderr));
    let status = wait(&mut child, PATIENCE).expect("the program did not end");
    let _ = feeder.join().unwrap();
    let stderr = String::from_utf8(stderr.join().unwrap()).expect("stderr is UTF-8");
    Done {
        status,
        stdout: stdout.join().unwrap(),
        stderr,
    }
}

fn read_all(stream: Option<impl Read>) -> Vec<u8> {
    let mut bytes = Vec::new();
    if let Some(mut stream) = stream {
        stream.read_to_end(&mut bytes).unwrap();
    }
    bytes
}

/// Returns the exit status of a child (`Some(None)` if a signal ended it), or `None` if it does not
/// end in time.
pub(crate) fn wait(child: &mut Child, patience: Duration) -> Option<Option<i32>> {
    let start = Instant::now();
    while start.elapsed() < patience {
        if let Some(status) = child.try_wait().unwrap() {
            return Some(status.code());
        }
        thread::sleep(Duration::from_millis(5));
    }
    child.kill().unwrap();
    child.wait().unwrap();
    None
}

/// Waits until a condition holds.
#[cfg(unix)]
#[track_caller]
pub(crate) fn until(what: &str, mut holds: impl FnMut() -> bool) {
    let start = Instant::now();
    while !holds() {
        assert!(start.elapsed() < PATIENCE, "timed out: {what}");
        thread::sleep(Duration::from_millis(2));
    }
}

impl Done {
    /// Asserts success without any output.
    #[track_caller]
    pub(crate) fn quiet_success(self) -> Vec<u8> {
        assert_eq!(self.status, Some(0), "stderr: {}", self.stderr);
        assert_eq!(self.stderr, "");
        self.stdout
    }

    /// Asserts this status and a one-line message that contains all of `words`.
    #[track_caller]
    pub(crate) fn one_line(&self, status: i32, words: &[&str]) {
        self.failure(status, words);
        let lines: Vec<&str> = self.stderr.lines().collect();
        assert_eq!(lines.len(), 1, "more than one line: {}", self.stderr);
        assert!(self.stderr.starts_with("error: "), "{}", self.stderr);
        assert!(self.stderr.ends_with('\n'), "{}", self.stderr);
    }

    /// Asserts this status and a message, of any length, that contains all of `words`.
    #[track_caller]
    pub(crate) fn failure(&self, status: i32, words: &[&str]) {
        let stderr = &self.stderr;
        assert_eq!(self.status, Some(status), "stderr: {stderr}");
        assert!(self.stdout.is_empty(), "standard output of a failed run");
        assert!(!stderr.is_empty(), "no message");
        for word in words {
            assert!(stderr.contains(word), "no {word:?} in: {stderr}");
        }
        self.no_panic();
    }

    /// Asserts that a scene was rejected with a message that names the file and contains all of
    /// `words`.
    #[track_caller]
    pub(crate) fn bad_scene(&self, file: &str, words: &[&str]) {
        self.failure(1, words);
        let stderr = &self.stderr;
        assert!(stderr.contains(file), "no {file:?} in: {stderr}");
        assert!(stderr.contains("error["), "no code in: {stderr}");
    }

    #[track_caller]
    pub(crate) fn no_panic(&self) {
        let rust = [
            "panicked",
            "RUST_BACKTRACE",
            "stack backtrace",
            "os error",
            "src/",
        ];
        for word in rust {
            assert!(!self.stderr.contains(word), "{}", self.stderr);
        }
    }
}

/// Prints the reason why a test was skipped.
#[cfg(unix)]
pub(crate) fn skip(reason: &str) {
    println!("skipped: {reason}");
}

/// Returns true if a program is installed.
#[cfg(unix)]
pub(crate) fn has(program: &str) -> bool {
    let found = Command::new("sh")
        .arg("-c")
        .arg(format!("command -v {program}"))
        .output();
    found.is_ok_and(|found| found.status.success())
}
