//! The settings of docs/editors.md, in the editors themselves: each gets the block of the manual as
//! its only file in a new home, and has to show the fault of a scene. They run with `STRAHL_FULL`; an editor that
//! is missing is reported as ignored. `NVIM` names another Neovim.

use std::{
    env,
    ffi::OsString,
    fs,
    path::Path,
    process::{Command, Stdio},
};

use libtest_mimic::{Arguments, Failed, Trial};

const MANUAL: &str = "docs/editors.md";

const SCENE: &str = r##"(
    camera: Perspective(eye: (0, 0, 9), gaze: (0, 0, -1), fov: 60),
    geometries: [Sphere(center: (0, 0, 0), radus: 1, color: "#ffd700")],
)
"##;

fn main() {
    env::set_current_dir(env!("CARGO_MANIFEST_DIR")).unwrap();
    let nvim = env::var_os("NVIM").unwrap_or_else(|| "nvim".into());
    let trials = vec![
        trial("neovim", nvim, neovim),
        trial("emacs", "emacs".into(), emacs),
        Trial::test("helix", helix),
        Trial::test("zed", zed),
    ];
    libtest_mimic::run(&Arguments::from_args(), trials).exit();
}

/// Creates the trial of an editor, which is ignored if the editor is missing.
fn trial(name: &str, program: OsString, run: fn(&Path, &str) -> Result<(), Failed>) -> Trial {
    let version = Command::new(&program).arg("--version").output();
    let version = version.ok().filter(|output| output.status.success());
    let is_missing = version.is_none() || env::var_os("STRAHL_FULL").is_none();
    let version = version.map(|output| String::from_utf8_lossy(&output.stdout).into_owned());
    let run = move || run(Path::new(&program), &version.unwrap_or_default());
    Trial::test(name, run).with_ignored_flag(is_missing)
}

/// Returns the block of the manual that follows a line with this beginning, and the path that the
/// line ends with.
fn block(beginning: &str) -> Result<(String, String), Failed> {
    let manual = fs::read_to_string(MANUAL)?;
    let mut lines = manual.lines();
    let missing = || format!("{MANUAL} has no line `{beginning}…` with a path");
    let line = lines
        .find(|line| line.starts_with(beginning))
        .ok_or_else(missing)?;
    let path = line
        .strip_suffix("`:")
        .and_then(|line| line.rsplit_once("`~/"));
    let (_, path) = path.ok_or_else(missing)?;
    let text = lines.skip_while(|line| !line.starts_with("```")).skip(1);
    let text: Vec<_> = text.take_while(|line| *line != "```").collect();
    Ok((path.to_owned(), text.join("\n") + "\n"))
}

/// Runs an editor in a new home with the settings of a block and a scene; returns what it prints.
fn run(program: &Path, beginning: &str, arguments: &[&str]) -> Result<String, Failed> {
    let home = tempfile::tempdir()?;
    let (path, text) = block(beginning)?;
    let settings = home.path().join(path);
    fs::create_dir_all(settings.parent().unwrap())?;
    fs::write(settings, text)?;
    fs::write(home.path().join("scene.ron"), SCENE)?;
    let folder = Path::new(env!("CARGO_BIN_EXE_strahl")).parent().unwrap();
    let path = env::join_paths(
        [folder.to_owned()]
            .into_iter()
            .chain(env::split_paths(&env::var_os("PATH").unwrap_or_default())),
    )?;
    let output = Command::new(program)
        .args(arguments)
        .current_dir(home.path())
        .env("HOME", home.path())
        .env("PATH", path)
        .env(
            "TESTS",
            Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/editors"),
        )
        .env_remove("XDG_CONFIG_HOME")
        .env_remove("XDG_STATE_HOME")
        .env_remove("XDG_DATA_HOME")
        .env_remove("XDG_CACHE_HOME")
        .stdin(Stdio::null())
        .output()?;
    let printed = [output.stdout, output.stderr].concat();
    Ok(String::from_utf8_lossy(&printed).into_owned())
}

fn shows(printed: &str, expected: &[&str]) -> Result<(), Failed> {
    for part in expected {
        if !printed.contains(part) {
            return Err(format!("`{part}` is missing in:\n{printed}").into());
        }
    }
    Ok(())
}

fn neovim(program: &Path, version: &str) -> Result<(), Failed> {
    let minor = version
        .strip_prefix("NVIM v0.")
        .and_then(|rest| rest.split('.').next());
    let minor: u32 = minor
        .ok_or_else(|| format!("unknown: {version}"))?
        .parse()?;
    let beginning = if minor >= 11 {
        "Neovim 0.11"
    } else {
        "Neovim 0.7"
    };
    let check = "execute 'luafile' $TESTS . '/neovim.lua'";
    let printed = run(
        program,
        beginning,
        &["--headless", "scene.ron", "-c", check],
    )?;
    shows(
        &printed,
        &[
            "filetype: ron",
            "unknown field `radus`",
            "above 0, below 180",
        ],
    )
}

fn emacs(program: &Path, _version: &str) -> Result<(), Failed> {
    let check = r#"(load (concat (getenv "TESTS") "/emacs.el"))"#;
    let arguments = ["--batch", "--load", "~/.emacs.d/init.el", "--eval", check];
    let printed = run(program, "In `~/.emacs.d", &arguments)?;
    shows(
        &printed,
        &[
            "mode: ron-mode",
            "unknown field `radus`",
            "above 0, below 180",
        ],
    )
}

/// The settings of Helix are TOML, and define a server for both languages.
fn helix() -> Result<(), Failed> {
    let (_, text) = block("In `~/.config/helix")?;
    toml::de::DeTable::parse(&text)?;
    shows(&text, &["command = \"strahl\"", "args = [\"lsp\"]"])?;
    for language in ["ron", "json"] {
        let expected = format!("name = \"{language}\"\nlanguage-servers = [\"strahl\"");
        shows(&text, &[&expected])?;
    }
    Ok(())
}

/// The extension for Zed has the version and the address of the program.
fn zed() -> Result<(), Failed> {
    let version = concat!("\nversion = \"", env!("CARGO_PKG_VERSION"), "\"\n");
    let address = concat!("\nrepository = \"", env!("CARGO_PKG_REPOSITORY"), "\"\n");
    for (name, expected) in [
        ("extension.toml", &[version, address][..]),
        ("Cargo.toml", &[version]),
    ] {
        let text = fs::read_to_string(Path::new("editors/zed").join(name))?;
        toml::de::DeTable::parse(&text)?;
        shows(&text, expected)?;
    }
    Ok(())
}
