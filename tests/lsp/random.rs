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
struct Model {
    units: Vec<u32>,
    columns: Columns,
}

impl Model {
    fn new(text: &str, columns: Columns) -> Self {
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

    fn text(&self) -> String {
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
    fn floor(&self, mut at: usize) -> usize {
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

    fn edit_anywhere(&mut self, random: &mut Random) -> Value {
        self.edit(random, 0..self.units.len())
    }

    /// Replaces a random part of a range, and returns the change.
    fn edit(&mut self, random: &mut Random, within: Range<usize>) -> Value {
        let mut start = self.floor(within.start + random.below(within.len() + 1));
        let mut end = self.floor((start + [0, 1, 3, 40][random.below(4)]).min(within.end));
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
    fn replace(&mut self, part: Range<usize>, new: &str) -> Value {
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

/// Edits a long scene `count` times. The last diagnostics of each text are those of the library, and
/// an edit that changes a single value tells them at once.
pub(crate) fn long(encoding: &str, columns: Columns, count: usize) -> Result<(), Failed> {
    let uri = "untitled:long";
    let mut random = Random(11 + count as u64 + encoding.len() as u64);
    let capabilities = json!({"general": {"positionEncodings": [encoding]}});
    for syntax in [Syntax::Ron, Syntax::Json] {
        let mut client = Client::initialized(&capabilities);
        let text = long_scene(syntax);
        let mut model = Model::new(&text, columns);
        client.open(uri, syntax.name(), &text);
        let mut version = 1;
        compare_diagnostics(&mut client, &model, uri, syntax)?;
        for _ in 0..count {
            let before = model.units.clone();
            let start = random.below(model.units.len());
            let is_number = |at: &usize| {
                let digit = |at: usize| (48..58).contains(&model.units[at]);
                digit(*at) && model.units[at - 1] == u32::from('.') && !digit(at + 1)
            };
            let number = (start..model.units.len() - 1).find(is_number);
            let number = number.filter(|_| random.below(2) == 0);
            let change = match number {
                Some(at) => model.replace(at..at + 1, "57"),
                None => model.edit(&mut random, start..(start + 300).min(before.len())),
            };
            let mut count_of = |change: &Value, model: &Model| -> Result<usize, Failed> {
                version += 1;
                let document = json!({"uri": uri, "version": version});
                let params = json!({"textDocument": document, "contentChanges": [change]});
                client.notify("textDocument/didChange", &params);
                let whole = compare_diagnostics(&mut client, model, uri, syntax)?;
                let pushed = client.take("textDocument/publishDiagnostics");
                let last = pushed.last().map(|last| &last["params"]);
                let is_last = last
                    .is_some_and(|last| last["version"] == version && last["diagnostics"] == whole);
                match is_last && pushed.len() <= 2 {
                    true => Ok(pushed.len()),
                    false => Err(format!("pushed {pushed:?}\nwhole {whole}\n{change}").into()),
                }
            };
            if count_of(&change, &model)? > 1 && number.is_some() {
                return Err(format!("not told at once: {change}").into());
            }
            // Most edits are taken back, so that the text stays a scene.
            if random.below(10) > 0 {
                let from = before.iter().zip(&model.units).take_while(|(a, b)| a == b);
                let from = model.floor(from.count());
                let rest = before[from..].iter().rev();
                let same = rest.zip(model.units[from..].iter().rev());
                let mut same = same.take_while(|(a, b)| a == b).count();
                while model.floor(model.units.len() - same) != model.units.len() - same {
                    same -= 1;
                }
                let [old, new] = [before.len(), model.units.len()].map(|all| from..all - same);
                let units = before[old].to_vec();
                let back = Model { units, columns }.text();
                let change = model.replace(new, &back);
                count_of(&change, &model)?;
            }
        }
        client.finish();
    }
    Ok(())
}

/// Returns a scene that is longer than those that are checked whole with every key. It has some
/// faults, names and materials.
fn long_scene(syntax: Syntax) -> String {
    const SPHERES: usize = 14_000;
    let spheres = (0..SPHERES).map(|index| {
        let radius = if index % 900 == 7 { "-1.5" } else { "0.5" };
        let (x, y) = (index % 61, index - usize::from(index % 1100 == 1003) * 61);
        let more = match index % 50 {
            0 => ["material: Named(\"gold\")", "\"material\": {\"Named\": \"gold\"}"],
            1 => ["color: \"#f0f\", name: \"é🙂 %\"", "\"color\": \"#f0f\", \"name\": \"é🙂 %\""],
            _ => ["color: \"#336699\"", "\"color\": \"#336699\""],
        };
        match syntax {
            Syntax::Ron => format!(
                "        Sphere(center: ({x}, {y}, 0.25), radius: {radius}, {}),\n",
                more[0].replace('%', &index.to_string())
            ),
            Syntax::Json => format!(
                "        {{\"Sphere\": {{\"center\": [{x}, {y}, 0.25], \"radius\": {radius}, {}}}}},\n",
                more[1].replace('%', &index.to_string())
            ),
        }
    });
    let spheres: String = spheres.collect();
    match syntax {
        Syntax::Ron => format!(
            "(\n    camera: Orthographic(eye: (0, 0, 9), gaze: (0, 0, -1), scale: 90.5),\n    \
             lights: [Headlight()],\n    materials: {{\"gold\": Mirror(color: \"#fd0\")}},\n    \
             geometries: [\n{spheres}    ],\n    animation: (frames: 2, tracks: \
             {{\"geometries[13000].radius\": [(0, 1.5), (1, 2.5)]}}),\n)\n"
        ),
        Syntax::Json => format!(
            "{{\n    \"camera\": {{\"Orthographic\": {{\"eye\": [0, 0, 9], \"gaze\": [0, 0, -1], \
             \"scale\": 90.5}}}},\n    \"materials\": {{\"silver\": {{\"Mirror\": {{}}}}}},\n    \
             \"geometries\": [\n{}    ]\n}}\n",
            spheres.trim_end_matches([',', '\n'])
        ),
    }
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
fn compare_diagnostics(
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
