//! Formatting: one edit for each run of lines that change, and the text of `strahl fmt`.

use std::{
    io::Write,
    process::{Command, Stdio},
};

use libtest_mimic::Failed;
use serde_json::{Value, json};
use strahl::text::Columns;

use crate::{
    client::Client,
    random::{Model, Random},
};

/// Spoils the lines of formatted scenes at random, and has them formatted.
pub(crate) fn run(encoding: &str, columns: Columns, count: usize) -> Result<(), Failed> {
    let mut random = Random(5 + count as u64 + encoding.len() as u64);
    let mut client = Client::initialized(&json!({"general": {"positionEncodings": [encoding]}}));
    for index in 0..count {
        let uri = format!("untitled:{index}");
        let items = 1 + random.below(30);
        let (text, runs) = spoiled(items, &mut random);
        client.open(&uri, "ron", &text);
        let formatted = fmt(&text)?;
        let edits = ask(&mut client, &uri, "formatting", &Value::Null);
        if edits.len() != runs {
            return Err(format!("{} edits of {runs} runs in {text:?}", edits.len()).into());
        }
        if applied(&text, columns, &edits)? != formatted {
            return Err(format!("{edits:?} of {text:?} do not give {formatted:?}").into());
        }
        let lines = text.lines().count();
        let place = |line| json!({"line": line, "character": 0});
        let first = random.below(lines);
        let last = first + random.below(lines - first);
        let range = json!({"start": place(first), "end": place(last)});
        let near = ask(&mut client, &uri, "rangeFormatting", &range);
        // A part of a spoiled line, and none in which the range is not.
        let is_near = |edit: &Value| {
            let [start, end] = ["start", "end"].map(|end| line_of(edit, end));
            start <= last && first <= end
        };
        let part = applied(&text, columns, &near)?;
        if !near.iter().all(is_near) || fmt(&part)? != formatted {
            return Err(format!("{near:?} near {range} in {text:?}").into());
        }
    }
    client.finish();
    Ok(())
}

/// Returns a scene that is not formatted, and the number of runs of lines that are not.
fn spoiled(items: usize, random: &mut Random) -> (String, usize) {
    let line_end = ["\n", "\r\n"][random.below(2)];
    let mut lines: Vec<_> = [
        "(",
        "    camera: Orthographic(eye: (0, 0, 9), gaze: (0, 0, -1), scale: 4),",
        "    geometries: [",
    ]
    .map(|line| (line.to_owned() + line_end, false))
    .into();
    let mut is_joined = false;
    for index in 0..items {
        let line = format!(
            "        /* é🙂 {index} */ Sphere(center: ({index}, 0, 0), radius: 1, color: \"#fff\"),"
        );
        let (line, is_spoiled) = match random.below(12) {
            0 => (line.trim_start().to_owned() + line_end, true),
            1 => (line.replace(": (", ":(") + line_end, true),
            2 => (line + " \t" + line_end, true),
            3 => (
                line.replace(" radius", &format!("{line_end}{line_end}radius")) + line_end,
                true,
            ),
            4 => (
                line.replace("),", &format!("){line_end}  ,")) + line_end,
                true,
            ),
            // The next line is on this one, unless it is the last.
            5 if index + 1 < items => (line, true),
            _ => (line + line_end, false),
        };
        let ends = line.ends_with('\n');
        lines.push((line, is_spoiled || is_joined));
        is_joined = !ends;
    }
    lines.extend(["    ],", ")"].map(|line| (line.to_owned() + line_end, false)));
    if random.below(2) == 0 {
        // No end of the last line.
        *lines.last_mut().unwrap() = (")".to_owned(), true);
    }
    let runs = lines.chunk_by(|(_, one), (_, other)| one == other);
    let runs = runs.filter(|run| run[0].1).count();
    (lines.into_iter().map(|(line, _)| line).collect(), runs)
}

fn ask(client: &mut Client, uri: &str, method: &str, range: &Value) -> Vec<Value> {
    let params = json!({
        "textDocument": {"uri": uri},
        "options": {"tabSize": 4, "insertSpaces": true},
        "range": range,
    });
    let edits = client.ask(&format!("textDocument/{method}"), &params);
    edits.unwrap().as_array().unwrap().clone()
}

fn line_of(edit: &Value, end: &str) -> usize {
    edit["range"][end]["line"].as_u64().unwrap() as usize
}

/// Applies edits, which are in order and have lines between them, in the units of the client.
fn applied(text: &str, columns: Columns, edits: &[Value]) -> Result<String, Failed> {
    let mut model = Model::new(text, columns);
    if !edits.is_sorted_by(|one, next| line_of(one, "end") < line_of(next, "start")) {
        return Err(format!("{edits:?} are not sorted runs").into());
    }
    for edit in edits.iter().rev() {
        let [start, end] = ["start", "end"].map(|end| model.index(&edit["range"][end]));
        model.replace(start..end, edit["newText"].as_str().unwrap());
    }
    Ok(model.text())
}

/// Returns a text as the command formats it.
fn fmt(text: &str) -> Result<String, Failed> {
    let mut process = Command::new(env!("CARGO_BIN_EXE_strahl"))
        .args(["fmt", "--input-format", "ron", "-"])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()?;
    process.stdin.take().unwrap().write_all(text.as_bytes())?;
    let output = process.wait_with_output()?;
    match output.status.success() {
        true => Ok(String::from_utf8(output.stdout)?),
        false => Err(format!("not formatted: {text:?}").into()),
    }
}

/// A text of which every line or every other one changes is formatted in a few times its memory.
pub(crate) fn memory() -> Result<(), Failed> {
    const LINES: usize = 40_000;
    const MOST: u64 = 5;
    for every in [1, 2] {
        let items = (0..LINES).map(|index| {
            let colon = if index % every == 0 { ":" } else { ": " };
            format!("        Sphere(center{colon}({index}, 0.125, 0.25), radius: 0.5, color: \"#336699\"),\n")
        });
        let items: String = items.collect();
        let text = format!(
            "(\n    camera: Orthographic(eye: (0, 0, 9), gaze: (0, 0, -1), scale: 90),\n    \
             geometries: [\n{items}    ],\n)\n"
        );
        let mut client = Client::initialized(&json!({"textDocument": {"diagnostic": {}}}));
        client.open("untitled:a", "ron", &text);
        let params = json!({"textDocument": {"uri": "untitled:a"}});
        client.ask("textDocument/diagnostic", &params).unwrap();
        let before = client.peak_memory();
        let edits = ask(&mut client, "untitled:a", "formatting", &Value::Null);
        let more = (client.peak_memory() - before) / text.len() as u64;
        if edits.len() != [1, LINES / 2][every - 1] || more > MOST {
            return Err(format!("{} edits in {more} times the text", edits.len()).into());
        }
        client.finish();
    }
    Ok(())
}
