//! The page of each code shows a scene that fails with this code alone, and its output.

use std::path::PathBuf;

use strahl::{
    Document, Error, ReadOptions, Syntax,
    diagnostic::{Code, Levels, describe},
    jobs::{Checked, check_files, find_scenes},
    report::{FileReport, OutputFormat, Style, Summary, reporter},
};

/// The folder of the tables and parts that the examples name.
const FOLDER: &str = "tests/explain/";

/// Returns the language and the content of each fenced block in the examples of a page.
fn example_blocks(page: &str) -> Vec<(String, String)> {
    let (_, rest) = page.split_once("\n## Example\n").unwrap();
    let (examples, _) = rest.split_once("\n## How to fix it\n").unwrap();
    let mut blocks = Vec::new();
    let mut open: Option<(String, String)> = None;
    for line in examples.lines() {
        match (line.strip_prefix("```"), open.take()) {
            (Some(language), None) => open = Some((language.to_owned(), String::new())),
            (Some(_), Some(block)) => blocks.push(block),
            (None, Some((language, content))) => {
                open = Some((language, content + line + "\n"));
            }
            (None, None) => {}
        }
    }
    assert!(open.is_none(), "a block is not closed");
    blocks
}

/// Returns the output of `--output-format short` for a document.
fn short(document: &Document) -> String {
    let mut out = Vec::new();
    let mut reporter = reporter(OutputFormat::Short, Style::default(), describe, &mut out);
    let scene = (document.name(), document.text(), document.diagnostics());
    let parts = document.parts();
    let parts = parts.map(|part| (part.name(), part.text(), part.diagnostics()));
    for (file, text, diagnostics) in [scene].into_iter().chain(parts) {
        let report = FileReport {
            file,
            text,
            diagnostics,
            ..FileReport::default()
        };
        reporter.file(&report).unwrap();
    }
    reporter.finish(&Summary::default()).unwrap();
    String::from_utf8(out).unwrap().replace(FOLDER, "")
}

#[test]
fn every_page_begins_with_its_code_and_one_sentence() {
    for code in Code::ALL.iter().copied() {
        let page = describe(code);
        let rest = page.strip_prefix(&format!("# {code}\n\n")).unwrap();
        let (sentence, _) = rest.split_once("\n\n").unwrap();
        assert_eq!(sentence.lines().count(), 1, "{code}");
        assert!(sentence.ends_with('.'), "{code}");
        assert!(!sentence.contains(". "), "{code}");
    }
}

#[test]
fn every_example_has_only_its_own_code() {
    for code in Code::ALL.iter().copied() {
        // The tests of the command line cover the codes of options.
        let of_options = [Code::UnknownName, Code::UnknownPath, Code::UnusedColumn];
        if code == Code::Unreadable || of_options.contains(&code) {
            continue;
        }
        // Some warnings are off by default; the other codes are not affected.
        let mut levels = Levels::default();
        levels.warn(code);
        let blocks = example_blocks(describe(code));
        assert!(!blocks.is_empty(), "{code}: there is no example");
        for pair in blocks.chunks(2) {
            let [(language, scene), (text, printed)] = pair else {
                panic!("{code}: a scene without its output");
            };
            assert_eq!(text, "text", "{code}");
            let (name, syntax) = match language.as_str() {
                "ron" => ("scene.ron", Syntax::Ron),
                "json" => ("scene.json", Syntax::Json),
                other => panic!("{code}: `{other}` is not a scene syntax"),
            };
            let options = ReadOptions::new().syntax(syntax).levels(levels.clone());
            let options = options.folder(FOLDER);
            let document = Document::from_reader(name, scene.as_bytes(), &options).unwrap();
            for fault in document.diagnostics() {
                assert_eq!(fault.code, code, "{name}: {}", fault.message);
                assert_eq!(fault.severity, code.severity(), "{name}: {}", fault.message);
            }
            assert_eq!(&short(&document), printed, "{code}");
        }
    }
}

#[test]
fn only_documented_warnings_are_off_by_default() {
    for code in Code::ALL.iter().copied() {
        let says_so = describe(code).contains("This warning is off by default.");
        assert_eq!(says_so, !code.on_by_default(), "{code}");
        let on = describe(code).contains("This warning is on by default.");
        assert_eq!(on || says_so, Code::WARNINGS.contains(&code), "{code}");
    }
}

#[test]
fn a_missing_file_is_unreadable() {
    let blocks = example_blocks(describe(Code::Unreadable));
    // Tests run in the package folder, which has no scene of this name.
    let files = find_scenes(
        &[PathBuf::from("scene.ron")],
        &[],
        &strahl::jobs::Configs::none(),
    )
    .unwrap();
    let mut printed = Vec::new();
    check_files(&files, &ReadOptions::new(), 1, |checked| {
        let Checked::Unreadable(document, _) = checked else {
            panic!("there is a scene.ron");
        };
        printed.push(("text".to_owned(), short(&document)));
        Ok::<(), Error>(())
    })
    .unwrap();
    assert_eq!(printed, blocks);
}
