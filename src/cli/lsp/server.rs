//! The state of the server, and its main loop.

use std::{
    path::{Path, PathBuf},
    sync::{
        Arc,
        mpsc::{Receiver, RecvTimeoutError, Sender},
    },
    time::Instant,
};

use lsp_server::{ErrorCode, Message, Notification, Request, RequestId};
use lsp_types::{
    DidChangeTextDocumentParams, DidChangeWatchedFilesParams, DidChangeWorkspaceFoldersParams,
    DidCloseTextDocumentParams, DidOpenTextDocumentParams, DidSaveTextDocumentParams,
};
use serde::de::DeserializeOwned;
use serde_json::{Value, json};
use strahl::session::Turns;

use super::{
    super::failure::Failure,
    capabilities,
    client::Client,
    diagnostics,
    document::{Event, OpenDocument, Report},
    documents::Documents,
    outbox::{Outbox, refused},
    parent, requests,
    settings::Settings,
    uri,
    watching::Watching,
    wire::Incoming,
    work::Work,
    workspace::Workspace,
};

/// The phase of the protocol.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Phase {
    Start,
    Running,
    ShutDown,
}

pub(super) struct Server {
    pub(super) outbox: Outbox,
    pub(super) work: Work,
    pub(super) client: Arc<Client>,
    pub(super) documents: Documents,
    pub(super) folders: Vec<PathBuf>,
    pub(super) settings: Settings,
    pub(super) workspace: Workspace,
    events: Sender<Event>,
    watching: Watching,
    turns: Turns,
    phase: Phase,
}

impl Server {
    pub(super) fn new(
        outbox: Outbox,
        events: Sender<Event>,
        settings: Settings,
    ) -> Result<Self, Failure> {
        Ok(Self {
            work: Work::new(outbox.clone())?,
            client: Client::new(&Value::Null).into(),
            documents: Documents::default(),
            folders: Vec::new(),
            settings,
            workspace: Workspace::default(),
            watching: Watching::new(events.clone()),
            turns: Turns::default(),
            phase: Phase::Start,
            outbox,
            events,
        })
    }

    /// Serves until the client leaves. Returns true if it has said so before.
    pub(super) fn run(&mut self, events: &Receiver<Event>) -> bool {
        loop {
            let event = match self.documents.due() {
                None => events.recv().map_err(|_| RecvTimeoutError::Disconnected),
                Some(due) => events.recv_timeout(due.saturating_duration_since(Instant::now())),
            };
            match event {
                Ok(event) => {
                    // What has arrived is read before a check starts, which it may make useless.
                    let mut next = Some(event);
                    while let Some(event) = next {
                        if !self.on_event(event) {
                            self.work.cancel_all();
                            return self.phase == Phase::ShutDown;
                        }
                        next = events.try_recv().ok();
                    }
                }
                Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => return false,
            }
            self.documents.check(&self.turns, &self.events);
        }
    }

    /// Returns false at the end.
    fn on_event(&mut self, event: Event) -> bool {
        match event {
            Event::End => return false,
            Event::Incoming(Incoming::Malformed(answer)) => self.outbox.send(&answer),
            Event::Incoming(Incoming::Message(Message::Request(request))) => {
                self.on_request(request);
            }
            Event::Incoming(Incoming::Message(Message::Notification(notification))) => {
                if notification.method == "exit" {
                    return false;
                }
                if self.phase == Phase::Running {
                    self.on_notification(notification);
                }
            }
            // Nothing depends on what the client answers.
            Event::Incoming(Incoming::Message(Message::Response(_))) => {}
            Event::Checked(report) => self.on_checked(report),
            Event::Files(files) => self.on_files(&files),
        }
        true
    }

    fn on_request(&mut self, request: Request) {
        let invalid = |message| Err(refused(ErrorCode::InvalidRequest, message));
        let answer = match (self.phase, &*request.method) {
            (Phase::Start, "initialize") => Ok(self.initialize(&request.params)),
            (Phase::Start, _) => Err(refused(
                ErrorCode::ServerNotInitialized,
                "expected `initialize` first",
            )),
            (Phase::Running, "shutdown") => {
                self.phase = Phase::ShutDown;
                self.work.cancel_all();
                self.documents = Documents::default();
                Ok(Value::Null)
            }
            (Phase::Running, "initialize") => invalid("`initialize` came before"),
            (Phase::Running, _) => return requests::dispatch(self, request),
            (Phase::ShutDown, _) => invalid("the server is shut down"),
        };
        self.outbox.respond(&request.id, answer);
    }

    fn initialize(&mut self, params: &Value) -> Value {
        self.phase = Phase::Running;
        let capabilities = params.get("capabilities").unwrap_or(&Value::Null);
        self.client = Client::new(capabilities).into();
        let folders = params.get("workspaceFolders").and_then(Value::as_array);
        let folders = folders.into_iter().flatten().map(|folder| &folder["uri"]);
        let paths: Vec<_> = folders
            .filter_map(|uri| uri::path_of(uri.as_str()?))
            .collect();
        let root = || {
            let of_uri = params["rootUri"].as_str().and_then(uri::path_of);
            of_uri.or_else(|| params["rootPath"].as_str().map(PathBuf::from))
        };
        self.folders = match paths.is_empty() {
            true => root().into_iter().collect(),
            false => paths,
        };
        let process = params["processId"].as_u64();
        let process = process.and_then(|id| u32::try_from(id).ok());
        parent::watch(process, self.events.clone());
        capabilities::of(&self.client)
    }

    fn on_notification(&mut self, notification: Notification) {
        let Notification { method, params } = notification;
        match &*method {
            "initialized" => self.watching.start(&self.client, &self.outbox),
            "$/cancelRequest" => {
                if let Ok(id) = serde_json::from_value::<RequestId>(params["id"].clone()) {
                    self.work.cancel(id);
                }
            }
            "textDocument/didOpen" => self.with(params, Self::open),
            "textDocument/didChange" => self.with(params, Self::change),
            "textDocument/didClose" => self.with(params, Self::close),
            "textDocument/didSave" => self.with(params, Self::save),
            "workspace/didChangeWatchedFiles" => self.with(params, Self::watched),
            "workspace/didChangeWorkspaceFolders" => self.with(params, Self::change_folders),
            // Others are optional, or not known.
            _ => {}
        }
    }

    /// Passes parameters on; without an id, malformed ones cannot be answered.
    fn with<P: DeserializeOwned>(&mut self, params: Value, act: impl FnOnce(&mut Self, P)) {
        match serde_json::from_value(params) {
            Ok(params) => act(self, params),
            Err(error) => {
                let message = format!("a notification was not understood: {error}");
                self.outbox
                    .notify("window/logMessage", json!({"type": 1, "message": message}));
            }
        }
    }

    fn open(&mut self, params: DidOpenTextDocumentParams) {
        let key = params.text_document.uri.as_str().to_owned();
        let folder = self.folder_of(&key);
        let settings = match &folder {
            Some(folder) => self.settings.in_folder(folder, &self.outbox),
            // Without a folder there are no tables.
            None => {
                let mut settings = self.settings.of(&strahl::jobs::Config::default());
                settings.options = settings.options.without_tables();
                settings
            }
        };
        let mut document = OpenDocument::new(params.text_document, settings);
        if let Some(mut old) = self.documents.remove(&key) {
            old.close();
            document.has_published = old.has_published;
            document.waiting = old.waiting;
        }
        let path = document.path.clone();
        if let Some(path) = &path {
            self.settings.open_files.open(path, document.text.as_str());
        }
        self.documents.insert(key, document);
        if let Some(path) = path {
            self.on_files(&[path]);
        }
        self.watch();
    }

    /// Returns the folder in which a document's tables are: its own, or that of the workspace.
    fn folder_of(&self, uri: &str) -> Option<PathBuf> {
        match uri::path_of(uri) {
            Some(path) => path.parent().map(Path::to_owned),
            None => self.folders.first().cloned(),
        }
    }

    fn change(&mut self, params: DidChangeTextDocumentParams) {
        let Some(document) = self.documents.get_mut(params.text_document.uri.as_str()) else {
            return;
        };
        let version = params.text_document.version;
        document.change(version, params.content_changes, self.client.columns);
        if let Some(path) = document.path.clone() {
            self.settings.open_files.open(&path, document.text.as_str());
            self.on_files(&[path]);
        }
    }

    fn close(&mut self, params: DidCloseTextDocumentParams) {
        let Some(mut document) = self.documents.remove(params.text_document.uri.as_str()) else {
            return;
        };
        document.close();
        for waiting in document.waiting {
            let gone = |_: &_| {
                Err::<(), _>(refused(
                    ErrorCode::ContentModified,
                    "the document was closed",
                ))
            };
            self.work.answer(waiting.id, super::work::Pace::Quick, gone);
        }
        if document.has_published {
            diagnostics::publish(&self.outbox, &document.uri, None, Vec::new());
        }
        if let Some(path) = document.path {
            self.settings.open_files.close(&path);
            self.on_files(&[path]);
        }
        self.watch();
    }

    fn save(&mut self, params: DidSaveTextDocumentParams) {
        if let Some(path) = uri::path_of(params.text_document.uri.as_str()) {
            self.on_files(&[path]);
        }
    }

    fn watched(&mut self, params: DidChangeWatchedFilesParams) {
        let changes = params.changes.iter();
        let files: Vec<_> = changes
            .filter_map(|change| uri::path_of(change.uri.as_str()))
            .collect();
        self.on_files(&files);
    }

    fn change_folders(&mut self, params: DidChangeWorkspaceFoldersParams) {
        let paths = |folders: &[lsp_types::WorkspaceFolder]| -> Vec<PathBuf> {
            let folders = folders.iter();
            folders
                .filter_map(|folder| uri::path_of(folder.uri.as_str()))
                .collect()
        };
        let removed = paths(&params.event.removed);
        self.folders.retain(|folder| !removed.contains(folder));
        self.folders.extend(paths(&params.event.added));
        let files = self.documents.files().cloned();
        self.watching.watch(files, &self.folders, &self.outbox);
    }

    /// Checks the scenes again that depend on these files.
    fn on_files(&mut self, files: &[PathBuf]) {
        let is_config = |file: &PathBuf| file.ends_with(super::settings::NAME);
        if files.iter().any(is_config) {
            self.settings.read_again();
            self.workspace = Workspace::default();
            let keys: Vec<_> = self.documents.keys().cloned().collect();
            for key in keys {
                let Some(folder) = self.folder_of(&key) else {
                    continue;
                };
                let settings = self.settings.in_folder(&folder, &self.outbox);
                if let Some(document) = self.documents.get_mut(&key) {
                    document.set(settings);
                }
            }
            diagnostics::refresh(&self.client, &self.outbox);
            return;
        }
        let users = self.documents.changed(files);
        for document in users.iter().filter_map(|key| self.documents.get(key)) {
            document.refresh();
        }
        if !users.is_empty() {
            diagnostics::refresh(&self.client, &self.outbox);
        }
    }

    /// Watches the files that the open scenes depend on.
    fn watch(&mut self) {
        let changes = self.documents.changes();
        let all = self.documents.files().cloned();
        self.watching
            .follow(changes, all, &self.folders, &self.outbox);
    }

    fn on_checked(&mut self, report: Report) {
        let uri = report.uri.clone();
        let Some(new) = self.documents.take(report) else {
            return;
        };
        // Watched before the client is told, which may change a file at once.
        self.find_parts(&uri);
        self.watch();
        if self.documents.is_outdated(&uri, &new)
            && let Some(document) = self.documents.get(&uri)
        {
            // No change of these files has been followed before.
            document.refresh();
        }
        let Some(document) = self.documents.get_mut(&uri) else {
            return;
        };
        if document.latest().is_none() {
            // It is checked again, as a part.
            return;
        }
        diagnostics::tell(document, &self.client, &self.outbox);
        for waiting in std::mem::take(&mut document.waiting) {
            diagnostics::answer_or_wait(document, waiting, &self.client, &self.work);
        }
    }

    /// Checks documents again, as parts, that lack a camera and that another one names: those that a
    /// document names, and itself.
    fn find_parts(&mut self, uri: &str) {
        for key in self.documents.parts(uri) {
            let lacks_a_camera = |document: &OpenDocument| {
                let whole = document.latest().and_then(|latest| latest.whole.as_ref());
                whole.is_some_and(|whole| whole.document().lacks_a_camera())
            };
            let document = self.documents.get(&key);
            if !document.is_some_and(lacks_a_camera) {
                continue;
            }
            if let Some(document) = self.documents.get_mut(&key) {
                let mut settings = document.settings.clone();
                settings.options = settings.options.as_part(true);
                document.set(settings);
            }
        }
    }
}
