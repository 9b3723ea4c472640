//! The scene on the desk: its draft, its file on the disk, and the state that pages follow.

use std::{
    io,
    path::{Path, PathBuf},
    sync::{Arc, Mutex},
};

use serde_json::{Value, json};
use strahl::{
    Error, Syntax,
    diagnostic::{read_file, read_text},
    image_file::{replace_file, write_file},
    parallel::Cancel,
    session::{Checked, Draft, Ready, Session},
};
use tokio::sync::watch;

use super::{
    findings,
    refusal::{Refusal, refuse},
};
use crate::cli::threads::lock;

/// The maximum number of bytes in the text: a browser could not show it.
pub(super) const LONGEST: u64 = 256 << 20;

/// A scene with its file.
pub(super) struct Desk {
    session: Session,
    path: PathBuf,
    syntax: Syntax,
    /// The turn to read or write the file. It is held without the lock of its state, so that pages
    /// never wait for the disk.
    turn: Mutex<()>,
    file: Mutex<FileState>,
    /// The last result, with its diagnostics as pages get them.
    latest: Mutex<Option<(Arc<Checked>, Vec<Value>)>>,
    state: watch::Sender<Arc<str>>,
    cancel: Cancel,
}

/// The file as far as it is known.
struct FileState {
    /// The text that the draft started from.
    base: Arc<str>,
    /// True if another text is on the disk, or none.
    has_changed: bool,
}

/// Returns a scene as pages get it.
fn scene_state(Ready { revision, scene }: &Ready) -> Value {
    let animation = scene.animation();
    let layers = scene.shown_layers().map(|layer| layer.to_string());
    json!({
        "revision": revision,
        "width": scene.size().width(),
        "height": scene.size().height(),
        "samples": scene.samples().count(),
        "follows_paths": scene.follows_paths(),
        "cameras": scene.cameras().collect::<Vec<_>>(),
        "has_camera": scene.has_camera(),
        "frames": animation.map_or(1, |animation| animation.frames()),
        "fps": animation.map_or(24.0, |animation| animation.fps()),
        "is_lit": scene.world().lighting().is_some(),
        "exposure": scene.tone().exposure(),
        "geometries": scene.world().ids(),
        "layers": layers.collect::<Vec<_>>(),
    })
}

impl Desk {
    pub(super) fn new(
        session: Session,
        path: PathBuf,
        syntax: Syntax,
        base: String,
        cancel: Cancel,
    ) -> Self {
        Self {
            session,
            path,
            syntax,
            turn: Mutex::new(()),
            file: Mutex::new(FileState {
                base: base.into(),
                has_changed: false,
            }),
            latest: Mutex::new(None),
            state: watch::Sender::new("".into()),
            cancel,
        }
    }

    pub(super) const fn session(&self) -> &Session {
        &self.session
    }

    pub(super) fn path(&self) -> &Path {
        &self.path
    }

    /// Returns the states from now on. The first is empty if nothing has been checked yet.
    pub(super) fn states(&self) -> watch::Receiver<Arc<str>> {
        self.state.subscribe()
    }

    /// Takes over the result of a check.
    pub(super) fn show(&self, checked: Arc<Checked>) {
        let diagnostics = findings::all(checked.document());
        *lock(&self.latest) = Some((checked, diagnostics));
        self.publish();
    }

    /// Publishes the state after a change of the draft, the file or the findings.
    pub(super) fn publish(&self) {
        let file = lock(&self.file);
        let latest = lock(&self.latest);
        let Some((checked, diagnostics)) = &*latest else {
            return;
        };
        let draft = self.session.draft();
        let is_saved = *draft.text == *file.base && !file.has_changed;
        let name = self.path.file_name().unwrap_or_default().to_string_lossy();
        let suppressed = checked.document().suppressed();
        let found = checked.document().diagnostics().len();
        let state = json!({
            "file": name,
            "syntax": self.syntax.name(),
            "version": draft.version,
            "revision": checked.revision(),
            "checked": checked.version(),
            "is_saved": is_saved,
            "conflict": file.has_changed,
            "is_broken": checked.is_broken(),
            "diagnostics": diagnostics,
            "suppressed": suppressed.errors + suppressed.warnings + found - diagnostics.len(),
            "scene": checked.scene().map(scene_state),
        });
        self.state.send_replace(state.to_string().into());
    }

    /// Takes notice of files that have changed on the disk.
    pub(super) fn on_change(&self, files: &[PathBuf]) {
        let is_scene = |file: &PathBuf| *file == self.path;
        let is_new = files.iter().any(is_scene) && self.read_again();
        // Its own save, for example, changes nothing.
        if !is_new && !files.iter().all(is_scene) {
            self.session.refresh();
        }
    }

    /// Takes over the text on the disk, unless the draft has unsaved edits. Returns true if it is a
    /// new one.
    fn read_again(&self) -> bool {
        let _turn = lock(&self.turn);
        let found = self.on_disk();
        let mut file = lock(&self.file);
        let draft = self.session.draft();
        match found {
            Ok(text) if text == *file.base || text == *draft.text => {
                file.base = text.into();
                file.has_changed = false;
            }
            Ok(text) if *draft.text == *file.base => {
                self.take_over(&mut file, text);
                return true;
            }
            _ => file.has_changed = true,
        }
        drop(file);
        self.publish();
        false
    }

    fn take_over(&self, file: &mut FileState, text: String) {
        self.session.replace(&*text);
        file.base = text.into();
        file.has_changed = false;
    }

    /// Returns the text of the file.
    pub(super) fn on_disk(&self) -> io::Result<String> {
        read_text(&self.path, LONGEST)
    }

    /// Drops the draft, and takes over the text of the file.
    pub(super) fn reload(&self) -> Result<(), Refusal> {
        let _turn = lock(&self.turn);
        let text = self.on_disk().map_err(|error| {
            let message = format!("{} cannot be read: {error}", self.path.display());
            refuse::conflict(message)
        })?;
        self.take_over(&mut lock(&self.file), text);
        self.publish();
        Ok(())
    }

    /// Writes the draft into the file. If another text is there, it survives unless `overwrite`.
    pub(super) fn save(&self, version: u64, overwrite: bool) -> Result<(), Refusal> {
        let _turn = lock(&self.turn);
        let Draft { version: now, text } = self.session.draft();
        if version != now {
            return Err(refuse::outdated());
        }
        let base = Arc::clone(&lock(&self.file).base);
        let written = match overwrite {
            true => self.overwrite(&text),
            false => replace_file(&self.path, base.as_bytes(), text.as_bytes(), &self.cancel),
        };
        if let Err(error) = written {
            if overwrite || self.on_disk().is_ok_and(|disk| disk == *base) {
                return Err(refuse::unwritable(error.to_string()));
            }
            lock(&self.file).has_changed = true;
            self.publish();
            let message = format!("{} has changed on the disk", self.path.display());
            return Err(refuse::conflict(message));
        }
        let mut file = lock(&self.file);
        file.base = text;
        file.has_changed = false;
        drop(file);
        self.publish();
        Ok(())
    }

    /// Writes a text into the file whatever is there, unless that is not a file.
    fn overwrite(&self, text: &str) -> Result<(), Error> {
        match read_file(&self.path, LONGEST) {
            Ok(old) => replace_file(&self.path, &old, text.as_bytes(), &self.cancel),
            Err(error) if error.kind() == io::ErrorKind::NotFound => {
                write_file(&self.path, text.as_bytes(), &self.cancel)
            }
            Err(error) => Err(Error::writing_failed(&self.path, error)),
        }
    }
}
