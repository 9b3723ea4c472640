//! Runs every command of the README and of docs/, and compares every sample output.
//!
//! Each page is a separate test: its blocks run from top to bottom in a new folder with the files
//! of a fresh clone. A block that follows a line ending with a name such as `` `first.ron`: `` is
//! the content of that file. A `text` block is compared with the output of the preceding block of
//! commands, or of its own commands, on lines that begin with `$ `; a line `…` stands for any
//! lines. A command that runs until Ctrl-C is interrupted once it has printed something, and must
//! then end as interrupted.

use std::{
    env, fs,
    path::{Path, PathBuf},
    process::Command,
};

use libtest_mimic::{Arguments, Failed, Trial};
use tempfile::TempDir;

/// Programs that the test skips: they install, compile, measure or need the network.
const NOT_RUN: [&str; 12] = [
    "apt-get",
    "benches/",
    "cargo",
    "code",
    "curl",
    "gh",
    "maturin",
    "npm",
    "pip",
    "sha256sum",
    "sudo",
    "tar",
];

/// What commands contain that run until Ctrl-C.
const ENDLESS: [&str; 3] = ["strahl preview ", "strahl watch ", " --watch "];

/// Runs such a command up to its first output.
const UNTIL_PRINTED: &str = r#"until_printed() {
    "$@" > printed.log 2>&1 &
    for _ in $(seq 600); do
        if [ -s printed.log ] || ! kill -0 $! 2> /dev/null; then break; fi
        sleep 0.1
    done
    kill -TERM $! || true
    status=0
    wait $! || status=$?
    cat printed.log
    rm printed.log
    [ $status = 130 ]
}
"#;

fn main() {
    let mut pages = vec![PathBuf::from("README.md")];
    let docs = fs::read_dir("docs").unwrap();
    pages.extend(docs.map(|page| page.unwrap().path()));
    pages.retain(|page| page.extension() == Some("md".as_ref()));
    pages.sort();
    let trial = |page: PathBuf| Trial::test(page.display().to_string(), move || run(&page));
    libtest_mimic::run(
        &Arguments::from_args(),
        pages.into_iter().map(trial).collect(),
    )
    .exit();
}

fn run(page: &Path) -> Result<(), Failed> {
    let clone = Clone::new(page);
    let text = fs::read_to_string(page).unwrap();
    let mut printed = None;
    for block in blocks(&text) {
        if is_python(page, &block) && !clone.bash("python3 -c 'import numpy'").0 {
            println!(
                "{} is not run from line {}: numpy is missing",
                page.display(),
                block.line
            );
            break;
        }
        let done = clone.block(page, &block, printed.as_deref());
        printed = done.map_err(|why| format!("{}:{}: {why}", page.display(), block.line))?;
    }
    Ok(())
}

/// Returns true if the block is run by Python. tests/explain.rs checks the examples of the codes.
fn is_python(page: &Path, block: &Block) -> bool {
    block.language == "python" && !page.ends_with("diagnostics.md")
}

/// A fenced block of a page.
struct Block {
    /// The line of the opening fence, counted from 1.
    line: usize,
    language: String,
    /// The file name, if the line before the block gives one.
    file: Option<String>,
    text: String,
}

fn blocks(page: &str) -> Vec<Block> {
    let mut blocks: Vec<Block> = Vec::new();
    let mut before = "";
    let mut lines = page.lines().enumerate();
    while let Some((at, line)) = lines.next() {
        if let Some(language) = line.trim_start().strip_prefix("```") {
            let indent = line.len() - line.trim_start().len();
            let body = lines
                .by_ref()
                .map(|(_, line)| line)
                .take_while(|line| line.trim_start() != "```");
            let body = body.map(|line| format!("{}\n", line.get(indent..).unwrap_or_default()));
            blocks.push(Block {
                line: at + 1,
                language: language.to_owned(),
                file: file_of(before),
                text: body.collect(),
            });
            before = "";
        } else if !line.trim().is_empty() {
            before = line;
        }
    }
    blocks
}

/// Returns the file name in a line such as ``Write `first.ron`:``.
fn file_of(line: &str) -> Option<String> {
    let name = line.trim_end().strip_suffix("`:")?.rsplit('`').next()?;
    let is_file = name.contains('.') && !name.contains([' ', '/', '*']);
    is_file.then(|| name.to_owned())
}

/// How many samples and how many pixels the large scenes have, and how many the tests draw.
const FAST: [[&str; 2]; 7] = [
    ["samples: 16)", "samples: 1)"],
    ["Path(samples: 512", "Path(samples: 1"],
    ["width: 600, height: ", "width: 60, height: "],
    ["width: 640, height: 360", "width: 160, height: 90"],
    ["width: 1200, height: 800", "width: 300, height: 200"],
    ["width: 1200, height: 900", "width: 300, height: 225"],
    ["width: 1280, height: 800", "width: 320, height: 200"],
];

/// A folder with the files of a fresh clone.
struct Clone(TempDir);

impl Clone {
    /// Gives the scenes one sample, since sixteen take minutes in a build for tests.
    fn draw_fast(&self) {
        for scene in fs::read_dir(self.0.path().join("scenes")).unwrap() {
            let scene = scene.unwrap().path();
            if scene.extension() == Some("ron".as_ref()) {
                let text = fs::read_to_string(&scene).unwrap();
                let fast = FAST
                    .iter()
                    .fold(text, |text, [whole, few]| text.replace(whole, few));
                fs::write(&scene, fast).unwrap();
            }
        }
    }

    fn new(page: &Path) -> Self {
        let clone = Self(tempfile::tempdir().unwrap());
        for folder in ["scenes", "schemas"] {
            copy(Path::new(folder), &clone.0.path().join(folder));
        }
        if !page.ends_with("info.md") {
            clone.draw_fast();
        }
        if !page.ends_with("README.md") {
            // The pages use these names for the reader's own scene.
            for name in ["scene.ron", "scene.txt"] {
                fs::copy("tests/docs/scene.ron", clone.0.path().join(name)).unwrap();
            }
            fs::write(clone.0.path().join("table.csv"), "id,camera.fov\na,30\n").unwrap();
        }
        let prepared = match page.file_name().and_then(|name| name.to_str()) {
            Some("README.md" | "diff.md") => "strahl render -q scenes/ -o golden/",
            Some("ci.md") => {
                "strahl render -q scenes/ -o pictures/
                 git init -q
                 git add .
                 git -c user.name=a -c user.email=a@example.com commit -q -m a
                 git update-ref refs/remotes/origin/main HEAD
                 cp scenes/sphere.ron scenes/more.ron
                 git add scenes/more.ron
                 strahl render -q scenes/ -o golden/"
            }
            _ => "",
        };
        let (done, printed) = clone.bash(prepared);
        assert!(done, "{printed}");
        clone
    }

    /// Runs a block; returns the output of its commands.
    fn block(
        &self,
        page: &Path,
        block: &Block,
        printed: Option<&str>,
    ) -> Result<Option<String>, String> {
        if let Some(file) = &block.file {
            fs::write(self.0.path().join(file), &block.text).unwrap();
            return Ok(None);
        }
        // tests/explain.rs checks the examples of the codes.
        let is_explained = page.ends_with("diagnostics.md");
        match &*block.language {
            "sh" => self.run(&commands(&block.text)).map(Some),
            "text" if is_explained => Ok(None),
            "text" if block.text.starts_with("$ ") => self.session(&block.text).map(|()| None),
            "text" => {
                let printed = match printed {
                    Some(printed) => printed.to_owned(),
                    None => self.broken_scene(page)?,
                };
                holds(&printed, &block.text).map(|()| Some(printed))
            }
            "yaml" => self.run(&steps(&block.text)).map(|_| None),
            "json" if !is_explained => match serde_json::from_str::<serde_json::Value>(&block.text)
            {
                Ok(_) => Ok(None),
                Err(error) => Err(error.to_string()),
            },
            "python" if is_python(page, block) => self.python(&block.text).map(|()| None),
            _ => Ok(None),
        }
    }

    /// Runs commands, which must all succeed.
    fn run(&self, script: &str) -> Result<String, String> {
        match self.bash(script) {
            (true, printed) => Ok(printed),
            (false, printed) => Err(format!("failed:\n{script}\n{printed}")),
        }
    }

    fn bash(&self, script: &str) -> (bool, String) {
        let program = Path::new(env!("CARGO_BIN_EXE_strahl")).parent().unwrap();
        let path = env::var("PATH").unwrap();
        let output = Command::new("bash")
            .args([
                "-euo",
                "pipefail",
                "-c",
                &format!("exec 2>&1\n{UNTIL_PRINTED}{script}"),
            ])
            .current_dir(self.0.path())
            .env("PATH", format!("{}:{path}", program.display()))
            .output()
            .unwrap();
        let printed = String::from_utf8_lossy(&output.stdout).into_owned();
        (output.status.success(), printed)
    }

    /// Runs the commands of a session; each must print the lines after it, whatever its exit
    /// status.
    fn session(&self, text: &str) -> Result<(), String> {
        for part in format!("\n{text}").split("\n$ ").skip(1) {
            let (command, expected) = part.split_once('\n').unwrap();
            let (_, printed) = self.bash(command);
            holds(&printed, expected)?;
        }
        Ok(())
    }

    /// Returns the output for the scene that the README asks the reader to break.
    fn broken_scene(&self, page: &Path) -> Result<String, String> {
        if !page.ends_with("README.md") {
            return Err("no command comes before this output".to_owned());
        }
        let path = self.0.path().join("first.ron");
        let scene = fs::read_to_string(&path).unwrap();
        let broken = scene.replace("radius", "radios");
        fs::write(&path, broken.replace("\"#fb8500\"", "\"orange\"")).unwrap();
        let (done, printed) = self.bash("strahl render first.ron");
        assert!(!done);
        fs::write(&path, scene).unwrap();
        Ok(printed)
    }

    fn python(&self, text: &str) -> Result<(), String> {
        fs::write(self.0.path().join("block.py"), text).unwrap();
        let printed = self.run("python3 block.py").map(|_| ());
        fs::remove_file(self.0.path().join("block.py")).unwrap();
        printed
    }
}

fn copy(from: &Path, to: &Path) {
    fs::create_dir_all(to).unwrap();
    for entry in fs::read_dir(from).unwrap() {
        let entry = entry.unwrap();
        let target = to.join(entry.file_name());
        if entry.path().is_dir() {
            copy(&entry.path(), &target);
        } else {
            fs::copy(entry.path(), target).unwrap();
        }
    }
}

/// Returns the commands of a block, with `cargo run` replaced by the built program.
fn commands(text: &str) -> String {
    let text = text.replace("cargo run --release -- ", "strahl ");
    let wanted = text.lines().filter(|line| is_run(line));
    let wanted = wanted.map(|line| match line.split_once("| ffmpeg") {
        Some((drawing, _)) => format!("{drawing} > film\n"),
        None if is_endless(line) => {
            // No test opens a browser of the person who runs it.
            let line = line.replace("strahl preview ", "strahl preview --no-open ");
            format!("until_printed {line}\n")
        }
        None => format!("{line}\n"),
    });
    wanted.collect()
}

fn is_endless(line: &str) -> bool {
    ENDLESS.iter().any(|words| line.contains(words))
}

fn is_run(line: &str) -> bool {
    let mut words = line.split_whitespace();
    !words.any(|word| {
        NOT_RUN
            .iter()
            .any(|program| word == *program || word.starts_with("benches/"))
    })
}

/// Returns the commands of the steps of a workflow. A step runs as a whole or not at all.
fn steps(text: &str) -> String {
    let mut steps: Vec<String> = Vec::new();
    let mut outer: Option<usize> = None;
    for line in text.lines() {
        let indent = line.len() - line.trim_start().len();
        let command = line.trim().trim_start_matches("- ");
        if let Some(command) = command.strip_prefix("run: ") {
            outer = (command == "|").then_some(indent);
            steps.push(if outer.is_none() { command } else { "" }.to_owned() + "\n");
        } else if command == "script:" {
            outer = Some(indent);
            steps.push(String::new());
        } else if outer.is_some_and(|outer| indent > outer) {
            if let Some(step) = steps.last_mut() {
                *step += &format!("{command}\n");
            }
        } else {
            outer = None;
        }
    }
    steps.retain(|step| step.lines().all(is_run));
    steps.concat()
}

/// Returns true if the output contains the sample.
fn holds(printed: &str, sample: &str) -> Result<(), String> {
    let mut rest = printed;
    for part in sample.split("…\n") {
        let Some(at) = rest.find(part) else {
            return Err(format!("`{part}` is missing in:\n{rest}"));
        };
        rest = &rest[at + part.len()..];
    }
    Ok(())
}
