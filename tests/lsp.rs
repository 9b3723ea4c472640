//! The language server, with clients: recorded sessions, one that edits at random, and Neovim.

#[path = "lsp/client.rs"]
mod client;
#[path = "lsp/formatting.rs"]
mod formatting;
#[path = "lsp/lifecycle.rs"]
mod lifecycle;
#[path = "lsp/long.rs"]
mod long;
#[path = "lsp/random.rs"]
mod random;
#[path = "lsp/scenarios.rs"]
mod scenarios;
#[path = "lsp/sessions.rs"]
mod sessions;

use std::{
    env, fs,
    path::PathBuf,
    process::{Command, Stdio},
};

use libtest_mimic::{Arguments, Failed, Trial};
use strahl::text::Columns;

/// The number of random edits, unless `STRAHL_CASES` says otherwise.
const EDITS: usize = 2000;

fn main() {
    env::set_current_dir(env!("CARGO_MANIFEST_DIR")).unwrap();
    let mut trials = Vec::new();
    let files = fs::read_dir("tests/lsp/sessions").unwrap();
    let mut files: Vec<PathBuf> = files.map(|file| file.unwrap().path()).collect();
    files.sort();
    for path in files {
        let name = format!("session {}", path.file_stem().unwrap().display());
        trials.push(Trial::test(name, move || sessions::run(&path)));
    }
    trials.extend(scenarios::all());
    trials.extend(lifecycle::all());
    trials.push(Trial::test("diagnostics of a long scene", long::pulled));
    let memory = Trial::test("the memory of formatting", formatting::memory);
    trials.push(memory.with_ignored_flag(!cfg!(target_os = "linux")));
    let count = env::var("STRAHL_CASES")
        .ok()
        .and_then(|count| count.parse().ok());
    let count = count.unwrap_or(EDITS);
    let encodings = [
        ("utf-8", Columns::Bytes),
        ("utf-16", Columns::Utf16),
        ("utf-32", Columns::Characters),
    ];
    for (encoding, columns) in encodings {
        let name = format!("random edits in {encoding}");
        trials.push(Trial::test(name, move || {
            random::run(encoding, columns, count)
        }));
        let name = format!("the text after random edits in {encoding}");
        trials.push(Trial::test(name, move || {
            random::text(encoding, columns, count)
        }));
        let name = format!("formatting of random lines in {encoding}");
        trials.push(Trial::test(name, move || {
            formatting::run(encoding, columns, (count / 20).max(20))
        }));
        let name = format!("random edits of a long text in {encoding}");
        trials.push(Trial::test(name, move || {
            long::run(encoding, columns, (count / 400).max(20))
        }));
    }
    let nvim = Command::new("nvim")
        .arg("--version")
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .status();
    let is_missing = !nvim.is_ok_and(|status| status.success());
    for (ending, scene, begin) in [("ron", RON, "back"), ("json", JSON, "\"back")] {
        let trial = Trial::test(format!("neovim with {ending}"), move || {
            neovim(ending, scene, begin)
        });
        trials.push(trial.with_ignored_flag(is_missing));
    }
    libtest_mimic::run(&Arguments::from_args(), trials).exit();
}

const RON: &str = r##"(
    camera: Perspective(eye: (0, 0, 9), gaze: (0, 0, -1), fov: 400),
    materials: {"gold": Mirror(color: "#ffd700")},
    geometries: [Sphere(center: (0, 0, 0),
        radus: 1, material: Named("gold"))],
)
"##;

const JSON: &str = r##"{
    "camera": {"Perspective": {"eye": [0, 0, 9], "gaze": [0, 0, -1], "fov": 400}},
    "materials": {"gold": {"Mirror": {"color": "#ffd700"}}},
    "geometries": [{"Sphere": {"center": [0, 0, 0],
        "radus": 1, "material": {"Named": "gold"}}}]
}
"##;

/// Opens a scene in Neovim, which checks what it gets.
fn neovim(ending: &str, scene: &str, begin: &str) -> Result<(), Failed> {
    let folder = tempfile::tempdir()?;
    let path = folder.path().join(format!("scene.{ending}"));
    fs::write(&path, scene)?;
    let output = Command::new("nvim")
        .args([
            "--headless",
            "--clean",
            "-c",
            "luafile tests/lsp/neovim.lua",
        ])
        .env("STRAHL", env!("CARGO_BIN_EXE_strahl"))
        .env("FOLDER", folder.path())
        .env("ENDING", ending)
        .env("BEGIN", begin)
        .env("XDG_STATE_HOME", folder.path())
        .env("XDG_CACHE_HOME", folder.path())
        .stdin(Stdio::null())
        .output()?;
    if !output.status.success() {
        return Err(String::from_utf8_lossy(&output.stderr).into_owned().into());
    }
    let text = fs::read_to_string(path)?;
    let scene = strahl::Document::from_text("", text.as_str(), strahl::Syntax::of_text(&text));
    let is_right = text.contains("brass") && scene.format().as_deref() == Some(&*text);
    match is_right {
        true => Ok(()),
        false => Err(format!("not formatted: {text}").into()),
    }
}
