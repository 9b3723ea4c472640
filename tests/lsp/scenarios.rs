//! What depends on time, or on files that change.

use std::{fs, path::Path, thread, time::Duration};

use libtest_mimic::{Failed, Trial};
use serde_json::{Value, json};

use crate::client::Client;

const SCENE: &str = r##"(
    camera: Orthographic(eye: (0, 0, 9), gaze: (0, 0, -1), scale: 4),
    geometries: [Spheres(file: "atoms.csv", radius: 1, color: "#f00")],
)
"##;
const TABLE: &str = "x,y,z\n0,0,0\n";
const BROKEN: &str = "x,y\n0,0\n";

type Scenario = fn() -> Result<(), Failed>;

pub(crate) fn all() -> Vec<Trial> {
    let trials: [(&str, Scenario); 11] = [
        ("a table is watched by the program", || table(false)),
        ("a table is watched by the client", || table(true)),
        ("an unsaved table is read", unsaved_table),
        (
            "a table that changes while it is read is read again",
            table_in_flight,
        ),
        ("an unsaved part is read", unsaved_part),
        ("a part in a folder needs no camera", part_in_folder),
        ("strahl.toml is watched", config),
        ("cancelled requests are answered", cancelled),
        ("thousands of scenes in a folder", folder),
        ("a long scene", long_scene),
        ("a newer text cancels the check of the older", newer),
    ];
    let trials = trials.into_iter();
    trials.map(|(name, run)| Trial::test(name, run)).collect()
}

fn uri(path: &Path) -> String {
    format!("file://{}", path.display())
}

/// Waits for diagnostics of a version, and returns their codes.
fn codes(client: &mut Client, uri: &str, version: u64) -> Vec<String> {
    let message = client.wait(|message| {
        message["method"] == "textDocument/publishDiagnostics"
            && message["params"]["uri"] == uri
            && message["params"]["version"] == version
    });
    let items = message["params"]["diagnostics"].as_array().unwrap();
    let codes = items
        .iter()
        .map(|item| item["code"].as_str().unwrap().to_owned());
    codes.collect()
}

fn expect(found: &[String], expected: &[&str]) -> Result<(), Failed> {
    match found == expected {
        true => Ok(()),
        false => Err(format!("expected {expected:?}, found {found:?}").into()),
    }
}

fn initialized(root: &Path, capabilities: Value) -> Client {
    let mut client = Client::new();
    let params = json!({"processId": null, "rootUri": uri(root), "capabilities": capabilities});
    client.ask("initialize", &params).unwrap();
    client.notify("initialized", &json!({}));
    client
}

fn table(by_client: bool) -> Result<(), Failed> {
    let folder = tempfile::tempdir()?;
    let table = folder.path().join("atoms.csv");
    fs::write(&table, TABLE)?;
    let watches = json!({"dynamicRegistration": by_client});
    let mut client = initialized(
        folder.path(),
        json!({"workspace": {"didChangeWatchedFiles": watches}}),
    );
    if by_client {
        client.wait(|message| message["method"] == "client/registerCapability");
    }
    let scene = uri(&folder.path().join("scene.ron"));
    client.open(&scene, "ron", SCENE);
    expect(&codes(&mut client, &scene, 1), &[])?;
    fs::write(&table, BROKEN)?;
    if by_client {
        let changes = json!({"changes": [{"uri": uri(&table), "type": 2}]});
        client.notify("workspace/didChangeWatchedFiles", &changes);
    }
    expect(&codes(&mut client, &scene, 1), &["invalid-table"])?;
    client.finish();
    Ok(())
}

fn unsaved_table() -> Result<(), Failed> {
    let folder = tempfile::tempdir()?;
    let table = folder.path().join("atoms.csv");
    fs::write(&table, BROKEN)?;
    let mut client = initialized(folder.path(), json!({}));
    let scene = uri(&folder.path().join("scene.ron"));
    client.open(&scene, "ron", SCENE);
    expect(&codes(&mut client, &scene, 1), &["invalid-table"])?;
    let table = uri(&table);
    client.open(&table, "csv", TABLE);
    expect(&codes(&mut client, &scene, 1), &[])?;
    let start = json!({"line": 0, "character": 0});
    let change = json!({"range": {"start": start, "end": {"line": 0, "character": 2}}, "text": ""});
    let document = json!({"uri": table, "version": 2});
    client.notify(
        "textDocument/didChange",
        &json!({"textDocument": document, "contentChanges": [change]}),
    );
    expect(&codes(&mut client, &scene, 1), &["invalid-table"])?;
    client.finish();
    Ok(())
}

/// Neither the text in the editor nor the file may change unnoticed before the server knows that the
/// scene depends on it. Some of the moments are within the check on any machine.
fn table_in_flight() -> Result<(), Failed> {
    for moment in [10, 20, 40, 80, 160].map(Duration::from_millis) {
        table_changes_after(moment, true)?;
        table_changes_after(moment, false)?;
    }
    Ok(())
}

fn table_changes_after(moment: Duration, is_open: bool) -> Result<(), Failed> {
    let folder = tempfile::tempdir()?;
    let [table, other] = ["atoms.csv", "new"].map(|name| folder.path().join(name));
    let long = format!("x,y,z\n{}", "0,0,0\n".repeat(300_000));
    fs::write(&table, &long)?;
    fs::write(&other, BROKEN)?;
    let mut client = initialized(folder.path(), json!({}));
    let (scene, open) = (uri(&folder.path().join("scene.ron")), uri(&table));
    if is_open {
        client.open(&open, "csv", &long);
    }
    client.open(&scene, "ron", SCENE);
    thread::sleep(moment);
    if is_open {
        let document = json!({"uri": open, "version": 2});
        let change = json!({"text": BROKEN});
        let params = json!({"textDocument": document, "contentChanges": [change]});
        client.notify("textDocument/didChange", &params);
    } else {
        fs::rename(&other, &table)?;
    }
    while codes(&mut client, &scene, 1) != ["invalid-table"] {}
    client.finish();
    Ok(())
}

const WHOLE: &str = r##"(
    camera: Orthographic(eye: (0, 0, 9), gaze: (0, 0, -1), scale: 4),
    geometries: [Part(file: "ball.ron")],
)
"##;
const BALL: &str =
    "(geometries: [Sphere(center: (0, 0, 0), radius: 1, material: Matte(color: \"#f00\"))])";

fn unsaved_part() -> Result<(), Failed> {
    let folder = tempfile::tempdir()?;
    let part = folder.path().join("ball.ron");
    fs::write(&part, BALL)?;
    let mut client = initialized(folder.path(), json!({}));
    let part = uri(&part);
    client.open(&part, "ron", BALL);
    // Alone it is a scene without a camera.
    expect(&codes(&mut client, &part, 1), &["missing-field"])?;
    let scene = uri(&folder.path().join("scene.ron"));
    client.open(&scene, "ron", WHOLE);
    let found = codes(&mut client, &scene, 1);
    expect(&codes(&mut client, &part, 1), &[])?;
    expect(&found, &[])?;
    let change = json!({"text": BALL.replace("radius: 1", "radius: -1")});
    let document = json!({"uri": part, "version": 2});
    client.notify(
        "textDocument/didChange",
        &json!({"textDocument": document, "contentChanges": [change]}),
    );
    expect(&codes(&mut client, &scene, 1), &["invalid-part"])?;
    expect(&codes(&mut client, &part, 2), &["out-of-range"])?;
    let params = json!({"textDocument": {"uri": scene}});
    let links = client.ask("textDocument/documentLink", &params).unwrap();
    if links[0]["target"] != part {
        return Err(links.to_string().into());
    }
    client.finish();
    Ok(())
}

fn part_in_folder() -> Result<(), Failed> {
    let folder = tempfile::tempdir()?;
    for (name, text) in [
        ("alone.ron", BALL),
        ("ball.ron", BALL),
        ("whole.ron", WHOLE),
    ] {
        fs::write(folder.path().join(name), text)?;
    }
    let mut client = initialized(folder.path(), json!({}));
    let all = client
        .ask("workspace/diagnostic", &json!({"previousResultIds": []}))
        .unwrap();
    let found = all["items"].as_array().unwrap().iter().map(|item| {
        let name = item["uri"].as_str().unwrap().rsplit('/').next().unwrap();
        format!("{name} {}", item["items"].as_array().unwrap().len())
    });
    let mut found: Vec<_> = found.collect();
    found.sort();
    expect(&found, &["alone.ron 1", "ball.ron 0", "whole.ron 0"])?;
    client.finish();
    Ok(())
}

fn config() -> Result<(), Failed> {
    let folder = tempfile::tempdir()?;
    let text = "(camera: Orthographic(eye: (0, 0, 9), gaze: (0, 0, -1), scale: 4), geometries: [])";
    let mut client = initialized(folder.path(), json!({}));
    let scene = uri(&folder.path().join("scene.ron"));
    client.open(&scene, "ron", text);
    expect(&codes(&mut client, &scene, 1), &["empty-scene"])?;
    fs::write(
        folder.path().join("strahl.toml"),
        "allow = [\"empty-scene\"]\n",
    )?;
    expect(&codes(&mut client, &scene, 1), &[])?;
    fs::write(folder.path().join("strahl.toml"), "nonsense = 1\n")?;
    expect(&codes(&mut client, &scene, 1), &["empty-scene"])?;
    let shown = client.wait(|message| message["method"] == "window/showMessage");
    if !shown["params"]["message"]
        .as_str()
        .unwrap()
        .contains("nonsense")
    {
        return Err(shown.to_string().into());
    }
    client.finish();
    Ok(())
}

/// Returns a scene of about this many spheres.
fn many(count: usize) -> String {
    let spheres = (0..count).map(|index| {
        let (x, y) = (index % 61, index % 53);
        format!("        Sphere(center: ({x}, {y}, 0), radius: 0.5, color: \"#336699\"),\n")
    });
    format!(
        "(\n    camera: Orthographic(eye: (0, 0, 9), gaze: (0, 0, -1), scale: 90),\n    geometries: [\n{}    ],\n)\n",
        spheres.collect::<String>()
    )
}

fn cancelled() -> Result<(), Failed> {
    let mut client = Client::initialized(&json!({}));
    let text = many(20_000);
    client.open("untitled:a", "ron", &text);
    let document = json!({"textDocument": {"uri": "untitled:a"}, "options": {"tabSize": 4, "insertSpaces": true}});
    // The first keeps the others waiting.
    let ids: Vec<_> = (0..20)
        .map(|_| client.request("textDocument/formatting", &document))
        .collect();
    for id in &ids[10..] {
        client.notify("$/cancelRequest", &json!({"id": id}));
    }
    for id in &ids[..10] {
        client.answer(*id).map_err(|error| error.to_string())?;
    }
    let mut count = 0;
    for id in &ids[10..] {
        // One may have been answered before it was cancelled.
        let answer = client.answer(*id);
        count += usize::from(answer.is_err_and(|error| error["code"] == -32800));
    }
    if count == 0 {
        return Err("nothing was cancelled".into());
    }
    // One that waits for diagnostics.
    let document = json!({"uri": "untitled:a", "version": 2});
    let params = json!({"textDocument": document, "contentChanges": [{"text": text}]});
    client.notify("textDocument/didChange", &params);
    let id = client.request(
        "textDocument/diagnostic",
        &json!({"textDocument": {"uri": "untitled:a"}}),
    );
    client.notify("$/cancelRequest", &json!({"id": id}));
    client.answer(id).ok();
    client.finish();
    Ok(())
}

fn folder() -> Result<(), Failed> {
    const COUNT: usize = 2000;
    let folder = tempfile::tempdir()?;
    for index in 0..COUNT {
        fs::write(folder.path().join(format!("{index}.ron")), "(camera: 1)")?;
    }
    fs::write(folder.path().join("package.json"), "{\"name\": 1}")?;
    let mut client = initialized(folder.path(), json!({}));
    let first = client
        .ask("workspace/diagnostic", &json!({"previousResultIds": []}))
        .unwrap();
    let items = first["items"].as_array().unwrap();
    let is_full =
        |item: &Value| item["kind"] == "full" && item["items"].as_array().unwrap().len() == 2;
    if items.len() != COUNT || !items.iter().all(is_full) {
        return Err(format!("{} items", items.len()).into());
    }
    // What has not changed is not sent again, and parts are sent as they are found.
    fs::write(folder.path().join("7.ron"), "(camera: 1, geometries: 1)")?;
    let known = items
        .iter()
        .map(|item| json!({"uri": item["uri"], "value": item["resultId"]}));
    let known: Vec<_> = known.collect();
    let params = json!({"previousResultIds": known, "partialResultToken": "part"});
    let last = client.ask("workspace/diagnostic", &params).unwrap();
    if last != json!({"items": []}) {
        return Err(last.to_string().into());
    }
    let (mut unchanged, mut full) = (0, Vec::new());
    while unchanged + full.len() < COUNT {
        let part = client.wait(|message| message["method"] == "$/progress");
        for item in part["params"]["value"]["items"].as_array().unwrap() {
            match item["kind"] == "unchanged" {
                true => unchanged += 1,
                false => full.push(item["uri"].as_str().unwrap().to_owned()),
            }
        }
    }
    client.finish();
    match &*full {
        [only] if only.ends_with("/7.ron") => Ok(()),
        full => Err(format!("{full:?}").into()),
    }
}

/// Requests about a long scene are answered from its newest text.
fn long_scene() -> Result<(), Failed> {
    let text = many(30_000);
    let mut client = Client::initialized(&json!({}));
    client.open("untitled:a", "ron", &text);
    let line = text.lines().count() / 2;
    for (index, letter) in "\n Pl".chars().enumerate() {
        let place = match index {
            0 => json!({"line": line, "character": 0}),
            _ => json!({"line": line + 1, "character": index - 1}),
        };
        let change = json!({"range": {"start": place, "end": place}, "text": letter.to_string()});
        let document = json!({"uri": "untitled:a", "version": index + 2});
        client.notify(
            "textDocument/didChange",
            &json!({"textDocument": document, "contentChanges": [change]}),
        );
    }
    let place = json!({"line": line + 1, "character": 3});
    let params = json!({"textDocument": {"uri": "untitled:a"}, "position": place});
    let found = client.ask("textDocument/completion", &params).unwrap();
    let labels: Vec<_> = found["items"]
        .as_array()
        .unwrap()
        .iter()
        .map(|item| item["label"].clone())
        .collect();
    if !labels.contains(&json!("Plane")) {
        return Err(format!("{labels:?}").into());
    }
    expect(&codes(&mut client, "untitled:a", 5), &["syntax"])?;
    client.finish();
    Ok(())
}

fn newer() -> Result<(), Failed> {
    let text = many(50_000);
    let mut client = Client::initialized(&json!({}));
    client.open("untitled:a", "ron", &text);
    let wrong = text.replacen("radius: 0.5", "radius: 0", 1);
    for version in 2..30 {
        let text = if version % 2 == 0 { &wrong } else { &text };
        let document = json!({"uri": "untitled:a", "version": version});
        client.notify(
            "textDocument/didChange",
            &json!({"textDocument": document, "contentChanges": [{"text": text}]}),
        );
    }
    client.notify("textDocument/didChange", &json!({"textDocument": {"uri": "untitled:a", "version": 30}, "contentChanges": [{"text": wrong}]}));
    let mut versions = Vec::new();
    while versions.last() != Some(&30) {
        let message = client.wait(|message| message["method"] == "textDocument/publishDiagnostics");
        versions.push(message["params"]["version"].as_u64().unwrap());
    }
    client.finish();
    // Every text would take longer than the next one to arrive.
    match versions.len() < 25 && versions.is_sorted() {
        true => Ok(()),
        false => Err(format!("{versions:?}").into()),
    }
}
