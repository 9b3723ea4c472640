//! A case is a file: what `tests/valid` must read, and what `tests/invalid` must say.
//!
//! - `tests/valid/*.{ron,json}` have no faults, survive writing and reading back in both syntaxes
//!   and the one layout; files of one stem are the same scene.
//! - `tests/invalid/<code>/<case>.{ron,json}` have a fault of that code, and maybe others; those in
//!   `many` have five faults or more. Beside each lie `<file>.expected`, what
//!   `strahl validate --output-format short` prints, and `<file>.codes`, a line `LINE:COLUMN CODE`
//!   for each fault.
//! - The tables that they name lie in folders `tables` beside them.
//! - A case of a warning that is off by default is read with `--warn` and its code. The cases of
//!   `unreadable` have no scene: the file is not there.
//!
//! `STRAHL_BLESS=1` rewrites the `.expected` files that differ, and never a `.codes` file: the
//! words may change, the places and the codes are the contract. A case that differs in these is not
//! blessed.

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
    report::{FileReport, OutputFormat, Style, Summary, Suppressed, reporter},
    scene::Converted,
    text::Lines,
};

const VALID: &str = "tests/valid";
const INVALID: &str = "tests/invalid";

/// The folder of the cases with many faults, and how many are many.
const MANY: (&str, usize) = ("many", 5);

/// Codes of faults that options have, and no scene.
const OF_OPTIONS: &[Code] = &[Code::UnknownName, Code::UnusedColumn];

/// The folder of the tables, which are no cases.
const TABLES: &str = "tables";

/// What stands beside a scene that has faults.
const BESIDE: [&str; 2] = ["expected", "codes"];

fn main() -> Result<ExitCode, Box<dyn Error>> {
    let arguments = Arguments::from_args();
    // A report names a file as it was given: below the folder of the package.
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
            let stray = format!("{file} is no scene");
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
            // An expectation stands for the scene that it belongs to, also for one that is missing.
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
    for code in Code::ALL.iter().filter(|code| !OF_OPTIONS.contains(code)) {
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

/// No faults, and what is written and read back is the same scene.
fn valid(file: &str) -> Result<(), Failed> {
    let document = read(file, &Levels::default())?;
    faultless(&document)?;
    let [ron, json] = both(&document)?;
    for (written, syntax) in [(&ron, Syntax::Ron), (&json, Syntax::Json)] {
        let again = parse(file, &written.text, syntax)?;
        let [ron_again, json_again] = both(&again)?;
        same("RON, written and read back", &ron.text, &ron_again.text)?;
        // What RON cannot say does not come back.
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

/// Two files of one stem are the same scene; RON has no `$schema`.
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

/// The faults are those that stand beside the scene.
fn invalid(file: &str, folder: &str) -> Result<(), Failed> {
    let code = folder.parse::<Code>();
    if !Path::new(file).exists() && code != Ok(Code::Unreadable) {
        return Err("there is no such scene".into());
    }
    let mut levels = Levels::default();
    if let Ok(code) = code {
        // It changes nothing for a code that is on.
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
    let printed = short(&document)?;
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

/// Reads what was made of a file.
fn parse(file: &str, text: &str, syntax: Syntax) -> Result<Document, Failed> {
    let document = copy(file, text, syntax)?;
    faultless(&document)?;
    Ok(document)
}

/// A document in the place of a file.
fn copy(file: &str, text: &str, syntax: Syntax) -> Result<Document, Failed> {
    let folder = Path::new(file).parent().ok_or("a file without a folder")?;
    let options = ReadOptions::new().syntax(syntax).folder(folder);
    Ok(Document::from_reader(file, text.as_bytes(), &options)?)
}

fn faultless(document: &Document) -> Result<(), Failed> {
    if document.diagnostics().is_empty() {
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

/// What `--output-format short` prints.
fn short(document: &Document) -> Result<String, Failed> {
    let mut out = Vec::new();
    let mut reporter = reporter(OutputFormat::Short, Style::default(), describe, &mut out);
    let report = FileReport {
        file: document.name(),
        text: document.text(),
        diagnostics: document.diagnostics(),
        suppressed: Suppressed::default(),
        ..FileReport::default()
    };
    let mut summary = Summary::default();
    summary.count(&report);
    reporter.file(&report)?;
    reporter.finish(&summary)?;
    Ok(String::from_utf8(out)?)
}

/// `LINE:COLUMN CODE` for every fault.
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

fn same(what: &str, expected: &str, found: &str) -> Result<(), Failed> {
    if expected == found {
        Ok(())
    } else {
        Err(format!("{what}\n--- expected\n{expected}\n--- found\n{found}").into())
    }
}

/// What lies in a folder, sorted, with `/` on every platform; hidden files are not ours.
fn files_in(folder: &str) -> io::Result<Vec<String>> {
    let mut files = Vec::new();
    for entry in fs::read_dir(folder)? {
        let name = entry?.file_name();
        let name = OsStr::to_string_lossy(&name);
        if !name.starts_with('.') && name != TABLES {
            files.push(format!("{folder}/{name}"));
        }
    }
    files.sort();
    Ok(files)
}
