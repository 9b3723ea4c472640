//! Each file in `tests/valid` and `tests/invalid` is a test case: a scene that must be read, or one
//! that must be rejected with the expected faults.
//!
//! - `tests/valid/*.{ron,json}` have no faults, and survive writing and reading back in both syntaxes
//!   and in the canonical format; files with the same stem are the same scene.
//! - `tests/invalid/<code>/<case>.{ron,json}` have a fault of that code, and possibly others; those
//!   in `many` have five faults or more. Next to each are `<file>.expected`, the output of
//!   `strahl validate --output-format short`, and `<file>.codes`, with a line `LINE:COLUMN CODE` for
//!   each fault.
//! - The tables, parts, meshes and pictures that they name are in folders called `tables`, `parts`, `meshes` and `pictures`
//!   next to them.
//!   `.expected` has the faults of parts as well, `.codes` those of the scene.
//! - In `.expected`, `…` stands for long lists of names and for their lengths, so that a new name
//!   rewrites few files.
//! - A case of a warning that is off by default is read with `--warn` and its code. The cases of
//!   `unreadable` have no scene: the file does not exist.
//!
//! `STRAHL_BLESS=1` rewrites the `.expected` files that differ, but never a `.codes` file: messages
//! may change, but positions and codes are the contract. A case with different positions or codes
//! is not blessed.

use std::{
    collections::{BTreeMap, BTreeSet},
    env,
    error::Error,
    ffi::OsStr,
    fs, io,
    path::{Path, PathBuf},
    process::ExitCode,
};

use libtest_mimic::{Arguments, Failed, Trial};
use strahl::{
    Document, ReadOptions, Syntax,
    diagnostic::{Code, Levels, describe},
    jobs::{Checked, check_files, find_scenes},
    report::{FileReport, OutputFormat, Style, Summary, reporter},
    scene::{Converted, PartFindings},
    text::Lines,
};

const VALID: &str = "tests/valid";
const INVALID: &str = "tests/invalid";

/// The folder of the cases with many faults, and the smallest number that counts as many.
const MANY: (&str, usize) = ("many", 5);

/// The folders of the files that scenes name, which are not cases.
const NAMED: [&str; 4] = ["tables", "parts", "meshes", "pictures"];

/// The extensions of the files next to a scene with faults.
const BESIDE: [&str; 2] = ["expected", "codes"];

fn main() -> Result<ExitCode, Box<dyn Error>> {
    let arguments = Arguments::from_args();
    // A report names a file as given: relative to the package folder.
    env::set_current_dir(env!("CARGO_MANIFEST_DIR"))?;
    let mut trials = valid_trials()?;
    trials.extend(invalid_trials()?);
    Ok(libtest_mimic::run(&arguments, trials).exit_code())
}

fn valid_trials() -> io::Result<Vec<Trial>> {
    let mut stems: BTreeMap<String, Vec<String>> = BTreeMap::new();
    let mut trials = Vec::new();
    for file in files_in(VALID)? {
        let Some((stem, "ron" | "json")) = file.rsplit_once('.') else {
            let stray = format!("{file} is not a scene");
            trials.push(Trial::test(file, || Err(stray.into())));
            continue;
        };
        let stem = stem.to_owned();
        stems.entry(stem).or_default().push(file.clone());
        trials.push(Trial::test(file.clone(), move || valid(&file)));
    }
    for (stem, files) in stems {
        if files.len() > 1 {
            let name = format!("{stem} twins");
            trials.push(Trial::test(name, move || twins(&files)));
        }
    }
    Ok(trials)
}

fn invalid_trials() -> io::Result<Vec<Trial>> {
    let mut trials = Vec::new();
    let mut folders = BTreeSet::new();
    for folder in files_in(INVALID)? {
        let name = folder.rsplit('/').next().unwrap_or_default().to_owned();
        let mut scenes = BTreeSet::new();
        for file in files_in(&folder)? {
            // An expectation represents its scene, even a missing one.
            scenes.insert(match file.rsplit_once('.') {
                Some((scene, ending)) if BESIDE.contains(&ending) => scene.to_owned(),
                _ => file,
            });
        }
        for scene in scenes {
            let folder = name.clone();
            trials.push(Trial::test(scene.clone(), move || invalid(&scene, &folder)));
        }
        folders.insert(name);
    }
    for code in Code::ALL {
        let name = format!("{INVALID}/{code} is there");
        trials.push(Trial::test(name, || has_both_syntaxes(*code)));
        folders.remove(code.name());
    }
    folders.remove(MANY.0);
    trials.push(Trial::test("every folder is a code", move || {
        if folders.is_empty() {
            Ok(())
        } else {
            Err(format!("no codes: {folders:?}").into())
        }
    }));
    Ok(trials)
}

/// Checks that a scene has no faults, and survives writing and reading back.
fn valid(file: &str) -> Result<(), Failed> {
    let document = read(file, &Levels::default())?;
    faultless(&document)?;
    let [ron, json] = both(&document)?;
    for (written, syntax) in [(&ron, Syntax::Ron), (&json, Syntax::Json)] {
        let again = parse(file, &written.text, syntax)?;
        let [ron_again, json_again] = both(&again)?;
        same("RON, written and read back", &ron.text, &ron_again.text)?;
        // Anything that RON cannot express is lost.
        if syntax == Syntax::Json || ron.dropped.iter().all(|what| !what.contains("$schema")) {
            same("JSON, written and read back", &json.text, &json_again.text)?;
        }
        let formatted = again.format().ok_or("what was written has no layout")?;
        same("the layout of what was written", &written.text, &formatted)?;
    }

    let formatted = document.format().ok_or("the scene has no layout")?;
    let again = parse(file, &formatted, document.syntax())?;
    let twice = again.format().ok_or("the layout has no layout")?;
    same("the layout of the layout", &formatted, &twice)?;
    let without_lines = |scenes: [Converted; 2]| {
        scenes.map(|scene| (scene.text, scene.dropped, scene.lost.map(|lost| lost.count)))
    };
    if without_lines(both(&again)?) != without_lines([ron, json]) {
        return Err(format!("the layout is another scene:\n{formatted}").into());
    }
    Ok(())
}

/// Checks that two files with the same stem are the same scene; RON has no `$schema`.
fn twins(files: &[String]) -> Result<(), Failed> {
    let mut texts = Vec::new();
    for file in files {
        let document = read(file, &Levels::default())?;
        texts.push(document.convert(Syntax::Ron)?.text);
    }
    match texts.as_slice() {
        [one, other] => same("the scene in the other file", one, other),
        _ => Err("there are more files of this stem than syntaxes".into()),
    }
}

/// Checks that the faults are those in the files next to the scene.
fn invalid(file: &str, folder: &str) -> Result<(), Failed> {
    let code = folder.parse::<Code>();
    if !Path::new(file).exists() && code != Ok(Code::Unreadable) {
        return Err("there is no such scene".into());
    }
    let mut levels = Levels::default();
    if let Ok(code) = code {
        // This does not affect a code that is on.
        levels.warn(code);
    }
    let document = read(file, &levels)?;
    let codes = codes(&document);
    same(
        &format!("{file}.codes"),
        &fs::read_to_string(format!("{file}.codes")).unwrap_or_default(),
        &codes,
    )?;
    match code {
        Ok(code) if !codes.lines().any(|line| line.ends_with(code.name())) => {
            return Err(format!("the scene has no {code}").into());
        }
        Err(_) if codes.lines().count() < MANY.1 => {
            return Err(format!("the scene has fewer than {} faults", MANY.1).into());
        }
        _ => {}
    }

    let expectation = format!("{file}.expected");
    let expected = fs::read_to_string(&expectation).unwrap_or_default();
    let printed = without_lists(&short(&document)?);
    if expected != printed && env::var_os("STRAHL_BLESS").is_some_and(|value| value == "1") {
        return Ok(fs::write(expectation, printed)?);
    }
    same(&expectation, &expected, &printed)
}

fn has_both_syntaxes(code: Code) -> Result<(), Failed> {
    let files = files_in(&format!("{INVALID}/{code}"))?;
    for ending in [".ron.codes", ".json.codes"] {
        if !files.iter().any(|file| file.ends_with(ending)) {
            return Err(format!("there is no case *{ending}").into());
        }
    }
    Ok(())
}

/// Reads a file as `strahl validate` does.
fn read(file: &str, levels: &Levels) -> Result<Document, Failed> {
    let files = find_scenes(&[PathBuf::from(file)], &[], &strahl::jobs::Configs::none())?;
    let mut found = None;
    check_files(
        &files,
        &ReadOptions::new().levels(levels.clone()),
        1,
        |checked| {
            if let Checked::Document(_, document) | Checked::Unreadable(document, _) = checked {
                found = Some(document);
            }
            Ok::<(), strahl::Error>(())
        },
    )?;
    found.ok_or_else(|| "the file was skipped".into())
}

/// Reads a text made from a file; it must not have faults.
fn parse(file: &str, text: &str, syntax: Syntax) -> Result<Document, Failed> {
    let document = copy(file, text, syntax)?;
    faultless(&document)?;
    Ok(document)
}

/// Reads a text in the place of a file.
fn copy(file: &str, text: &str, syntax: Syntax) -> Result<Document, Failed> {
    let folder = Path::new(file).parent().ok_or("a file without a folder")?;
    let options = ReadOptions::new().syntax(syntax).folder(folder);
    Ok(Document::from_reader(file, text.as_bytes(), &options)?)
}

fn faultless(document: &Document) -> Result<(), Failed> {
    if document.diagnostics().is_empty() && document.parts().all(PartFindings::is_empty) {
        Ok(())
    } else {
        Err(format!("{}\n{}", short(document)?, document.text()).into())
    }
}

/// The scene in RON and in JSON.
fn both(document: &Document) -> Result<[Converted; 2], Failed> {
    let convert = |syntax| -> Result<Converted, Failed> {
        let copy = copy(document.name(), document.text(), document.syntax())?;
        Ok(copy.convert(syntax)?)
    };
    Ok([convert(Syntax::Ron)?, convert(Syntax::Json)?])
}

/// Returns the output of `--output-format short`.
fn short(document: &Document) -> Result<String, Failed> {
    let mut out = Vec::new();
    let mut reporter = reporter(OutputFormat::Short, Style::default(), describe, &mut out);
    let scene = (document.name(), document.text(), document.diagnostics());
    let parts = document.parts();
    let parts = parts.map(|part| (part.name(), part.text(), part.diagnostics()));
    for (file, text, diagnostics) in [scene].into_iter().chain(parts) {
        reporter.file(&FileReport {
            file,
            text,
            diagnostics,
            ..FileReport::default()
        })?;
    }
    reporter.finish(&Summary::default())?;
    Ok(String::from_utf8(out)?)
}

/// Returns `LINE:COLUMN CODE` for every fault.
fn codes(document: &Document) -> String {
    let lines = Lines::new(document.text());
    let faults = document.diagnostics().iter();
    faults
        .map(|fault| {
            let at = lines.position(fault.range.start);
            format!("{}:{} {}\n", at.line, at.column, fault.code)
        })
        .collect()
}

/// Returns messages with `…` for each list of more than 10 names, and for the length of one that is left
/// out.
fn without_lists(messages: &str) -> String {
    const LEAD: &str = "expected one of ";
    const LONG: usize = 10;
    let mut parts = messages.split(LEAD);
    let first = parts.next().unwrap_or_default().to_owned();
    parts.fold(first, |printed, part| {
        let names = part.strip_prefix("the variants ").unwrap_or(part);
        let line = names.lines().next().unwrap_or_default();
        let end = line.find(", found").unwrap_or(line.len());
        let (list, rest) = names.split_at(end);
        let is_length = !list.is_empty() && list.bytes().all(|byte| byte.is_ascii_digit());
        match is_length || list.split(", ").count() > LONG {
            true => printed + LEAD + "…" + rest,
            false => printed + LEAD + part,
        }
    })
}

fn same(what: &str, expected: &str, found: &str) -> Result<(), Failed> {
    if expected == found {
        Ok(())
    } else {
        Err(format!("{what}\n--- expected\n{expected}\n--- found\n{found}").into())
    }
}

/// Returns the sorted paths in a folder, with `/` on every platform. Hidden files are skipped.
fn files_in(folder: &str) -> io::Result<Vec<String>> {
    let mut files = Vec::new();
    for entry in fs::read_dir(folder)? {
        let name = entry?.file_name();
        let name = OsStr::to_string_lossy(&name);
        if !name.starts_with('.') && !NAMED.contains(&&*name) {
            files.push(format!("{folder}/{name}"));
        }
    }
    files.sort();
    Ok(files)
}
