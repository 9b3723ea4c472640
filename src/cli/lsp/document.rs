//! An open document: its text, its checks, and the requests that wait for them.

use std::{
    path::{Path, PathBuf},
    sync::{Arc, mpsc::Sender},
    time::{Duration, Instant},
};

use lsp_server::RequestId;
use lsp_types::{TextDocumentItem, Uri};
use strahl::{
    Diagnostic, Syntax,
    diagnostic::Code,
    scene::Cuts,
    session::{Checked, Session, Turns},
    text::Columns,
};

use super::{
    client::Client,
    settings::OfScene,
    text::{Places, Replaced, Text},
    uri,
    wire::Incoming,
};

/// The number of bytes up to which every change is checked at once.
const SHORT: usize = 1 << 18;
/// The time without a change after which the whole of a longer text is checked.
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
    /// Checks the text.
    whole: Checker,
    /// Checks what is new, without a wait for a check of the text.
    near: Checker,
    /// What the text of `near` leaves out.
    cuts: Cuts,
    /// The number of sessions.
    sessions: u64,
    /// The number of changes.
    changes: u64,
    /// The next check, and its time.
    due: Option<(Instant, Extent)>,
    /// The time from which the text has been as it is now.
    changed: Instant,
    latest: Option<Latest>,
    /// The diagnostics of the last check of the whole text that found no syntax faults, moved with
    /// the edits since.
    last: Vec<Diagnostic>,
    files: Vec<PathBuf>,
    /// True if the client has diagnostics that a list without any must replace.
    pub(super) has_published: bool,
    /// The diagnostics that the client has of the text with this number of changes.
    told: Option<(u64, Vec<lsp_types::Diagnostic>)>,
    /// The requests that need the diagnostics of the newest text.
    pub(super) waiting: Vec<Waiting>,
}

/// Checks one text after another.
#[derive(Default)]
struct Checker {
    session: Option<Session>,
    /// Tells the results of this session from those of others.
    id: u64,
    /// The version of the session's text, and the number of changes it has.
    sent: (u64, u64),
}

/// The part of a text that is checked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Extent {
    /// What is new near an offset. It takes no longer than a key is down.
    Around(usize),
    Whole,
}

/// The result of a check.
#[derive(Clone)]
pub(super) struct Latest {
    changes: u64,
    /// The diagnostics, in the order of the text.
    pub(super) diagnostics: Arc<[Diagnostic]>,
    /// The check of the whole text; `None` until it is finished.
    pub(super) whole: Option<Arc<Checked>>,
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

/// Something that the server reacts to.
pub(super) enum Event {
    Incoming(Incoming),
    /// The result of a check.
    Checked(Report),
    /// Files that have changed.
    Files(Vec<PathBuf>),
    /// The client is gone.
    End,
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
    pub(super) client: Arc<Client>,
}

impl Snapshot {
    pub(super) fn places(&self) -> Places<'_> {
        self.text.places(self.client.columns)
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
            whole: Checker::default(),
            near: Checker::default(),
            cuts: Cuts::default(),
            sessions: 0,
            changes: 0,
            due: syntax.map(|_| (Instant::now(), Extent::Whole)),
            changed: Instant::now(),
            latest: None,
            last: Vec::new(),
            files: Vec::new(),
            has_published: false,
            told: None,
            waiting: Vec::new(),
        }
    }

    /// Changes the text.
    pub(super) fn change(
        &mut self,
        version: i32,
        changes: Vec<lsp_types::TextDocumentContentChangeEvent>,
        columns: Columns,
    ) {
        self.version = version;
        let replaced = self.text.change(changes, columns);
        if replaced.is_none() {
            self.last.clear();
        }
        for replaced in replaced.iter().flatten() {
            let last = std::mem::take(&mut self.last).into_iter();
            let moved = last.map(|fault| fault.moved(|range| replaced.moved(range)));
            self.last = moved.collect();
        }
        let is_scene = self.latest.as_ref().is_some_and(|latest| latest.is_scene);
        let near = replaced.filter(|_| is_scene && self.text.has_excerpts());
        let near = near.and_then(|replaced| replaced.last().map(Replaced::end));
        self.changed(near.map_or(Extent::Whole, Extent::Around));
    }

    /// Notes that the text is to be checked, and that the check in flight is of no use.
    fn changed(&mut self, extent: Extent) {
        self.changes += 1;
        self.changed = Instant::now();
        if let Some(session) = &self.whole.session {
            session.pause();
        }
        self.is_due(extent);
    }

    fn is_due(&mut self, extent: Extent) {
        let is_long = self.text.as_str().len() > SHORT;
        let time = match extent {
            Extent::Whole if is_long => self.changed + QUIET,
            Extent::Whole | Extent::Around(_) => self.changed,
        };
        self.due = self.is_scene_file.then_some((time, extent));
    }

    /// Reads the text with other settings.
    pub(super) fn set(&mut self, settings: OfScene) {
        self.settings = settings;
        self.close();
        self.changed(Extent::Whole);
    }

    pub(super) fn due(&self) -> Option<Instant> {
        self.due.map(|(time, _)| time)
    }

    /// Checks the text at once, unless that is under way.
    pub(super) fn hurry(&mut self) {
        self.due = self.due.map(|(_, extent)| (Instant::now(), extent));
    }

    /// Starts the check of the text, if it is time.
    pub(super) fn check(&mut self, turns: &Turns, events: &Sender<Event>) {
        let Some((_, extent)) = self.due.filter(|(time, _)| *time <= Instant::now()) else {
            return;
        };
        self.due = None;
        let (text, checker, turns): (Arc<str>, _, _) = match extent {
            Extent::Around(offset) => {
                let (source, cuts) = self.text.around(offset).into_parts();
                self.cuts = cuts;
                let turns = Turns::default();
                (source.into_text().into(), &mut self.near, turns)
            }
            Extent::Whole => (self.text.as_str().into(), &mut self.whole, turns.clone()),
        };
        if let Some(session) = &checker.session {
            checker.sent = (session.replace(text), self.changes);
            return;
        }
        self.sessions += 1;
        let (session_id, uri) = (self.sessions, self.uri.as_str().to_owned());
        let events = events.clone();
        let syntax = self.text.syntax();
        let options = self.settings.options.clone().syntax(syntax);
        let report = move |checked: Arc<Checked>| {
            let _ = events.send(Event::Checked(Report {
                uri: uri.clone(),
                session_id,
                is_scene: !checked.document().is_no_scene(),
                checked,
            }));
        };
        let session = Session::of_findings(self.uri.as_str(), text, options, &turns, report);
        *checker = Checker {
            // Without a thread there are no diagnostics, but all else works.
            session: session.ok(),
            id: session_id,
            sent: (1, self.changes),
        };
    }

    /// Takes over a result; returns false if it is of an older text.
    pub(super) fn take(&mut self, report: Report) -> bool {
        let checked = report.checked;
        let sent = (checked.version(), self.changes);
        let is_of = |checker: &Checker| (checker.id, checker.sent) == (report.session_id, sent);
        let found = checked.document().diagnostics();
        if is_of(&self.near) {
            self.latest = Some(Latest {
                changes: self.changes,
                diagnostics: self.cuts.diagnostics(found, &self.last).into(),
                whole: None,
                is_scene: true,
            });
            self.is_due(Extent::Whole);
            return true;
        }
        if !is_of(&self.whole) {
            return false;
        }
        if found.iter().all(|fault| fault.code != Code::Syntax) {
            self.last = found.to_vec();
        }
        self.files = checked.files().to_vec();
        self.latest = Some(Latest {
            changes: self.changes,
            diagnostics: found.into(),
            whole: Some(checked),
            is_scene: report.is_scene,
        });
        true
    }

    /// Returns the result for the newest text, if there is one.
    pub(super) fn latest(&self) -> Option<&Latest> {
        let is_newest = |latest: &&Latest| latest.changes == self.changes;
        self.latest.as_ref().filter(is_newest)
    }

    /// Notes the diagnostics that the client gets. Returns false if it has them.
    pub(super) fn tell(&mut self, found: &[lsp_types::Diagnostic]) -> bool {
        let told = self.told.as_ref();
        let is_new = told.is_none_or(|told| told.0 != self.changes || told.1 != found);
        self.told = Some((self.changes, found.to_vec()));
        is_new
    }

    /// Returns true if the client has other diagnostics of the newest text.
    pub(super) fn has_other(&self, found: &[lsp_types::Diagnostic]) -> bool {
        let told = self.told.as_ref();
        told.is_some_and(|told| told.0 == self.changes && told.1 != found)
    }

    /// Returns the tables and parts that the last scene named, and those of its parts.
    pub(super) fn files(&self) -> &[PathBuf] {
        &self.files
    }

    /// Checks the text again, after a change of a file that it names.
    pub(super) fn refresh(&self) {
        if let Some(session) = &self.whole.session {
            session.refresh();
        }
    }

    pub(super) fn snapshot(&self, client: &Arc<Client>) -> Snapshot {
        Snapshot {
            uri: self.uri.clone(),
            version: self.version,
            text: self.text.clone(),
            settings: self.settings.clone(),
            client: Arc::clone(client),
        }
    }

    /// Ends the checks.
    pub(super) fn close(&mut self) {
        for checker in [&mut self.whole, &mut self.near] {
            if let Some(session) = checker.session.take() {
                session.pause();
            }
        }
    }
}
