//! Recorded sessions: each line of a file is a message of the client (`client`), the bytes of one
//! (`raw`), a file of the folder (`file` with `text`), a message of the server (`server`), or the
//! status at the end (`status`).
//!
//! After a request, its answer is awaited, and after a change of a scene (unless `quiet` is there)
//! its diagnostics; `awaits` names another message. `$FOLDER` stands for the address of the folder,
//! `$PATH` for its path, and `$VERSION` for the version
//! of the program.

use std::{env, fs, path::Path};

use libtest_mimic::Failed;
use serde_json::{Value, json};

use crate::client::Client;

pub(crate) fn run(path: &Path) -> Result<(), Failed> {
    let recorded = fs::read_to_string(path)?;
    let replayed = replay(&recorded)?;
    if replayed == recorded {
        return Ok(());
    }
    if env::var_os("STRAHL_BLESS").is_some() {
        fs::write(path, replayed)?;
        return Ok(());
    }
    let mut lines = replayed.lines().zip(recorded.lines()).enumerate();
    let differs = lines.find(|(_, (new, old))| new != old);
    let (number, (new, old)) = differs.unwrap_or((0, ("another number of lines", "")));
    Err(format!("line {}\nnew: {new}\nold: {old}", number + 1).into())
}

fn replay(recorded: &str) -> Result<String, Failed> {
    let folder = tempfile::tempdir()?;
    // Not through a link, as temporary folders may be.
    let folder_path = folder.path().canonicalize()?;
    let address = format!("file://{}", folder_path.display());
    let mut client = Some(Client::new());
    let mut replayed = String::new();
    let mut add = |line: &Value| {
        let line = line.to_string().replace(&address, "$FOLDER");
        let line = line.replace(&*folder_path.to_string_lossy(), "$PATH");
        let version = env!("CARGO_PKG_VERSION");
        let line = line.replace(&format!("/v{version}/"), "/v$VERSION/");
        let line = line.replace(
            &format!("\"version\":\"{version}\""),
            "\"version\":\"$VERSION\"",
        );
        replayed += &(line + "\n");
    };
    for line in recorded.lines() {
        let plain: Value = serde_json::from_str(line)?;
        if plain.get("server").is_some() || plain.get("status").is_some() {
            continue;
        }
        add(&plain);
        let line: Value = serde_json::from_str(&line.replace("$FOLDER", &address))?;
        if let (Some(name), Some(text)) = (line["file"].as_str(), line["text"].as_str()) {
            fs::write(folder_path.join(name), text)?;
            continue;
        }
        let Some(running) = &mut client else {
            return Err("a message after the end".into());
        };
        let message = match line["raw"].as_str() {
            Some(raw) => {
                running.send_raw(raw.as_bytes());
                &json!({"id": null})
            }
            None => {
                running.send(&line["client"]);
                &line["client"]
            }
        };
        if message["method"] == "exit" {
            let status = client.take().map(Client::end);
            add(&json!({"status": status.and_then(|status| status.code())}));
            continue;
        }
        let Some(is_last) = awaited(message, &line) else {
            continue;
        };
        loop {
            let answer = running.next_message();
            add(&json!({"server": answer}));
            if is_last(&answer) {
                break;
            }
        }
    }
    if let Some(client) = client {
        add(&json!({"status": client.end().code()}));
    }
    Ok(replayed)
}

type Test = Box<dyn Fn(&Value) -> bool>;

/// Returns the test for the message that is awaited after one of the client.
fn awaited(message: &Value, line: &Value) -> Option<Test> {
    if line["quiet"] == true {
        return None;
    }
    if let Some(id) = message.get("id").cloned() {
        return Some(Box::new(move |answer| {
            answer.get("id") == Some(&id) && answer.get("method").is_none()
        }));
    }
    let method = match (line["awaits"].as_str(), message["method"].as_str()?) {
        (Some(method), _) => method.to_owned(),
        (None, "textDocument/didOpen" | "textDocument/didChange") => {
            "textDocument/publishDiagnostics".to_owned()
        }
        (None, _) => return None,
    };
    let version = message["params"]["textDocument"]["version"].clone();
    Some(Box::new(move |answer| {
        let is_newest = version.is_null() || answer["params"]["version"] == version;
        answer["method"] == *method && (is_newest || !method.starts_with("textDocument"))
    }))
}
