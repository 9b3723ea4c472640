//! The order of the rooms: checks all imports against the tables of `ARCHITECTURE.md`.
//!
//! The tables define the order. This test reads them, so that no second list is needed.

use std::{
    collections::{BTreeMap, BTreeSet},
    fs,
    path::{Path, PathBuf},
};

/// The modules of the program; all others are the library.
const PROGRAM: [&str; 2] = ["cli", "main"];

#[test]
fn every_room_is_in_the_table_and_every_row_is_a_room() {
    let rows = Table::read("Room");
    let mut listed: Vec<&str> = rows.names().collect();
    let count = listed.len();
    listed.sort_unstable();
    listed.dedup();
    assert_eq!(listed.len(), count, "a room is in the table twice");
    let rooms: BTreeSet<String> = sources().iter().map(|file| file.path[0].clone()).collect();
    let rooms: Vec<&str> = rooms.iter().map(String::as_str).collect();
    assert_eq!(listed, rooms, "left: ARCHITECTURE.md, right: src/");
    assert!(rooms.len() <= 18 + ["lib.rs", "main.rs"].len(), "{rooms:?}");
}

#[test]
fn every_file_of_a_room_with_a_table_is_in_it() {
    for (room, rows) in inner_tables() {
        let mut listed: Vec<&str> = rows.names().collect();
        listed.sort_unstable();
        let files = sources();
        let files: BTreeSet<&str> = files
            .iter()
            .filter(|file| file.path[0] == room && file.path.len() > 1)
            .map(|file| file.path[1].as_str())
            .filter(|file| *file != "tests")
            .collect();
        let files: Vec<&str> = files.into_iter().collect();
        assert_eq!(listed, files, "left: ARCHITECTURE.md, right: src/{room}/");
    }
}

#[test]
fn every_path_in_the_pages_for_contributors_exists() {
    let mut seen = 0;
    let mut missing = Vec::new();
    for page in ["ARCHITECTURE.md", "CONTRIBUTING.md"] {
        let text = fs::read_to_string(root().join(page)).unwrap();
        for path in paths(&text) {
            seen += 1;
            let folders = ["", "src", "src/tracer", "src/text", "src/scene"]
                .map(|folder| root().join(folder));
            if !folders.iter().any(|folder| folder.join(path).exists()) {
                missing.push(format!("{page}: {path}"));
            }
        }
    }
    assert!(missing.is_empty(), "{missing:#?}");
    assert!(seen > 80, "only {seen} paths were found");
}

#[test]
fn paths_are_recognized_in_code() {
    let page = "`src/lib.rs`, `film.rs`, [a](docs/a.md), `.strahl/`, `strahl new`, `f32`\n\
                ```text\nscene/ `code/`\n```\n`deny.toml` `fov` `/ 2`";
    let found: Vec<&str> = paths(page).collect();
    assert_eq!(found, ["src/lib.rs", "film.rs", "docs/a.md", "deny.toml"]);
}

#[test]
fn imports_go_upwards_only() {
    let (rooms, inner) = (Table::read("Room"), inner_tables());
    let mut faults = Vec::new();
    let mut seen = 0;
    for file in sources() {
        for import in imports(&file.path, &file.text) {
            seen += 1;
            if let Err(why) = check(&rooms, &inner, &file.path, &import) {
                faults.push(format!("{}: {import:?}: {why}", file.name));
            }
        }
    }
    assert!(faults.is_empty(), "\n{}\n", faults.join("\n"));
    assert!(seen > 100, "only {seen} imports were found");
}

// A `mod.rs` gives its children what they share; only a circle beside that makes files hard to read apart.
#[test]
fn no_more_than_three_files_import_each_other() {
    let is_test = |file: &Source| file.path.iter().any(|part| part == "tests");
    let mut files = sources();
    files.retain(|file| !is_test(file));
    let modules = files.iter().filter(|file| file.name.ends_with("mod.rs"));
    let modules: BTreeSet<_> = modules.map(|file| file.path.as_slice()).collect();
    let graph: BTreeMap<_, BTreeSet<_>> = files
        .iter()
        .map(|file| {
            let imports = imports(&file.path, &file.text).into_iter();
            let files = imports.filter_map(|import| {
                let mut ends = (1..=import.len()).rev();
                let longest = ends.find(|end| files.iter().any(|to| to.path == import[..*end]))?;
                Some(import[..longest].to_vec())
            });
            let is_parent = |to: &[String]| {
                file.path.starts_with(to) && (modules.contains(to) || file.path == to)
            };
            let others = files.filter(|to| !is_parent(to));
            (file.path.clone(), others.collect())
        })
        .collect();
    let reached = graph.keys().map(|file| {
        let (mut reached, mut open) = (BTreeSet::new(), vec![file]);
        while let Some(next) = open.pop() {
            open.extend(graph[next].iter().filter(|to| reached.insert(*to)));
        }
        (file, reached)
    });
    let reached: BTreeMap<_, _> = reached.collect();
    let mut largest = 0;
    for (file, others) in &reached {
        let circle: Vec<_> = others
            .iter()
            .filter(|other| reached[**other].contains(file))
            .map(|other| other.join("/"))
            .collect();
        assert!(circle.len() <= 3, "these import each other: {circle:#?}");
        largest = largest.max(circle.len());
    }
    assert_eq!(largest, 3, "left: the largest circle");
}

#[test]
fn files_are_opened_in_one_place() {
    let mut found = Vec::new();
    for file in sources() {
        let is_test = file.path.iter().any(|part| part == "tests");
        if is_test || file.path == ["diagnostic", "reading"] {
            continue;
        }
        let code = file.text.split("#[cfg(test)]\nmod tests").next().unwrap();
        let code: Vec<_> = code
            .lines()
            .filter(|line| !line.trim().starts_with("//"))
            .collect();
        for other in [
            "File::open",
            "fs::read(",
            "fs::read_to_string",
            ".read(true)",
        ] {
            // A record is opened to append to it.
            let is_record = other == ".read(true)" && file.path == ["cli", "record"];
            if !is_record && code.iter().any(|line| line.contains(other)) {
                found.push(format!(
                    "{}: `{other}`; use diagnostic::open_file",
                    file.name
                ));
            }
        }
    }
    assert!(found.is_empty(), "\n{}\n", found.join("\n"));
}

#[test]
fn a_wrong_import_is_found() {
    let (rooms, inner) = (Table::read("Room"), inner_tables());
    for (module, text, right) in [
        ("scene::build", "use crate::tracer::world::World;", true),
        ("scene::build", "use crate::{render::RayTracer};", false),
        (
            "scene::build",
            "let x = crate::image_file::buffer();",
            false,
        ),
        ("tracer::ray", "use crate::film::Film;", false),
        ("tracer::ray", "use super::camera::Camera;", false),
        ("tracer::world", "use super::{ray::Ray, hit::Hit};", true),
        ("tracer::hit", "use crate::tracer::world::World;", false),
        ("tracer::shape::plane", "use super::in_front;", true),
        (
            "tracer::shape::plane",
            "use super::super::world::World;",
            false,
        ),
        (
            "scene::format::scene",
            "use crate::scene::check::check;",
            false,
        ),
        ("text::lines", "use super::syntax::Tree;", false),
        ("film", "use crate::{Color, tracer::ray::Ray};", false),
        ("film", "use crate::tracer::{ray::*};", false),
        (
            "film",
            "// use crate::cli::run;\nlet s = \"crate::cli\";",
            true,
        ),
        (
            "film",
            "#[cfg(test)]\nmod tests {\n    use super::*;\n}",
            true,
        ),
        (
            "film",
            "pub(crate) fn x(c: char) -> bool { c == '\"' }",
            true,
        ),
        (
            "film",
            "use crate::{parallel as p, tracer::ray::Ray};",
            false,
        ),
        ("film", "crate::tracer::world::hit::<f64>();", true),
        (
            "film",
            "let s = r#\"crate::cli\"#; crate::cli::x::<f64>();",
            false,
        ),
        ("film", "fn x<'a>(s: &'a str) { crate::cli::x(s) }", false),
        ("cli::man", "use super::{Cli, Failure};", true),
        ("cli::man", "use strahl::Scene;", true),
        ("cli::man", "use strahl::*;", false),
        ("main", "use crate::cli::run;", true),
        ("lib", "pub use crate::tracer::ray::Ray;", true),
        ("lib", "pub use crate::cli::run;", false),
    ] {
        let module: Vec<String> = module.split("::").map(str::to_owned).collect();
        let checked = imports(&module, text)
            .iter()
            .try_for_each(|import| check(&rooms, &inner, &module, import));
        assert_eq!(checked.is_ok(), right, "{module:?}: {text}: {checked:?}");
    }
}

/// Checks that a module may import `import`, a path from the root.
fn check(
    rooms: &Table,
    inner: &[(&str, Table)],
    module: &[String],
    import: &[String],
) -> Result<(), String> {
    if import.last().is_some_and(|last| last == "*") {
        return Err("`*` hides what is imported".to_owned());
    }
    let (from, to) = (module[0].as_str(), import[0].as_str());
    if to == "strahl" {
        // The compiler checks the public API.
        return Ok(());
    }
    let here = rooms.row(from)?;
    let there = rooms
        .row(to)
        .map_err(|_| "not from the module that defines it".to_owned())?;
    if from != to {
        let crosses = PROGRAM.contains(&from) != PROGRAM.contains(&to);
        if crosses || there >= here {
            return Err(format!("`{to}` does not stand above `{from}`"));
        }
        if rooms.rows[here].never.iter().any(|never| never == to) {
            return Err(format!("`{from}` does not know `{to}`"));
        }
    } else if let Some((_, table)) = inner.iter().find(|(room, _)| *room == from)
        && let ([_, from, ..], [_, to, ..]) = (module, import)
        && from != to
        && !module.iter().any(|part| part == "tests")
        && table.row(to)? > table.row(from)?
    {
        return Err(format!("`{to}` does not stand above `{from}`"));
    }
    Ok(())
}

/// The tables of the rooms with an internal order.
fn inner_tables() -> [(&'static str, Table); 3] {
    ["tracer", "text", "scene"].map(|room| (room, Table::read(&format!("In `{room}/`"))))
}

/// A table of `ARCHITECTURE.md`: the names in the first column, from the top, and those in the last
/// column.
struct Table {
    rows: Vec<Row>,
}

struct Row {
    names: Vec<String>,
    never: Vec<String>,
}

impl Table {
    /// The table whose heading begins with `| heading |`.
    fn read(heading: &str) -> Self {
        let text = fs::read_to_string(root().join("ARCHITECTURE.md")).unwrap();
        let rows: Vec<Row> = text
            .lines()
            .skip_while(|line| !line.starts_with(&format!("| {heading} |")))
            .skip(2)
            .take_while(|line| line.starts_with('|'))
            .map(|line| {
                let cells: Vec<&str> = line.trim_matches('|').split('|').collect();
                Row {
                    names: quoted(cells[0]),
                    never: cells.get(2).map_or_else(Vec::new, |cell| quoted(cell)),
                }
            })
            .collect();
        assert!(!rows.is_empty(), "ARCHITECTURE.md has no table {heading:?}");
        Self { rows }
    }

    fn names(&self) -> impl Iterator<Item = &str> {
        self.rows
            .iter()
            .flat_map(|row| row.names.iter().map(String::as_str))
    }

    fn row(&self, name: &str) -> Result<usize, String> {
        let mut rows = self.rows.iter();
        let at = rows.position(|row| row.names.iter().any(|known| known == name));
        at.ok_or_else(|| format!("`{name}` is not in the table"))
    }
}

/// Returns the names in backticks: `scene/` and `film.rs` as `scene` and `film`.
fn quoted(cell: &str) -> Vec<String> {
    let names = cell.split('`').skip(1).step_by(2);
    let names = names.map(|name| name.trim_end_matches('/').trim_end_matches(".rs"));
    names.map(str::to_owned).collect()
}

/// Returns the paths in backticks or links of a page, outside code blocks. Names that begin with a
/// dot are skipped: only some clones have these hidden files.
fn paths(page: &str) -> impl Iterator<Item = &str> {
    const ENDINGS: [&str; 3] = [".rs", ".md", ".toml"];
    let prose = page.split("```").step_by(2);
    let words = prose.flat_map(|text| text.split(['`', '(', ')']));
    words.filter(|word| {
        let is_path = word.contains('/') || ENDINGS.iter().any(|ending| word.ends_with(ending));
        let is_one_word = !word.contains(char::is_whitespace) && !word.contains(':');
        is_path && is_one_word && !word.starts_with('.') && *word != "strahl.toml"
    })
}

struct Source {
    name: String,
    /// The module's path from the root.
    path: Vec<String>,
    text: String,
}

fn sources() -> Vec<Source> {
    let folder = root().join("src");
    let mut files = Vec::new();
    let mut folders = vec![folder.clone()];
    while let Some(next) = folders.pop() {
        for entry in fs::read_dir(next).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|ending| ending == "rs") {
                let inside = path.strip_prefix(&folder).unwrap().with_extension("");
                let parts = inside.iter().map(|part| part.to_str().unwrap().to_owned());
                files.push(Source {
                    name: path.display().to_string(),
                    path: parts.filter(|part| part != "mod").collect(),
                    text: fs::read_to_string(&path).unwrap(),
                });
            }
        }
    }
    files.sort_by(|a, b| a.name.cmp(&b.name));
    files
}

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).to_owned()
}

/// Returns every crate path that a module uses outside its tests, from the root.
fn imports(module: &[String], text: &str) -> Vec<Vec<String>> {
    let text = text.replace('\r', "");
    let text = text
        .split("#[cfg(test)]\nmod tests {")
        .next()
        .unwrap_or_default();
    let words = words(text);
    let mut found = Vec::new();
    for (at, word) in words.iter().enumerate() {
        let begins = at == 0 || words[at - 1] != "::";
        if begins
            && words.get(at + 1).is_some_and(|next| next == "::")
            && matches!(word.as_str(), "crate" | "self" | "super" | "strahl")
        {
            tree(&words, at, &[], &mut found);
        }
    }
    found
        .into_iter()
        .filter_map(|path| absolute(module, path))
        .collect()
}

/// Reads `a::{b::c, d}` from `words[at..]` into a path for each leaf; returns the end position.
fn tree(words: &[String], mut at: usize, before: &[String], found: &mut Vec<Vec<String>>) -> usize {
    let mut path = before.to_vec();
    loop {
        match words.get(at).map(String::as_str) {
            Some("{") => {
                at += 1;
                while words.get(at).is_some_and(|word| word != "}") {
                    at = match words[at].as_str() {
                        "," => at + 1,
                        "as" => at + 2,
                        _ => tree(words, at, &path, found).max(at + 1),
                    };
                }
                return at + 1;
            }
            Some(word) if word == "*" || is_name(word) => path.push(word.to_owned()),
            // `name::<T>()`
            _ => {
                found.push(path);
                return at;
            }
        }
        if words.get(at + 1).is_none_or(|word| word != "::") {
            found.push(path);
            return at + 1;
        }
        at += 2;
    }
}

/// Returns a path from the root, or `None` for a path inside the module itself.
fn absolute(module: &[String], path: Vec<String>) -> Option<Vec<String>> {
    let mut base = match path[0].as_str() {
        "strahl" => return Some(path),
        "crate" => Vec::new(),
        _ => module.to_vec(),
    };
    for part in path {
        match part.as_str() {
            "crate" | "self" => {}
            "super" => drop(base.pop()),
            _ => base.push(part),
        }
    }
    (!base.is_empty()).then_some(base)
}

fn is_name(word: &str) -> bool {
    word.starts_with(|c: char| c.is_alphabetic() || c == '_')
}

/// Returns the names and punctuation of a text, without comments, strings and characters.
fn words(text: &str) -> Vec<String> {
    let mut words = Vec::new();
    let mut rest = text;
    while let Some(first) = rest.chars().next() {
        let length = if rest.starts_with("//") {
            rest.find('\n').unwrap_or(rest.len())
        } else if rest.starts_with("/*") {
            rest.find("*/").map_or(rest.len(), |end| end + 2)
        } else if let Some(raw) = raw_string(rest) {
            raw
        } else if first == '"' {
            string(rest)
        } else if first == '\'' {
            character(rest)
        } else if rest.starts_with("::") {
            words.push("::".to_owned());
            2
        } else if is_name(&rest[..first.len_utf8()]) {
            let end = rest.find(|c: char| !c.is_alphanumeric() && c != '_');
            let end = end.unwrap_or(rest.len());
            words.push(rest[..end].to_owned());
            end
        } else {
            if !first.is_whitespace() {
                words.push(first.to_string());
            }
            first.len_utf8()
        };
        rest = &rest[length..];
    }
    words
}

/// Returns the length of `"…"`.
fn string(text: &str) -> usize {
    let mut escaped = false;
    for (at, c) in text.char_indices().skip(1) {
        match c {
            '"' if !escaped => return at + 1,
            '\\' => escaped = !escaped,
            _ => escaped = false,
        }
    }
    text.len()
}

/// Returns the length of `r"…"`, `r#"…"#` and so on.
fn raw_string(text: &str) -> Option<usize> {
    let hashes = text.strip_prefix("br").or(text.strip_prefix('r'))?;
    let body = hashes.trim_start_matches('#');
    let count = hashes.len() - body.len();
    let body = body.strip_prefix('"')?;
    let closing = format!("\"{}", "#".repeat(count));
    let end = body
        .find(&closing)
        .map_or(body.len(), |at| at + closing.len());
    Some(text.len() - body.len() + end)
}

/// Returns the length of `'c'`, or of the `'` of a lifetime.
fn character(text: &str) -> usize {
    let mut inside = text[1..].chars();
    match (inside.next(), inside.next()) {
        (Some('\\'), Some(kind)) => {
            let begun = 2 + kind.len_utf8();
            text[begun..].find('\'').map_or(1, |end| begun + end + 1)
        }
        (Some(c), Some('\'')) => 2 + c.len_utf8(),
        _ => 1,
    }
}

#[test]
fn the_public_api_is_small() {
    let text = fs::read_to_string(root().join("src/lib.rs")).unwrap();
    let words = words(&text);
    let mut names = Vec::new();
    for (at, word) in words.iter().enumerate().filter(|(_, word)| *word == "pub") {
        match words[at + 1].as_str() {
            "use" => drop(tree(&words, at + 2, &[], &mut names)),
            _ => names.push(vec![word.clone(), words[at + 2].clone()]),
        }
    }
    assert!(names.len() > 30, "only {} names were found", names.len());
    assert!(names.len() <= 44, "{} names: {names:#?}", names.len());
    let is_hidden = |path: &&Vec<String>| path.last().is_some_and(|last| last == "*");
    assert_eq!(names.iter().find(is_hidden), None);
}

#[test]
fn only_simd_may_hold_unsafe_code() {
    let root = fs::read_to_string("src/lib.rs").unwrap();
    let mut is_forbidden = false;
    let mut rooms = Vec::new();
    for line in root.lines() {
        let declared = line.trim_start_matches("pub ").strip_prefix("mod ");
        if let Some(room) = declared.and_then(|rest| rest.strip_suffix(';')) {
            rooms.push((room, is_forbidden));
        }
        // Other attributes may come between this one and the room.
        is_forbidden = line == "#[forbid(unsafe_code)]" || is_forbidden && line.starts_with("#[");
    }
    assert!(rooms.contains(&("tracer", true)), "{rooms:?}");
    rooms.retain(|(_, is_forbidden)| !is_forbidden);
    assert_eq!(rooms, [("simd", false)]);
    let program = fs::read_to_string("src/main.rs").unwrap();
    assert!(program.contains("#![forbid(unsafe_code)]"));
}

/// The names that several types still share. A name that leaves this list stays away.
const SHARED_NAMES: &str = "\
    Answer Args Around Array Arriving At Block Blocks Bounds Builder Bytes Cell Change Checked \
    Column Columns Common Cone Content Copies Corners Counts Crossing Crossings Cut Draw Drawing \
    Drawn Element Elements Encoding End Entry Excerpt Extent Eye Failure Farthest Fault Fields \
    Fill FirstOfEach Form Format Frame Frames Grid Header Hits Index Interpolation \
    Item Items Job Kinds Known Lanes Last Layer Layout Leaf Leaves Level Levels Light LightTerms \
    Line Lines List Lists Mark Materials Name Names Near Needs Node Number One Opening Order \
    OutputFormat Own Palette Parts Passage Path Pending Pixel Placed Places Plain Plan Plane \
    Printer Project Queue Range Rays Reader Record Refused Region Report Request Result Round \
    Rows Rule Run Runs Samples Scalar Search See Seen Selection SetLevel Settings Shading Shape \
    Shared Sheared Side Solid Source Span Spare Spot Stage Stamp State Step Summary Surface \
    Tally Target Terms Text Tree Type Value Variant Vector Waiting Walk Wanted Way Words Work";

#[test]
fn a_type_name_occurs_once() {
    let mut places: BTreeMap<String, Vec<String>> = BTreeMap::new();
    for file in sources() {
        if file.path.iter().any(|part| part == "tests") {
            continue;
        }
        let code = file.text.split("#[cfg(test)]\nmod tests {").next();
        for line in code.unwrap_or_default().lines() {
            // A `type` inside of a block belongs to a trait.
            let is_inner = line.starts_with(' ');
            let words = words(line);
            let is_word = |word: &&String| *word != "pub" && *word != "crate" && *word != "super";
            let mut words = words.iter().filter(is_word);
            let words = words
                .by_ref()
                .skip_while(|word| "()in::".contains(word.as_str()));
            if let [kind, name] = *words.take(2).collect::<Vec<_>>()
                && is_name(name)
                && (matches!(kind.as_str(), "struct" | "enum" | "trait" | "union")
                    || kind == "type" && !is_inner)
            {
                places
                    .entry(name.clone())
                    .or_default()
                    .push(file.name.clone());
            }
        }
    }
    assert!(places.len() > 500, "only {} names were found", places.len());
    places.retain(|_, files| files.len() > 1);
    let shared: BTreeSet<&str> = SHARED_NAMES.split_whitespace().collect();
    let found: BTreeSet<&str> = places.keys().map(String::as_str).collect();
    let new: Vec<_> = found
        .difference(&shared)
        .map(|name| &places[*name])
        .collect();
    assert!(new.is_empty(), "types of one name: {new:#?}");
}
