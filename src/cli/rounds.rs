//! Work that is done again after each change of the files it reads.

use std::{
    collections::BTreeSet,
    io::{self, Write},
    path::{Path, PathBuf},
    sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError},
    time::{Duration, Instant},
};

use strahl::{
    parallel::Cancel,
    scene::{Content, Disk, Files},
    text::sanitize,
};

use super::{failure::Failure, interrupt, threads::lock, watcher::Watcher};

/// The time without a change after which a round begins. A burst of saves is one change, and a file
/// that is being written is not read while it is still empty.
const QUIET: Duration = Duration::from_millis(50);
/// The longest wait for such a time.
const LONGEST: Duration = Duration::from_millis(500);

/// The message between rounds.
pub(super) const WAITING: &str = "waiting for changes";

/// Rounds of work, one at the start and one after each change. Ctrl-C ends the program.
pub(super) struct Rounds {
    shared: Arc<Shared>,
    files: WatchedFiles,
}

/// The reason for a round.
pub(super) struct Round {
    /// The files that have changed since the last round began, as they were named.
    pub(super) changed: BTreeSet<PathBuf>,
    /// The handle of the work, which the next change cancels.
    pub(super) cancel: Cancel,
}

struct Shared {
    state: Mutex<State>,
    wake: Condvar,
}

struct State {
    /// True if a round is due.
    is_due: bool,
    /// True once the program ends.
    is_closed: bool,
    changed: BTreeSet<PathBuf>,
    cancel: Cancel,
}

impl Shared {
    fn on_change(&self, files: &[PathBuf]) {
        let mut state = lock(&self.state);
        state.is_due = true;
        state.changed.extend(files.iter().cloned());
        state.cancel.cancel();
        drop(state);
        self.wake.notify_all();
    }

    /// Removes unfinished files, and begins no more of them.
    fn close(&self) {
        let mut state = lock(&self.state);
        state.is_closed = true;
        state.cancel.cancel();
    }
}

impl Rounds {
    pub(super) fn new() -> Result<Self, Failure> {
        let shared = Arc::new(Shared {
            state: Mutex::new(State {
                is_due: true,
                is_closed: false,
                changed: BTreeSet::new(),
                cancel: Cancel::new(),
            }),
            wake: Condvar::new(),
        });
        let at_end = Arc::clone(&shared);
        interrupt::exit_on_signal(move || at_end.close());
        let changing = Arc::clone(&shared);
        let watcher = Watcher::new(move |files: &[PathBuf]| changing.on_change(files))?;
        Ok(Self {
            shared,
            files: WatchedFiles(Arc::new(Mutex::new(Watched {
                watcher,
                named: BTreeSet::new(),
            }))),
        })
    }

    /// Waits until a round is due, and begins it.
    pub(super) fn next(&self) -> Round {
        let Shared { state, wake } = &*self.shared;
        let woken = wake.wait_while(lock(state), |state| !state.is_due);
        let mut state = woken.unwrap_or_else(PoisonError::into_inner);
        let start = Instant::now();
        while state.is_due && !state.changed.is_empty() && start.elapsed() < LONGEST {
            state.is_due = false;
            let woken = wake.wait_timeout_while(state, QUIET, |state| !state.is_due);
            (state, _) = woken.unwrap_or_else(PoisonError::into_inner);
        }
        // Once closed, the program ends, and no other file may be begun.
        let woken = wake.wait_while(state, |state| state.is_closed);
        let mut state = woken.unwrap_or_else(PoisonError::into_inner);
        state.is_due = false;
        state.cancel = Cancel::new();
        Round {
            changed: std::mem::take(&mut state.changed),
            cancel: state.cancel.clone(),
        }
    }

    /// Watches these files, and no longer those of the last round. To be called before they are read,
    /// so that no change is missed.
    pub(super) fn watch(&self, files: impl IntoIterator<Item = PathBuf>) -> Result<(), Failure> {
        self.files.begin().watcher.watch(files)
    }

    /// Likewise watches each of these files, and everything below each of these folders.
    pub(super) fn watch_below(
        &self,
        paths: impl IntoIterator<Item = PathBuf>,
    ) -> Result<(), Failure> {
        self.files.begin().watcher.watch_below(paths)
    }

    /// Watches one more file.
    pub(super) fn add(&self, file: &Path) -> Result<(), Failure> {
        lock(&self.files.0).watcher.add(file)
    }

    /// Returns the files on the disk, of which each table and part is watched from the time it is opened.
    pub(super) fn files(&self) -> WatchedFiles {
        self.files.clone()
    }

    /// Returns true if the file is a table or part that this round has opened, or could not.
    pub(super) fn is_named(&self, file: &Path) -> bool {
        lock(&self.files.0).named.contains(file)
    }
}

/// The files on the disk, of which each table and part is watched.
#[derive(Clone, Debug)]
pub(super) struct WatchedFiles(Arc<Mutex<Watched>>);

#[derive(Debug)]
struct Watched {
    watcher: Watcher,
    named: BTreeSet<PathBuf>,
}

impl WatchedFiles {
    /// Forgets the files that scenes named in the last round.
    fn begin(&self) -> MutexGuard<'_, Watched> {
        let mut watched = lock(&self.0);
        watched.named.clear();
        watched
    }
}

impl Files for WatchedFiles {
    /// Called for each table and part before it is opened, and for the folder of the scene.
    fn resolve(&self, path: &Path) -> io::Result<PathBuf> {
        if !path.is_dir() {
            let mut watched = lock(&self.0);
            if watched.named.insert(path.to_owned())
                && let Err(failure) = watched.watcher.add(path)
            {
                failure.print();
            }
        }
        Disk.resolve(path)
    }

    fn length(&self, path: &Path) -> io::Result<Option<u64>> {
        Disk.length(path)
    }

    fn open(&self, path: &Path) -> io::Result<Content> {
        Disk.open(path)
    }
}

/// Prints a line on standard error. If nobody reads it any more, the program ends.
pub(super) fn print_line(line: &str) -> Result<(), Failure> {
    match writeln!(io::stderr(), "{}", sanitize(line)) {
        Err(error) if error.kind() == io::ErrorKind::BrokenPipe => {
            Err(Failure::Closed { status: 0 })
        }
        _ => Ok(()),
    }
}
