//! The time from a keystroke in a scene of 10 MB to each answer of the language server, against the
//! time that the library takes to parse the text.
//!
//! `cargo bench --bench lsp`

use std::{
    io::{BufRead, BufReader, Read, Write},
    process::{Child, ChildStdin, ChildStdout, Command, Stdio},
    time::{Duration, Instant},
};

use serde_json::{Value, json};
use strahl::{Syntax, scene::Source};

const BYTES: usize = 10_000_000;
const ROUNDS: usize = 15;
const URI: &str = "untitled:long";

struct Server {
    process: Child,
    input: ChildStdin,
    output: BufReader<ChildStdout>,
    version: u64,
}

impl Server {
    fn new() -> Self {
        let mut process = Command::new(env!("CARGO_BIN_EXE_strahl"))
            .arg("lsp")
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .expect("the server starts");
        let (input, output) = (process.stdin.take(), process.stdout.take());
        let mut server = Self {
            process,
            input: input.expect("an input"),
            output: BufReader::new(output.expect("an output")),
            version: 1,
        };
        server.send(&json!({"id": 0, "method": "initialize", "params": {"capabilities": {}}}));
        server.wait(|message| message["id"] == 0);
        server.send(&json!({"method": "initialized", "params": {}}));
        server
    }

    fn send(&mut self, message: &Value) {
        let text = message.to_string();
        let frame = format!("Content-Length: {}\r\n\r\n{text}", text.len());
        self.input.write_all(frame.as_bytes()).expect("written");
        self.input.flush().expect("written");
    }

    fn wait(&mut self, is_wanted: impl Fn(&Value) -> bool) -> Value {
        loop {
            let mut length = 0;
            loop {
                let mut line = String::new();
                self.output.read_line(&mut line).expect("a header");
                if line.trim().is_empty() {
                    break;
                }
                if let Some(value) = line.trim().strip_prefix("Content-Length: ") {
                    length = value.parse().expect("a length");
                }
            }
            let mut body = vec![0; length];
            self.output.read_exact(&mut body).expect("a message");
            let message = serde_json::from_slice(&body).expect("JSON");
            if is_wanted(&message) {
                return message;
            }
        }
    }

    fn open(&mut self, text: &str, syntax: Syntax) {
        let document = json!({"uri": URI, "languageId": syntax.name(), "version": 1, "text": text});
        self.send(&json!({"method": "textDocument/didOpen", "params": {"textDocument": document}}));
        self.diagnostics();
    }

    /// Replaces a number of characters.
    fn replace(&mut self, (line, column): (usize, usize), count: usize, text: &str) {
        self.version += 1;
        let start = json!({"line": line, "character": column});
        let end = json!({"line": line, "character": column + count});
        let change = json!({"range": {"start": start, "end": end}, "text": text});
        let document = json!({"uri": URI, "version": self.version});
        let params = json!({"textDocument": document, "contentChanges": [change]});
        self.send(&json!({"method": "textDocument/didChange", "params": params}));
    }

    fn diagnostics(&mut self) {
        let version = self.version;
        self.wait(|message| message["params"]["version"] == version);
    }

    fn ask(&mut self, method: &str, (line, column): (usize, usize)) {
        let place = json!({"line": line, "character": column});
        let params = json!({
            "textDocument": {"uri": URI},
            "position": place,
            "range": {"start": place, "end": place},
            "context": {"includeDeclaration": true, "diagnostics": [], "triggerKind": 2},
            "newName": "brass",
            "ch": "\n",
            "options": {"tabSize": 4, "insertSpaces": true},
        });
        let method = format!("textDocument/{method}");
        self.send(&json!({"id": 1, "method": method, "params": params}));
        let answer = self.wait(|message| message["id"] == 1);
        assert!(answer["error"].is_null(), "{answer}");
    }
}

/// A key: what it replaces, and by what.
struct Key {
    name: &'static str,
    replaces: &'static str,
    by: &'static str,
}

/// Keys after which the text is broken, and others after which it is not.
const KEYS: [Key; 3] = [
    Key {
        name: "a letter in a name",
        replaces: "radius",
        by: "rradius",
    },
    Key {
        name: "a digit",
        replaces: "0.7",
        by: "0.8",
    },
    Key {
        name: "a bracket",
        replaces: "radius",
        by: "(radius",
    },
];

fn scene(syntax: Syntax) -> String {
    let mut items = Vec::new();
    let mut length = 0;
    while length < BYTES {
        let index = items.len();
        let (x, y, z) = (index % 61, index * 7 % 53, index * 13 % 97);
        // Some have a name or a material of the scene.
        let more = match (syntax, index % 100) {
            (Syntax::Ron, 0) => format!("material: Named(\"gold\"), name: \"ball {index}\""),
            (Syntax::Ron, _) => format!("color: \"#{index:06x}\""),
            (Syntax::Json, 0) => {
                format!("\"material\": {{\"Named\": \"gold\"}}, \"name\": \"ball {index}\"")
            }
            (Syntax::Json, _) => format!("\"color\": \"#{index:06x}\""),
        };
        let item = match syntax {
            Syntax::Ron => {
                format!("        Sphere(center: ({x}.25, -{y}.5, {z}.125), radius: 0.7, {more})")
            }
            Syntax::Json => format!(
                "        {{\"Sphere\": {{\"center\": [{x}.25, -{y}.5, {z}.125], \"radius\": 0.7, {more}}}}}"
            ),
        };
        length += item.len() + 2;
        items.push(item);
    }
    let items = items.join(",\n");
    match syntax {
        Syntax::Ron => format!(
            "(\n    camera: Orthographic(eye: (0, 0, 200), gaze: (0, 0, -1), scale: 90),\n    lights: [Headlight()],\n    materials: {{\"gold\": Mirror(color: \"#ffd700\")}},\n    geometries: [\n{items},\n    ],\n)\n"
        ),
        Syntax::Json => format!(
            "{{\n    \"camera\": {{\"Orthographic\": {{\"eye\": [0, 0, 200], \"gaze\": [0, 0, -1], \"scale\": 90}}}},\n    \"lights\": [{{\"Headlight\": {{}}}}],\n    \"materials\": {{\"gold\": {{\"Mirror\": {{\"color\": \"#ffd700\"}}}}}},\n    \"geometries\": [\n{items}\n    ]\n}}\n"
        ),
    }
}

fn median(mut times: Vec<Duration>) -> Duration {
    times.sort();
    times[times.len() / 2]
}

fn print(what: &str, times: Vec<Duration>, parse: Duration) {
    let time = median(times);
    let ratio = time.as_secs_f64() / parse.as_secs_f64();
    println!(
        "  {what:28} {:8.1} ms  {ratio:5.2}",
        time.as_secs_f64() * 1e3
    );
}

fn main() {
    for syntax in [Syntax::Ron, Syntax::Json] {
        let text = scene(syntax);
        let lines: Vec<&str> = text.lines().collect();
        let middle = lines.len() / 2;
        let line = (middle..).find(|line| lines[*line].contains("ball"));
        let line = line.expect("a name");
        let at = |word: &str| (line, lines[line].find(word).expect("a word"));
        let parse = (0..ROUNDS).map(|_| {
            let source = Source::new(text.as_str(), syntax);
            let start = Instant::now();
            assert!(source.is_scene());
            start.elapsed()
        });
        let parse = median(parse.collect());
        println!("{}, {:.1} MB", syntax.name(), text.len() as f64 / 1e6);
        print("parse, in the library", vec![parse], parse);
        let mut server = Server::new();
        server.open(&text, syntax);
        for key in KEYS {
            println!("  {}:", key.name);
            let (_, column) = at(key.replaces);
            let is_longer = key.by.len() - key.replaces.len();
            let mut measure = |what: &str, ask: &dyn Fn(&mut Server, usize)| {
                let times = (0..ROUNDS).map(|_| {
                    let start = Instant::now();
                    server.replace((line, column), key.replaces.len(), key.by);
                    ask(&mut server, is_longer);
                    let time = start.elapsed();
                    server.replace((line, column), key.by.len(), key.replaces);
                    server.diagnostics();
                    time
                });
                print(what, times.collect(), parse);
            };
            measure("publishDiagnostics", &|server, _| server.diagnostics());
            let (_, name) = at("gold");
            let places = [
                ("completion", column),
                ("hover", column),
                ("onTypeFormatting", column),
                ("codeAction", column),
                ("documentHighlight", name),
                ("definition", name),
                ("references", name),
                ("prepareRename", name),
                ("rename", name),
                ("documentSymbol", 0),
                ("foldingRange", 0),
                ("documentColor", 0),
                ("documentLink", 0),
                ("diagnostic", 0),
            ];
            for (method, column) in places {
                measure(method, &|server, more| {
                    let more = if column == name { more } else { 0 };
                    server.ask(method, (line, column + more));
                });
            }
        }
        server.process.kill().expect("ended");
        server.process.wait().expect("ended");
    }
}
