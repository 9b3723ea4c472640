//! The open documents. What is done with one takes no longer because others are open.

use std::{
    collections::{BTreeMap, BTreeSet, HashMap},
    mem,
    path::{Path, PathBuf},
    sync::mpsc::Sender,
    time::Instant,
};

use strahl::session::Turns;

use super::{
    document::{Event, OpenDocument, Report},
    settings::Settings,
};

/// The open documents, by their addresses.
#[derive(Default)]
pub(super) struct Documents {
    all: BTreeMap<String, OpenDocument>,
    /// Those that may have to be checked.
    touched: BTreeSet<String>,
    /// The documents in each file.
    of_path: Users,
    /// The documents that depend on each file, also those that are not the text of a scene.
    users: Users,
    changes: Changes,
    recent: Recent,
}

/// The changes of the files that documents depend on.
#[derive(Default)]
pub(super) struct Changes {
    /// The files that no document depended on before.
    pub(super) new: Vec<PathBuf>,
    /// The number of files that no document depends on any more.
    pub(super) gone: usize,
}

/// The most files whose changes are noted.
const MOST: usize = 10_000;

/// The times at which files have changed. A check in flight may have read an older content of a file
/// that its scene is not yet known to depend on.
struct Recent {
    times: HashMap<PathBuf, Instant>,
    /// The time before which nothing is known.
    start: Instant,
}

impl Default for Recent {
    fn default() -> Self {
        Self {
            times: HashMap::new(),
            start: Instant::now(),
        }
    }
}

impl Recent {
    fn note(&mut self, file: &Path) {
        if self.times.len() == MOST {
            *self = Self::default();
        }
        self.times.insert(file.to_owned(), Instant::now());
    }

    /// Returns true if a file may have changed since a time.
    fn is_since(&self, file: &Path, time: Instant) -> bool {
        let changed = self.times.get(file);
        time < self.start || changed.is_some_and(|changed| *changed >= time)
    }
}

/// The addresses of documents, by files.
#[derive(Default)]
struct Users(HashMap<PathBuf, BTreeSet<String>>);

impl Users {
    fn add(&mut self, file: PathBuf, user: &str, changes: &mut Changes) {
        let users = self.0.entry(file.clone()).or_default();
        if users.is_empty() {
            changes.new.push(file);
        }
        users.insert(user.to_owned());
    }

    fn remove(&mut self, file: &Path, user: &str, changes: &mut Changes) {
        if let Some(users) = self.0.get_mut(file)
            && users.remove(user)
            && users.is_empty()
        {
            self.0.remove(file);
            changes.gone += 1;
        }
    }

    fn of(&self, file: &Path) -> impl Iterator<Item = &String> {
        self.0.get(file).into_iter().flatten()
    }
}

/// Returns the files that a document depends on: those that it names, and each `strahl.toml` that
/// may apply.
fn dependencies(document: &OpenDocument) -> Vec<PathBuf> {
    if !document.is_scene_file {
        return Vec::new();
    }
    let folder = document.path.as_deref().and_then(Path::parent);
    let configs = folder.into_iter().flat_map(Settings::files_of);
    document.files().iter().cloned().chain(configs).collect()
}

impl Documents {
    pub(super) fn get(&self, key: &str) -> Option<&OpenDocument> {
        self.all.get(key)
    }

    pub(super) fn get_mut(&mut self, key: &str) -> Option<&mut OpenDocument> {
        let document = self.all.get_mut(key)?;
        self.touched.insert(key.to_owned());
        Some(document)
    }

    pub(super) fn keys(&self) -> impl Iterator<Item = &String> {
        self.all.keys()
    }

    pub(super) fn values(&self) -> impl Iterator<Item = &OpenDocument> {
        self.all.values()
    }

    pub(super) fn insert(&mut self, key: String, document: OpenDocument) {
        if let Some(path) = &document.path {
            let changes = &mut Changes::default();
            self.of_path.add(path.clone(), &key, changes);
        }
        for file in dependencies(&document) {
            self.users.add(file, &key, &mut self.changes);
        }
        self.touched.insert(key.clone());
        self.all.insert(key, document);
    }

    pub(super) fn remove(&mut self, key: &str) -> Option<OpenDocument> {
        let document = self.all.remove(key)?;
        if let Some(path) = &document.path {
            self.of_path.remove(path, key, &mut Changes::default());
        }
        for file in dependencies(&document) {
            self.users.remove(&file, key, &mut self.changes);
        }
        Some(document)
    }

    /// Notes that files have changed, and returns the documents that depend on one of them.
    pub(super) fn changed(&mut self, files: &[PathBuf]) -> BTreeSet<String> {
        for file in files {
            self.recent.note(file);
        }
        let users = files.iter().flat_map(|file| self.users.of(file));
        users.cloned().collect()
    }

    /// Returns true if a document has not been checked since one of these files has changed.
    pub(super) fn is_outdated(&self, key: &str, files: &[PathBuf]) -> bool {
        let latest = self.get(key).and_then(OpenDocument::latest);
        let whole = latest.and_then(|latest| latest.whole.as_ref());
        whole.is_some_and(|whole| {
            let has_changed = |file: &PathBuf| {
                self.recent.is_since(file, whole.began()) || whole.may_precede(file)
            };
            files.iter().any(has_changed)
        })
    }

    /// Takes over the result of a check, and returns the files that the document did not depend on
    /// before; `None` if the result is of an older text.
    pub(super) fn take(&mut self, report: Report) -> Option<Vec<PathBuf>> {
        let key = report.uri.clone();
        let document = self.get_mut(&key)?;
        let before = document.files().to_vec();
        if !document.take(report) {
            return None;
        }
        let after = document.files().to_vec();
        if before != after {
            // Added first: what stays is neither new nor gone.
            let document = self.all.get(&key);
            for file in document.map(dependencies).unwrap_or_default() {
                self.users.add(file, &key, &mut self.changes);
            }
            for file in before.iter().filter(|file| !after.contains(file)) {
                self.users.remove(file, &key, &mut self.changes);
            }
        }
        let new = after.into_iter().filter(|file| !before.contains(file));
        Some(new.collect())
    }

    /// Returns those among a document and the parts that it names that another document names.
    pub(super) fn parts(&self, key: &str) -> BTreeSet<String> {
        let Some(document) = self.get(key) else {
            return BTreeSet::new();
        };
        let own = document.path.as_ref();
        let is_named = own.is_some_and(|path| self.users.of(path).next().is_some());
        let named = document.files().iter();
        let mut parts: BTreeSet<_> = named
            .flat_map(|file| self.of_path.of(file))
            .cloned()
            .collect();
        parts.extend(is_named.then(|| key.to_owned()));
        parts
    }

    /// Returns the changes of the files that documents depend on, since the last call.
    pub(super) fn changes(&mut self) -> Changes {
        mem::take(&mut self.changes)
    }

    /// Returns the files that documents depend on.
    pub(super) fn files(&self) -> impl ExactSizeIterator<Item = &PathBuf> {
        self.users.0.keys()
    }

    /// Returns the time of the next check.
    pub(super) fn due(&self) -> Option<Instant> {
        let touched = self.touched.iter();
        touched.filter_map(|key| self.get(key)?.due()).min()
    }

    /// Starts the checks for which it is time.
    pub(super) fn check(&mut self, turns: &Turns, events: &Sender<Event>) {
        let all = &mut self.all;
        self.touched.retain(|key| {
            let Some(document) = all.get_mut(key) else {
                return false;
            };
            document.check(turns, events);
            document.due().is_some()
        });
    }
}
