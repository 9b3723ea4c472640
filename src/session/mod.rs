//! A scene that is edited: each text is checked on a thread of its own, and the last one without
//! errors stays ready to be drawn.

mod camera;
mod outline;
mod rewrite;
mod view;

use std::{
    mem,
    path::{Path, PathBuf},
    sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError},
    thread::{self, JoinHandle},
    time::Duration,
};

pub use camera::Motion;
pub use view::{Quality, Seen, View};

use crate::{
    diagnostic::error::{Error, ErrorKind},
    parallel::Cancel,
    pipeline::{Scene, options::RenderOptions},
    scene::{document::Document, options::ReadOptions},
    text::edit::{self, Edit},
};

/// A scene that is edited.
///
/// Each change of the text, and of a file that the scene names, starts a check on the thread of
/// the session. A newer change cancels it.
///
/// # Examples
///
/// ```
/// use std::sync::mpsc;
/// use strahl::{ReadOptions, Syntax, session::Session};
///
/// let (checked, results) = mpsc::channel();
/// let options = ReadOptions::new().syntax(Syntax::Ron);
/// let session = Session::new("mine.ron", "(camera: 1)", options, move |result| {
///     let _ = checked.send(result.document().diagnostics().len());
/// })?;
/// assert_eq!(results.recv()?, 2);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct Session {
    shared: Arc<Shared>,
    checker: Option<JoinHandle<()>>,
}

/// A text and its version, which grows with each change.
#[derive(Clone, Debug)]
pub struct Draft {
    /// The number of changes of the text.
    pub version: u64,
    /// The text.
    pub text: Arc<str>,
}

/// The result of a check.
#[derive(Debug)]
pub struct Checked {
    version: u64,
    revision: u64,
    document: Document,
    files: Vec<PathBuf>,
    scene: Option<Ready>,
    is_broken: bool,
}

/// The last scene without errors.
#[derive(Clone, Debug)]
pub struct Ready {
    /// The first revision with the same pictures: that of a text with another comment stays.
    pub revision: u64,
    /// The scene.
    pub scene: Arc<Scene>,
}

impl Checked {
    /// The version of the text.
    pub const fn version(&self) -> u64 {
        self.version
    }

    /// The number of checks before this one that were not cancelled.
    pub const fn revision(&self) -> u64 {
        self.revision
    }

    /// The text with its diagnostics.
    pub const fn document(&self) -> &Document {
        &self.document
    }

    /// The paths of the files that the scene depends on: tables, and parts with theirs.
    pub fn files(&self) -> &[PathBuf] {
        &self.files
    }

    /// Returns the scene of this text, or the last one before it without errors.
    pub const fn scene(&self) -> Option<&Ready> {
        self.scene.as_ref()
    }

    /// Returns true if the text has errors, so that [`Checked::scene`] is of an earlier one.
    pub const fn is_broken(&self) -> bool {
        self.is_broken
    }
}

/// The turns of sessions that check one after another. Clones are the same turns.
#[derive(Clone, Debug, Default)]
pub struct Turns(Arc<(Mutex<bool>, Condvar)>);

/// The right to check, until it is dropped.
struct Turn<'a>(&'a Turns);

impl Turns {
    /// The time after which a waiting session looks whether it is closed.
    const WAIT: Duration = Duration::from_millis(20);

    fn is_taken(&self) -> MutexGuard<'_, bool> {
        self.0.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Waits for a turn, but not long.
    fn take(&self) -> Option<Turn<'_>> {
        let mut is_taken = self.is_taken();
        if *is_taken {
            let waited = self.0.1.wait_timeout(is_taken, Self::WAIT);
            (is_taken, _) = waited.unwrap_or_else(PoisonError::into_inner);
        }
        (!mem::replace(&mut *is_taken, true)).then_some(Turn(self))
    }
}

impl Drop for Turn<'_> {
    fn drop(&mut self) {
        *self.0.is_taken() = false;
        self.0.0.1.notify_one();
    }
}

#[derive(Debug)]
struct Shared {
    name: String,
    options: ReadOptions,
    turns: Turns,
    /// True if the scene is needed, and not only its diagnostics.
    keeps_scene: bool,
    state: Mutex<State>,
    wake: Condvar,
}

#[derive(Debug)]
struct State {
    draft: Draft,
    /// True if the text, or a file that it names, has changed since the last check began.
    is_due: bool,
    is_closed: bool,
    /// The handle of the check in flight.
    cancel: Cancel,
    checked: Option<Arc<Checked>>,
}

impl Shared {
    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Requests a check, and cancels the one in flight.
    fn request(&self, mut state: MutexGuard<'_, State>) {
        state.is_due = true;
        state.cancel.cancel();
        drop(state);
        self.wake.notify_all();
    }

    /// Waits for a request and a turn; `None` once the session is closed.
    fn next(&self) -> Option<(Draft, Cancel, Turn<'_>)> {
        loop {
            let mut state = self.state();
            while !state.is_due && !state.is_closed {
                state = self
                    .wake
                    .wait(state)
                    .unwrap_or_else(PoisonError::into_inner);
            }
            drop(state);
            let turn = self.turns.take();
            let mut state = self.state();
            if state.is_closed {
                return None;
            }
            if let Some(turn) = turn.filter(|_| state.is_due) {
                state.is_due = false;
                state.cancel = Cancel::new();
                return Some((state.draft.clone(), state.cancel.clone(), turn));
            }
        }
    }

    /// Checks texts until the session is closed.
    fn run(&self, mut on_checked: impl FnMut(Arc<Checked>)) {
        let mut last = None;
        while let Some((draft, cancel, turn)) = self.next() {
            let Ok(checked) = self.check(&draft, &cancel, last.as_deref()) else {
                continue;
            };
            drop(turn);
            let checked = Arc::new(checked);
            self.state().checked = Some(Arc::clone(&checked));
            last = Some(Arc::clone(&checked));
            on_checked(checked);
        }
    }

    fn check(
        &self,
        draft: &Draft,
        cancel: &Cancel,
        last: Option<&Checked>,
    ) -> Result<Checked, Error> {
        let options = self.options.clone().cancel(cancel.clone());
        let document = Document::from_reader(&*self.name, draft.text.as_bytes(), &options)
            .map_err(|error| Error::reading_failed(&self.name, error))?;
        let revision = last.map_or(1, |last| last.revision + 1);
        let findings = document.findings();
        let files = document.dependencies().into_iter();
        let files = files.map(|file| file.path.to_owned()).collect();
        let scene = self.keeps_scene.then(|| Scene::try_from(document));
        let is_broken = !matches!(scene, Some(Ok(_)));
        let before = last.and_then(|last| last.scene.as_ref());
        let scene = match scene {
            Some(Ok(scene)) => Some(Ready {
                revision: before
                    .filter(|before| before.scene.looks_like(&scene))
                    .map_or(revision, |before| before.revision),
                scene: scene.into(),
            }),
            Some(Err(_)) => before.cloned(),
            None => None,
        };
        Ok(Checked {
            version: draft.version,
            revision,
            document: findings,
            files,
            scene,
            is_broken,
        })
    }
}

impl Session {
    /// Starts to check a text. `on_checked` receives each result on the thread of the session.
    ///
    /// `name` is the name in reports. [`ReadOptions::syntax`] and [`ReadOptions::folder`] tell how
    /// the text is read.
    ///
    /// # Errors
    ///
    /// Fails if no thread can be started.
    pub fn new(
        name: impl Into<String>,
        text: impl Into<Arc<str>>,
        options: ReadOptions,
        on_checked: impl FnMut(Arc<Checked>) + Send + 'static,
    ) -> Result<Self, Error> {
        let draft = Draft {
            version: 1,
            text: text.into(),
        };
        Self::start(
            name.into(),
            draft,
            options,
            (Turns::default(), true),
            on_checked,
        )
    }

    /// Starts to check a text for its diagnostics only, so that [`Checked::scene`] is always
    /// `None`. Sessions with the same `turns` check one after another.
    ///
    /// # Errors
    ///
    /// As [`Session::new`].
    ///
    /// # Examples
    ///
    /// ```
    /// use std::sync::mpsc;
    /// use strahl::{
    ///     ReadOptions, Syntax,
    ///     session::{Session, Turns},
    /// };
    ///
    /// let (turns, (checked, results)) = (Turns::default(), mpsc::channel());
    /// let options = ReadOptions::new().syntax(Syntax::Ron);
    /// let sessions = ["(camera: 1)", "("].map(|text| {
    ///     let checked = checked.clone();
    ///     Session::of_findings("mine.ron", text, options.clone(), &turns, move |result| {
    ///         let _ = checked.send(result.scene().is_none());
    ///     })
    /// });
    /// assert!(results.recv()? && results.recv()?);
    /// # drop(sessions);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn of_findings(
        name: impl Into<String>,
        text: impl Into<Arc<str>>,
        options: ReadOptions,
        turns: &Turns,
        on_checked: impl FnMut(Arc<Checked>) + Send + 'static,
    ) -> Result<Self, Error> {
        let draft = Draft {
            version: 1,
            text: text.into(),
        };
        Self::start(
            name.into(),
            draft,
            options,
            (turns.clone(), false),
            on_checked,
        )
    }

    fn start(
        name: String,
        draft: Draft,
        options: ReadOptions,
        (turns, keeps_scene): (Turns, bool),
        on_checked: impl FnMut(Arc<Checked>) + Send + 'static,
    ) -> Result<Self, Error> {
        // Threads of its own, so that a picture in flight does not delay the check of a long text.
        let threads = RenderOptions::new().thread_count();
        let shared = Arc::new(Shared {
            name,
            options: options.threads(threads),
            turns,
            keeps_scene,
            state: Mutex::new(State {
                draft,
                is_due: true,
                is_closed: false,
                cancel: Cancel::new(),
                checked: None,
            }),
            wake: Condvar::new(),
        });
        let checker = Arc::clone(&shared);
        let checker = thread::Builder::new()
            .name("check".to_owned())
            .spawn(move || checker.run(on_checked));
        let checker = checker.map_err(|error| {
            let message = "the thread that checks the scene could not be started";
            Error::new(ErrorKind::Unavailable, message).caused_by(error)
        })?;
        Ok(Self {
            shared,
            checker: Some(checker),
        })
    }

    /// Returns the text.
    pub fn draft(&self) -> Draft {
        self.shared.state().draft.clone()
    }

    /// Returns the last result; `None` before the first.
    pub fn checked(&self) -> Option<Arc<Checked>> {
        self.shared.state().checked.clone()
    }

    /// Replaces parts of a version of the text, and returns the number of the new version; `None`
    /// if the text has another version by now, or no version has these ranges.
    pub fn edit(&self, version: u64, edits: &[Edit]) -> Option<u64> {
        let mut state = self.shared.state();
        let text = Arc::clone(&state.draft.text);
        let is_range = |edit: &Edit| text.get(edit.range.clone()).is_some();
        if state.draft.version != version || !edits.iter().all(is_range) {
            return None;
        }
        let (text, _) = edit::apply(&text, edits.iter().map(std::slice::from_ref));
        state.draft = Draft {
            version: version + 1,
            text: text.into(),
        };
        self.shared.request(state);
        Some(version + 1)
    }

    /// Replaces the whole text, and returns the number of the new version.
    pub fn replace(&self, text: impl Into<Arc<str>>) -> u64 {
        let mut state = self.shared.state();
        let version = state.draft.version + 1;
        state.draft = Draft {
            version,
            text: text.into(),
        };
        self.shared.request(state);
        version
    }

    /// Ends the check in flight. The next change starts one again.
    pub fn pause(&self) {
        let mut state = self.shared.state();
        state.is_due = false;
        state.cancel.cancel();
    }

    /// Checks the text again, after a change of a file that it names.
    pub fn refresh(&self) {
        self.shared.request(self.shared.state());
    }
}

impl Drop for Session {
    fn drop(&mut self) {
        let mut state = self.shared.state();
        state.is_closed = true;
        self.shared.request(state);
        if let Some(checker) = self.checker.take() {
            // It has nothing left to report.
            let _ = checker.join();
        }
    }
}

/// Returns the error for a request that cannot be met.
fn refused(message: impl Into<String>) -> Error {
    Error::new(ErrorKind::Usage, message)
}

/// The folder of a scene file, where its tables are.
pub fn folder_of(path: &Path) -> PathBuf {
    path.parent().unwrap_or(Path::new("")).to_owned()
}
