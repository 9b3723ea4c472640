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
    Config, Event, EventKind, RecommendedWatcher, RecursiveMode, Watcher as _,
    event::{AccessKind, AccessMode, ModifyKind},
};

use super::{Failure, paths::folder_of};

/// The time without an event after which a save is over.
const QUIET: Duration = Duration::from_millis(10);
/// The longest time that events are collected.
const LONGEST: Duration = Duration::from_millis(100);

/// Reports changes of files and folders.
#[derive(Debug)]
pub(super) struct Watcher {
    inner: RecommendedWatcher,
    wanted: Arc<Mutex<Wanted>>,
}

/// The files whose changes are reported.
#[derive(Debug, Default)]
struct Wanted {
    /// The files by their real paths, as they were named.
    files: BTreeMap<PathBuf, PathBuf>,
    /// The folders of which every file counts, likewise.
    folders: BTreeMap<PathBuf, PathBuf>,
    /// The folders that the system watches.
    watched: BTreeMap<PathBuf, RecursiveMode>,
}

impl Wanted {
    /// Adds a file, and returns the folders to watch for it.
    fn add(&mut self, file: &Path) -> Vec<PathBuf> {
        // Behind a link, another file changes.
        let places = [first_missing(file), file.canonicalize().ok()];
        let mut folders = Vec::new();
        for place in places.into_iter().flatten() {
            let is_below = |folder: &PathBuf| place.starts_with(folder);
            if !self.folders.keys().any(is_below) {
                folders.extend(place.parent().map(Path::to_owned));
            }
            self.files.insert(place, file.to_owned());
        }
        folders
    }

    /// Returns a changed file as it was named.
    fn named(&self, changed: &Path) -> Option<PathBuf> {
        let in_folder = || {
            let mut folders = self.folders.iter();
            folders.find_map(|(real, named)| Some(named.join(changed.strip_prefix(real).ok()?)))
        };
        self.files.get(changed).cloned().or_else(in_folder)
    }

    /// Returns the files that changed with a folder that is gone. The system does not watch another
    /// one in its place.
    fn lost(&mut self, folder: &Path) -> Vec<PathBuf> {
        if self.watched.remove(folder).is_none() {
            return Vec::new();
        }
        let all = self.files.iter().chain(&self.folders);
        let lost = all.filter(|(real, _)| real.starts_with(folder));
        lost.map(|(_, named)| named.clone()).collect()
    }
}

/// Returns the real path of a file, which may be a link; if its folder is missing, that of the first
/// missing folder, whose creation is the change to wait for.
fn first_missing(file: &Path) -> Option<PathBuf> {
    let mut ancestors = file.ancestors();
    ancestors.find_map(|place| {
        Some(
            folder_of(place)
                .canonicalize()
                .ok()?
                .join(place.file_name()?),
        )
    })
}

impl Watcher {
    /// Creates a watcher of nothing. `on_change` gets the changed files, as they were named, on a
    /// thread of its own. The events of one save are one call.
    pub(super) fn new(on_change: impl FnMut(&[PathBuf]) + Send + 'static) -> Result<Self, Failure> {
        let wanted = Arc::new(Mutex::new(Wanted::default()));
        let (sender, changes) = mpsc::channel();
        let of_events = Arc::clone(&wanted);
        let on_event = move |event| pass_on(event, &of_events, &sender);
        // A link in a folder may lead to the whole disk.
        let config = Config::default().with_follow_symlinks(false);
        let inner = RecommendedWatcher::new(on_event, config).map_err(|error| refused(&error))?;
        let started = thread::Builder::new()
            .name("watch".to_owned())
            .spawn(move || collect(&changes, on_change));
        started.map_err(|error| Failure::usage(format!("files cannot be watched: {error}")))?;
        Ok(Self { inner, wanted })
    }

    /// Watches these files, and no longer what was named before. Neither a file nor its folder need
    /// exist.
    pub(super) fn watch(
        &mut self,
        files: impl IntoIterator<Item = PathBuf>,
    ) -> Result<(), Failure> {
        self.replace(Vec::new(), files.into_iter().collect())
    }

    /// Watches all files below these paths, and no longer what was named before. A path may be a file.
    pub(super) fn watch_below(
        &mut self,
        paths: impl IntoIterator<Item = PathBuf>,
    ) -> Result<(), Failure> {
        let (folders, files) = paths.into_iter().partition(|path| path.is_dir());
        self.replace(folders, files)
    }

    fn replace(&mut self, folders: Vec<PathBuf>, files: Vec<PathBuf>) -> Result<(), Failure> {
        let mut wanted = Wanted::default();
        for named in folders {
            if let Ok(real) = named.canonicalize() {
                wanted.folders.insert(real, named);
            }
        }
        let mut folders = BTreeMap::new();
        for folder in files.iter().flat_map(|file| wanted.add(file)) {
            folders.insert(folder, RecursiveMode::NonRecursive);
        }
        for folder in wanted.folders.keys() {
            folders.insert(folder.clone(), RecursiveMode::Recursive);
        }
        let old = {
            let mut current = lock(&self.wanted);
            wanted.watched = std::mem::take(&mut current.watched);
            *current = wanted;
            current.watched.clone()
        };
        for folder in old.keys().filter(|folder| !folders.contains_key(*folder)) {
            // It may be gone.
            let _ = self.inner.unwatch(folder);
            lock(&self.wanted).watched.remove(folder);
        }
        folders
            .iter()
            .try_for_each(|(folder, mode)| self.watch_folder(folder, *mode))
    }

    /// Watches one more file.
    pub(super) fn add(&mut self, file: &Path) -> Result<(), Failure> {
        let folders = lock(&self.wanted).add(file);
        folders
            .iter()
            .try_for_each(|folder| self.watch_folder(folder, RecursiveMode::NonRecursive))
    }

    /// Watches a folder, if the system does not yet.
    fn watch_folder(&mut self, folder: &Path, mode: RecursiveMode) -> Result<(), Failure> {
        // The lock is not held meanwhile: the thread that answers may be waiting for it.
        if lock(&self.wanted).watched.get(folder) == Some(&mode) {
            return Ok(());
        }
        let watched = self.inner.watch(folder, mode);
        watched.map_err(|error| refused(&error))?;
        lock(&self.wanted).watched.insert(folder.to_owned(), mode);
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
    let mut wanted = lock(wanted);
    let changed: Vec<_> = if event.need_rescan() {
        // Events were lost: anything may have changed.
        let all = wanted.files.values().chain(wanted.folders.values());
        all.cloned().collect()
    } else if is_change(&event.kind) {
        let (is_gone, paths) = (may_be_gone(&event.kind), event.paths.iter());
        let lost = |path: &PathBuf| match is_gone {
            true => wanted.lost(path),
            false => Vec::new(),
        };
        let mut changed: Vec<_> = paths.clone().flat_map(lost).collect();
        changed.extend(paths.filter_map(|path| wanted.named(path)));
        changed
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

/// Returns true if a file or a folder was removed or has another name.
const fn may_be_gone(kind: &EventKind) -> bool {
    matches!(
        kind,
        EventKind::Remove(_) | EventKind::Modify(ModifyKind::Name(_))
    )
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
        // Each write is several events.
        assert!(calls < 1000, "{calls}");
    }

    #[test]
    fn everything_below_a_folder_is_watched() {
        let mut case = Case::new();
        fs::create_dir(case.path("deep")).unwrap();
        let folder = case.folder.path().to_owned();
        case.watcher.watch_below([folder]).unwrap();
        case.write("deep/new.ron", "1");
        case.expect("deep/new.ron");
        // Another file below does not end that.
        case.watcher.add(&case.path("deep/table.csv")).unwrap();
        fs::create_dir(case.path("deep/deeper")).unwrap();
        case.expect("deep/deeper");
        case.write("deep/deeper/new.ron", "1");
        case.expect("deep/deeper/new.ron");
    }

    #[test]
    fn a_file_in_a_missing_folder_is_waited_for() {
        let mut case = Case::new();
        case.watch(&["data/deep/table.csv"]);
        fs::create_dir_all(case.path("data/deep")).unwrap();
        case.expect("data/deep/table.csv");
        case.watch(&["data/deep/table.csv"]);
        case.write("data/deep/table.csv", "1");
        case.expect("data/deep/table.csv");
    }

    #[test]
    fn a_folder_that_was_replaced_is_watched_again() {
        let mut case = Case::new();
        fs::create_dir(case.path("a")).unwrap();
        case.write("a/b.ron", "1");
        case.watch(&["a/b.ron"]);
        for _ in 0..2 {
            fs::rename(case.path("a"), case.path("old")).unwrap();
            case.expect("a/b.ron");
            fs::create_dir(case.path("a")).unwrap();
            case.watch(&["a/b.ron"]);
            case.write("a/b.ron", "2");
            case.expect("a/b.ron");
            fs::remove_dir_all(case.path("old")).unwrap();
        }
    }
}
