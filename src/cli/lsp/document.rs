//! An open document: its text, its checks, and the requests that wait for them.

use std::{
    path::{Path, PathBuf},
    sync::{Arc, mpsc::Sender},
    time::{Duration, Instant},
};

use lsp_server::RequestId;
use lsp_types::{TextDocumentItem, Uri};
use strahl::{
    Syntax,
    session::{Checked, Session, Turns},
    text::Columns,
};

use super::{
    server::Event,
    settings::OfScene,
    text::{Places, Text},
    uri,
};

/// The number of bytes up to which every change is checked at once.
const SHORT: usize = 1 << 18;
/// The time without a change after which a longer text is checked.
const QUIET: Duration = Duration::from_millis(150);

/// An open document.
pub(super) struct OpenDocument {
    pub(super) uri: Uri,
    pub(super) path: Option<PathBuf>,
    pub(super) version: i32,
    pub(super) text: Text,
    /// False for a file that only others name, such as a table.
    pub(super) is_scene_file: bool,
    pub(super) settings: OfScene,
    session: Option<Session>,
    /// Tells the results of this session from those of others.
    session_id: u64,
    /// The number of changes.
    changes: u64,
    /// The version of the session's text, and the number of changes it has.
    sent: (u64, u64),
    /// The time at which the text will be checked.
    due: Option<Instant>,
    latest: Option<Latest>,
    /// True if the client has diagnostics that a list without any must replace.
    pub(super) has_published: bool,
    /// The requests that need the diagnostics of the newest text.
    pub(super) waiting: Vec<Waiting>,
}

/// The result of a check.
#[derive(Clone)]
pub(super) struct Latest {
    changes: u64,
    pub(super) checked: Arc<Checked>,
    /// False for a text that is not a scene.
    pub(super) is_scene: bool,
}

/// A request that needs diagnostics.
pub(super) struct Waiting {
    pub(super) id: RequestId,
    pub(super) wish: Wish,
}

/// The kind of such a request.
pub(super) enum Wish {
    /// The diagnostics; the client may know a result.
    Diagnostics(Option<String>),
    Actions(Box<lsp_types::CodeActionParams>),
}

/// The result of a check, on its way to the document.
pub(super) struct Report {
    pub(super) uri: String,
    session_id: u64,
    checked: Arc<Checked>,
    is_scene: bool,
}

/// A document at a moment, for an answer on another thread.
#[derive(Clone)]
pub(super) struct Snapshot {
    pub(super) uri: Uri,
    pub(super) version: i32,
    pub(super) text: Text,
    pub(super) settings: OfScene,
    pub(super) columns: Columns,
}

impl Snapshot {
    pub(super) fn places(&self) -> Places<'_> {
        self.text.places(self.columns)
    }
}

/// Returns the syntax of a document: that of its language, or of its ending.
pub(super) fn syntax_of(document: &TextDocumentItem, path: Option<&Path>) -> Option<Syntax> {
    let path = path.unwrap_or(Path::new(document.uri.path().as_str()));
    match &*document.language_id {
        "ron" => Some(Syntax::Ron),
        "json" | "jsonc" => Some(Syntax::Json),
        language => Syntax::of_path(path).or_else(|| {
            let is_ours = language.starts_with("strahl");
            is_ours.then(|| Syntax::of_text(&document.text))
        }),
    }
}

impl OpenDocument {
    pub(super) fn new(document: TextDocumentItem, settings: OfScene) -> Self {
        let path = uri::path_of(document.uri.as_str());
        let syntax = syntax_of(&document, path.as_deref());
        Self {
            path,
            version: document.version,
            text: Text::new(document.text, syntax.unwrap_or(Syntax::Ron)),
            is_scene_file: syntax.is_some(),
            uri: document.uri,
            settings,
            session: None,
            session_id: 0,
            changes: 0,
            sent: (0, 0),
            due: syntax.map(|_| Instant::now()),
            latest: None,
            has_published: false,
            waiting: Vec::new(),
        }
    }

    /// Notes that the text has changed: the check in flight is of no use.
    pub(super) fn changed(&mut self) {
        self.changes += 1;
        if let Some(session) = &self.session {
            session.pause();
        }
        let is_short = self.text.as_str().len() <= SHORT;
        let delay = if is_short { Duration::ZERO } else { QUIET };
        self.due = self.is_scene_file.then(|| Instant::now() + delay);
    }

    /// Reads the text with other settings.
    pub(super) fn set(&mut self, settings: OfScene) {
        self.settings = settings;
        self.close();
        self.changed();
    }

    pub(super) const fn due(&self) -> Option<Instant> {
        self.due
    }

    /// Checks the text at once, unless that is under way.
    pub(super) fn hurry(&mut self) {
        self.due = self.due.map(|_| Instant::now());
    }

    /// Starts the check of the text, if it is time.
    pub(super) fn check(&mut self, turns: &Turns, events: &Sender<Event>) {
        if self.due.is_none_or(|due| due > Instant::now()) {
            return;
        }
        self.due = None;
        let text: Arc<str> = self.text.as_str().into();
        if let Some(session) = &self.session {
            self.sent = (session.replace(text), self.changes);
            return;
        }
        self.session_id += 1;
        let (session_id, uri) = (self.session_id, self.uri.as_str().to_owned());
        let events = events.clone();
        let syntax = self.text.source().syntax();
        let options = self.settings.options.clone().syntax(syntax);
        let report = move |checked: Arc<Checked>| {
            let _ = events.send(Event::Checked(Report {
                uri: uri.clone(),
                session_id,
                is_scene: !checked.document().is_no_scene(),
                checked,
            }));
        };
        let session = Session::of_findings(self.uri.as_str(), text, options, turns, report);
        // Without a thread there are no diagnostics, but all else works.
        self.session = session.ok();
        self.sent = (1, self.changes);
    }

    /// Takes over a result; returns false if it is of an older text.
    pub(super) fn take(&mut self, report: Report) -> bool {
        let Report {
            session_id,
            checked,
            is_scene,
            ..
        } = report;
        let is_current =
            session_id == self.session_id && (checked.version(), self.changes) == self.sent;
        if is_current {
            self.latest = Some(Latest {
                changes: self.changes,
                checked,
                is_scene,
            });
        }
        is_current
    }

    /// Returns the result for the newest text, if there is one.
    pub(super) fn latest(&self) -> Option<&Latest> {
        let is_newest = |latest: &&Latest| latest.changes == self.changes;
        self.latest.as_ref().filter(is_newest)
    }

    /// Returns the tables and parts that the last scene named, and those of its parts.
    pub(super) fn files(&self) -> &[PathBuf] {
        let latest = self.latest.as_ref();
        latest.map_or(&[], |latest| latest.checked.files())
    }

    /// Checks the text again, after a change of a file that it names.
    pub(super) fn refresh(&self) {
        if let Some(session) = &self.session {
            session.refresh();
        }
    }

    pub(super) fn snapshot(&self, columns: Columns) -> Snapshot {
        Snapshot {
            uri: self.uri.clone(),
            version: self.version,
            text: self.text.clone(),
            settings: self.settings.clone(),
            columns,
        }
    }

    /// Ends the checks.
    pub(super) fn close(&mut self) {
        if let Some(session) = self.session.take() {
            session.pause();
        }
    }
}
