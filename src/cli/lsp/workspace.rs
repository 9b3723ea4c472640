//! The diagnostics of all scenes in the folders of the workspace.

use std::{
    collections::{HashMap, HashSet},
    fs, iter, mem,
    path::{Path, PathBuf},
    sync::{Arc, Mutex},
    time::SystemTime,
};

use lsp_server::{ErrorCode, RequestId};
use lsp_types::WorkspaceDiagnosticParams;
use serde_json::{Value, json};
use strahl::{
    Document, ReadOptions,
    jobs::{Checked, Configs, SceneFile, check_files, find_scenes},
    parallel::Cancel,
    text::LineStarts,
};

use super::{
    super::{failure::Failure, threads::lock},
    client::Client,
    diagnostics,
    document::Snapshot,
    outbox::{Outbox, refused},
    server::Server,
    settings::{OfScene, SettingsOf},
    text::Places,
    uri,
    work::{Pace, Result},
};

/// The number of files in a part of the answer.
const PART: usize = 100;

/// The files that were checked, for the next time.
#[derive(Clone, Default)]
pub(super) struct Workspace(Arc<Mutex<CheckedFiles>>);

type CheckedFiles = HashMap<PathBuf, CheckedFile>;

/// A file that was checked.
struct CheckedFile {
    /// The state of the file and of those that it depends on then.
    stamps: Vec<FileStamp>,
    /// Its diagnostics, unless it is not a scene.
    items: Option<Items>,
}

/// The diagnostics of a scene.
struct Items {
    of_scene: Vec<lsp_types::Diagnostic>,
    /// Those that a scene without a camera has if another one names it as a part.
    of_part: Option<Vec<lsp_types::Diagnostic>>,
}

/// A file, and its length and time.
type FileStamp = (PathBuf, Option<(u64, SystemTime)>);

fn stamp(path: &Path) -> FileStamp {
    let about = fs::metadata(path).ok();
    let about = about.and_then(|about| Some((about.len(), about.modified().ok()?)));
    (path.to_owned(), about)
}

/// Answers a request for the diagnostics of all scenes.
pub(super) fn answer(server: &mut Server, id: RequestId, params: WorkspaceDiagnosticParams) {
    let known = params.previous_result_ids.into_iter();
    let known = known.map(|known| (known.uri.as_str().to_owned(), known.value));
    let open = server
        .documents
        .values()
        .filter(|document| document.is_scene_file);
    let open = open.filter_map(|document| {
        let snapshot = document.snapshot(&server.client);
        Some((document.path.clone()?, snapshot))
    });
    let run = FolderCheck {
        client: Arc::clone(&server.client),
        outbox: server.outbox.clone(),
        token: params
            .partial_result_params
            .partial_result_token
            .map(|token| json!(token)),
        folders: server.folders.clone(),
        known: known.collect(),
        open: open.collect(),
        configs: server.settings.configs().clone(),
        workspace: server.workspace.clone(),
        items: Vec::new(),
        waiting: Vec::new(),
    };
    let settings = server.settings.checker();
    server
        .work
        .answer(id, Pace::Files, move |cancel| run.answer(&settings, cancel));
}

struct FolderCheck {
    client: Arc<Client>,
    outbox: Outbox,
    /// The token of the parts that the client wants.
    token: Option<Value>,
    folders: Vec<PathBuf>,
    /// The results that the client has, by address.
    known: HashMap<String, String>,
    /// The open scenes, which may not be saved.
    open: HashMap<PathBuf, Snapshot>,
    configs: Configs,
    workspace: Workspace,
    items: Vec<Value>,
    /// The files that lack a camera: whether that is a fault is known at the end.
    waiting: Vec<PathBuf>,
}

impl FolderCheck {
    fn answer(mut self, settings: &SettingsOf, cancel: &Cancel) -> Result<Value> {
        for folder in self.folders.clone() {
            // A folder without scenes is not a fault here.
            let files = find_scenes(&[folder], &[], &self.configs).unwrap_or_default();
            if let Err(failure) = self.check(&files, settings, cancel) {
                let message = failure.message().unwrap_or_default();
                return Err(refused(ErrorCode::RequestFailed, message));
            }
        }
        let waiting = mem::take(&mut self.waiting);
        if !waiting.is_empty() {
            self.report(&waiting, &self.named());
        }
        Ok(json!({"items": self.items}))
    }

    fn check(
        &mut self,
        files: &[SceneFile],
        settings: &SettingsOf,
        cancel: &Cancel,
    ) -> Result<(), Failure> {
        let configs = self.configs.clone();
        let config = |file: &SceneFile| configs.of_file(&file.path).unwrap_or_default();
        let mut rest = files;
        while let Some(first) = rest.first() {
            let config_of_first = config(first);
            let same = rest.iter().take(PART);
            let same = same.take_while(|file| Arc::ptr_eq(&config(file), &config_of_first));
            let (part, others) = rest.split_at(same.count().max(1));
            rest = others;
            let of_scene = settings(&config_of_first);
            self.part(part, &of_scene, cancel)?;
        }
        Ok(())
    }

    /// Checks the files of a part that have changed, and reports all of them.
    fn part(
        &mut self,
        files: &[SceneFile],
        settings: &OfScene,
        cancel: &Cancel,
    ) -> Result<(), Failure> {
        let changed: Vec<_> = files
            .iter()
            .filter(|file| self.has_changed(&file.path))
            .cloned()
            .collect();
        let options = settings
            .options
            .clone()
            .files(settings.open_files.now())
            .cancel(cancel.clone());
        check_files(&changed, &options, 0, |checked| {
            if cancel.is_cancelled() {
                return Err(Failure::usage("cancelled"));
            }
            match checked {
                Checked::Document(file, document) => {
                    let items = self.items(&file.path, &document, (&options, settings.most));
                    let files = document.dependencies().into_iter();
                    let files = files.map(|file| file.path.to_owned());
                    self.keep(&file.path, files, Some(items));
                }
                Checked::Unreadable(document, _) => {
                    let path = PathBuf::from(document.name());
                    let items = self.items(&path, &document, (&options, settings.most));
                    self.keep(&path, iter::empty(), Some(items));
                }
                Checked::Skipped(file) => self.keep(&file.path, iter::empty(), None),
            }
            Ok(())
        })?;
        let (waiting, now): (Vec<_>, Vec<_>) = files
            .iter()
            .map(|file| file.path.clone())
            .partition(|path| self.may_be_part(path));
        self.waiting.extend(waiting);
        self.report(&now, &HashSet::new());
        Ok(())
    }

    /// Reports files, those among `parts` as parts of other scenes.
    fn report(&mut self, files: &[PathBuf], parts: &HashSet<PathBuf>) {
        let reports = files.iter();
        let reports: Vec<_> = reports
            .filter_map(|path| self.report_of(path, parts.contains(path)))
            .collect();
        match &self.token {
            Some(token) => {
                let value = json!({"token": token, "value": {"items": reports}});
                self.outbox.notify("$/progress", value);
            }
            None => self.items.extend(reports),
        }
    }

    fn has_changed(&self, path: &Path) -> bool {
        let known = lock(&self.workspace.0);
        let is_same = |old: &FileStamp| !self.open.contains_key(&old.0) && stamp(&old.0) == *old;
        let known = known.get(path);
        self.open.contains_key(path) || !known.is_some_and(|entry| entry.stamps.iter().all(is_same))
    }

    /// Returns true if a file lacks a camera.
    fn may_be_part(&self, path: &Path) -> bool {
        let known = lock(&self.workspace.0);
        let items = known.get(path).and_then(|entry| entry.items.as_ref());
        items.is_some_and(|items| items.of_part.is_some())
    }

    /// Returns the files that others depend on.
    fn named(&self) -> HashSet<PathBuf> {
        let known = lock(&self.workspace.0);
        let stamps = known.values().flat_map(|entry| entry.stamps.iter().skip(1));
        stamps.map(|(path, _)| path.clone()).collect()
    }

    fn items(
        &self,
        path: &Path,
        document: &Document,
        (options, most): (&ReadOptions, usize),
    ) -> Items {
        let as_part = document.lacks_a_camera().then(|| {
            let options = options.clone().as_part(true);
            let document = Document::from_path_with(path, &options).ok()?;
            Some(self.diagnostics(path, &document, most))
        });
        Items {
            of_scene: self.diagnostics(path, document, most),
            of_part: as_part.flatten(),
        }
    }

    fn diagnostics(
        &self,
        path: &Path,
        document: &Document,
        most: usize,
    ) -> Vec<lsp_types::Diagnostic> {
        let Some(uri) = uri::of_path(path) else {
            return Vec::new();
        };
        let starts = LineStarts::new(document.text());
        let places = Places::new(document.text(), &starts, self.client.columns);
        diagnostics::all(document.diagnostics(), &places, (&uri, &self.client), most)
    }

    fn keep(&self, path: &Path, files: impl Iterator<Item = PathBuf>, items: Option<Items>) {
        let files = files.map(|file| stamp(&file));
        let stamps = iter::once(stamp(path)).chain(files).collect();
        let mut known = lock(&self.workspace.0);
        known.insert(path.to_owned(), CheckedFile { stamps, items });
    }

    /// Returns the report of a file; `None` if it is not a scene.
    fn report_of(&self, path: &Path, is_part: bool) -> Option<Value> {
        let known = lock(&self.workspace.0);
        let Items { of_scene, of_part } = known.get(path)?.items.as_ref()?;
        let of_part = of_part.as_ref().filter(|_| is_part);
        let items = of_part.unwrap_or(of_scene).clone();
        // The client's own spelling of the address, if it has the file open.
        let open = self.open.get(path);
        let uri = match open {
            Some(open) => open.uri.clone(),
            None => uri::of_path(path)?,
        };
        let known = self.known.get(uri.as_str()).map(String::as_str);
        let mut report = diagnostics::report(items, known);
        report["uri"] = json!(uri);
        report["version"] = json!(open.map(|open| open.version));
        Some(report)
    }
}
