//! Messages to the client.

use std::{
    io::Write,
    sync::{
        Arc,
        atomic::{AtomicI32, Ordering},
        mpsc::{self, Sender},
    },
    time::Duration,
};

use lsp_server::{ErrorCode, RequestId, ResponseError};
use serde::Serialize;
use serde_json::{Value, json};

use super::{
    super::{failure::Failure, threads::spawn},
    wire,
    work::Result,
};

/// The fault of a server whose threads the system refuses.
pub(super) const NO_THREADS: &str = "the server cannot run";

/// The longest time that the last messages may take.
const PATIENCE: Duration = Duration::from_secs(2);

/// Writes messages on a thread of its own, so that a client that reads slowly delays nothing.
#[derive(Clone)]
pub(super) struct Outbox {
    frames: Sender<Frame>,
    /// The id of the next request.
    next: Arc<AtomicI32>,
}

enum Frame {
    Message(Vec<u8>),
    /// Everything before it has been written.
    End(Sender<()>),
}

impl Outbox {
    pub(super) fn new(mut output: impl Write + Send + 'static) -> Result<Self, Failure> {
        let (frames, queue) = mpsc::channel();
        spawn("write", NO_THREADS, move || {
            for frame in queue {
                match frame {
                    // A client that is gone is noticed by the reader.
                    Frame::Message(message) => drop(wire::write(&mut output, &message)),
                    Frame::End(done) => drop(done.send(())),
                }
            }
        })?;
        Ok(Self {
            frames,
            next: Arc::default(),
        })
    }

    /// Writes a message in JSON.
    pub(super) fn write(&self, message: Vec<u8>) {
        let _ = self.frames.send(Frame::Message(message));
    }

    pub(super) fn send(&self, message: &Value) {
        self.write(message.to_string().into_bytes());
    }

    pub(super) fn respond<T: Serialize>(&self, id: &RequestId, result: Result<T>) {
        self.write(wire::response(id, result));
    }

    pub(super) fn notify(&self, method: &str, params: impl Serialize) {
        self.send(&json!({"jsonrpc": "2.0", "method": method, "params": params}));
    }

    /// Sends a request whose answer does not matter.
    pub(super) fn request(&self, method: &str, params: impl Serialize) {
        let id = self.next.fetch_add(1, Ordering::Relaxed);
        let mut message = json!({"jsonrpc": "2.0", "id": id, "method": method, "params": params});
        if message["params"].is_null()
            && let Some(message) = message.as_object_mut()
        {
            message.remove("params");
        }
        self.send(&message);
    }

    /// Waits until all messages are written.
    pub(super) fn finish(&self) {
        let (done, end) = mpsc::channel();
        let _ = self.frames.send(Frame::End(done));
        let _ = end.recv_timeout(PATIENCE);
    }
}

/// Returns the error of a response.
pub(super) fn refused(code: ErrorCode, message: impl Into<String>) -> ResponseError {
    ResponseError {
        code: code as i32,
        message: message.into(),
        data: None,
    }
}
