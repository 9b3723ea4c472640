//! Laws of formatted texts, tested on random scenes with comments in random places.

use std::{
    fs,
    ops::Range,
    time::{Duration, Instant},
};

use crate::text::print::format;
use crate::{
    scene::tests::oracle,
    text::syntax::{Syntax, parse},
    tracer::random::{Rng, cases},
};

/// Number of random texts; `STRAHL_CASES` overrides it.
const CASES: usize = 5_000;

impl Rng {
    fn one_in(&mut self, n: usize) -> bool {
        self.below(n) == 0
    }

    fn of<T: Copy>(&mut self, all: &[T]) -> T {
        all[self.below(all.len())]
    }
}

/// A value before it is written.
enum Value {
    Leaf(String),
    Tuple(Option<&'static str>, Vec<Value>),
    Struct(Option<&'static str>, Vec<(String, Value)>),
    List(Vec<Value>),
    Map(Vec<(Value, Value)>),
}

fn leaf(text: &str) -> Value {
    Value::Leaf(text.to_owned())
}

const NUMBERS: &[&str] = &[
    "0",
    "1",
    "-0",
    "0.5",
    "-3.25",
    "1e3",
    "640",
    "0.12345678901234567890123456789",
    "-1234567890123456789012345678901234567890.5",
];
const RON_NUMBERS: &[&str] = &["+5", ".5", "1.", "1_000.5", "2f64"];
const WORDS: &[&str] = &[
    "0x5A",
    "inf",
    "NaN",
    "None",
    "true",
    "Blue",
    "()",
    "'c'",
    "'\"'",
    "'\\''",
    "b'x'",
    "b\"a */\"",
];
const STRINGS: &[&str] = &[
    r##""#ff0000""##,
    "\"\"",
    r#""a \"b\" // c""#,
    "\"/* no comment */\"",
    "\"变, (\"",
];
const RON_STRINGS: &[&str] = &[
    "r\"raw \\ */\"",
    "r#\"a \"b\" // c\"#",
    "\"two  \n  lines\"",
    "\"two\r\nlines\"",
    "r\"raw\n\n\n lines  \n\"",
    "\"joined \\\n   lines\"",
];
const KEYS: &[&str] = &["a", "radius", "r#type", "变", "a_long_name_of_a_field"];

fn number(rng: &mut Rng, syntax: Syntax) -> Value {
    if syntax == Syntax::Ron && rng.one_in(4) {
        return leaf(rng.of(RON_NUMBERS));
    }
    leaf(rng.of(NUMBERS))
}

fn triple(rng: &mut Rng, syntax: Syntax) -> Value {
    Value::Tuple(None, (0..3).map(|_| number(rng, syntax)).collect())
}

/// Creates a scene that the loader accepts.
fn scene(rng: &mut Rng, syntax: Syntax) -> Value {
    let color = |rng: &mut Rng| match rng.below(3) {
        0 => leaf("\"#f80\""),
        1 if syntax == Syntax::Ron => leaf("r#\"#ff8000\"#"),
        _ => triple(rng, syntax),
    };
    let ron = syntax == Syntax::Ron;
    let mut fields = Vec::new();
    let mut field = |name: &str, value| fields.push((name.to_owned(), value));
    if rng.one_in(2) {
        field("version", leaf("1"));
    }
    if rng.one_in(2) {
        let sides = ["width", "height"].map(|side| (side.to_owned(), leaf("480")));
        let sides = sides.into_iter().take(rng.below(3)).collect();
        let name = (ron && rng.one_in(3)).then_some("Image");
        field("image", Value::Struct(name, sides));
    }
    let camera = vec![
        ("eye".to_owned(), triple(rng, syntax)),
        ("gaze".to_owned(), triple(rng, syntax)),
        ("fov".to_owned(), leaf("90")),
    ];
    field("camera", Value::Struct(Some("Perspective"), camera));
    if rng.one_in(2) {
        field("background", color(rng));
    }
    let geometries = (0..rng.below(4)).map(|_| {
        let mut fields = vec![
            ("center".to_owned(), triple(rng, syntax)),
            ("radius".to_owned(), number(rng, syntax)),
            ("color".to_owned(), color(rng)),
        ];
        let turn = rng.below(3);
        fields.rotate_left(turn);
        Value::Struct(Some("Sphere"), fields)
    });
    field("geometries", Value::List(geometries.collect()));
    if rng.one_in(3) {
        let names = (0..rng.below(5)).map(|_| leaf("\"eye-inside\"")).collect();
        field("allow", Value::List(names));
    }
    let turn = rng.below(fields.len());
    fields.rotate_left(turn);
    Value::Struct((ron && rng.one_in(3)).then_some("Scene"), fields)
}

/// Creates any value without a syntax fault.
fn wild(rng: &mut Rng, syntax: Syntax, depth: usize) -> Value {
    let ron = syntax == Syntax::Ron;
    let kind = if depth == 0 { 0 } else { rng.below(10) };
    let count = rng.of(&[0, 0, 1, 1, 2, 3, 12]);
    let count = if depth > 4 { count.min(1) } else { count };
    let name = (ron && rng.one_in(2)).then_some("Foo");
    let children = |rng: &mut Rng| (0..count).map(|_| wild(rng, syntax, depth - 1)).collect();
    match kind {
        0..=3 if depth > 50 => Value::List(vec![wild(rng, syntax, depth - 1)]),
        0 | 1 => number(rng, syntax),
        2 if ron && rng.one_in(2) => leaf(rng.of(RON_STRINGS)),
        2 => leaf(rng.of(STRINGS)),
        3 if ron => leaf(rng.of(WORDS)),
        3 => leaf(rng.of(&["null", "true", "false"])),
        4 | 5 => Value::List(children(rng)),
        6 => Value::Tuple(name, children(rng)),
        7 if ron => {
            let children: Vec<Value> = children(rng);
            let mut keys = (0..count).map(|_| wild(rng, syntax, depth.min(3) - 1));
            Value::Map(keys.by_ref().zip(children).collect())
        }
        _ => {
            let children: Vec<Value> = children(rng);
            let keyed = children.into_iter().map(|value| {
                let key = rng.of(KEYS).to_owned();
                (key, value)
            });
            Value::Struct(name, keyed.collect())
        }
    }
}

/// Appends the tokens of a value; the last comma in RON brackets is random.
fn tokens(value: &Value, syntax: Syntax, rng: &mut Rng, out: &mut Vec<String>) {
    let ron = syntax == Syntax::Ron;
    let push = |out: &mut Vec<String>, text: &str| out.push(text.to_owned());
    let (open, close) = match value {
        Value::Leaf(text) => return push(out, text),
        Value::List(_) => ("[", "]"),
        Value::Tuple(..) if !ron => ("[", "]"),
        Value::Map(_) => ("{", "}"),
        Value::Struct(..) if !ron => ("{", "}"),
        _ => ("(", ")"),
    };
    let mut closers = vec![close];
    if let Value::Tuple(Some(name), _) | Value::Struct(Some(name), _) = value {
        if ron {
            push(out, name);
        } else {
            out.extend(["{".to_owned(), format!("\"{name}\""), ":".to_owned()]);
            closers.push("}");
        }
    }
    push(out, open);
    let start = out.len();
    let comma = |out: &mut Vec<String>| {
        if out.len() > start {
            out.push(",".to_owned());
        }
    };
    match value {
        Value::Leaf(_) => {}
        Value::Tuple(_, items) | Value::List(items) => {
            for item in items {
                comma(out);
                tokens(item, syntax, rng, out);
            }
        }
        Value::Struct(_, fields) => {
            for (key, value) in fields {
                comma(out);
                out.push(if ron { key.clone() } else { format!("{key:?}") });
                push(out, ":");
                tokens(value, syntax, rng, out);
            }
        }
        Value::Map(entries) => {
            for (key, value) in entries {
                comma(out);
                tokens(key, syntax, rng, out);
                push(out, ":");
                tokens(value, syntax, rng, out);
            }
        }
    }
    if ron && rng.one_in(2) {
        comma(out);
    }
    out.extend(closers.into_iter().map(str::to_owned));
}

const ATTRIBUTES: &[&[&str]] = &[
    &["#", "!", "[", "enable", "(", "implicit_some", ")", "]"],
    &[
        "#",
        "!",
        "[",
        "enable",
        "(",
        "unwrap_newtypes",
        ",",
        "implicit_some",
        ",",
        ")",
        "]",
    ],
    &["#", "!", "[", "type", "=", "\"a */ b\"", "]"],
    &["#", "!", "[", "schema", "=", "r\"a\"", "]"],
];

/// Line comments include their line end.
const COMMENTS: &[&str] = &[
    "// a\n",
    "//\n",
    "// 变 (\n",
    "// x */\n",
    "// \"q\n",
    "// [\n\n",
    "// white space \t \n",
    "// , :\n",
    "// /* not open\n",
    "/**/",
    "/* b */",
    "/* b */",
    "/*/ c /*/ n */ m */",
    "/* two\n lines */",
    "/* 变\n\n\n\n   x  \n*/",
    "/* a, b: c */",
    "/*(*/",
    "/* \" */",
    "/* ends in spaces \n */",
];
const SPACES: &[&str] = &[" ", " ", "  ", "\t", "\n", "\n", "\n\n", "\n  \n\n\n"];

/// Appends white space and comments.
fn trivia(rng: &mut Rng, syntax: Syntax, out: &mut String) {
    for _ in 0..=rng.below(4) {
        if syntax == Syntax::Ron && rng.one_in(2) {
            out.push_str(rng.of(COMMENTS));
        } else {
            out.push_str(rng.of(SPACES));
        }
    }
}

/// Writes tokens with trivia between them, each with a probability of `percent`.
fn written(tokens: &[String], syntax: Syntax, percent: usize, rng: &mut Rng) -> String {
    // In strings, line ends are part of the value.
    let ends = rng.of(&["\n", "\n", "\r\n", "mixed"]);
    let mut text = String::new();
    if rng.one_in(20) {
        text.push('\u{feff}');
    }
    for index in 0..=tokens.len() {
        let mut between = String::new();
        if rng.below(100) < percent {
            trivia(rng, syntax, &mut between);
        }
        match ends {
            "mixed" => {
                for (index, line) in between.split('\n').enumerate() {
                    if index > 0 {
                        text.push_str(rng.of(&["\n", "\r\n"]));
                    }
                    text.push_str(line);
                }
            }
            _ => text.push_str(&between.replace('\n', ends)),
        }
        if let Some(token) = tokens.get(index) {
            text.push_str(token);
        }
    }
    if syntax == Syntax::Ron && rng.one_in(10) {
        text.push_str("// without a line end");
    }
    text
}

/// A piece of a text as split by the lexical grammar alone.
struct Piece {
    range: Range<usize>,
    is_comment: bool,
}

fn pieces(text: &str) -> Vec<Piece> {
    let mut pieces = Vec::new();
    let mut at = text.len() - text.trim_start_matches('\u{feff}').len();
    while let Some(first) = text[at..].chars().next() {
        let rest = &text[at..];
        if first.is_whitespace() {
            at += first.len_utf8();
            continue;
        }
        let is_comment = rest.starts_with("//") || rest.starts_with("/*");
        let length = if rest.starts_with("//") {
            let line = rest.split('\n').next().unwrap_or(rest);
            line.trim_end_matches('\r').len()
        } else if is_comment {
            let (mut depth, mut end) = (1, 2);
            while depth > 0 {
                match &rest.as_bytes()[end..] {
                    [b'/', b'*', ..] => (depth, end) = (depth + 1, end + 2),
                    [b'*', b'/', ..] => (depth, end) = (depth - 1, end + 2),
                    _ => end += 1,
                }
            }
            end
        } else {
            token(rest)
        };
        pieces.push(Piece {
            range: at..at + length,
            is_comment,
        });
        at += length;
    }
    pieces
}

/// Returns the length of the token at the start of a text.
fn token(rest: &str) -> usize {
    let plain = rest.strip_prefix('b').unwrap_or(rest);
    let prefix = rest.len() - plain.len();
    if let Some(raw) = plain.strip_prefix('r') {
        let hashes = raw.len() - raw.trim_start_matches('#').len();
        if raw[hashes..].starts_with('"') {
            let end = format!("\"{}", "#".repeat(hashes));
            let content = prefix + 1 + hashes + 1;
            return content + rest[content..].find(&end).unwrap() + end.len();
        }
    }
    if let Some(quote) = plain.chars().next().filter(|c| matches!(c, '"' | '\'')) {
        let mut escaped = false;
        for (index, c) in plain.char_indices().skip(1) {
            if c == quote && !escaped {
                return prefix + index + 1;
            }
            escaped = c == '\\' && !escaped;
        }
    }
    let is_word = |c: char| c.is_alphanumeric() || "_.+-".contains(c);
    let head = if rest.starts_with("r#") { 2 } else { 0 };
    match rest[head..].find(|c| !is_word(c)) {
        Some(0) => rest.chars().next().map_or(0, char::len_utf8),
        Some(length) => head + length,
        None => rest.len(),
    }
}

/// Returns the tokens, without commas before a closing bracket, and the comments: their lines
/// without trailing white space, and the number of tokens before them, commas and colons excluded.
fn meaning(text: &str) -> (Vec<&str>, Vec<(String, usize)>) {
    let mut tokens: Vec<&str> = Vec::new();
    let mut comments = Vec::new();
    let mut before = 0;
    for piece in pieces(text) {
        let source = &text[piece.range];
        if piece.is_comment {
            let lines: Vec<_> = source.lines().map(str::trim_end).collect();
            comments.push((lines.join("\n"), before));
            continue;
        }
        if matches!(source, ")" | "]" | "}") && tokens.last() == Some(&",") {
            tokens.pop();
        }
        before += usize::from(!matches!(source, "," | ":"));
        tokens.push(source);
    }
    (tokens, comments)
}

/// Formats a text and panics unless all laws hold.
fn judge(text: &str, syntax: Syntax) -> String {
    let tree = parse(text, syntax);
    assert!(tree.faults().is_empty(), "{:?} in\n{text}", tree.faults());
    let once = format(text, &tree);
    let shown = || format!("\n=== of ===\n{text}\n=== came ===\n{once}\n===\n{text:?}");
    let tree = parse(&once, syntax);
    assert!(tree.faults().is_empty(), "{:?}{}", tree.faults(), shown());
    let twice = format(&once, &tree);
    assert!(twice == once, "formatted twice: {}\n{twice}", shown());

    let (tokens, comments) = meaning(text);
    let (new_tokens, new_comments) = meaning(&once);
    assert!(tokens == new_tokens, "other tokens{}", shown());
    let texts = |comments: &[(String, usize)]| -> Vec<String> {
        comments.iter().map(|(text, _)| text.clone()).collect()
    };
    let (old, new) = (texts(&comments), texts(&new_comments));
    assert!(old == new, "other comments: {old:?} {new:?}{}", shown());
    for (old, new) in comments.iter().zip(&new_comments) {
        assert!(old == new, "{old:?} has moved{}", shown());
    }
    if let Ok(model) = oracle::model(text, syntax) {
        let new = oracle::model(&once, syntax).unwrap();
        assert_eq!(format!("{model:?}"), format!("{new:?}"), "{}", shown());
    }

    let mut outside = text.to_owned();
    for piece in pieces(text).into_iter().rev() {
        if !piece.is_comment {
            outside.replace_range(piece.range, "x");
        }
    }
    let end = match outside.split_once('\n') {
        Some((line, _)) if line.ends_with('\r') => "\r\n",
        _ => "\n",
    };
    assert!(once.ends_with(end), "the last line has no end{}", shown());
    let mut at = 0;
    let pieces = pieces(&once);
    // Attributes stay as written.
    let head = tree.attributes().last().map_or(0, |range| range.end);
    for piece in &pieces {
        if piece.range.start >= head && at >= head {
            let gap = &once[at..piece.range.start];
            let lines: Vec<_> = gap.split(end).collect();
            let inner = &lines[..lines.len() - 1];
            assert!(lines.len() <= 3, "blank lines before {at}{}", shown());
            assert!(
                inner.iter().all(|line| line.is_empty()),
                "white space at the end of a line before {at}{}",
                shown()
            );
            assert!(
                !lines.concat().contains(['\n', '\r']),
                "line ends{}",
                shown()
            );
        }
        at = piece.range.end;
    }
    assert!(
        pieces[0].range.start == 0,
        "nothing at the start{}",
        shown()
    );
    assert_eq!(&once[at..], end, "one line end at the end{}", shown());
    once
}

#[test]
fn scenes_of_this_repository_are_formatted() {
    let root = concat!(env!("CARGO_MANIFEST_DIR"), "/");
    let mut paths: Vec<_> = ["src/scene/new.ron", "src/scene/new.json"]
        .map(|path| format!("{root}{path}").into())
        .into();
    let scenes = fs::read_dir(format!("{root}scenes")).unwrap();
    paths.extend(scenes.map(|entry| entry.unwrap().path()));
    let mut count = 0;
    for path in paths {
        let Some(syntax) = Syntax::of_path(&path) else {
            continue;
        };
        let text = fs::read_to_string(&path).unwrap();
        judge(&text, syntax);
        judge(&text.replace('\n', "\r\n"), syntax);
        // The formatted text does not depend on the trivia between the tokens, except for comments.
        let mut rng = Rng(0x5851_f42d_4c95_7f2d);
        let tokens: Vec<_> = pieces(&text)
            .into_iter()
            .filter(|piece| !piece.is_comment)
            .map(|piece| text[piece.range].to_owned())
            .collect();
        let bare = judge(&tokens.concat(), syntax);
        for _ in 0..20 {
            judge(&written(&tokens, syntax, 30, &mut rng), syntax);
            let spaced = tokens.join(rng.of(&[" ", "\t", "\n", " \n "]));
            assert_eq!(judge(&spaced, syntax), bare);
        }
        count += 1;
    }
    assert!(count > 5);
}

#[test]
fn random_texts_keep_the_laws() {
    let mut rng = Rng(0x9e37_79b9_7f4a_7c15);
    let mut loaded = 0;
    for case in 0..cases(CASES) {
        let syntax = if rng.one_in(5) {
            Syntax::Json
        } else {
            Syntax::Ron
        };
        let value = match case % 4 {
            0 | 1 => scene(&mut rng, syntax),
            2 => wild(&mut rng, syntax, 4),
            _ if rng.one_in(20) => wild(&mut rng, syntax, 100),
            _ => wild(&mut rng, syntax, 7),
        };
        let mut all = Vec::new();
        if syntax == Syntax::Ron && rng.one_in(4) {
            for _ in 0..=rng.below(2) {
                all.extend(rng.of(ATTRIBUTES).iter().map(|token| (*token).to_owned()));
            }
        }
        tokens(&value, syntax, &mut rng, &mut all);
        let percent = rng.of(&[0, 3, 10, 30, 95]);
        let text = written(&all, syntax, percent, &mut rng);
        judge(&text, syntax);
        loaded += usize::from(oracle::model(&text, syntax).is_ok());
    }
    assert!(loaded * 3 > cases(CASES), "too few scenes: {loaded}");
}

/// Much more than a linear printer needs, and much less than a quadratic one.
const PATIENCE: Duration = Duration::from_secs(20);

fn timed(what: &str, text: &str, syntax: Syntax) {
    let tree = parse(text, syntax);
    assert!(tree.faults().is_empty(), "{what}: {:?}", tree.faults());
    let start = Instant::now();
    let formatted = format(text, &tree);
    let time = start.elapsed();
    let speed = text.len() as f64 / 1e6 / time.as_secs_f64();
    eprintln!("{what}: {} bytes, {time:?}, {speed:.1} MB/s", text.len());
    assert!(time < PATIENCE, "{what}");
    let again = parse(&formatted, syntax);
    assert!(again.faults().is_empty(), "{what}: {:?}", again.faults());
    assert_eq!(format(&formatted, &again).len(), formatted.len(), "{what}");
}

#[test]
fn time_is_linear() {
    const MANY: usize = 100_000;
    let sphere = "Sphere(center: (1.5, -2, 3), radius: 1, color: \"#f00\"),";
    let spheres = format!("(geometries:[{}])", sphere.repeat(MANY));
    timed("spheres", &spheres, Syntax::Ron);
    let sphere = "Sphere( // one\n  center: (1.5, -2, 3), /* two */ radius: 1),\n";
    let spheres = format!("(geometries:[{}])", sphere.repeat(MANY));
    timed("commented spheres", &spheres, Syntax::Ron);
    let json = "{\"Sphere\":{\"center\":[1.5,-2,3],\"radius\":1}}";
    let spheres = format!("{{\"geometries\":[{}]}}", vec![json; MANY].join(","));
    timed("JSON", &spheres, Syntax::Json);

    let block = "/* x */".repeat(MANY);
    for text in [
        format!("(a: 1, {block}\n b: 2)"),
        format!("(a: 1 {block}, b: 2)"),
        format!("(a: 1, {block} b: 2)"),
        format!("(a: {block} 1)"),
        format!("(a {block}: 1)"),
        format!("Scene {block} ()"),
        format!("{block} ()"),
        format!("() {block}"),
        format!("#![enable(implicit_some)] {block}\n()"),
        format!("#![enable({block} implicit_some)]\n()"),
        format!("[{block} 1]"),
        format!("[{block}]"),
    ] {
        timed("comments on one line", &text, Syntax::Ron);
    }
    let lines = "// x\n".repeat(MANY);
    for text in [
        format!("(a: 1, {lines} b: 2)"),
        format!("(a: {lines} 1)"),
        format!("Scene {lines} ()"),
        format!("{lines} ()"),
    ] {
        timed("comments on lines", &text, Syntax::Ron);
    }
    let huge = "x".repeat(1_000_000);
    let key = format!("({huge}: 1)");
    timed("a long key", &key, Syntax::Ron);
    let string = format!("(a: \"{huge}\", b: /* {huge} */ (1, 2, [\"{huge}\", 3]))");
    timed("long strings", &string, Syntax::Ron);
    timed(
        "elements",
        &format!("[{}]", "1,".repeat(5 * MANY)),
        Syntax::Ron,
    );
    timed(
        "entries",
        &format!("{{{}}}", "(1): (2),".repeat(MANY)),
        Syntax::Ron,
    );
    timed("units", &format!("[{}]", "(),".repeat(MANY)), Syntax::Ron);
    let deep = format!("{}{}", "[".repeat(100), "]".repeat(100));
    timed(
        "depth",
        &format!("[{}]", format!("{deep},").repeat(MANY / 100)),
        Syntax::Ron,
    );
}
