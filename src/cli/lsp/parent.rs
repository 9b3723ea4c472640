//! The process of the editor, whose end ends the server.

use std::{thread, time::Duration};

use super::document::Event;
use std::sync::mpsc::Sender;

/// The time between two looks. Usually the end of the input comes first.
const PAUSE: Duration = Duration::from_secs(3);

/// Watches the process that started this one, and the one that the client says is its own.
#[cfg(unix)]
pub(super) fn watch(process: Option<u32>, events: Sender<Event>) {
    use std::{os::unix::process::parent_id, path::PathBuf};

    use super::{super::threads::spawn, outbox::NO_THREADS};

    let parent = parent_id();
    // Processes are folders there, but only on Linux.
    let client = process.map(|id| PathBuf::from(format!("/proc/{id}")));
    let client = client.filter(|folder| folder.exists());
    // Without this thread, the end of the input still ends the server.
    let _ = spawn("parent", NO_THREADS, move || {
        loop {
            thread::sleep(PAUSE);
            let is_gone = client.as_ref().is_some_and(|folder| !folder.exists());
            if is_gone || parent_id() != parent {
                let _ = events.send(Event::End);
                return;
            }
        }
    });
}

/// Elsewhere, the end of the input is the only sign.
#[cfg(not(unix))]
pub(super) fn watch(_process: Option<u32>, _events: Sender<Event>) {}
