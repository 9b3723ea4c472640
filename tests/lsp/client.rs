//! A client of the server, over its standard input and output.

use std::{
    collections::VecDeque,
    fs,
    io::{BufRead, BufReader, Write},
    process::{Child, ChildStdin, Command, ExitStatus, Stdio},
    sync::mpsc::{self, Receiver},
    thread,
    time::{Duration, Instant},
};

use serde_json::{Value, json};

/// Enough for any machine; a test that succeeds does not wait that long.
const PATIENCE: Duration = Duration::from_secs(60);

pub(crate) struct Client {
    process: Child,
    input: Option<ChildStdin>,
    messages: Receiver<Value>,
    /// Messages that came before the one that was waited for.
    early: VecDeque<Value>,
    next: u64,
}

impl Client {
    pub(crate) fn new() -> Self {
        let mut process = Command::new(env!("CARGO_BIN_EXE_strahl"))
            .arg("lsp")
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let mut output = BufReader::new(process.stdout.take().unwrap());
        let (sender, messages) = mpsc::channel();
        thread::spawn(move || {
            while let Some(message) = read(&mut output) {
                if sender.send(message).is_err() {
                    return;
                }
            }
        });
        Self {
            input: process.stdin.take(),
            process,
            messages,
            early: VecDeque::new(),
            next: 1,
        }
    }

    /// Starts a client with these capabilities.
    pub(crate) fn initialized(capabilities: &Value) -> Self {
        let mut client = Self::new();
        let params = json!({"processId": null, "rootUri": null, "capabilities": capabilities});
        client.ask("initialize", &params).unwrap();
        client.notify("initialized", &json!({}));
        client
    }

    pub(crate) fn send_raw(&mut self, bytes: &[u8]) {
        let input = self.input.as_mut().unwrap();
        input.write_all(bytes).unwrap();
        input.flush().unwrap();
    }

    pub(crate) fn send(&mut self, message: &Value) {
        let text = message.to_string();
        let frame = format!("Content-Length: {}\r\n\r\n{text}", text.len());
        self.send_raw(frame.as_bytes());
    }

    pub(crate) fn notify(&mut self, method: &str, params: &Value) {
        self.send(&json!({"jsonrpc": "2.0", "method": method, "params": params}));
    }

    /// Sends a request, and returns its id.
    pub(crate) fn request(&mut self, method: &str, params: &Value) -> u64 {
        self.next += 1;
        let id = self.next;
        self.send(&json!({"jsonrpc": "2.0", "id": id, "method": method, "params": params}));
        id
    }

    /// Sends a request, and returns its result or its error.
    pub(crate) fn ask(&mut self, method: &str, params: &Value) -> Result<Value, Value> {
        let id = self.request(method, params);
        self.answer(id)
    }

    pub(crate) fn answer(&mut self, id: u64) -> Result<Value, Value> {
        let mut message = self.wait(|message| message["id"] == id && message["method"].is_null());
        match message.get_mut("error") {
            Some(error) => Err(error.take()),
            None => Ok(message["result"].take()),
        }
    }

    /// Waits for a message; others stay for later.
    pub(crate) fn wait(&mut self, is_wanted: impl Fn(&Value) -> bool) -> Value {
        if let Some(at) = self.early.iter().position(&is_wanted) {
            return self.early.remove(at).unwrap();
        }
        loop {
            let message = self.next_message();
            if is_wanted(&message) {
                return message;
            }
            self.early.push_back(message);
        }
    }

    /// Returns the next message.
    pub(crate) fn next_message(&mut self) -> Value {
        let message = self.messages.recv_timeout(PATIENCE);
        message.expect("the server does not answer")
    }

    /// Returns the notifications of a method that have come.
    pub(crate) fn take(&mut self, method: &str) -> Vec<Value> {
        let early = std::mem::take(&mut self.early).into_iter();
        let (taken, others): (_, Vec<_>) = early.partition(|message| message["method"] == method);
        self.early = VecDeque::from(others);
        taken
    }

    /// Forgets the messages that nothing waits for.
    pub(crate) fn forget(&mut self) {
        self.early.clear();
    }

    pub(crate) fn open(&mut self, uri: &str, language: &str, text: &str) {
        let document = json!({"uri": uri, "languageId": language, "version": 1, "text": text});
        self.notify("textDocument/didOpen", &json!({"textDocument": document}));
    }

    /// Returns the most memory that the server has had, in bytes; 0 if the system does not tell.
    pub(crate) fn peak_memory(&self) -> u64 {
        let status = fs::read_to_string(format!("/proc/{}/status", self.process.id()));
        let status = status.unwrap_or_default();
        let peak = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
        let kibibytes = peak.and_then(|peak| peak.trim().strip_suffix(" kB")?.parse::<u64>().ok());
        kibibytes.unwrap_or(0) << 10
    }

    /// Closes the input, and waits for the end.
    pub(crate) fn end(mut self) -> ExitStatus {
        self.input.take();
        self.process.wait().unwrap()
    }

    /// Waits for the end, with the input open.
    pub(crate) fn wait_for_end(&mut self) -> ExitStatus {
        let start = Instant::now();
        loop {
            match self.process.try_wait().unwrap() {
                Some(status) => return status,
                None => assert!(start.elapsed() < PATIENCE, "the server does not end"),
            }
            thread::sleep(Duration::from_millis(20));
        }
    }

    /// Ends the session as the protocol demands.
    pub(crate) fn finish(mut self) {
        assert_eq!(self.ask("shutdown", &Value::Null), Ok(Value::Null));
        self.notify("exit", &Value::Null);
        assert!(self.process.wait().unwrap().success());
    }
}

impl Drop for Client {
    fn drop(&mut self) {
        // A failed test leaves no process behind.
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

fn read(output: &mut impl BufRead) -> Option<Value> {
    let mut length = None;
    loop {
        let mut line = String::new();
        if output.read_line(&mut line).ok()? == 0 {
            return None;
        }
        let line = line.trim();
        if line.is_empty() {
            break;
        }
        if let Some(value) = line.strip_prefix("Content-Length: ") {
            length = value.parse().ok();
        }
    }
    let mut body = vec![0; length?];
    output.read_exact(&mut body).ok()?;
    Some(serde_json::from_slice(&body).unwrap())
}
