//! The scenes of a run. Whoever needs a scene first reads it, and it is kept until all of its
//! pictures are drawn.

use std::{
    fs,
    path::PathBuf,
    sync::{
        Arc, Mutex,
        atomic::{AtomicU64, Ordering},
    },
};

use strahl::{Diagnostic, Document, Scene, jobs::SceneFile, report::FileReport};

use super::{list::List, shared::Shared};
use crate::cli::{
    failure::Failure,
    params::{Columns, Params, TableFaults, Told},
    scene, set,
    threads::lock,
};

/// The size from which a file is read by all threads together.
const LARGE: u64 = 1 << 20;

/// A scene file that pictures are made from.
pub(super) struct Source {
    read: Mutex<Option<Arc<Base>>>,
    /// Number of pictures that have not been made yet.
    left: AtomicU64,
}

/// The result of reading a scene file.
pub(super) struct Base {
    /// The diagnostics, if there are any.
    pub(super) findings: Option<Document>,
    /// The other files that the scene depends on.
    pub(super) files: Vec<PathBuf>,
    pub(super) content: Content,
}

pub(super) enum Content {
    /// A file found in a folder that is not a scene.
    Nothing,
    Refused(Failure),
    /// A scene that is the same for all of its pictures.
    Scene(Box<Scene>),
    /// A scene in which each row of a table sets values.
    Document(Box<Document>, Columns, Option<Shared>),
}

impl Source {
    pub(super) fn new(pictures: u64) -> Self {
        Self {
            read: Mutex::new(None),
            left: AtomicU64::new(pictures),
        }
    }

    /// Returns the scene, unless this requires reading a large file. A pool thread must not wait
    /// here for others of its pool.
    pub(super) fn if_small(
        &self,
        file: &SceneFile,
        read: impl FnOnce() -> Base,
    ) -> Option<Arc<Base>> {
        let is_large = || fs::metadata(&file.path).is_ok_and(|found| found.len() >= LARGE);
        match self.read.try_lock() {
            Ok(read) if read.is_none() && is_large() => return None,
            Err(_) if is_large() => return None,
            _ => {}
        }
        Some(self.get(read))
    }

    /// Returns the scene, waiting for it if necessary.
    pub(super) fn get(&self, read: impl FnOnce() -> Base) -> Arc<Base> {
        Arc::clone(lock(&self.read).get_or_insert_with(|| Arc::new(read())))
    }

    /// Counts a picture as made. After the last one the scene is dropped.
    pub(super) fn done(&self) {
        if self.left.fetch_sub(1, Ordering::Relaxed) == 1 {
            *lock(&self.read) = None;
        }
    }
}

impl Base {
    /// Returns the result for a file: its content and diagnostics, or the reason why it was not
    /// read.
    pub(super) fn of(file: &SceneFile, read: Result<Document, Failure>, list: &List) -> Self {
        let document = match read {
            Ok(document) if file.folder.is_none() || is_picture(&document) => document,
            unusable => {
                return Self {
                    findings: None,
                    files: Vec::new(),
                    content: unusable.map_or_else(Content::Refused, |_| Content::Nothing),
                };
            }
        };
        let has_findings = !document.diagnostics().is_empty()
            || document.setting_diagnostics().next().is_some()
            || document.parts().any(|part| !part.is_empty());
        let findings = has_findings.then(|| document.findings());
        let files = document.dependencies().into_iter();
        let files = files.map(|file| file.path.to_owned()).collect();
        let content = if set::leads_nowhere(&document) {
            Content::Refused(Failure::Reported)
        } else if document.has_errors() {
            Content::Refused(Failure::Found)
        } else if let Some(params) = &list.params {
            let mut columns = params.columns_of(&document, Some(&list.places()));
            let shared = list
                .shares
                .then(|| Shared::of(list, &document, &mut columns));
            match shared.transpose() {
                Ok(shared) => Content::Document(Box::new(document), columns, shared),
                Err(failure) => Content::Refused(failure),
            }
        } else {
            let scene = Scene::try_from(document);
            let last = list.last_frame().unwrap_or(0);
            let checked = scene.and_then(|scene| {
                let frame = scene.frame(last);
                frame.map_err(|error| error.of_file(&file.path))?;
                Ok(scene)
            });
            match checked {
                Ok(scene) => Content::Scene(Box::new(scene)),
                Err(error) => Content::Refused(error.into()),
            }
        };
        Self {
            findings,
            files,
            content,
        }
    }
}

/// Returns true for a scene, but not for one that can only be a part of another one.
fn is_picture(document: &Document) -> bool {
    !document.is_no_scene() && !document.lacks_only_a_camera()
}

/// The faults of the values that a row sets.
pub(crate) struct RowFaults {
    /// The faults in the table.
    cells: Vec<TableFaults>,
    /// The faults that result elsewhere in the scene.
    elsewhere: Vec<Diagnostic>,
    /// The scene, if there are any.
    document: Option<Document>,
}

impl RowFaults {
    /// Returns the faults in the table, then those in the scene.
    pub(crate) fn all(&self) -> impl Iterator<Item = FileReport<'_>> {
        let cells = self.cells.iter().map(TableFaults::report);
        let scene = self.document.iter().map(|document| FileReport {
            diagnostics: &self.elsewhere,
            ..scene::findings(document)
        });
        let all = cells.chain(scene);
        all.filter(|report| !report.diagnostics.is_empty())
    }

    /// Removes the faults that have been told for another row.
    pub(crate) fn keep_new(&mut self, told: &mut Told) {
        self.cells.iter_mut().for_each(|cells| cells.keep_new(told));
        let name = self.document.as_ref().map_or("", Document::name);
        self.elsewhere.retain(|fault| told.is_new(name, 0, fault));
    }
}

/// Returns the scene with the values that a row of a table sets, if possible, and the faults.
pub(super) fn with_row(
    list: &List,
    row: usize,
    document: &Document,
    columns: &Columns,
) -> (Result<Scene, Failure>, Option<RowFaults>) {
    let Some(params) = &list.params else {
        return (Err(Failure::Found), None);
    };
    if columns.has_errors() {
        return (Err(Failure::Found), None);
    }
    let settings = match params.settings(row, columns) {
        Ok(settings) => settings,
        Err(failure) => return (Err(failure), None),
    };
    let set = document.with(settings);
    let faults = faults_of_row(&set, params, row);
    let scene = if set.has_errors() {
        Err(Failure::Found)
    } else {
        Scene::try_from(set).map_err(Failure::from)
    };
    (scene, faults)
}

/// Returns the faults of the values that a row has set in a document, if there are any.
pub(crate) fn faults_of_row(set: &Document, params: &Params, row: usize) -> Option<RowFaults> {
    let cells = set.setting_diagnostics();
    let cells: Vec<_> = cells
        .map(|(setting, faults)| params.faults(row, setting, faults))
        .collect();
    let is_about_scene = set.has_errors() && !set.diagnostics().is_empty();
    (is_about_scene || !cells.is_empty()).then(|| {
        let document = is_about_scene.then(|| set.findings());
        let elsewhere = document.as_ref().map_or(&[][..], Document::diagnostics);
        RowFaults {
            cells,
            elsewhere: elsewhere.to_vec(),
            document,
        }
    })
}
