//! Random mutations of scenes, tested with the loader and its diagnostics.
use std::{
    cell::RefCell,
    fs::File,
    io::{Seek, Write},
    sync::atomic::{AtomicUsize, Ordering},
};

use super::spelling;
use crate::parallel::Pool;
use crate::text::syntax::tests::common::{JSON, RON, check};
use crate::tracer::random::{Rng, cases};
use crate::{
    diagnostic::Diagnostic,
    scene::{convert, document::Document, format::scene::Model, read, tests::oracle},
    text::syntax::{Syntax, parse},
};

/// Number of mutations per syntax; `STRAHL_CASES` overrides it.
const CASES: usize = 10_000;

const BITS: &[&str] = &[
    "(",
    ")",
    "[",
    "]",
    "{",
    "}",
    ",",
    ":",
    ";",
    "=",
    "\"",
    "'",
    "`",
    "/",
    "//",
    "/*",
    "*/",
    "/* /* */ */",
    "// x\n",
    "#",
    "!",
    "$",
    "\\",
    "\\n",
    "\\u00e9",
    "\\u{e9}",
    "\\x41",
    "\\xc3\\xa9",
    "\\ud800",
    "\\udc00",
    "\\ud83d\\ude00",
    "\\q",
    "\\\n",
    "\\\r\n  ",
    "\n",
    "\r\n",
    "\t",
    " ",
    "\u{b}",
    "\u{c}",
    "\u{85}",
    "\u{a0}",
    "\u{200e}",
    "\u{200b}",
    "\u{2028}",
    "\u{3000}",
    "\u{feff}",
    "\0",
    "\u{1b}",
    "\u{7f}",
    "é",
    "ß",
    "变",
    "，",
    "“",
    "”",
    "−",
    "…",
    "（",
    "）",
    "̈",
    "1.",
    "00",
    "+5",
    ".5",
    "1_000",
    "_1",
    "1_",
    "1__0",
    "1._5",
    "1_.5",
    "1e_5",
    "1e-_5",
    "90f64",
    "90f32",
    "1e999",
    "-1e999",
    "1e-999",
    "inf",
    "-inf",
    "inff64",
    "NaN",
    "NaNf32",
    "+NaN",
    "0x5A",
    "0b11",
    "0o7",
    "0x_1",
    "0xFFu32",
    "5u32",
    "5u8",
    "5i128",
    "1e",
    "1e+",
    "-",
    "+",
    "--1",
    "1..2",
    "..",
    "..=3",
    "-.5",
    "-0",
    "0",
    "123456789012345678901234567890",
    "b'x'",
    "b'\\xff'",
    "b\"x\"",
    "br#\"x\"#",
    "'c'",
    "'\\''",
    "'ab'",
    "r\"raw\"",
    "r#\"r\"aw\"#",
    "r##\"x\"#\"##",
    "r#ident",
    "r#a-b",
    "r#",
    "r##",
    "r",
    "b",
    "br#",
    "a-b",
    "a.b",
    "#![enable(implicit_some)]",
    "#![enable(unwrap_newtypes,)]",
    "#![type = \"x\"]",
    "#![schema = r\"x\"]",
    "#! [ enable ( foo ) ]",
    "Some",
    "Some(",
    "Some ",
    "Some+1",
    "None",
    "null",
    "true",
    "false",
    "True",
    "()",
    "( )",
    "Scene",
    "Image",
    "Foo",
    "Foo(1,1,1)",
    "[1,1,1]",
    "{\"a\": 1}",
    "(1,1,1)",
    "\"\"",
    "\"#fff\"",
    "radius",
    "radius:",
    "\"radius\":",
    "eye: (0,0,0)",
    "Sphere(",
    "version: 1,",
    "up: Some(0,1,0),",
    "[[[[",
    "))))",
    "é:",
];

fn boundary(text: &str, mut at: usize) -> usize {
    while !text.is_char_boundary(at) {
        at -= 1;
    }
    at
}

fn spot(text: &str, rng: &mut Rng) -> usize {
    boundary(text, rng.below(text.len() + 1))
}

/// The range of a token-like piece of the text.
fn piece(text: &str, rng: &mut Rng) -> std::ops::Range<usize> {
    let at = spot(text, rng);
    let word = |c: char| c.is_alphanumeric() || "_.-#\"".contains(c);
    let rest = &text[at..];
    let Some(first) = rest.chars().next() else {
        return at..at;
    };
    let len = if word(first) {
        rest.find(|c| !word(c)).unwrap_or(rest.len())
    } else {
        first.len_utf8()
    };
    at..at + len
}

fn mutate(seeds: &[&str], rng: &mut Rng) -> String {
    let mut text = seeds[rng.below(seeds.len())].to_owned();
    for _ in 0..=rng.below(3) {
        match rng.below(9) {
            0 => text.replace_range(piece(&text, rng), ""),
            1 => {
                let range = piece(&text, rng);
                let copy = text[range.clone()].to_owned();
                text.insert_str(range.start, &copy);
            }
            2 => {
                let (a, b) = (piece(&text, rng), piece(&text, rng));
                if a.end <= b.start {
                    let (ta, tb) = (text[a.clone()].to_owned(), text[b.clone()].to_owned());
                    text.replace_range(b, &ta);
                    text.replace_range(a, &tb);
                }
            }
            3 | 4 => {
                let at = spot(&text, rng);
                text.insert_str(at, BITS[rng.below(BITS.len())]);
            }
            5 | 6 => text.replace_range(piece(&text, rng), BITS[rng.below(BITS.len())]),
            7 if rng.below(4) == 0 => text.truncate(spot(&text, rng)),
            7 => {
                let at = spot(&text, rng);
                if let Some(c) = text[at..].chars().next() {
                    text.replace_range(at..at + c.len_utf8(), "");
                }
            }
            _ if rng.below(4) == 0 => {
                let other = seeds[rng.below(seeds.len())];
                let (a, b) = (spot(&text, rng), spot(other, rng));
                text = format!("{}{}", &text[..a], &other[b..]);
            }
            _ => {
                // Replaces any number.
                if let Some(at) = text
                    .char_indices()
                    .filter(|(_, c)| c.is_ascii_digit())
                    .nth(rng.below(40))
                    .map(|(i, _)| i)
                {
                    text.replace_range(at..=at, BITS[rng.below(BITS.len())]);
                }
            }
        }
    }
    text
}

/// Number of texts read in blocks.
static IN_BLOCKS: AtomicUsize = AtomicUsize::new(0);

/// Returns true if the fast reader knows a text, and true if `ron` or `serde_json` accepts it.
/// Checks that a known text gives the same values.
fn compare(text: &str, syntax: Syntax) -> (bool, bool) {
    let body = text.strip_prefix('\u{feff}').unwrap_or(text);
    let judged = oracle::lenient::<Model>(body, syntax);
    let found = oracle::from_tree(text, syntax);
    // Unlike `==`, the debug output distinguishes -0 from 0, and any two other numbers.
    let shown = |model: &Model| format!("{model:?}");
    match (&judged, &found) {
        // In the keys of an animation they accept more than the format.
        (Ok(_), Err(fault)) if fault.path.to_string().starts_with("animation") => {}
        // A number too large for its type is read as the largest, which validation reports. A float
        // without a fraction is a whole number.
        (Err(fault), Ok(model)) => {
            let document = Document::from_text("large", text, syntax);
            let is_float = ["floating point", "Expected comma", "Invalid digit"]
                .iter()
                .any(|reason| fault.contains(reason));
            if is_float && !document.has_errors() {
                let written = convert::convert(model.clone(), syntax).text;
                let again = oracle::lenient::<Model>(&written, syntax);
                assert_eq!(again.as_ref().map(shown), Ok(shown(model)), "in {text}");
            } else {
                assert!(document.has_errors(), "{judged:?} in {text}");
            }
        }
        _ => {
            let expected = judged.as_ref().map(shown).unwrap_or_default();
            let found = found.as_ref().map(shown).unwrap_or_default();
            assert_eq!(found, expected, "{judged:?} in {text}");
        }
    }
    let known = read::model(body, syntax, &Pool::new(None));
    if let Some(model) = &known {
        let expected = found.as_ref().map(shown).unwrap_or_default();
        assert_eq!(shown(model), expected, "in {text}");
    }
    // Read in blocks, the result is the same or unknown.
    thread_local!(static FILE: RefCell<File> = RefCell::new(tempfile::tempfile().unwrap()));
    let in_blocks = FILE.with_borrow_mut(|file| {
        file.set_len(0).unwrap();
        file.rewind().unwrap();
        file.write_all(text.as_bytes()).unwrap();
        file.rewind().unwrap();
        read::file(file, text.len(), syntax, &Pool::Calling)
    });
    if in_blocks.is_some() {
        IN_BLOCKS.fetch_add(1, Ordering::Relaxed);
        assert_eq!(format!("{in_blocks:?}"), format!("{known:?}"), "in {text}");
    }
    (known.is_some(), found.is_ok())
}

/// Checks the laws between the loader, the tree and the diagnostics. Returns true if the loader
/// accepts the text.
fn judge(text: &str, syntax: Syntax) -> bool {
    let tree = parse(text, syntax);
    check(text, &tree);
    compare(text, syntax);
    let accepted = oracle::model(text, syntax).is_ok();
    let faults = tree.faults();
    assert!(!accepted || faults.is_empty(), "{faults:?}\nin {text}");

    let mut document = Document::from_text("mutation", text, syntax);
    assert!(
        accepted || document.has_errors(),
        "refused without a reason: {text}"
    );
    let diagnostics = document.diagnostics().to_vec();
    for fault in &diagnostics {
        let labels = fault.labels.iter().map(|label| &label.range);
        for range in labels.chain([&fault.range]) {
            assert!(
                range.start <= range.end && text.get(range.clone()).is_some(),
                "{fault:?}\nin {text}"
            );
        }
    }
    // A fixed text has no fixable faults left, and all of its comments.
    if let Some((fixed, _)) = document.fixed() {
        let comments = |text: &str| -> Vec<String> {
            let tree = parse(text, syntax);
            let ranges = tree.comments().iter().map(|comment| comment.range());
            ranges.map(|range| text[range].to_owned()).collect()
        };
        let again = Document::from_text("fixed", &*fixed, syntax).fixed();
        assert_eq!(again, None, "in {fixed}\nof {text}");
        // After a lost quote, an apparent comment may turn out to be part of a string.
        let is_kept = |comment: &String| fixed.contains(comment);
        assert!(comments(text).iter().all(is_kept), "in {fixed}\nof {text}");
    }
    let place = |fault: &Diagnostic| (fault.range.start, fault.range.end, fault.code);
    assert!(
        diagnostics.is_sorted_by_key(place),
        "{diagnostics:#?}\nin {text}"
    );
    accepted
}

#[test]
fn ron_is_never_stricter() {
    let mut rng = Rng(0x9e37_79b9_7f4a_7c15);
    let mut accepted = 0;
    assert!(RON.iter().any(|seed| judge(seed, Syntax::Ron)));
    for _ in 0..cases(CASES) {
        let text = mutate(RON, &mut rng);
        accepted += usize::from(judge(&text, Syntax::Ron));
    }
    eprintln!("ron: {accepted} of {} accepted", cases(CASES));
    assert!(
        accepted * 20 > cases(CASES),
        "the mutations are too harsh: {accepted} left"
    );
    let in_blocks = IN_BLOCKS.load(Ordering::Relaxed);
    assert!(in_blocks * 50 > cases(CASES), "{in_blocks} in blocks");
}

#[test]
fn json_is_exact() {
    use serde::de::IgnoredAny;
    use serde_json::error::Category;
    let mut rng = Rng(0x1234_5678_9abc_def1);
    let (mut accepted, mut read, mut refused) = (0, 0, 0);
    for _ in 0..cases(CASES) {
        let text = mutate(JSON, &mut rng);
        accepted += usize::from(judge(&text, Syntax::Json));
        let tree = parse(&text, Syntax::Json);
        let body = text.strip_prefix('\u{feff}').unwrap_or(&text);
        let faults = tree.faults();
        let ignored = serde_json::from_str::<IgnoredAny>(body);
        match serde_json::from_str::<serde_json::Value>(body) {
            Ok(_) => {
                read += 1;
                assert!(faults.is_empty(), "{faults:?}\nin {text}");
            }
            Err(e) if e.to_string().starts_with("number out of range") => match ignored {
                Ok(_) if text.contains("\\ud") => {}
                Ok(_) => assert!(faults.is_empty(), "{faults:?}\nin {text}"),
                Err(_) => assert!(!faults.is_empty(), "no fault in {text}"),
            },
            Err(e) => {
                assert!(matches!(e.classify(), Category::Syntax | Category::Eof));
                refused += 1;
                assert!(!faults.is_empty(), "{e}, and no fault in {text}");
            }
        }
    }
    eprintln!(
        "json: {accepted} scenes, {read} other or well-formed, {refused} no JSON, of {}",
        cases(CASES)
    );
    assert!(read * 20 > cases(CASES) && accepted * 50 > cases(CASES));
}

/// Scenes in every spelling, whole and mutated.
#[test]
fn the_fast_reader_agrees_with_the_others() {
    for syntax in [Syntax::Ron, Syntax::Json] {
        let mut rng = Rng(0x0123_4567_89ab_cdef);
        let (mut known, mut valid) = (0, 0);
        for case in 0..cases(CASES) {
            let mut text = spelling::scene(syntax, &mut rng);
            if case % 4 == 0 {
                text = mutate(&[&text], &mut rng);
            }
            let (is_known, is_valid) = compare(&text, syntax);
            known += usize::from(is_known);
            valid += usize::from(is_valid);
        }
        let all = cases(CASES);
        eprintln!("{}: {valid} of {all} valid, {known} known", syntax.name());
        assert!(valid * 4 > all, "the mutations are too harsh: {valid} left");
        assert!(known * 2 > valid, "hardly anything is known: {known}");
    }
}

/// Ordinary scenes never need the slow readers.
#[test]
fn ordinary_scenes_are_known() {
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR"));
    // Each case in `tests/valid` has a rare feature, but seldom in its spelling.
    for (folder, share) in [("scenes", 1.0), ("tests/valid", 0.8)] {
        let (mut all, mut unknown) = (0, Vec::new());
        for file in std::fs::read_dir(root.join(folder)).unwrap() {
            let path = file.unwrap().path();
            let Some(syntax) = Syntax::of_path(&path) else {
                continue;
            };
            let (is_known, is_valid) = compare(&std::fs::read_to_string(&path).unwrap(), syntax);
            all += 1;
            if is_valid && !is_known {
                unknown.push(path);
            }
        }
        let most = f64::from(all) * (1.0 - share);
        assert!(all > 5 && unknown.len() as f64 <= most, "{unknown:#?}");
    }
}
