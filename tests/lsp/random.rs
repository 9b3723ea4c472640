//! A client that edits at random: the server never fails, and its diagnostics, folds and formatted
//! text are those of the client's text.

use std::{fs, ops::Range};

use libtest_mimic::Failed;
use serde_json::{Value, json};
use strahl::{
    Document, Syntax,
    scene::Source,
    text::{Columns, LineStarts, Position},
};

use crate::client::Client;

/// The number of edits between two comparisons.
const ROUND: usize = 50;
/// The number of edits after which another scene is opened.
const ONE_TEXT: usize = 1000;
/// The largest text.
const LONGEST: usize = 20_000;
/// The code of the error for a fault of the server.
const INTERNAL: i64 = -32603;

/// Texts that edits insert.
const PIECES: &[&str] = &[
    "(",
    ")",
    "[",
    "]",
    "{",
    "}",
    ",",
    ":",
    "\"",
    "'",
    "\\",
    "/*",
    "*/",
    "//",
    "\n",
    "\r\n",
    "\r",
    " ",
    "\t",
    "0",
    "1.5",
    "-",
    "#ff0000",
    "\"#0f0\"",
    "Sphere",
    "radius: 2, ",
    "geometries",
    "Named(\"gold\")",
    "é",
    "日本",
    "🙂",
    "\u{feff}",
    "\u{2028}",
    "e\u{301}",
    "r#\"",
    "\"#",
    "null",
    "true",
    "\"materials[\\\"a\\\"].color\": []",
    "file: \"a.csv\"",
];

pub(crate) struct Random(pub(crate) u64);

impl Random {
    /// The generator of S. Vigna, xorshift*.
    pub(crate) fn below(&mut self, n: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        ((self.0.wrapping_mul(0x2545_f491_4f6c_dd1d) >> 33) as usize) % n.max(1)
    }
}

/// The text of the client, in the units of its encoding, so that its edits share no code with those
/// of the server.
pub(crate) struct Model {
    pub(crate) units: Vec<u32>,
    pub(crate) columns: Columns,
}

impl Model {
    pub(crate) fn new(text: &str, columns: Columns) -> Self {
        let units = Self::units(text, columns);
        Self { units, columns }
    }

    fn units(text: &str, columns: Columns) -> Vec<u32> {
        match columns {
            Columns::Bytes => text.bytes().map(u32::from).collect(),
            Columns::Utf16 => text.encode_utf16().map(u32::from).collect(),
            Columns::Characters => text.chars().map(u32::from).collect(),
        }
    }

    pub(crate) fn text(&self) -> String {
        let units = self.units.iter();
        match self.columns {
            Columns::Bytes => String::from_utf8(units.map(|unit| *unit as u8).collect()).unwrap(),
            Columns::Utf16 => {
                let units: Vec<_> = units.map(|unit| *unit as u16).collect();
                String::from_utf16(&units).unwrap()
            }
            Columns::Characters => units.map(|unit| char::from_u32(*unit).unwrap()).collect(),
        }
    }

    /// Moves an index to the start of a character.
    pub(crate) fn floor(&self, mut at: usize) -> usize {
        at = at.min(self.units.len());
        let splits = |unit: u32| match self.columns {
            Columns::Bytes => unit & 0xc0 == 0x80,
            Columns::Utf16 => (0xdc00..0xe000).contains(&unit),
            Columns::Characters => false,
        };
        while at > 0 && self.units.get(at).is_some_and(|unit| splits(*unit)) {
            at -= 1;
        }
        at
    }

    /// Returns the position of an index that is not between CR and LF.
    fn position(&self, at: usize) -> Value {
        let (mut line, mut start) = (0, 0);
        for (index, unit) in self.units[..at].iter().enumerate() {
            let is_crlf = *unit == 13 && self.units.get(index + 1) == Some(&10);
            if *unit == 10 || *unit == 13 && !is_crlf {
                (line, start) = (line + 1, index + 1);
            }
        }
        json!({"line": line, "character": at - start})
    }

    /// Returns the index of a position.
    pub(crate) fn index(&self, position: &Value) -> usize {
        let [line, character] =
            ["line", "character"].map(|key| position[key].as_u64().unwrap() as usize);
        let ends = self.units.split_inclusive(|unit| *unit == 10).take(line);
        ends.map(<[u32]>::len).sum::<usize>() + character
    }

    fn edit_anywhere(&mut self, random: &mut Random) -> Value {
        self.edit(random, 0..self.units.len())
    }

    /// Replaces a random part of a range, and returns the change.
    pub(crate) fn edit(&mut self, random: &mut Random, within: Range<usize>) -> Value {
        let mut start = self.floor(within.start + random.below(within.len() + 1));
        // A short text grows.
        let lengths: &[usize] = if within.len() < 400 {
            &[0, 1]
        } else {
            &[0, 1, 3, 40]
        };
        let length = lengths[random.below(lengths.len())];
        let mut end = self.floor((start + length).min(within.end));
        // A position between CR and LF is that of their line's end.
        let is_inside =
            |at: usize| at > 0 && self.units[at - 1] == 13 && self.units.get(at) == Some(&10);
        start -= usize::from(start > within.start && is_inside(start));
        end = end.max(start);
        end -= usize::from(end > start && is_inside(end));
        let new = match random.below(3) {
            0 if self.units.len() < LONGEST || within.len() < self.units.len() => {
                let count = random.below(4);
                (0..count)
                    .map(|_| PIECES[random.below(PIECES.len())])
                    .collect()
            }
            1 => String::new(),
            _ => PIECES[random.below(PIECES.len())].to_owned(),
        };
        self.replace(start..end, &new)
    }

    /// Replaces a part, and returns the change.
    pub(crate) fn replace(&mut self, part: Range<usize>, new: &str) -> Value {
        let range = json!({"start": self.position(part.start), "end": self.position(part.end)});
        self.units.splice(part, Self::units(new, self.columns));
        json!({"range": range, "text": new})
    }
}

/// Edits scenes `count` times.
pub(crate) fn run(encoding: &str, columns: Columns, count: usize) -> Result<(), Failed> {
    let scenes = scenes();
    let mut random = Random(21 + count as u64 + encoding.len() as u64);
    let mut client = Client::initialized(&json!({
        "general": {"positionEncodings": [encoding]},
        "textDocument": {"diagnostic": {}},
    }));
    for start in (0..count).step_by(ONE_TEXT) {
        let (text, syntax) = &scenes[random.below(scenes.len())];
        let uri = format!("untitled:{start}");
        let mut model = Model::new(text, columns);
        client.open(&uri, syntax.name(), text);
        for version in 0..ONE_TEXT.min(count - start) {
            let edits = 1 + usize::from(random.below(5) == 0) * random.below(4);
            let changes: Vec<_> = (0..edits)
                .map(|_| model.edit_anywhere(&mut random))
                .collect();
            let document = json!({"uri": uri, "version": version + 2});
            let params = json!({"textDocument": document, "contentChanges": changes});
            client.notify("textDocument/didChange", &params);
            if random.below(4) == 0 {
                ask_anything(&mut client, &model, &uri, &mut random)?;
            }
            if version % ROUND == ROUND - 1 {
                compare(&mut client, &model, &uri, *syntax)?;
            }
        }
        compare(&mut client, &model, &uri, *syntax)?;
        client.notify(
            "textDocument/didClose",
            &json!({"textDocument": {"uri": uri}}),
        );
        client.forget();
    }
    client.finish();
    Ok(())
}

/// Edits the inside of a raw string `count` times. It is the name of a geometry, which the server
/// sends back whole, so that its text is compared with the client's byte by byte.
pub(crate) fn text(encoding: &str, columns: Columns, count: usize) -> Result<(), Failed> {
    /// The number of edits between two comparisons.
    const ROUND: usize = 5;
    /// The text before and behind what is edited. No random text has that many hashes.
    const AROUND: [&str; 2] = [
        "(geometries: [/* 🙂 */ Sphere(name: r####################\"",
        "\"####################)])",
    ];
    let uri = "untitled:text";
    let mut random = Random(2024 + count as u64 + encoding.len() as u64);
    let capabilities = json!({
        "general": {"positionEncodings": [encoding]},
        "textDocument": {"diagnostic": {}},
    });
    let mut client = Client::initialized(&capabilities);
    let text = AROUND.join("a");
    let mut model = Model::new(&text, columns);
    let [before, behind] = AROUND.map(|part| Model::units(part, columns).len());
    client.open(uri, "ron", &text);
    for version in 2..count + 2 {
        let changes = (0..1 + random.below(3)).map(|_| {
            let end = model.units.len() - behind;
            model.edit(&mut random, before..end)
        });
        let changes: Vec<_> = changes.collect();
        let document = json!({"uri": uri, "version": version});
        let params = json!({"textDocument": document, "contentChanges": changes});
        client.notify("textDocument/didChange", &params);
        if version % ROUND != 0 {
            continue;
        }
        let position = model.position(before);
        let params = json!({"textDocument": {"uri": uri}, "position": position});
        let answer = client.ask("textDocument/prepareRename", &params);
        let answer = answer.map_err(|error| error.to_string())?;
        let (text, end) = (model.text(), model.units.len() - behind);
        let inside = text.strip_prefix(AROUND[0]).unwrap();
        let inside = inside.strip_suffix(AROUND[1]).unwrap();
        // The end between CR and LF is that of their line's end.
        let range = json!({"start": position, "end": model.position(end)});
        if answer["placeholder"] != inside || answer["range"] != range {
            return Err(
                format!("the server has {answer}, the client {inside:?} at {range}").into(),
            );
        }
        client.forget();
    }
    client.finish();
    Ok(())
}

fn scenes() -> Vec<(String, Syntax)> {
    let files = fs::read_dir("scenes").unwrap();
    let mut paths: Vec<_> = files.map(|file| file.unwrap().path()).collect();
    paths.sort();
    let texts = paths.iter().filter_map(|path| {
        let syntax = Syntax::of_path(path)?;
        let text = fs::read_to_string(path).ok()?;
        (text.len() < LONGEST / 2).then_some((text, syntax))
    });
    texts.collect()
}

/// Sends a request, or several, one of which is cancelled.
fn ask_anything(
    client: &mut Client,
    model: &Model,
    uri: &str,
    random: &mut Random,
) -> Result<(), Failed> {
    const METHODS: [&str; 14] = [
        "completion",
        "hover",
        "definition",
        "references",
        "documentHighlight",
        "prepareRename",
        "rename",
        "documentSymbol",
        "foldingRange",
        "documentLink",
        "documentColor",
        "rangeFormatting",
        "onTypeFormatting",
        "codeAction",
    ];
    let method = format!("textDocument/{}", METHODS[random.below(METHODS.len())]);
    let mut place = || model.position(model.floor(random.below(model.units.len() + 1)));
    let (start, end) = (place(), place());
    let params = json!({
        "textDocument": {"uri": uri},
        "position": start,
        "range": {"start": start, "end": end},
        "context": {"includeDeclaration": true, "diagnostics": [], "triggerKind": 1},
        "newName": "new name",
        "options": {"tabSize": 4, "insertSpaces": true},
        "ch": "\n",
    });
    let id = client.request(&method, &params);
    if random.below(8) == 0 {
        client.notify("$/cancelRequest", &json!({"id": id}));
    }
    match client.answer(id) {
        Err(error) if error["code"] == INTERNAL => {
            Err(format!("{method}: {error} in {:?}", model.text()).into())
        }
        _ => Ok(()),
    }
}

/// Compares the server's diagnostics with those of the library, and returns them.
pub(crate) fn compare_diagnostics(
    client: &mut Client,
    model: &Model,
    uri: &str,
    syntax: Syntax,
) -> Result<Value, Failed> {
    let text = model.text();
    let params = json!({"textDocument": {"uri": uri}});
    let starts = LineStarts::new(&text);
    let lines = starts.lines(&text);
    let position = |offset: usize| {
        let Position { line, column } = lines.position_in(offset, model.columns);
        json!({"line": line - 1, "character": column - 1})
    };

    let report = client
        .ask("textDocument/diagnostic", &params)
        .map_err(|error| error.to_string())?;
    let found: Vec<_> = report["items"]
        .as_array()
        .unwrap()
        .iter()
        .map(|item| (item["code"].clone(), item["range"].clone()))
        .collect();
    let options = strahl::ReadOptions::new().syntax(syntax).without_tables();
    let document = Document::from_reader("", text.as_bytes(), &options).unwrap();
    let is_scene = !document.is_no_scene();
    let expected = document
        .diagnostics()
        .iter()
        .filter(|_| is_scene)
        .map(|fault| {
            let range =
                json!({"start": position(fault.range.start), "end": position(fault.range.end)});
            (json!(fault.code.name()), range)
        });
    let expected: Vec<_> = expected.collect();
    if document.suppressed().is_empty() && expected.len() < 1000 && found != expected {
        let text = if text.len() < LONGEST { &*text } else { "" };
        return Err(format!("{found:?}\n{expected:?}\n{text:?}").into());
    }
    Ok(report["items"].clone())
}

/// Compares what the server says of its text with what the library says of the client's.
fn compare(client: &mut Client, model: &Model, uri: &str, syntax: Syntax) -> Result<(), Failed> {
    compare_diagnostics(client, model, uri, syntax)?;
    let text = model.text();
    let params =
        json!({"textDocument": {"uri": uri}, "options": {"tabSize": 4, "insertSpaces": true}});
    let starts = LineStarts::new(&text);
    let lines = starts.lines(&text);
    // The text itself, as far as a formatter can show it.
    let source = Source::new(text.as_str(), syntax);
    let edits = client
        .ask("textDocument/formatting", &params)
        .map_err(|error| error.to_string())?;
    let formatted = source.format().filter(|_| source.may_be_scene());
    if let (Some(formatted), Some(edits)) = (formatted, edits.as_array()) {
        let offset = |position: &Value| {
            let count = |key: &str| position[key].as_u64().unwrap() as usize + 1;
            let place = Position {
                line: count("line"),
                column: count("character"),
            };
            lines.offset(place, model.columns)
        };
        let mut result = text.clone();
        for edit in edits.iter().rev() {
            let range = offset(&edit["range"]["start"])..offset(&edit["range"]["end"]);
            result.replace_range(range, edit["newText"].as_str().unwrap());
        }
        if result != formatted {
            return Err(format!("formatted {result:?}, expected {formatted:?}").into());
        }
    }
    Ok(())
}
