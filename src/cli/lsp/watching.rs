//! Watching the files that scenes depend on: by the client if it can, else by the program.

use std::{collections::BTreeSet, path::PathBuf, sync::mpsc::Sender};

use serde_json::json;

use super::{super::watcher::Watcher, client::Client, outbox::Outbox, server::Event};

/// The files that the client is asked to watch.
const PATTERNS: [&str; 2] = [
    "**/strahl.toml",
    "**/*.{csv,npy,npz,ply,xyz,pdb,ron,json,CSV,NPY,NPZ,PLY,XYZ,PDB,RON,JSON}",
];

pub(super) struct Watching {
    events: Sender<Event>,
    /// True if the client watches the files in its folders.
    by_client: bool,
    /// Started for the first file.
    watcher: Option<Watcher>,
    watched: BTreeSet<PathBuf>,
    has_failed: bool,
}

impl Watching {
    pub(super) const fn new(events: Sender<Event>) -> Self {
        Self {
            events,
            by_client: false,
            watcher: None,
            watched: BTreeSet::new(),
            has_failed: false,
        }
    }

    /// Asks the client to watch, if it can.
    pub(super) fn start(&mut self, client: &Client, outbox: &Outbox) {
        self.by_client = client.watches;
        if !self.by_client {
            return;
        }
        let watchers = PATTERNS.map(|pattern| json!({"globPattern": pattern}));
        let registration = json!({
            "id": "watch",
            "method": "workspace/didChangeWatchedFiles",
            "registerOptions": {"watchers": watchers},
        });
        let params = json!({"registrations": [registration]});
        outbox.request("client/registerCapability", params);
    }

    /// Watches these files, and no longer those named before. A client watches what is in its
    /// folders.
    pub(super) fn watch(
        &mut self,
        files: impl IntoIterator<Item = PathBuf>,
        folders: &[PathBuf],
        outbox: &Outbox,
    ) {
        let by_client = |file: &PathBuf| {
            self.by_client && folders.iter().any(|folder| file.starts_with(folder))
        };
        let files = files.into_iter().filter(|file| !by_client(file));
        let files: BTreeSet<_> = files.collect();
        if files == self.watched || self.has_failed {
            return;
        }
        self.watched = files;
        if let Err(message) = self.replace() {
            self.has_failed = true;
            outbox.notify("window/logMessage", json!({"type": 2, "message": message}));
        }
    }

    fn replace(&mut self) -> Result<(), String> {
        let message = |failure: super::super::Failure| failure.message().unwrap_or_default();
        if self.watcher.is_none() {
            let events = self.events.clone();
            let on_change = move |files: &[PathBuf]| {
                let _ = events.send(Event::Files(files.to_vec()));
            };
            self.watcher = Some(Watcher::new(on_change).map_err(message)?);
        }
        let watcher = self.watcher.as_mut();
        let watched = watcher.map(|watcher| watcher.watch(self.watched.iter().cloned()));
        watched.transpose().map(drop).map_err(message)
    }
}
