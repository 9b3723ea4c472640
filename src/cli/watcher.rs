//! Watching files for changes.
//!
//! The folders of the files are watched, not the files: editors replace a file by renaming another
//! one over it, and a file may not exist yet. So is the folder of each link on the way to a file,
//! since another link there leads to another file.

use std::{
    collections::{BTreeMap, BTreeSet},
    path::{Path, PathBuf},
    sync::{
        Arc, Mutex,
        mpsc::{self, Receiver, Sender},
    },
    time::{Duration, Instant},
};

use notify::{
    Config, Event, EventKind, RecommendedWatcher, RecursiveMode, Watcher as _,
    event::{AccessKind, AccessMode, ModifyKind},
};

use super::{
    failure::Failure,
    threads::{lock, spawn},
};

/// The fault of a watcher that the system refuses.
const LOST: &str = "files cannot be watched";

/// The time without an event after which a save is over.
const QUIET: Duration = Duration::from_millis(10);
/// The longest time that events are collected.
const LONGEST: Duration = Duration::from_millis(100);

/// The maximum number of links on the way to a file, as on Linux.
const MOST_LINKS: usize = 40;

/// Reports changes of files and folders.
#[derive(Debug)]
pub(super) struct Watcher {
    inner: RecommendedWatcher,
    wanted: Arc<Mutex<Wanted>>,
}

/// The files whose changes are reported.
#[derive(Debug, Default)]
struct Wanted {
    /// The files, as they were named, by each real path whose change changes them.
    files: BTreeMap<PathBuf, BTreeSet<PathBuf>>,
    /// The folders of which every file counts, likewise.
    folders: BTreeMap<PathBuf, PathBuf>,
    /// The folders that the system watches.
    watched: BTreeMap<PathBuf, RecursiveMode>,
}

impl Wanted {
    /// Adds a file, and returns the folders to watch for it.
    fn add(&mut self, file: &Path) -> Vec<PathBuf> {
        let mut folders = Vec::new();
        for place in on_the_way(file) {
            let is_below = |folder: &PathBuf| place.starts_with(folder);
            if !self.folders.keys().any(is_below) {
                folders.extend(place.parent().map(Path::to_owned));
            }
            self.files.entry(place).or_default().insert(file.to_owned());
        }
        folders
    }

    /// Returns the files that have changed with one, as they were named.
    fn named(&self, changed: &Path) -> BTreeSet<PathBuf> {
        let in_folder = || {
            let mut folders = self.folders.iter();
            folders.find_map(|(real, named)| Some(named.join(changed.strip_prefix(real).ok()?)))
        };
        let files = self.files.get(changed).cloned();
        files.unwrap_or_else(|| in_folder().into_iter().collect())
    }

    /// Returns all files and folders, as they were named.
    fn all(&self) -> impl Iterator<Item = (&Path, &Path)> {
        let files = self.files.iter();
        let files = files.flat_map(|(real, named)| named.iter().map(move |named| (real, named)));
        let all = files.chain(&self.folders);
        all.map(|(real, named)| (&**real, &**named))
    }

    /// Returns the files that changed with a folder that is gone. The system does not watch another
    /// one in its place.
    fn lost(&mut self, folder: &Path) -> Vec<PathBuf> {
        if self.watched.remove(folder).is_none() {
            return Vec::new();
        }
        let lost = self.all().filter(|(real, _)| real.starts_with(folder));
        lost.map(|(_, named)| named.to_owned()).collect()
    }
}

/// Returns the real path of each link on the way to a file, and of the file itself. If a folder is
/// missing, its creation is the change to wait for, so the last path is that of the folder.
fn on_the_way(file: &Path) -> Vec<PathBuf> {
    let (mut found, mut links) = (Vec::new(), 0);
    let mut real = PathBuf::new();
    let parts = |path: &Path| -> Vec<PathBuf> {
        let parts = path.components().rev();
        parts.map(|part| part.as_os_str().into()).collect()
    };
    let mut rest = parts(&std::path::absolute(file).unwrap_or_else(|_| file.to_owned()));
    while let Some(part) = rest.pop() {
        if part == Path::new("..") {
            real.pop();
            continue;
        }
        if part == Path::new(".") {
            continue;
        }
        // The root replaces what is before it.
        real.push(&part);
        if let Ok(target) = real.read_link() {
            // A ring leads nowhere.
            if links == MOST_LINKS {
                break;
            }
            links += 1;
            // The system's own links stay, and all files are below their folder.
            if !(cfg!(target_os = "macos") && real.parent() == Some(Path::new("/"))) {
                found.push(real.clone());
            }
            real.pop();
            rest.extend(parts(&target));
        } else if real.symlink_metadata().is_err() {
            break;
        }
    }
    found.push(real);
    found
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
        spawn("watch", LOST, move || collect(&changes, on_change))?;
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
        for named in &folders {
            if let Ok(real) = named.canonicalize() {
                wanted.folders.insert(real, named.clone());
            }
        }
        // Another link on the way to a folder leads to another folder.
        let named = files.iter().chain(&folders);
        let single: Vec<_> = named.flat_map(|path| wanted.add(path)).collect();
        let mut folders = BTreeMap::new();
        for folder in single {
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

fn refused(error: &notify::Error) -> Failure {
    let cure = match error.kind {
        notify::ErrorKind::MaxFilesWatch => {
            "; the system allows no more watched folders (on Linux, raise \
             fs.inotify.max_user_watches)"
        }
        _ => "",
    };
    Failure::usage(format!("{LOST}: {error}{cure}"))
}

/// Passes on the wanted files of an event.
fn pass_on(event: notify::Result<Event>, wanted: &Mutex<Wanted>, sender: &Sender<PathBuf>) {
    let Ok(event) = event else {
        return;
    };
    let mut wanted = lock(wanted);
    let changed: Vec<_> = if event.need_rescan() {
        // Events were lost: anything may have changed.
        wanted.all().map(|(_, named)| named.to_owned()).collect()
    } else if is_change(&event.kind) {
        let (is_gone, paths) = (may_be_gone(&event.kind), event.paths.iter());
        let lost = |path: &PathBuf| match is_gone {
            true => wanted.lost(path),
            false => Vec::new(),
        };
        let mut changed: Vec<_> = paths.clone().flat_map(lost).collect();
        changed.extend(paths.flat_map(|path| wanted.named(path)));
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

    #[cfg(unix)]
    #[test]
    fn each_link_on_the_way_is_watched() {
        use std::os::unix::fs::symlink;

        let mut case = Case::new();
        for (folder, text) in [("v1", "1"), ("v2", "2"), ("v3", "3")] {
            fs::create_dir(case.path(folder)).unwrap();
            case.write(&format!("{folder}/a.ron"), text);
            case.write(&format!("{folder}/b.csv"), text);
        }
        let point = |case: &Case, folder: &str| {
            symlink(folder, case.path("new")).unwrap();
            fs::rename(case.path("new"), case.path("data")).unwrap();
        };
        // As configuration maps of Kubernetes are: a link to a file behind a link.
        point(&case, "v1");
        symlink("data/a.ron", case.path("a.ron")).unwrap();
        let names = ["a.ron", "data/b.csv"];
        case.watch(&names);
        for folder in ["./v2", "v1/../v3", "v1"] {
            point(&case, folder);
            case.expect("a.ron");
            point(&case, folder);
            case.expect("data/b.csv");
            case.watch(&names);
            case.write("data/a.ron", "new");
            case.expect("a.ron");
            case.write("data/b.csv", "new");
            case.expect("data/b.csv");
        }
        // Everything below a link to a folder.
        let below = case.path("data");
        case.watcher.watch_below([below]).unwrap();
        point(&case, "v2");
        case.expect("data");
        // A ring has an end.
        symlink("ring", case.path("ring")).unwrap();
        case.watch(&["ring/a.ron"]);
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
