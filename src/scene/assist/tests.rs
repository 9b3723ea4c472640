//! Completion, docs and colors at a cursor, which `|` marks.

mod law;

use std::{fs, ops::Range};

use super::Elements;
use crate::{
    diagnostic::{Code, Diagnostic, path::Path},
    scene::{
        assist::completion::Completions, document::Document, options::ReadOptions, source::Source,
    },
    text::{
        edit::{Edit, apply},
        syntax::Syntax,
    },
    tracer::random::{Rng, cases},
};

fn at(marked: &str) -> (String, usize, Syntax) {
    let offset = marked.find('|').unwrap();
    let text = marked.replacen('|', "", 1);
    let syntax = Syntax::of_text(&text);
    (text, offset, syntax)
}

fn completed(marked: &str) -> (String, Completions) {
    let (text, offset, syntax) = at(marked);
    let source = Source::new(text.as_str(), syntax);
    let found = source.completions(offset, &ReadOptions::new());
    (text, found)
}

/// Checks that the completions at a cursor begin with some labels, and include none of others.
#[track_caller]
fn check(marked: &str, first: &[&str], never: &[&str]) {
    let (_, found) = completed(marked);
    let labels: Vec<_> = found.items.iter().map(|item| &*item.label).collect();
    assert!(labels.starts_with(first), "{marked}: {labels:?}");
    for label in never {
        assert!(!labels.contains(label), "{marked}: {labels:?}");
    }
}

/// Returns the text after the completion with a label.
#[track_caller]
fn inserted(marked: &str, label: &str) -> String {
    let (text, found) = completed(marked);
    let item = found.items.iter().find(|item| item.label == label);
    let item = item.unwrap_or_else(|| panic!("{marked}: {:?}", found.items));
    apply(&text, [&[Edit::replace(found.range, &*item.insert)][..]]).0
}

#[test]
fn an_object_without_fields_is_empty() {
    let text = "(camera: Fit(projection: |))";
    let whole = "(camera: Fit(projection: Orthographic()))";
    assert_eq!(inserted(text, "Orthographic"), whole);
    let text = r#"{"camera": {"Fit": {"projection": |}}}"#;
    let whole = r#"{"camera": {"Fit": {"projection": {"Orthographic": {}}}}}"#;
    assert_eq!(inserted(text, "Orthographic"), whole);
}

#[test]
fn fields_that_are_not_given_yet() {
    check("(|)", &["geometries", "camera", "allow"], &[]);
    check("(\n  geometries: [],\n  |\n)", &[], &["geometries"]);
    check(
        "(geometries: [Sphere(|)])",
        &["center", "radius", "color", "material"],
        &[],
    );
    check(
        "(geometries: [Sphere(center: (0, 0, 0), |)])",
        &["radius"],
        &["center"],
    );
    check(
        "(geometries: [Sphere(center: (0, 0, 0), ra|)])",
        &["radius"],
        &["center"],
    );
    check(
        "(camera: Perspective(eye: (0, 0, 0), |",
        &["fov"],
        &["eye", "scale"],
    );
    check("(geometries: [Sphere(|", &["center"], &[]);
    check("(image: (|", &[], &["center"]);
    check("{|}", &["geometries"], &[]);
    check(r#"{"geometries": [{"Sphere": {"|"}}]}"#, &["center"], &[]);
    check(
        r#"{"geometries": [{"Sphere": {"center": [0, 0, 0], "ra|"}}]}"#,
        &["radius"],
        &["center"],
    );
    check(
        r#"{"cameras": {"a": {"Orthographic": {|}}}}"#,
        &["eye", "scale"],
        &["fov"],
    );
    check(
        "(cameras: {\"a\": Orthographic(|)})",
        &["eye", "scale"],
        &["fov"],
    );
    check("(materials: {\"gold\": Mirror(|)})", &["color"], &[]);
}

#[test]
fn values_that_fit() {
    check("(camera: |", &["Perspective", "Orthographic"], &[]);
    check("(camera: |\n geometries: [])", &["Perspective"], &[]);
    check("(geometries: [|])", &[], &["center"]);
    check(
        "(geometries: [Sphere(center: (0, 0, 0), radius: 1), |])",
        &["Plane", "Sphere"],
        &[],
    );
    check("(geometries: [Sp|])", &["Plane", "Sphere"], &[]);
    check("(geometries: [Sp|(radius: 1)])", &["Plane", "Sphere"], &[]);
    check("(image: (tone_mapping: |))", &["Clip", "Neutral"], &[]);
    check(
        r#"{"image": {"tone_mapping": "|"}}"#,
        &["Clip", "Neutral"],
        &[],
    );
    check(
        "(camera: Orthographic(stretch: |))",
        &["true", "false"],
        &[],
    );
    check("(lights: [|])", &["Ambient"], &[]);
    check(r#"{"camera": {|}}"#, &["Perspective"], &[]);
    check(
        "(background: \"#123456\", geometries: [Plane(color: |)])",
        &["#123456"],
        &[],
    );
    check("(allow: [|])", &["color-clamped"], &[]);
}

#[test]
fn names_of_materials() {
    let materials = "(materials: {\"gold\": Matte(color: \"#f00\"), \"glass\": Glass()}, ";
    let marked = format!("{materials}geometries: [Plane(material: Named(\"|\"))])");
    check(&marked, &["gold", "glass"], &[]);
    assert!(inserted(&marked, "gold").contains("Named(\"gold\"))"));
    let marked = format!("{materials}geometries: [Plane(material: Named(|))])");
    assert!(inserted(&marked, "glass").contains("Named(\"glass\"))"));
    let marked = r#"(geometries: [Sphere(name: "ball"), Instances(of: "|")])"#;
    assert!(inserted(marked, "ball").contains("of: \"ball\")"));
    let json = r##"{"materials": {"gold": {"Matte": {"color": "#f00"}}}, "geometries": [{"Plane": {"material": {"Named": "|"}}}]}"##;
    check(json, &["gold"], &[]);
}

#[test]
fn paths_of_tracks() {
    let text = "(camera: Perspective(eye: (0, 0, 1)), cameras: {\"a b\": Orthographic(scale: 1)},
        geometries: [Plane(name: \"floor\", point: (0, 0, 0), material: Mirror(color: (1, 1, 1)))],
        animation: (tracks: {|}))";
    let labels = [
        "camera.eye",
        "cameras[\"a b\"].scale",
        "geometries.floor.point",
    ];
    check(text, &labels, &["camera.gaze"]);
    let new = inserted(text, "cameras[\"a b\"].scale");
    assert!(new.contains("{\"cameras[\\\"a b\\\"].scale\": }"), "{new}");
    let text = text.replace("{|}", "{\"cam|\": []}");
    let new = inserted(&text, "camera.eye");
    assert!(new.contains("{\"camera.eye\": []}"), "{new}");
}

#[test]
fn paths_lead_into_groups() {
    let text =
        "(geometries: [Group(geometries: [Sphere(radius: 1, name: \"leg\"), Group(geometries: [
        Sphere(center: (0, 0, 0)), Spheres(file: \"a.csv\")])])], animation: (tracks: {|}))";
    let nested = "geometries[0].geometries[1].geometries[0].center";
    check(text, &["geometries.leg.radius", nested], &[]);
    let fields = "(geometries: [Group(geometries: [Sphere(|)])])";
    check(fields, &["center", "radius"], &["geometries"]);
    check(
        "(geometries: [Group(|)])",
        &["geometries", "name"],
        &["radius"],
    );
    let source = Source::new(text.replace('|', ""), Syntax::Ron);
    let links = source.links(&ReadOptions::new());
    assert!(links.iter().map(|link| &*link.name).eq(["a.csv"]));
}

#[test]
fn files_of_the_folder() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str| {
        let path = folder.path().join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, "").unwrap();
    };
    for name in [
        "a.csv", "b.PLY", "c.txt", ".d.csv", "f.Ron", "g.json", "in/e.npy",
    ] {
        write(name);
    }
    let labels = |marked: &str, inside: &str| -> Vec<_> {
        let (text, offset, syntax) = at(marked);
        let options = ReadOptions::new().folder(folder.path().join(inside));
        let found = Source::new(text.as_str(), syntax).completions(offset, &options);
        let word = text[found.range].to_owned();
        let items = found.items.into_iter();
        std::iter::once(word)
            .chain(items.map(|item| item.insert))
            .collect()
    };
    let ron = "(geometries: [Spheres(file: \"|\", radius: 1)])";
    let all = ["\"\"", "\"a.csv\"", "\"b.PLY\"", "\"in/\""];
    assert_eq!(labels(ron, ""), all);
    let ron = "(geometries: [Cylinders(file: \"|\", radius: 1)])";
    assert_eq!(labels(ron, ""), ["\"\"", "\"a.csv\"", "\"in/\""]);
    let ron = "(geometries: [Part(file: \"|\")])";
    assert_eq!(
        labels(ron, ""),
        ["\"\"", "\"f.Ron\"", "\"g.json\"", "\"in/\""]
    );
    let ron = "(geometries: [Spheres(file: \"in/x|, radius: 1)])";
    assert_eq!(labels(ron, ""), ["\"in/x", "\"in/e.npy\""]);
    let json = r#"{"geometries": [{"Spheres": {"file": "../|"}}]}"#;
    assert_eq!(labels(json, "in"), ["\"../\""], "outside");
}

#[test]
fn lines_are_indented_by_their_brackets() {
    let width = |marked: &str| {
        let (text, offset, syntax) = at(marked);
        Source::new(text, syntax).indentation(offset)
    };
    assert_eq!(width("(\n|"), Some(4));
    assert_eq!(width("(\n|)"), Some(0));
    assert_eq!(width("(\n  a: [\n|"), Some(6));
    assert_eq!(width("(\n  a: [\n| ]"), Some(2));
    assert_eq!(width("(a: 1)\n|"), Some(0));
    assert_eq!(width("(a: Sphere(b: 1,\n|"), Some(4));
    assert_eq!(width("( /*\n| */ a: 1)"), None);
    assert_eq!(width("{\n    \"a\": [1,\n|"), Some(8));
}

/// Returns a scene with many elements, some of which have names.
fn many(syntax: Syntax) -> String {
    let items = (0..300).map(|index| {
        let name = match (syntax, index % 7) {
            (Syntax::Ron, 3) => format!(", name: \"n{index}\""),
            (Syntax::Json, 3) => format!(", \"name\": \"n{index}\""),
            (Syntax::Ron, 4) => ", /* e) */".to_owned(),
            _ => String::new(),
        };
        let radius = if index % 40 == 5 { -1.0 } else { 1.0 };
        match syntax {
            Syntax::Ron => format!(
                "Sphere(center: ({index}, 0, 1), radius: {radius:?}, material: Named(\"a\"){name})"
            ),
            Syntax::Json => format!(
                "{{\"Sphere\": {{\"center\": [{index}, 0, 1], \"radius\": {radius:?}, \
                 \"material\": {{\"Named\": \"a\"}}{name}}}}}"
            ),
        }
    });
    let items = items.collect::<Vec<_>>().join(", ");
    match syntax {
        Syntax::Ron => format!(
            "(lights: [Headlight()], camera: Perspective(eye: (0, 0, 9), gaze: (0, 0, -1), fov: 60), \
             materials: {{\"a\": Mirror()}}, geometries: [{items}], \
             animation: (frames: 2, tracks: {{\"geometries.n150.radius\": [(0, 1)], \"|\"}}))"
        ),
        Syntax::Json => format!(
            "{{\"lights\": [{{\"Headlight\": {{}}}}], \"camera\": {{\"Perspective\": {{\"eye\": [0, 0, 9], \
             \"gaze\": [0, 0, -1], \"fov\": 60}}}}, \"materials\": {{\"a\": {{\"Mirror\": {{}}}}}}, \
             \"geometries\": [{items}], \"animation\": {{\"frames\": 2, \"tracks\": \
             {{\"geometries.n150.radius\": [[0, 1]], \"|\"}}}}}}"
        ),
    }
}

#[test]
fn an_excerpt_gives_the_same_help() {
    let mut random = Rng(22);
    let options = ReadOptions::new();
    for syntax in [Syntax::Ron, Syntax::Json] {
        let mut text = many(syntax).replace(", \"|\"", "");
        let mut elements = Elements::new(&Source::new(text.as_str(), syntax));
        let (mut shorter, mut names) = (0, 0);
        for _ in 0..cases(500) {
            let at = random.below(text.len());
            let (range, new) = match random.below(4) {
                0 => (at..(at + random.below(9)).min(text.len()), ""),
                1 => (at..at, "ra"),
                _ => (at..at, ""),
            };
            let mut edited = text.clone();
            edited.replace_range(range.clone(), new);
            let source = Source::new(edited.as_str(), syntax);
            if !source.tree().faults().is_empty() {
                continue;
            }
            text = edited;
            elements.replace(range, new.len());
            let excerpt = elements.around(&text, syntax, at);
            shorter += usize::from(excerpt.source().text().len() < text.len() / 2);
            assert_eq!(excerpt.hover(at), source.hover(at), "{at} in {text}");
            let grafted = Source::new(text.as_str(), syntax);
            elements.give_tree(&grafted);
            assert!(grafted.has_tree());
            assert_eq!(
                format!("{:?}", grafted.tree()),
                format!("{:?}", source.tree())
            );
            let name = source.name_at(at);
            assert_eq!(excerpt.name_at(at), name);
            if let Some(name) = name {
                names += 1;
                assert_eq!(excerpt.places_of(&name), source.places_of(&name));
                assert_eq!(
                    excerpt.rename(&name, "n10").ok(),
                    source.rename(&name, "n10").ok()
                );
            }
            // The indices of geometries that are left out are not offered.
            if at < text.find("animation").unwrap_or(0) {
                assert_eq!(
                    excerpt.completions(at, &options),
                    source.completions(at, &options),
                    "{at} in {text}"
                );
            }
        }
        assert!(shorter > 12 && names > 2, "{shorter} {names}");
    }
}

#[test]
fn what_goes_on_behind_an_element_is_parsed() {
    let text = format!("(geometries: [{}\n])", "Sphere(radius: 1), ".repeat(300));
    let elements = Elements::new(&Source::new(text.as_str(), Syntax::Ron));
    let at = text.match_indices("Sphere").nth(10).unwrap().0;
    for (new, is_grafted) in [("//", false), ("//\n", true), ("/* */", true)] {
        let mut elements = elements.clone();
        let mut edited = text.clone();
        edited.insert_str(at, new);
        elements.replace(at..at, new.len());
        let source = Source::new(edited.as_str(), Syntax::Ron);
        elements.give_tree(&source);
        assert_eq!(source.has_tree(), is_grafted, "{new:?}");
        let parsed = Source::new(edited, Syntax::Ron);
        let [tree, expected] = [source.tree(), parsed.tree()].map(|tree| format!("{tree:?}"));
        assert_eq!(tree, expected, "{new:?}");
    }
}

#[test]
fn paths_lead_to_geometries_that_an_excerpt_leaves_out() {
    for syntax in [Syntax::Ron, Syntax::Json] {
        let marked = many(syntax);
        let (text, offset, _) = at(&marked);
        let elements = Elements::new(&Source::new(text.as_str(), syntax));
        let excerpt = elements.around(&text, syntax, offset);
        let found = excerpt.completions(offset, &ReadOptions::new()).items;
        let has = |label: &str| found.iter().any(|item| item.label == label);
        assert!(has("geometries.n150.center") && has("geometries[2].center"));
        // Only those whose index is known.
        assert!(!has("geometries[40].center") && !has("geometries[299].center"));
    }
}

#[test]
fn an_excerpt_tells_what_is_wrong_with_a_value() {
    let mut random = Rng(5);
    let mut count = 0;
    for syntax in [Syntax::Ron, Syntax::Json] {
        let text = many(syntax).replace(", \"|\"", "");
        let options = ReadOptions::new().syntax(syntax);
        let check = |text: &str| {
            let document = Document::from_reader("", text.as_bytes(), &options).unwrap();
            let found = document.diagnostics().iter().cloned();
            // An excerpt has other indices.
            let found = found.map(|fault| Diagnostic {
                path: Path::ROOT,
                ..fault
            });
            found.collect::<Vec<_>>()
        };
        let document = Document::from_text("", text.as_str(), syntax);
        let elements = Elements::new(&Source::new(text.as_str(), syntax));
        let last = document.diagnostics();
        assert!(last.len() > 7, "{last:?}");
        for _ in 0..cases(100) {
            let from = random.below(text.len());
            let words = ["radius", "Named", "1.0", "name", "Sphere", "0, 1"];
            let word = words[random.below(words.len())];
            let Some(at) = text[from..].find(word).map(|at| from + at) else {
                continue;
            };
            let new = ["", "r", "\"x\"", "-", "(", "nan", "0"][random.below(7)];
            let mut edited = text.clone();
            edited.insert_str(at, new);
            let mut elements = elements.clone();
            elements.replace(at..at, new.len());
            let moved = |range: &Range<usize>| {
                let [start, end] = [range.start, range.end]
                    .map(|offset| offset + if offset > at { new.len() } else { 0 });
                start..end
            };
            let last: Vec<_> = last
                .iter()
                .map(|fault| fault.clone().moved(moved))
                .collect();
            let (source, cuts) = elements.around(&edited, syntax, at).into_parts();
            let part = Document::from_reader("", source.text().as_bytes(), &options).unwrap();
            let found = cuts.diagnostics(part.diagnostics(), &last).into_iter();
            let found = found.map(|fault| Diagnostic {
                path: Path::ROOT,
                ..fault
            });
            let found: Vec<_> = found.collect();
            let whole = check(&edited);
            // These wait for the whole text.
            let depends = |found: &[Diagnostic]| {
                let waits = |fault: &&Diagnostic| !fault.code.depends_on_others();
                found.iter().filter(waits).cloned().collect::<Vec<_>>()
            };
            if whole.iter().any(|fault| fault.code == Code::UnknownPath) {
                continue;
            }
            assert_eq!(depends(&found), depends(&whole), "{word} {new} {at}");
            count += 1;
        }
    }
    assert!(count > 25, "{count}");
}

#[test]
fn what_is_there_is_kept() {
    assert_eq!(
        inserted("(came|: Perspective())", "camera"),
        "(camera: Perspective())"
    );
    assert_eq!(inserted("{\"came|\": 1}", "camera"), "{\"camera\": 1}");
    assert_eq!(inserted("{\"came|\"}", "camera"), "{\"camera\": }");
    assert_eq!(inserted("{came|}", "camera"), "{\"camera\": }");
    assert_eq!(
        inserted("(geometries: [Sp|])", "Sphere"),
        "(geometries: [Sphere(center: (0, 0, 0), radius: 1, color: \"#808080\")])",
    );
    assert_eq!(
        inserted("{\"geometries\": [|]}", "Sphere"),
        "{\"geometries\": [{\"Sphere\": {\"center\": [0, 0, 0], \"radius\": 1, \"color\": \"#808080\"}}]}",
    );
    assert_eq!(
        inserted("(image: (tone_mapping: N|))", "Neutral"),
        "(image: (tone_mapping: Neutral))"
    );
}

#[test]
fn nothing_fits_in_comments_and_after_values() {
    check("( // ca|\n)", &[], &["camera"]);
    assert!(completed("( // ca|\n)").1.items.is_empty());
    assert!(completed("(camera: Perspective() |)").1.items.is_empty());
}

#[test]
fn an_empty_text_becomes_a_scene() {
    for syntax in [Syntax::Ron, Syntax::Json] {
        let found = Source::new("", syntax).completions(0, &ReadOptions::new());
        let document = Document::from_text("mine", &*found.items[0].insert, syntax);
        let errors: Vec<_> = document
            .diagnostics()
            .iter()
            .map(|one| one.code.name())
            .collect();
        assert_eq!(errors, ["empty-scene"], "{}", found.items[0].insert);
    }
}

#[test]
fn titles_and_docs() {
    let title = |marked: &str| {
        let (text, offset, syntax) = at(marked);
        Source::new(text, syntax)
            .hover(offset)
            .map(|hover| hover.title)
    };
    let found = |marked, expected: &str| assert_eq!(title(marked).as_deref(), Some(expected));
    found(
        "(image: (wi|dth: 3))",
        "width: integer, at least 1, at most 1000000, default 640",
    );
    found(
        "(geometries: [Sphere(radius: 1|2)])",
        "radius: number, above 0, required",
    );
    found("(geometries: [Sph|ere(radius: 12)])", "Sphere");
    found(r#"{"geometries": [{"Sph|ere": {"radius": 12}}]}"#, "Sphere");
    found(
        r#"{"geometries": [{"Sphere": {"rad|ius": 12}}]}"#,
        "radius: number, above 0, required",
    );
    found("(image: (tone_mapping: Cl|ip))", "Clip");
    assert_eq!(title("(image: (width: 3)) // wi|dth"), None);
}

#[test]
fn any_text_and_any_cursor() {
    let count = cases(2000);
    let mut random = Rng(20);
    let files = fs::read_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/scenes")).unwrap();
    let files = files.filter_map(|file| {
        let path = file.ok()?.path();
        let syntax = Syntax::of_path(&path)?;
        let text = fs::read_to_string(path).ok()?;
        (text.len() < 20_000).then_some((text, syntax))
    });
    let files: Vec<_> = files.collect();
    let mut below = |most: usize| random.below(most);
    let (mut fields, mut seen) = (0, 0);
    for _ in 0..count {
        let (text, syntax) = &files[below(files.len())];
        let end = boundary(text, below(text.len() + 1));
        let text = &text[..end];
        let offset = boundary(text, end.saturating_sub(below(200)));
        let document = Document::from_text("mine", text, *syntax);
        let _ = document.hover(offset);
        let _ = document.colors(offset..end);
        let found = document.completions(offset);
        let unknown = |document: &Document| {
            let of_code = document.diagnostics().iter();
            of_code.filter(|one| one.code == Code::UnknownField).count()
        };
        seen += usize::from(!found.items.is_empty());
        let Some(field) = found.items.iter().find(|item| item.insert.ends_with(": ")) else {
            continue;
        };
        fields += 1;
        let edited = document.edit(found.range, &field.insert).unwrap();
        assert!(
            unknown(&edited) <= unknown(&document),
            "{text}|{}",
            field.insert
        );
    }
    assert!(fields > count / 50, "{fields} fields of {seen} places");
}

/// Returns the last boundary of characters at or before an offset.
fn boundary(text: &str, offset: usize) -> usize {
    let is_boundary = |at: &usize| text.is_char_boundary(*at);
    (0..=offset).rev().find(is_boundary).unwrap_or(0)
}
