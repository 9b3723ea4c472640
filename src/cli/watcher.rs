//! Watching files for changes.
//!
//! The folders of the files are watched, not the files: editors replace a file by renaming another
//! one over it, and a file may not exist yet.

use std::{
    collections::{BTreeMap, BTreeSet},
    path::{Path, PathBuf},
    sync::{
        Arc, Mutex, MutexGuard, PoisonError,
        mpsc::{self, Receiver, Sender},
    },
    thread,
    time::{Duration, Instant},
};

use notify::{
    Event, EventKind, RecommendedWatcher, RecursiveMode, Watcher as _,
    event::{AccessKind, AccessMode, ModifyKind},
};

use super::Failure;

/// The time without an event after which a save is over.
const QUIET: Duration = Duration::from_millis(10);
/// The longest time that events are collected.
const LONGEST: Duration = Duration::from_millis(100);

/// Reports changes of files and folders.
pub(super) struct Watcher {
    inner: RecommendedWatcher,
    wanted: Arc<Mutex<Wanted>>,
    /// The folders that are watched.
    folders: BTreeMap<PathBuf, RecursiveMode>,
}

/// The files whose changes are reported.
#[derive(Default)]
struct Wanted {
    /// The files by their real paths, as they were named.
    files: BTreeMap<PathBuf, PathBuf>,
    /// The folders of which every file counts, likewise.
    folders: BTreeMap<PathBuf, PathBuf>,
}

impl Wanted {
    /// Returns a changed file as it was named.
    fn named(&self, changed: &Path) -> Option<PathBuf> {
        let in_folder = || {
            let mut folders = self.folders.iter();
            folders.find_map(|(real, named)| Some(named.join(changed.strip_prefix(real).ok()?)))
        };
        self.files.get(changed).cloned().or_else(in_folder)
    }
}

impl Watcher {
    /// Creates a watcher of nothing. `on_change` gets the changed files, as they were named, on a
    /// thread of its own. The events of one save are one call.
    pub(super) fn new(on_change: impl FnMut(&[PathBuf]) + Send + 'static) -> Result<Self, Failure> {
        let wanted = Arc::new(Mutex::new(Wanted::default()));
        let (sender, changes) = mpsc::channel();
        let of_events = Arc::clone(&wanted);
        let on_event = move |event| pass_on(event, &of_events, &sender);
        let inner = notify::recommended_watcher(on_event).map_err(|error| refused(&error))?;
        let started = thread::Builder::new()
            .name("watch".to_owned())
            .spawn(move || collect(&changes, on_change));
        started.map_err(|error| Failure::usage(format!("files cannot be watched: {error}")))?;
        Ok(Self {
            inner,
            wanted,
            folders: BTreeMap::new(),
        })
    }

    /// Watches these files, and no longer those named before. A file need not exist, but its folder
    /// must, or it is left out.
    pub(super) fn watch(
        &mut self,
        files: impl IntoIterator<Item = PathBuf>,
    ) -> Result<(), Failure> {
        let mut wanted = Wanted::default();
        for file in files {
            let folder = match file.parent() {
                Some(folder) if folder != Path::new("") => folder,
                _ => Path::new("."),
            };
            if let (Ok(folder), Some(name)) = (folder.canonicalize(), file.file_name()) {
                wanted.files.insert(folder.join(name), file.clone());
            }
            // Behind a link, another file changes.
            if let Ok(real) = file.canonicalize() {
                wanted.files.insert(real, file);
            }
        }
        let folders = wanted.files.keys().filter_map(|file| file.parent());
        let folders = folders.map(|folder| (folder.to_owned(), RecursiveMode::NonRecursive));
        let folders = folders.collect();
        self.replace(wanted, folders)
    }

    /// Watches all files below these paths, and no longer those named before. A path may be a file.
    pub(super) fn watch_below(&mut self, paths: &[PathBuf]) -> Result<(), Failure> {
        let (folders, files): (Vec<_>, Vec<_>) = paths.iter().partition(|path| path.is_dir());
        self.watch(files.into_iter().cloned())?;
        let mut all = self.folders.clone();
        let mut wanted = std::mem::take(&mut *lock(&self.wanted));
        for named in folders {
            if let Ok(real) = named.canonicalize() {
                all.insert(real.clone(), RecursiveMode::Recursive);
                wanted.folders.insert(real, named.clone());
            }
        }
        self.replace(wanted, all)
    }

    fn replace(
        &mut self,
        wanted: Wanted,
        folders: BTreeMap<PathBuf, RecursiveMode>,
    ) -> Result<(), Failure> {
        for (folder, mode) in &folders {
            if self.folders.get(folder) != Some(mode) {
                let watched = self.inner.watch(folder, *mode);
                watched.map_err(|error| refused(&error))?;
            }
        }
        for folder in self.folders.keys() {
            if !folders.contains_key(folder) {
                // It may be gone.
                let _ = self.inner.unwatch(folder);
            }
        }
        self.folders = folders;
        *lock(&self.wanted) = wanted;
        Ok(())
    }
}

fn lock(wanted: &Mutex<Wanted>) -> MutexGuard<'_, Wanted> {
    wanted.lock().unwrap_or_else(PoisonError::into_inner)
}

fn refused(error: &notify::Error) -> Failure {
    let cure = match error.kind {
        notify::ErrorKind::MaxFilesWatch => {
            "; the system allows no more watched folders (on Linux, raise \
             fs.inotify.max_user_watches)"
        }
        _ => "",
    };
    Failure::usage(format!("files cannot be watched: {error}{cure}"))
}

/// Passes on the wanted files of an event.
fn pass_on(event: notify::Result<Event>, wanted: &Mutex<Wanted>, sender: &Sender<PathBuf>) {
    let Ok(event) = event else {
        return;
    };
    let wanted = lock(wanted);
    let changed: Vec<_> = if event.need_rescan() {
        // Events were lost: anything may have changed.
        let all = wanted.files.values().chain(wanted.folders.values());
        all.cloned().collect()
    } else if is_change(&event.kind) {
        let paths = event.paths.iter();
        paths.filter_map(|path| wanted.named(path)).collect()
    } else {
        Vec::new()
    };
    for path in changed {
        // At the end of the program nobody listens.
        let _ = sender.send(path);
    }
}

/// Returns true unless a file was only read, or only its attributes changed.
fn is_change(kind: &EventKind) -> bool {
    match kind {
        EventKind::Access(access) => *access == AccessKind::Close(AccessMode::Write),
        EventKind::Modify(ModifyKind::Metadata(_)) => false,
        _ => true,
    }
}

/// Calls `on_change` after each save.
fn collect(changes: &Receiver<PathBuf>, mut on_change: impl FnMut(&[PathBuf])) {
    while let Ok(first) = changes.recv() {
        let start = Instant::now();
        let mut changed = BTreeSet::from([first]);
        while let Ok(next) = changes.recv_timeout(QUIET) {
            changed.insert(next);
            if start.elapsed() > LONGEST {
                break;
            }
        }
        let changed: Vec<_> = changed.into_iter().collect();
        on_change(&changed);
    }
}

#[cfg(test)]
mod tests {
    use std::fs;

    use tempfile::TempDir;

    use super::*;

    /// Enough for any machine; a test that succeeds does not wait that long.
    const PATIENCE: Duration = Duration::from_secs(20);

    struct Case {
        folder: TempDir,
        watcher: Watcher,
        calls: Receiver<Vec<PathBuf>>,
    }

    impl Case {
        fn new() -> Self {
            let (send, calls) = mpsc::channel();
            let watcher = Watcher::new(move |files: &[PathBuf]| {
                let _ = send.send(files.to_vec());
            });
            Self {
                folder: TempDir::new().unwrap(),
                watcher: watcher.unwrap(),
                calls,
            }
        }

        fn path(&self, name: &str) -> PathBuf {
            self.folder.path().join(name)
        }

        fn write(&self, name: &str, text: &str) {
            fs::write(self.path(name), text).unwrap();
        }

        fn watch(&mut self, names: &[&str]) {
            let files: Vec<_> = names.iter().map(|name| self.path(name)).collect();
            self.watcher.watch(files).unwrap();
        }

        /// Waits until this file was reported.
        fn expect(&self, name: &str) {
            let expected = self.path(name);
            let end = Instant::now() + PATIENCE;
            while !self
                .calls
                .recv_timeout(end - Instant::now())
                .expect("no change was reported")
                .contains(&expected)
            {}
        }
    }

    #[test]
    fn writes_renames_and_new_files_are_reported() {
        let mut case = Case::new();
        case.write("a.ron", "1");
        case.watch(&["a.ron", "table.csv"]);
        case.write("a.ron", "2");
        case.expect("a.ron");
        case.write("other", "3");
        fs::rename(case.path("other"), case.path("a.ron")).unwrap();
        case.expect("a.ron");
        case.write("table.csv", "x");
        case.expect("table.csv");
        fs::remove_file(case.path("a.ron")).unwrap();
        case.expect("a.ron");
        case.write("a.ron", "4");
        case.expect("a.ron");
    }

    #[test]
    fn other_files_and_reading_are_not_reported() {
        let mut case = Case::new();
        case.write("a.ron", "1");
        case.watch(&["a.ron"]);
        case.write("b.ron", "1");
        fs::read(case.path("a.ron")).unwrap();
        fs::remove_file(case.path("b.ron")).unwrap();
        case.write("a.ron", "2");
        let first = case.calls.recv_timeout(PATIENCE).unwrap();
        assert_eq!(first, [case.path("a.ron")]);
    }

    #[cfg(unix)]
    #[test]
    fn the_file_behind_a_link_is_watched() {
        let mut case = Case::new();
        fs::create_dir(case.path("real")).unwrap();
        case.write("real/a.ron", "1");
        std::os::unix::fs::symlink(case.path("real/a.ron"), case.path("a.ron")).unwrap();
        case.watch(&["a.ron"]);
        case.write("real/a.ron", "2");
        case.expect("a.ron");
    }

    #[test]
    fn many_writes_are_few_calls() {
        let mut case = Case::new();
        case.watch(&["a.ron"]);
        for count in 0..1000 {
            case.write("a.ron", &count.to_string());
        }
        case.watch(&["a.ron", "end"]);
        case.write("end", "");
        let mut calls = 0;
        while !case
            .calls
            .recv_timeout(PATIENCE)
            .unwrap()
            .contains(&case.path("end"))
        {
            calls += 1;
        }
        assert!(calls < 200, "{calls}");
    }

    #[test]
    fn everything_below_a_folder_is_watched() {
        let mut case = Case::new();
        fs::create_dir(case.path("deep")).unwrap();
        let folder = case.folder.path().to_owned();
        case.watcher.watch_below(&[folder]).unwrap();
        case.write("deep/new.ron", "1");
        case.expect("deep/new.ron");
    }
}
