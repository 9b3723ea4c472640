//! Watching the files that scenes depend on: by the client if it can, else by the program.

use std::{
    collections::BTreeSet,
    path::{Path, PathBuf},
    sync::mpsc::Sender,
};

use serde_json::json;

use super::{
    super::{failure::Failure, watcher::Watcher},
    client::Client,
    document::Event,
    documents::Changes,
    outbox::Outbox,
};

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
    /// The number of watched files that no document depends on any more.
    gone: usize,
    has_failed: bool,
}

impl Watching {
    pub(super) const fn new(events: Sender<Event>) -> Self {
        Self {
            events,
            by_client: false,
            watcher: None,
            watched: BTreeSet::new(),
            gone: 0,
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

    /// Watches the new files. Those that are gone are forgotten together, once they are many: that takes
    /// as long as to watch all anew.
    pub(super) fn follow(
        &mut self,
        Changes { mut new, gone }: Changes,
        all: impl ExactSizeIterator<Item = PathBuf>,
        folders: &[PathBuf],
        outbox: &Outbox,
    ) {
        self.gone += gone;
        new.retain(|file| !self.is_left_to_client(file, folders));
        if self.gone > all.len() / 2 || (self.watcher.is_none() && !new.is_empty()) {
            self.gone = 0;
            return self.watch(all, folders, outbox);
        }
        for file in new {
            let watcher = self.watcher.as_mut().filter(|_| !self.has_failed);
            let added = watcher.map(|watcher| watcher.add(&file));
            let added = added.transpose().map_err(message);
            self.watched.insert(file);
            self.note(added.map(drop), outbox);
        }
    }

    /// Returns true if the client watches a file.
    fn is_left_to_client(&self, file: &Path, folders: &[PathBuf]) -> bool {
        self.by_client && folders.iter().any(|folder| file.starts_with(folder))
    }

    /// Tells the user that files cannot be watched.
    fn note(&mut self, done: Result<(), String>, outbox: &Outbox) {
        if let Err(message) = done {
            self.has_failed = true;
            outbox.notify("window/logMessage", json!({"type": 2, "message": message}));
        }
    }

    /// Watches these files, and no longer those named before. A client watches what is in its
    /// folders.
    pub(super) fn watch(
        &mut self,
        files: impl IntoIterator<Item = PathBuf>,
        folders: &[PathBuf],
        outbox: &Outbox,
    ) {
        let files = files.into_iter();
        let files = files.filter(|file| !self.is_left_to_client(file, folders));
        let files: BTreeSet<_> = files.collect();
        if files == self.watched || self.has_failed {
            return;
        }
        self.watched = files;
        let replaced = self.replace();
        self.note(replaced, outbox);
    }

    fn replace(&mut self) -> Result<(), String> {
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

fn message(failure: Failure) -> String {
    failure.message().unwrap_or_default()
}
