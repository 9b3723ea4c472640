//! Answers to requests, on threads of their own, so that the next message is always read at once.

use std::{
    collections::HashMap,
    panic::{self, AssertUnwindSafe},
    sync::{
        Arc, Mutex,
        mpsc::{self, Sender},
    },
};

use lsp_server::{ErrorCode, RequestId, ResponseError};
use serde::Serialize;
use strahl::parallel::Cancel;

use super::{
    super::{
        failure::Failure,
        threads::{lock, spawn},
    },
    outbox::{NO_THREADS, Outbox, refused},
    wire,
};

/// The result of an answer.
pub(super) type Result<T, E = ResponseError> = std::result::Result<T, E>;
/// A request, and the function that returns the response in JSON.
type Job = (
    RequestId,
    Cancel,
    Box<dyn FnOnce(&Cancel) -> Vec<u8> + Send>,
);

/// The time that an answer takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Pace {
    /// An editor waits for it with every key.
    Quick,
    /// It needs the tree of the whole text.
    Slow,
    /// It reads many files.
    Files,
}

/// The requests that are not answered yet.
pub(super) struct Work {
    outbox: Outbox,
    pending: Arc<Mutex<Pending>>,
    quick: Sender<Job>,
    slow: Sender<Job>,
    files: Sender<Job>,
}

type Pending = HashMap<RequestId, Cancel>;

impl Work {
    pub(super) fn new(outbox: Outbox) -> Result<Self, Failure> {
        let pending = Arc::default();
        Ok(Self {
            quick: start(&outbox, &pending)?,
            slow: start(&outbox, &pending)?,
            files: start(&outbox, &pending)?,
            pending,
            outbox,
        })
    }

    /// Notes a request that will be answered.
    pub(super) fn expect(&self, id: RequestId) {
        lock(&self.pending).insert(id, Cancel::new());
    }

    /// Answers a request that was noted, unless it is cancelled before.
    pub(super) fn answer<T: Serialize>(
        &self,
        id: RequestId,
        pace: Pace,
        answer: impl FnOnce(&Cancel) -> Result<T> + Send + 'static,
    ) {
        let Some(cancel) = lock(&self.pending).get(&id).cloned() else {
            return;
        };
        let queue = match pace {
            Pace::Quick => &self.quick,
            Pace::Slow => &self.slow,
            Pace::Files => &self.files,
        };
        let of = id.clone();
        let answer = move |cancel: &Cancel| wire::response(&of, answer(cancel));
        // The threads end with the server.
        let _ = queue.send((id, cancel, Box::new(answer)));
    }

    /// Cancels a request, and answers it.
    pub(super) fn cancel(&self, id: RequestId) {
        let cancel = lock(&self.pending).remove(&id);
        if let Some(cancel) = cancel {
            cancel.cancel();
            let error = refused(ErrorCode::RequestCanceled, "cancelled");
            self.outbox.respond::<()>(&id, Err(error));
        }
    }

    /// Cancels all requests.
    pub(super) fn cancel_all(&self) {
        let ids: Vec<_> = lock(&self.pending).keys().cloned().collect();
        for id in ids {
            self.cancel(id);
        }
    }
}

fn start(outbox: &Outbox, pending: &Arc<Mutex<Pending>>) -> Result<Sender<Job>, Failure> {
    let (sender, jobs) = mpsc::channel::<Job>();
    let (outbox, pending) = (outbox.clone(), Arc::clone(pending));
    spawn("answer", NO_THREADS, move || {
        for (id, cancel, answer) in jobs {
            if cancel.is_cancelled() {
                continue;
            }
            // A fault of one answer must not cost the others.
            let answer = panic::catch_unwind(AssertUnwindSafe(|| answer(&cancel)));
            let answer = answer.unwrap_or_else(|_| {
                let message = "the answer failed; please report this";
                wire::response::<()>(&id, Err(refused(ErrorCode::InternalError, message)))
            });
            let is_wanted = lock(&pending).remove(&id).is_some();
            if is_wanted {
                outbox.write(answer);
            }
        }
    })?;
    Ok(sender)
}
