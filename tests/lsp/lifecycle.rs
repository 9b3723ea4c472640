//! How the server starts and ends.

use std::{
    fs,
    io::Write,
    path::Path,
    process::{Command, Stdio},
};

use libtest_mimic::{Failed, Trial};
use serde_json::{Value, json};

use crate::client::Client;

type Scenario = fn() -> Result<(), Failed>;

pub(crate) fn all() -> Vec<Trial> {
    let trials: [(&str, Scenario); 5] = [
        ("the input ends", input_ends),
        ("thousands of documents", thousands),
        ("the order of shutdown and exit", order),
        ("garbage is answered", garbage),
        ("messages in small pieces", pieces),
    ];
    let trials = trials.into_iter();
    let mut trials: Vec<_> = trials.map(|(name, run)| Trial::test(name, run)).collect();
    let parent = Trial::test("the editor's process ends", parent);
    trials.push(parent.with_ignored_flag(!Path::new("/proc/self").exists()));
    let script = Command::new("script")
        .arg("--version")
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .status();
    let is_missing = !script.is_ok_and(|status| status.success());
    trials.push(Trial::test("a person starts it", terminal).with_ignored_flag(is_missing));
    trials
}

fn expect_status(client: Client, expected: i32, when: &str) -> Result<(), Failed> {
    let status = client.end().code();
    match status == Some(expected) {
        true => Ok(()),
        false => Err(format!("{when}: expected status {expected}, found {status:?}").into()),
    }
}

fn input_ends() -> Result<(), Failed> {
    expect_status(Client::new(), 1, "before all messages")?;
    let mut client = Client::new();
    client.send_raw(b"Content-Length: 100\r\n\r\n{\"id\"");
    expect_status(client, 1, "within a message")?;
    let mut client = Client::initialized(&json!({}));
    client.open("untitled:a", "ron", "(camera: 1");
    expect_status(client, 1, "with an open document")?;
    let mut client = Client::initialized(&json!({}));
    client.ask("shutdown", &Value::Null).unwrap();
    expect_status(client, 0, "after `shutdown`")
}

/// All documents are checked, one after another, and the server still answers.
fn thousands() -> Result<(), Failed> {
    const COUNT: usize = 2000;
    let folder = tempfile::tempdir()?;
    let mut client = Client::initialized(&json!({}));
    for index in 0..COUNT {
        let uri = format!("file://{}/{index}.ron", folder.path().display());
        client.open(&uri, "ron", "(camera: 1)");
    }
    for _ in 0..COUNT {
        client.wait(|message| message["method"] == "textDocument/publishDiagnostics");
    }
    for index in 0..COUNT {
        let uri = format!("file://{}/{index}.ron", folder.path().display());
        let document = json!({"textDocument": {"uri": uri}});
        client.notify("textDocument/didClose", &document);
    }
    client.finish();
    Ok(())
}

fn order() -> Result<(), Failed> {
    // The input stays open: the messages alone end the server.
    let mut client = Client::new();
    client.notify("exit", &Value::Null);
    let mut statuses = vec![client.wait_for_end().code()];
    let mut client = Client::initialized(&json!({}));
    client.notify("exit", &Value::Null);
    statuses.push(client.wait_for_end().code());
    let mut client = Client::initialized(&json!({}));
    client.ask("shutdown", &Value::Null).unwrap();
    let after = client.ask("textDocument/hover", &json!({}));
    client.notify("exit", &Value::Null);
    statuses.push(client.wait_for_end().code());
    let is_refused = after.is_err_and(|error| error["code"] == -32600);
    match is_refused && statuses == [Some(1), Some(1), Some(0)] {
        true => Ok(()),
        false => Err(format!("{statuses:?}, refused after `shutdown`: {is_refused}").into()),
    }
}

/// Sends what is no message: the server says so, and serves on.
fn garbage() -> Result<(), Failed> {
    let mut client = Client::new();
    let mut random = crate::random::Random(7);
    for _ in 0..200 {
        let length = random.below(300);
        let bytes = (0..length).map(|_| random.below(256) as u8);
        // An empty line ends a header, whatever is in it.
        let mut bytes: Vec<u8> = bytes.filter(|byte| *byte != b'\n').collect();
        bytes.extend(b"\r\n\r\n");
        client.send_raw(&bytes);
        client.wait(|message| message["error"]["code"] == -32700);
    }
    for body in [
        "",
        "{",
        "null",
        "7",
        "[1]",
        "{\"id\": {}}",
        "\u{feff}{}",
        "{\"jsonrpc\": 2}",
    ] {
        let frame = format!("Content-Length: {}\r\n\r\n{body}", body.len());
        client.send_raw(frame.as_bytes());
        client.wait(|message| {
            message["error"]["code"]
                .as_i64()
                .is_some_and(|code| code < 0)
        });
    }
    client.send_raw(b"Content-Length: 3\r\n\r\n\xff\xfe\xfd");
    client.wait(|message| message["error"]["code"] == -32700);
    let params = json!({"processId": "x", "rootUri": 4, "capabilities": []});
    client.ask("initialize", &params).unwrap();
    client.notify("initialized", &json!([1]));
    client.open("untitled:a", "ron", "(camera: 1)");
    client.wait(|message| message["method"] == "textDocument/publishDiagnostics");
    for params in [
        json!(null),
        json!([]),
        json!({"textDocument": {"uri": "::"}}),
        json!("x"),
    ] {
        for method in ["didOpen", "didChange", "didClose", "didSave"] {
            client.notify(&format!("textDocument/{method}"), &params);
        }
        for method in ["hover", "rename", "codeAction", "diagnostic", "formatting"] {
            let answer = client.ask(&format!("textDocument/{method}"), &params);
            if answer.is_ok() {
                return Err(format!("{method} with {params} succeeded").into());
            }
        }
    }
    client.finish();
    Ok(())
}

fn pieces() -> Result<(), Failed> {
    let mut client = Client::new();
    let body =
        json!({"jsonrpc": "2.0", "id": 2, "method": "initialize", "params": {"capabilities": {}}});
    let body = body.to_string();
    let frame = format!("content-length:{}\r\nX: y\r\n\r\n{body}", body.len());
    for byte in frame.bytes() {
        client.send_raw(&[byte]);
    }
    client.answer(2).unwrap();
    client.finish();
    Ok(())
}

/// The editor is killed, and something else holds the input open.
fn parent() -> Result<(), Failed> {
    let mut editor = Command::new("sleep").arg("1000").spawn()?;
    let mut client = Client::new();
    let params = json!({"processId": editor.id(), "capabilities": {}});
    let started = client.ask("initialize", &params);
    editor.kill()?;
    editor.wait()?;
    started.map_err(|error| error.to_string())?;
    match client.wait_for_end().code() {
        Some(1) => Ok(()),
        status => Err(format!("{status:?}").into()),
    }
}

/// At a terminal, the command says what it is for, and Ctrl-D ends it.
fn terminal() -> Result<(), Failed> {
    let folder = tempfile::tempdir()?;
    let log = folder.path().join("log");
    let mut shell = Command::new("script")
        .args(["--quiet", "--return", "--command"])
        .arg(format!("{} lsp", env!("CARGO_BIN_EXE_strahl")))
        .arg(&log)
        .stdin(Stdio::piped())
        .stdout(Stdio::null())
        .spawn()?;
    let mut input = shell.stdin.take().unwrap();
    input.write_all(b"\x04")?;
    let status = shell.wait()?;
    let shown = fs::read_to_string(log)?;
    match status.code() == Some(1) && shown.contains("this command is started by an editor") {
        true => Ok(()),
        false => Err(format!("{status}: {shown}").into()),
    }
}
