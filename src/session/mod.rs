//! A scene that is edited: each text is checked on a thread of its own, and the last one without
//! errors stays ready to be drawn.

mod additions;
mod camera;
mod checked;
mod magnified;
mod moves;
mod outline;
mod parts;
mod rewrite;
#[cfg(test)]
mod tests;
mod turns;
mod view;

use std::{
    fmt, io, mem,
    path::{Path, PathBuf},
    sync::{Arc, Mutex, MutexGuard, PoisonError},
    time::{Instant, SystemTime},
};

pub use additions::PartList;
pub use camera::Motion;
pub use checked::{Checked, Ready};
pub use parts::ScenePart;
pub use turns::Turns;
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
/// Each change of the text, and of a file that the scene names, starts a check on another thread.
/// A newer change cancels it, and so does the end of the session, which does not wait for it.
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
}

/// A text and its version, which grows with each change.
#[derive(Clone, Debug)]
pub struct Draft {
    /// The number of changes of the text.
    pub version: u64,
    /// The text.
    pub text: Arc<str>,
}

type OnChecked = dyn FnMut(Arc<Checked>) + Send;

struct Shared {
    name: String,
    options: ReadOptions,
    turns: Turns,
    /// True if the scene is needed, and not only its diagnostics.
    keeps_scene: bool,
    state: Mutex<State>,
    on_checked: Mutex<Box<OnChecked>>,
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

impl fmt::Debug for Shared {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("Shared").field(&self.name).finish()
    }
}

impl Shared {
    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Requests a check, and cancels the one in flight.
    ///
    /// # Errors
    ///
    /// Fails if no thread can be started. The next request tries again.
    fn request(self: &Arc<Self>, mut state: MutexGuard<'_, State>) -> io::Result<()> {
        state.cancel.cancel();
        if mem::replace(&mut state.is_due, true) {
            return Ok(());
        }
        let given = self.turns.give(Arc::clone(self));
        state.is_due = given.is_ok();
        given
    }

    /// Checks the text, if it is still to be checked.
    fn turn(&self) {
        let mut state = self.state();
        if state.is_closed || !mem::take(&mut state.is_due) {
            return;
        }
        state.cancel = Cancel::new();
        let (draft, cancel) = (state.draft.clone(), state.cancel.clone());
        let last = state.checked.clone();
        drop(state);
        let Ok(checked) = self.check(&draft, &cancel, last.as_deref()) else {
            return;
        };
        let checked = Arc::new(checked);
        let mut state = self.state();
        if state.is_closed {
            return;
        }
        state.checked = Some(Arc::clone(&checked));
        drop(state);
        let on_checked = self.on_checked.lock();
        on_checked.unwrap_or_else(PoisonError::into_inner)(checked);
    }

    fn check(
        &self,
        draft: &Draft,
        cancel: &Cancel,
        last: Option<&Checked>,
    ) -> Result<Checked, Error> {
        let began = (Instant::now(), SystemTime::now());
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
            began,
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
    /// Starts to check a text. `on_checked` receives each result on the thread of the check.
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
        let turns = (Turns::default(), true);
        Self::start(name.into(), text.into(), options, turns, on_checked)
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
        let turns = (turns.clone(), false);
        Self::start(name.into(), text.into(), options, turns, on_checked)
    }

    fn start(
        name: String,
        text: Arc<str>,
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
                draft: Draft { version: 1, text },
                is_due: false,
                is_closed: false,
                cancel: Cancel::new(),
                checked: None,
            }),
            on_checked: Mutex::new(Box::new(on_checked)),
        });
        shared.request(shared.state()).map_err(|error| {
            let message = "the thread that checks the scene could not be started";
            Error::new(ErrorKind::Unavailable, message).caused_by(error)
        })?;
        Ok(Self { shared })
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
        let state = self.shared.state();
        let text = Arc::clone(&state.draft.text);
        let is_range = |edit: &Edit| text.get(edit.range.clone()).is_some();
        if state.draft.version != version || !edits.iter().all(is_range) {
            return None;
        }
        let (text, _) = edit::apply(&text, edits.iter().map(std::slice::from_ref));
        Some(self.put(state, text.into()))
    }

    /// Replaces the whole text, and returns the number of the new version.
    pub fn replace(&self, text: impl Into<Arc<str>>) -> u64 {
        self.put(self.shared.state(), text.into())
    }

    fn put(&self, mut state: MutexGuard<'_, State>, text: Arc<str>) -> u64 {
        let version = state.draft.version + 1;
        state.draft = Draft { version, text };
        self.request(state);
        version
    }

    fn request(&self, state: MutexGuard<'_, State>) {
        // Without a thread, the last result stays until the next change.
        let _ = self.shared.request(state);
    }

    /// Ends the check in flight. The next change starts one again.
    pub fn pause(&self) {
        let mut state = self.shared.state();
        state.is_due = false;
        state.cancel.cancel();
    }

    /// Checks the text again, after a change of a file that it names.
    pub fn refresh(&self) {
        self.request(self.shared.state());
    }
}

impl Drop for Session {
    /// Cancels the check in flight, and does not wait for it.
    fn drop(&mut self) {
        let mut state = self.shared.state();
        state.is_closed = true;
        state.cancel.cancel();
    }
}

/// The folder of a scene file, where its tables are.
pub fn folder_of(path: &Path) -> PathBuf {
    path.parent().unwrap_or(Path::new("")).to_owned()
}
