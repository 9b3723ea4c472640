//! The reference in docs/ matches the code: it is generated from the descriptions of the schema and
//! the pages of the codes. `STRAHL_BLESS=1 cargo test --test docs` regenerates it.

use std::{env, fmt::Write, fs};

use serde_json::Value;
use strahl::diagnostic::{Code, describe};

#[test]
fn the_manual_of_the_format_is_up_to_date() {
    let schema: Value = serde_json::from_str(&strahl::scene::schema()).unwrap();
    let mut text = fs::read_to_string("tests/docs/scene-format.md").unwrap();
    section(&mut text, &schema, "Scene", &schema);
    for (name, definition) in schema["$defs"].as_object().unwrap() {
        section(&mut text, &schema, name, definition);
    }
    text.push('\n');
    text.push_str(&fs::read_to_string("tests/docs/equations.md").unwrap());
    compare("docs/scene-format.md", &text);
}

#[test]
fn the_manual_of_the_diagnostics_is_up_to_date() {
    let mut text = String::from(
        "# Diagnostics\n\nEverything that Strahl finds wrong with a scene has a code. A code never \
         changes its meaning. `strahl explain CODE` prints its page.\n\n\
         | Code | Severity | Meaning |\n| --- | --- | --- |\n",
    );
    for code in Code::ALL {
        let meaning = describe(*code).lines().nth(2).unwrap();
        let severity = if code.on_by_default() {
            code.severity().name().to_owned()
        } else {
            format!("{}, off by default", code.severity())
        };
        writeln!(text, "| [{code}](#{code}) | {severity} | {meaning} |").unwrap();
    }
    for code in Code::ALL {
        text.push('\n');
        let mut fenced = false;
        for line in describe(*code).lines() {
            fenced ^= line.starts_with("```");
            if line.starts_with('#') && !fenced {
                text.push('#');
            }
            writeln!(text, "{line}").unwrap();
        }
    }
    compare("docs/diagnostics.md", &text);
}

#[test]
fn the_address_of_the_repository_is_that_of_cargo_toml() {
    const REPOSITORY: &str = env!("CARGO_PKG_REPOSITORY");
    let name = REPOSITORY.rsplit('/').next().unwrap();
    let mut pages = vec!["README.md".into(), "CONTRIBUTING.md".into()];
    pages.extend(
        fs::read_dir("docs")
            .unwrap()
            .map(|page| page.unwrap().path()),
    );
    let mut others = Vec::new();
    for page in pages
        .iter()
        .filter(|page| page.extension() == Some("md".as_ref()))
    {
        for (at, line) in fs::read_to_string(page).unwrap().lines().enumerate() {
            let is_here = |(start, _)| line[start..].starts_with(REPOSITORY);
            let mut addresses = line.match_indices("https://github.com/");
            let is_other = line.contains(&format!("/{name}")) && !addresses.all(is_here);
            if is_other || line.contains("OWNER") {
                others.push(format!("{}:{}: {line}", page.display(), at + 1));
            }
        }
    }
    assert!(
        others.is_empty(),
        "not of {REPOSITORY}:\n{}",
        others.join("\n")
    );
}

fn compare(path: &str, expected: &str) {
    if env::var_os("STRAHL_BLESS").is_some() {
        fs::write(path, expected).unwrap();
    }
    let found = fs::read_to_string(path).unwrap_or_default();
    assert!(
        found == expected,
        "{path} is stale: `STRAHL_BLESS=1 cargo test --test docs` writes it anew"
    );
}

/// Writes the fields of a struct, or of each variant.
fn section(text: &mut String, schema: &Value, name: &str, definition: &Value) {
    let name_of_section = name;
    let description = definition["description"].as_str().unwrap();
    writeln!(text, "\n### {name}\n\n{description}").unwrap();
    if definition["properties"].is_object() {
        table(text, schema, definition);
    }
    let variants = definition["oneOf"].as_array().into_iter().flatten();
    if name == "Solid" {
        // Described as geometries.
        let names = variants.map(|variant| {
            let (name, _) = variant["properties"]
                .as_object()
                .unwrap()
                .iter()
                .next()
                .unwrap();
            // A heading of the same text before has the anchor.
            let is_variant = |of: &Value| of["properties"][name].is_object();
            let before = schema["$defs"].as_object().unwrap().iter();
            let before = before.take_while(|(other, _)| *other != "Geometry");
            let variants = before.flat_map(|(_, of)| of["oneOf"].as_array().into_iter().flatten());
            let anchor = match variants.filter(|of| is_variant(of)).count() {
                0 => name.to_lowercase(),
                count => format!("{}-{count}", name.to_lowercase()),
            };
            format!("[{name}](#{anchor})")
        });
        let names = names.collect::<Vec<_>>().join(", ");
        writeln!(text, "\nOne of {names}.").unwrap();
        return;
    }
    let (names, variants): (Vec<_>, Vec<_>) =
        variants.partition(|variant| variant["const"].is_string());
    for name in &names {
        let meaning = name["description"].as_str().unwrap();
        write!(text, "\n- `{}`: {meaning}", name["const"]).unwrap();
    }
    if !names.is_empty() {
        text.push('\n');
    }
    for variant in variants {
        let (name, body) = variant["properties"]
            .as_object()
            .unwrap()
            .iter()
            .next()
            .unwrap();
        writeln!(
            text,
            "\n#### {name}\n\n{}",
            variant["description"].as_str().unwrap()
        )
        .unwrap();
        let picture = format!("shapes/{}", name.to_lowercase());
        if name_of_section == "Geometry" && fs::exists(format!("docs/{picture}.ron")).unwrap() {
            writeln!(text, "\n[![{name}]({picture}.png)]({picture}.ron)").unwrap();
        }
        if body["properties"].is_object() {
            table(text, schema, body);
        }
    }
    for value in definition["enum"].as_array().into_iter().flatten() {
        write!(text, "\n- `{value}`").unwrap();
    }
    if definition["enum"].is_array() {
        text.push('\n');
    }
}

fn table(text: &mut String, schema: &Value, body: &Value) {
    text.push_str("\n| Field | Type | Default | Meaning |\n| --- | --- | --- | --- |\n");
    let required: Vec<_> = body["required"].as_array().into_iter().flatten().collect();
    for (field, property) in body["properties"].as_object().unwrap() {
        let default = match &property["default"] {
            _ if required.iter().any(|name| *name == field) => "required".to_owned(),
            Value::Null => "none".to_owned(),
            default => format!("`{default}`"),
        };
        let kind = kind(schema, property);
        let description = property["description"].as_str().unwrap();
        writeln!(text, "| `{field}` | {kind} | {default} | {description} |").unwrap();
    }
}

/// Returns the type of a property in a word or two.
fn kind(schema: &Value, property: &Value) -> String {
    if let Some(name) = property["$ref"].as_str() {
        let name = name.rsplit('/').next().unwrap();
        assert!(schema["$defs"][name].is_object());
        return format!("[{name}](#{})", name.to_lowercase());
    }
    let any_of = property["anyOf"].as_array();
    if let Some(first) = any_of.and_then(|all| all.first())
        && property["type"].is_null()
    {
        return kind(schema, first);
    }
    let name = match &property["type"] {
        Value::Array(names) => names[0].as_str(),
        name => name.as_str(),
    };
    match name {
        Some("array") if property["items"]["type"] == "number" => {
            let count = if property["minItems"] == 2 {
                "two"
            } else {
                "three"
            };
            format!("{count} numbers")
        }
        Some("array") => format!("list of {}", kind(schema, &property["items"])),
        Some("integer") => "whole number".to_owned(),
        Some("object") if property["patternProperties"].is_object() => {
            "lists of keys by path".to_owned()
        }
        Some("object") => format!(
            "{} by name",
            kind(schema, &property["additionalProperties"])
        ),
        Some("boolean") => "`true` or `false`".to_owned(),
        Some(name) => name.to_owned(),
        None => "1".to_owned(),
    }
}
