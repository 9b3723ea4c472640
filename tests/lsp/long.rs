//! A client that edits a long scene at random: what the server says at once and what it says later.

use libtest_mimic::Failed;
use serde_json::{Value, json};
use strahl::{Syntax, text::Columns};

use crate::{
    client::Client,
    random::{Model, Random, compare_diagnostics},
};

/// Edits a long scene `count` times. The last diagnostics of each text are those of the library, and
/// an edit that changes a single value tells them at once, unless it makes geometries equal or different.
pub(crate) fn run(encoding: &str, columns: Columns, count: usize) -> Result<(), Failed> {
    let uri = "untitled:long";
    let mut random = Random(11 + count as u64 + encoding.len() as u64);
    let capabilities = json!({"general": {"positionEncodings": [encoding]}});
    for syntax in [Syntax::Ron, Syntax::Json] {
        let mut client = Client::initialized(&capabilities);
        let text = long_scene(syntax);
        let mut model = Model::new(&text, columns);
        client.open(uri, syntax.name(), &text);
        let mut version = 1;
        let whole = compare_diagnostics(&mut client, &model, uri, syntax)?;
        let mut equal_before = equal_geometries(&whole);
        client.forget();
        // Whether all edits but those of values were taken back.
        let mut is_scene = true;
        for index in 0..count {
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
            // How many times diagnostics were told, and how many geometries are equal to others.
            let mut count_of = |change: &Value, model: &Model| -> Result<[usize; 2], Failed> {
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
                    true => Ok([pushed.len(), equal_geometries(&whole)]),
                    false => Err(format!("pushed {pushed:?}\nwhole {whole}\n{change}").into()),
                }
            };
            let [told, equal] = count_of(&change, &model)?;
            if told > 1 && number.is_some() && is_scene && equal == equal_before {
                return Err(format!("not told at once: {change}").into());
            }
            equal_before = equal;
            let is_kept = index > count / 2 && random.below(4) == 0;
            is_scene &= !is_kept || number.is_some();
            if !is_kept {
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
                [_, equal_before] = count_of(&change, &model)?;
            }
        }
        client.finish();
    }
    Ok(())
}

/// Returns the number of geometries that are said to be equal to others, which only the check of the
/// whole text can tell.
fn equal_geometries(diagnostics: &Value) -> usize {
    let all = diagnostics.as_array().into_iter().flatten();
    all.filter(|one| one["code"] == "duplicate-geometry")
        .count()
}

/// A client that asks for diagnostics is answered at once, and told to ask again if there are more.
pub(crate) fn pulled() -> Result<(), Failed> {
    let uri = "untitled:long";
    let mut client = Client::initialized(&json!({
        "textDocument": {"diagnostic": {}},
        "workspace": {"diagnostics": {"refreshSupport": true}},
    }));
    let text = long_scene(Syntax::Ron);
    client.open(uri, "ron", &text);
    let count = |client: &mut Client| {
        let params = json!({"textDocument": {"uri": uri}});
        let report = client.ask("textDocument/diagnostic", &params).unwrap();
        equal_geometries(&report["items"])
    };
    let before = count(&mut client);
    let lines: Vec<&str> = text.lines().collect();
    let (old, new) = (lines[5000], lines[4900]);
    let start = json!({"line": 5000, "character": 0});
    let end = json!({"line": 5000, "character": old.len()});
    let change = json!({"range": {"start": start, "end": end}, "text": new});
    let document = json!({"uri": uri, "version": 2});
    client.notify(
        "textDocument/didChange",
        &json!({"textDocument": document, "contentChanges": [change]}),
    );
    let at_once = count(&mut client);
    client.wait(|message| message["method"] == "workspace/diagnostic/refresh");
    let later = count(&mut client);
    client.finish();
    match (at_once, later) == (before, before + 1) {
        true => Ok(()),
        false => Err(format!("{before}, then {at_once}, then {later}").into()),
    }
}

/// Returns a scene that is longer than those that are checked whole with every key. It has some
/// faults, names and materials.
fn long_scene(syntax: Syntax) -> String {
    const SPHERES: usize = 20_000;
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
