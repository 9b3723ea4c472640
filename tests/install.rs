//! The release workflow creates the files that `cargo binstall`, the wheel and the manual expect.

use std::{error::Error, fs, path::Path};

type Outcome = Result<(), Box<dyn Error>>;

fn file(name: &str) -> std::io::Result<String> {
    fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join(name))
}

/// Returns the values of a key such as `pkg-url = "…"` or `- target: …`, in the order of the text.
fn values<'a>(text: &'a str, key: &'a str) -> impl Iterator<Item = &'a str> {
    let lines = text.lines().map(str::trim);
    lines.filter_map(move |line| Some(line.strip_prefix(key)?.trim().trim_matches('"')))
}

fn value<'a>(text: &'a str, key: &'a str) -> Result<&'a str, String> {
    values(text, key)
        .next()
        .ok_or_else(|| format!("no {key:?}"))
}

/// Returns the part of a text between two others.
fn between<'a>(text: &'a str, start: &str, end: &str) -> Result<&'a str, String> {
    let rest = text.split_once(start).map(|(_, rest)| rest);
    let part = rest.and_then(|rest| rest.split_once(end));
    part.map(|(part, _)| part)
        .ok_or_else(|| format!("nothing between {start:?} and {end:?}"))
}

struct Target<'a> {
    name: &'a str,
    /// The name of the archive without its extension, and of the folder in it.
    stem: String,
    archive: String,
}

/// Returns the archives that the workflow creates.
fn targets(workflow: &str) -> Result<Vec<Target<'_>>, String> {
    let version = env!("CARGO_PKG_VERSION");
    let stem = between(workflow, "echo \"NAME=", "\"")?;
    let zip = between(workflow, "7z a \"../archives/$NAME", "\"")?;
    let tar = between(workflow, "tar -czf \"archives/$NAME", "\"")?;
    Ok(values(workflow, "- target:")
        .map(|name| {
            let stem = stem.replace("$version", version).replace("$TARGET", name);
            let ending = if name.contains("windows") { zip } else { tar };
            let archive = format!("{stem}{ending}");
            Target {
                name,
                stem,
                archive,
            }
        })
        .collect())
}

#[test]
fn binstall_finds_the_archive_of_each_target() -> Outcome {
    let manifest = file("Cargo.toml")?;
    let workflow = file(".github/workflows/release.yml")?;
    let general = between(
        &manifest,
        "[package.metadata.binstall]\n",
        "\n[dependencies]",
    )?;
    let tag = between(&workflow, "if [ \"", "$version\"")?;
    assert_eq!(tag, "v");
    let targets = targets(&workflow)?;
    assert_eq!(targets.len(), 5);
    for target in targets {
        let filled = |text: &str| {
            text.replace("{ repo }", "REPO")
                .replace("{ version }", env!("CARGO_PKG_VERSION"))
                .replace("{ target }", target.name)
        };
        let own = format!("[package.metadata.binstall.overrides.{}]\n", target.name);
        let own = general.split_once(&own).map_or(general, |(_, own)| own);
        let url = format!(
            "REPO/releases/download/{tag}{}/{}",
            env!("CARGO_PKG_VERSION"),
            target.archive
        );
        assert_eq!(filled(value(own, "pkg-url =")?), url);
        let formats = [("tgz", ".tar.gz"), ("zip", ".zip")];
        let format = value(own, "pkg-fmt =")?;
        let ending = formats.iter().find(|(name, _)| *name == format);
        let (_, ending) = ending.ok_or(format)?;
        assert!(target.archive.ends_with(ending), "{}", target.archive);
        let folder = format!("{}/{{ bin }}{{ binary-ext }}", target.stem);
        assert_eq!(filled(value(general, "bin-dir =")?), folder);
    }
    Ok(())
}

#[test]
fn a_release_has_all_files_that_the_manual_names() -> Outcome {
    let workflow = file(".github/workflows/release.yml")?;
    let manual = file("docs/install.md")?;
    for target in targets(&workflow)? {
        let archive = format!("`{}`", target.archive);
        assert!(manual.contains(&archive), "docs/install.md lacks {archive}");
    }
    let project = file("pyproject.toml")?;
    let name = value(&project, "name =")?;
    assert!(manual.contains(&format!("pip install {name}")));
    let wheel = format!("archives/{}-*.whl", name.replace('-', "_"));
    assert!(workflow.contains(&wheel), "release.yml lacks {wheel}");
    Ok(())
}
