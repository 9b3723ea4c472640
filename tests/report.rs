//! One sample in every format, and properties that hold for any text.

use std::{fmt::Write as _, fs, ops::Range, path::Path, time::Instant};

use strahl::{
    Diagnostic,
    diagnostic::{Code, Path as At},
    report::{FileReport, OutputFormat, Style, Summary, Suppressed, reporter},
    text::Lines,
};

const SCENE: &str = "\u{feff}(\r
\tversion: 1,\r
\tcamera: Perspective(\r
\t\teye: (0, 0, 0), gaze: (0, 1, 0), up: (0, 2, 0), fov: 190,\r
\t),\r
\tgeometries: [ // 日本語 🙂\r
\t\tSphere(center: (0, 0, -3), radius: -1, color: \"日本🙂\"),\r
\t\tSphere(center: (1, 0, -3), radius: 1 color: (255, 0, 0)),\r
\t\tSphere(\r
\t\t\tcenter: (0, 0, -3),\r
\t\t\tradius: -1,\r
\t\t\tcolor: \"#0f0\",\r
\t\t),\r
\t],\r
";

fn range(needle: &str) -> Range<usize> {
    let start = SCENE.find(needle).unwrap();
    start..start + needle.len()
}

fn findings() -> Vec<Diagnostic> {
    let end = SCENE.len();
    let comma = range(" color: (255").start;
    let later = range("Sphere(\r").start..range("),\r\n\t],").start + 1;
    vec![
        Diagnostic::new(
            Code::ParallelVectors,
            range("(0, 1, 0)"),
            "`gaze` is parallel to `up`",
        )
        .with_path(At::ROOT.field("camera").field("gaze"))
        .with_label(range("(0, 2, 0)"), "`up` is this")
        .with_help("give an `up` that points somewhere else"),
        Diagnostic::new(
            Code::OutOfRange,
            range("190"),
            "the angle `190` is not between 0 and 180",
        )
        .with_path(At::ROOT.field("camera").field("fov"))
        .with_help(
            "`fov` is the full vertical angle in degrees: 2α of the camera equation, so an \
                 α of 45 is written as 90",
        ),
        Diagnostic::new(
            Code::OutOfRange,
            range("-1"),
            "the radius `-1` is not above 0",
        )
        .with_path(At::ROOT.field("geometries").index(0).field("radius")),
        Diagnostic::new(
            Code::InvalidColor,
            range("\"日本🙂\""),
            "`日本🙂` is no color",
        )
        .with_path(At::ROOT.field("geometries").index(0).field("color"))
        .with_help("write `\"#rrggbb\"` or `(r, g, b)`"),
        Diagnostic::new(
            Code::Syntax,
            comma..comma,
            "expected a comma, found `color`",
        ),
        Diagnostic::new(
            Code::ColorClamped,
            range("255"),
            "the channel `255` is not in 0..1",
        )
        .with_path(
            At::ROOT
                .field("geometries")
                .index(1)
                .field("color")
                .index(0),
        )
        .with_help("an 8-bit value? write `1.0`"),
        Diagnostic::new(Code::DuplicateGeometry, later, "this sphere is there twice")
            .with_path(At::ROOT.field("geometries").index(2))
            .with_label(range("Sphere"), "equal to this one"),
        Diagnostic::new(
            Code::Syntax,
            end..end,
            "expected `)`, found the end of the file",
        )
        .with_label(range("("), "to close this one"),
    ]
}

fn page(code: Code) -> &'static str {
    match code {
        Code::OutOfRange => {
            "# out-of-range\n\nA number is outside of its range.\n\nThe radius of a sphere is \
             above 0.\n\nWrite a number inside of the range."
        }
        other => other.name(),
    }
}

fn report<'a>(file: &'a str, text: &'a str, diagnostics: &'a [Diagnostic]) -> FileReport<'a> {
    FileReport {
        file,
        text,
        diagnostics,
        suppressed: Suppressed::default(),
        ..FileReport::default()
    }
}

fn written(format: OutputFormat, style: Style, files: &[FileReport<'_>]) -> String {
    let mut out = Vec::new();
    let mut reporter = reporter(format, style, page, &mut out);
    let mut summary = Summary::default();
    for file in files {
        summary.count(file);
        reporter.file(file).unwrap();
    }
    reporter.finish(&summary).unwrap();
    String::from_utf8(out).unwrap()
}

fn sample(format: OutputFormat, style: Style) -> String {
    let findings = findings();
    let unreadable = [
        Diagnostic::new(Code::Unreadable, 0..0, "there is no such file")
            .with_help("did you mean `second.ron`?"),
    ];
    let files = [
        FileReport {
            suppressed: Suppressed {
                errors: 37,
                warnings: 2,
            },
            time: std::time::Duration::from_micros(1500),
            ..report("scenes/first one.ron", SCENE, &findings)
        },
        report("second.ron", "()", &[]),
        report("secnd.ron", "", &unreadable),
    ];
    written(format, style, &files)
}

fn human(text: &str, diagnostics: &[Diagnostic], width: usize) -> String {
    let style = Style {
        color: false,
        width,
    };
    written(
        OutputFormat::Human,
        style,
        &[report("a.ron", text, diagnostics)],
    )
}

/// Compares a text with a file, or writes the file if `STRAHL_BLESS=1`.
fn expect(name: &str, actual: &str) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("tests/report")
        .join(name);
    if std::env::var_os("STRAHL_BLESS").is_some_and(|value| value == "1") {
        fs::write(&path, actual).unwrap();
    }
    let expected = fs::read_to_string(&path).unwrap_or_default();
    assert!(
        expected == actual,
        "{} differs; now it is:\n{actual}",
        path.display()
    );
}

#[test]
fn the_sample_in_every_format() {
    for format in OutputFormat::ALL {
        let name = match format {
            OutputFormat::Human => "human.txt",
            OutputFormat::Short => "short.txt",
            OutputFormat::Json => "report.json",
            OutputFormat::Jsonl => "report.jsonl",
            OutputFormat::Sarif => "report.sarif",
            OutputFormat::Github => "github.txt",
            OutputFormat::Junit => "junit.xml",
        };
        let text = sample(*format, Style::default());
        // The sample does not change with the version of the program.
        let version = concat!("\"version\": \"", env!("CARGO_PKG_VERSION"), "\"");
        let text = text.replace(version, "\"version\": \"VERSION\"");
        let pages = concat!("/blob/v", env!("CARGO_PKG_VERSION"), "/");
        expect(name, &text.replace(pages, "/blob/vVERSION/"));
    }
}

#[test]
fn the_sample_in_a_narrow_terminal() {
    let style = Style {
        color: false,
        width: 40,
    };
    expect("human-40.txt", &sample(OutputFormat::Human, style));
}

/// Some colors differ on Windows.
#[cfg(not(windows))]
#[test]
fn the_sample_in_color() {
    let style = Style {
        color: true,
        width: 80,
    };
    expect("human-color.txt", &sample(OutputFormat::Human, style));
}

#[test]
fn every_format_without_a_file() {
    for format in OutputFormat::ALL {
        let text = written(*format, Style::default(), &[]);
        match format {
            OutputFormat::Json | OutputFormat::Sarif => {
                serde_json::from_str::<serde_json::Value>(&text).unwrap();
            }
            OutputFormat::Junit => assert!(text.ends_with("</testsuites>\n")),
            _ => assert_eq!(text, ""),
        }
    }
}

#[test]
fn json_has_the_fields_of_the_contract() {
    let text = sample(OutputFormat::Json, Style::default());
    let json: serde_json::Value = serde_json::from_str(&text).unwrap();
    assert_eq!(
        (&json["strahl"], &json["format"]),
        (&"validate/1".into(), &1.into())
    );
    assert_eq!(
        json["summary"],
        serde_json::json!({"files": 3, "errors": 44, "warnings": 4, "skipped": 0})
    );
    assert_eq!(json["diagnostics"].as_array().unwrap().len(), 9);
    let lines = sample(OutputFormat::Jsonl, Style::default());
    for (line, entry) in lines.lines().zip(json["diagnostics"].as_array().unwrap()) {
        let mut line: serde_json::Value = serde_json::from_str(line).unwrap();
        let stamp = line.as_object_mut().unwrap().remove("strahl");
        assert_eq!(stamp, Some("diagnostic/1".into()));
        assert_eq!(line, *entry);
    }
    assert_eq!(lines.lines().count(), 9);
}

/// Returns a minified scene: one line, with faults at regular intervals.
fn one_line(columns: usize, faults: usize) -> (String, Vec<Diagnostic>) {
    let mut text = String::new();
    while text.len() < columns {
        text.push_str(r#"{"Sphere":{"center":[0,0,-3],"radius":1,"color":"日"}},"#);
    }
    let diagnostics = (0..faults)
        .map(|fault| {
            let from = text[columns / faults * fault..].find("-3").unwrap();
            let start = columns / faults * fault + from;
            Diagnostic::new(Code::OutOfRange, start..start + 2, "no")
                .with_path(At::ROOT.field("geometries").index(3).field("radius"))
                .with_label(2..8, "this is the first one")
        })
        .collect();
    (text, diagnostics)
}

#[test]
fn long_lines_are_cut_at_any_width() {
    let (text, diagnostics) = one_line(100_000, 100);
    for width in [40, 80, 2000] {
        let shown = human(&text, &diagnostics, width);
        for line in shown.lines() {
            assert!(columns(line) <= width, "{width}: {line}");
        }
        let marked = shown.lines().filter(|line| line.contains("^^")).count();
        assert_eq!(marked, diagnostics.len());
        // The last position is far from its label: both are shown, without the text between them.
        let last = shown.rsplit_once("error[").unwrap().1;
        assert!(
            last.contains("Sphere") && last.contains("-3") && last.contains('…'),
            "{last}"
        );
    }
}

#[test]
fn long_lines_are_fast() {
    let (text, diagnostics) = one_line(100_000, 100);
    let best = (0..5).map(|_| {
        let start = Instant::now();
        human(&text, &diagnostics, 100);
        start.elapsed()
    });
    let best = best.min().unwrap();
    println!("100 findings on a line of 100,000 columns: {best:?}");
    // About 10 ms; looking at the whole line for each finding takes many seconds.
    assert!(best.as_secs() < 1, "{best:?}");
}

#[test]
fn a_distant_label_has_its_own_excerpt() {
    let text = "radius: 1,\n".repeat(20_000);
    let late = text.len() - 3;
    let diagnostic = Diagnostic::new(Code::DuplicateGeometry, late..late + 1, "twice")
        .with_label(8..9, "equal to this one");
    let expected = "\
warning[duplicate-geometry]: twice
     --> a.ron:20000:9
      |
20000 | radius: 1,
      |         ^
note: equal to this one
 --> a.ron:1:9
  |
1 | radius: 1,
  |         ^

";
    assert_eq!(human(&text, &[diagnostic], 80), expected);
}

#[test]
fn control_characters_never_reach_the_terminal() {
    let text = "a\u{1b}[31m\u{9b}31m\u{7}\u{202e}\u{200b}b\u{0}\rc\n";
    let diagnostics = [Diagnostic::new(Code::Syntax, 0..text.len(), text)
        .with_help(text)
        .with_path(At::ROOT.field(text))
        .with_label(1..2, text)];
    for format in OutputFormat::ALL {
        let out = written(
            *format,
            Style::default(),
            &[report(text, text, &diagnostics)],
        );
        let raw = |character: &char| character.is_control() && *character != '\n';
        assert_eq!(out.chars().find(raw), None, "{format}: {out:?}");
        assert!(!out.contains(['\u{202e}', '\u{200b}']), "{format}: {out:?}");
    }
}

#[test]
fn any_range_in_any_text() {
    let pieces = [
        "\r\n",
        "\n",
        "\r",
        "\t",
        "日本",
        "🙂",
        "👨\u{200d}👩",
        "e\u{301}",
        "\u{1b}[0m",
        "\u{3000}",
        "x",
        "          ",
        "radius: -1",
        "(",
        ")",
        "//",
        "\u{200b}",
    ];
    let mut state = 1_u64;
    let mut random = move |below: usize| {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1);
        usize::try_from(state >> 33).unwrap() % below
    };
    for _ in 0..1000 {
        let mut text = String::from(if random(4) == 0 { "\u{feff}" } else { "" });
        for _ in 0..random(200) {
            text.push_str(pieces[random(pieces.len())]);
        }
        let mut any = || {
            let (start, length) = (random(text.len() + 3), random(40) * random(12));
            start..start + length.saturating_sub(random(3))
        };
        let mut diagnostic = Diagnostic::new(Code::WrongType, any(), "no");
        let at = Lines::new(&text).position(diagnostic.range.start);
        for label in ["short", "a label that is longer than it should be", ""] {
            diagnostic = diagnostic.with_label(any(), label);
        }
        for width in [0, 40, 80] {
            let shown = human(&text, std::slice::from_ref(&diagnostic), width);
            for line in shown.lines().filter(|line| line.contains(" | ")) {
                assert!(columns(line) <= width.max(40), "{width} {text:?}: {line}");
            }
            let mut place = String::new();
            writeln!(place, "--> a.ron:{}:{}", at.line, at.column).unwrap();
            assert!(shown.contains(&place), "{place} {shown}");
            // An empty text has no line to show.
            let row = format!("{} |", at.line);
            assert_eq!(
                shown.contains(&row),
                !text.is_empty(),
                "{text:?} {diagnostic:?} {shown}"
            );
        }
        for format in OutputFormat::ALL {
            let file = report("a.ron", &text, std::slice::from_ref(&diagnostic));
            written(*format, Style::default(), &[file]);
        }
    }
}

#[test]
fn marks_are_under_their_range() {
    let pieces = [
        "\t",
        "日本",
        "🙂",
        "👨\u{200d}👩",
        "e\u{301}",
        "\u{1b}",
        "\u{3000}",
        "(1, 2)",
    ];
    for before in 0..120 {
        let mut text = String::new();
        for piece in 0..before {
            text.push_str(pieces[piece * piece % 97 % pieces.len()]);
        }
        let start = text.len();
        text.push_str("ZZZ");
        text.extend(text.clone()[..start].chars().rev());
        let diagnostic = Diagnostic::new(Code::WrongType, start..start + 3, "no");
        for width in [40, 80, 2000] {
            let shown = human(&text, std::slice::from_ref(&diagnostic), width);
            let (above, marks) = shown.split_once("ZZZ").unwrap();
            let (_, line) = above.rsplit_once('\n').unwrap();
            let marks = marks.lines().nth(1).unwrap();
            assert!(marks.ends_with("^^^"), "{shown}");
            assert_eq!(columns(line) + 3, columns(marks), "{shown}");
        }
    }
}

fn columns(line: &str) -> usize {
    line.chars()
        .map(|one| unicode_width::UnicodeWidthChar::width(one).unwrap_or(1))
        .sum()
}
