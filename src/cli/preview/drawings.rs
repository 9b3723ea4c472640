//! Pictures in flight and the last ones: who asks for the same one gets the same one, and one that
//! nobody waits for any more is cancelled.

use std::{
    collections::VecDeque,
    sync::{Arc, Mutex},
};

use axum::body::Bytes;
use strahl::parallel::Cancel;
use tokio::{sync::watch, task};

use super::refusal::{Refusal, refuse};
use crate::cli::threads::lock;

/// The number of pictures that are kept.
const KEPT: usize = 8;
/// The number of bytes that kept pictures may have.
const LARGEST: usize = 64 << 20;

/// The file of a picture.
type Drawn = Result<Bytes, Refusal>;

#[derive(Default)]
pub(super) struct Drawings(Mutex<VecDeque<KeptDrawing>>);

struct KeptDrawing {
    key: String,
    cancel: Cancel,
    /// The number of requests that wait.
    waiting: usize,
    done: watch::Receiver<Option<Drawn>>,
}

impl KeptDrawing {
    fn size(&self) -> Option<usize> {
        let done = self.done.borrow();
        Some(done.as_ref()?.as_ref().map_or(0, Bytes::len))
    }
}

impl Drawings {
    /// Returns a picture: a known one with this key, or else what `draw` makes.
    pub(super) async fn get(
        self: &Arc<Self>,
        key: String,
        draw: impl FnOnce(&Cancel) -> Result<Vec<u8>, strahl::Error> + Send + 'static,
    ) -> Drawn {
        let (mut done, _waiter) = self.join(key, draw);
        let drawn = done.wait_for(Option::is_some).await;
        let drawn = drawn.ok().and_then(|drawn| drawn.clone());
        drawn.unwrap_or_else(|| Err(refuse::unwritable("the picture could not be drawn")))
    }

    fn join(
        self: &Arc<Self>,
        key: String,
        draw: impl FnOnce(&Cancel) -> Result<Vec<u8>, strahl::Error> + Send + 'static,
    ) -> (watch::Receiver<Option<Drawn>>, Waiter) {
        let mut entries = lock(&self.0);
        let waiter = Waiter {
            drawings: Arc::clone(self),
            key: key.clone(),
        };
        if let Some(entry) = entries.iter_mut().find(|entry| entry.key == key) {
            entry.waiting += 1;
            return (entry.done.clone(), waiter);
        }
        let cancel = Cancel::new();
        let (sender, done) = watch::channel(None);
        entries.push_back(KeptDrawing {
            key,
            cancel: cancel.clone(),
            waiting: 1,
            done: done.clone(),
        });
        drop(entries);
        task::spawn_blocking(move || {
            let drawn = draw(&cancel).map(Bytes::from).map_err(Refusal::from);
            sender.send_replace(Some(drawn));
        });
        (done, waiter)
    }

    /// Ends the wait of a request. Drops failures, pictures without a reader, and old ones.
    fn leave(&self, key: &str) {
        let mut entries = lock(&self.0);
        if let Some(entry) = entries.iter_mut().find(|entry| entry.key == key) {
            entry.waiting -= 1;
        }
        let (mut count, mut bytes) = (0, 0);
        let mut kept = VecDeque::new();
        for entry in entries.drain(..).rev() {
            let keep = match entry.size() {
                _ if entry.waiting > 0 => true,
                None => {
                    entry.cancel.cancel();
                    false
                }
                Some(0) => false,
                Some(size) => {
                    count += 1;
                    bytes += size;
                    count <= KEPT && bytes <= LARGEST
                }
            };
            if keep {
                kept.push_front(entry);
            }
        }
        *entries = kept;
    }
}

/// A request that waits for a picture, until it is dropped.
struct Waiter {
    drawings: Arc<Drawings>,
    key: String,
}

impl Drop for Waiter {
    fn drop(&mut self) {
        self.drawings.leave(&self.key);
    }
}

#[cfg(test)]
mod tests {
    use std::{sync::mpsc, thread};

    use super::*;

    fn runtime() -> tokio::runtime::Runtime {
        tokio::runtime::Builder::new_current_thread()
            .enable_all()
            .build()
            .unwrap()
    }

    #[test]
    fn a_picture_is_drawn_once_and_few_are_kept() {
        runtime().block_on(async {
            let drawings = Arc::new(Drawings::default());
            for _ in 0..2 {
                for key in 0..20_u8 {
                    let drawn = drawings
                        .get(key.to_string(), move |_| Ok(vec![key; 3]))
                        .await;
                    assert_eq!(drawn.unwrap(), vec![key; 3]);
                }
            }
            assert_eq!(lock(&drawings.0).len(), KEPT);
            let again = drawings.get("19".to_owned(), |_| panic!("drawn again"));
            assert_eq!(again.await.unwrap(), vec![19; 3]);
        });
    }

    #[test]
    fn what_nobody_waits_for_is_cancelled() {
        let (send, cancelled) = mpsc::channel();
        runtime().block_on(async {
            let drawings = Arc::new(Drawings::default());
            let draw = move |cancel: &Cancel| {
                while !cancel.is_cancelled() {
                    thread::yield_now();
                }
                let _ = send.send(());
                Ok(vec![1])
            };
            {
                let (_done, one) = drawings.join("a".to_owned(), draw);
                let (_done, other) = drawings.join("a".to_owned(), |_| panic!("drawn again"));
                drop(one);
                assert_eq!(lock(&drawings.0).len(), 1);
                drop(other);
            }
            assert!(lock(&drawings.0).is_empty());
        });
        cancelled.recv().unwrap();
    }
}
