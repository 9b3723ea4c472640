//! The scenes of a run: each is read by whoever needs it first, and kept while pictures of it are
//! left to be drawn.

use std::{
    fs,
    path::PathBuf,
    sync::{
        Arc, Mutex, MutexGuard, PoisonError,
        atomic::{AtomicU64, Ordering},
    },
};

use strahl::{Document, Error, Scene, jobs::SceneFile, report::FileReport};

use super::list::{Item, List};
use crate::cli::{
    Failure,
    params::{Columns, Params, TableFaults},
    scene, set,
};

/// A file from this size on is read by all threads together.
const LARGE: u64 = 1 << 20;

/// A scene file that pictures are made of.
pub(super) struct Source {
    read: Mutex<Option<Arc<Base>>>,
    /// How many pictures have not been made yet.
    left: AtomicU64,
}

/// What became of a scene file.
pub(super) struct Base {
    /// What there is to say about it.
    pub(super) findings: Option<Document>,
    pub(super) tables: Vec<PathBuf>,
    pub(super) content: Content,
}

pub(super) enum Content {
    /// It was found in a folder, and is no scene.
    Nothing,
    Unreadable(Error),
    Refused(Failure),
    /// A scene, as all of its pictures show it.
    Scene(Box<Scene>),
    /// A scene in which each row of a table sets values.
    Document(Box<Document>, Columns),
}

impl Source {
    pub(super) fn new(pictures: u64) -> Self {
        Self {
            read: Mutex::new(None),
            left: AtomicU64::new(pictures),
        }
    }

    /// The scene, if nobody has to read a large file for it. A thread of a pool must not wait here
    /// for others of it.
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

    /// The scene, which this may have to wait for.
    pub(super) fn get(&self, read: impl FnOnce() -> Base) -> Arc<Base> {
        Arc::clone(self.lock().get_or_insert_with(|| Arc::new(read())))
    }

    /// One picture less is to be made.
    pub(super) fn done(&self) {
        if self.left.fetch_sub(1, Ordering::Relaxed) == 1 {
            *self.lock() = None;
        }
    }

    fn lock(&self) -> MutexGuard<'_, Option<Arc<Base>>> {
        self.read.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Base {
    /// What there is to say about a file that has been read, or why it was not.
    pub(super) fn of(file: &SceneFile, read: Result<Document, Failure>, list: &List) -> Self {
        let document = match read {
            Ok(document) => document,
            Err(Failure::Library(error)) if file.folder.is_some() || list.scenes.len() > 1 => {
                return Self::without_findings(Content::Unreadable(error));
            }
            Err(failure) => return Self::without_findings(Content::Refused(failure)),
        };
        if file.folder.is_some() && document.is_no_scene() {
            return Self::without_findings(Content::Nothing);
        }
        let has_findings =
            !document.diagnostics().is_empty() || document.setting_diagnostics().next().is_some();
        let findings = has_findings.then(|| document.findings());
        let tables = document.table_paths().collect();
        let content = if set::leads_nowhere(&document) {
            Content::Refused(Failure::Reported)
        } else if document.has_errors() {
            Content::Refused(Failure::Found)
        } else if let Some(params) = &list.params {
            let columns = params.columns_of(&document, Some(&list.places()));
            Content::Document(Box::new(document), columns)
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
            tables,
            content,
        }
    }

    const fn without_findings(content: Content) -> Self {
        Self {
            findings: None,
            tables: Vec::new(),
            content,
        }
    }
}

/// What is wrong with what a row sets.
pub(crate) struct RowFaults {
    /// In the table.
    cells: Vec<TableFaults>,
    /// What is wrong elsewhere in the scene because of that.
    document: Option<Document>,
}

impl RowFaults {
    /// What is wrong in the table, then what is in the scene.
    pub(crate) fn all(&self) -> impl Iterator<Item = FileReport<'_>> {
        let cells = self.cells.iter().map(TableFaults::report);
        cells.chain(self.document.iter().map(|all| FileReport {
            file: all.name(),
            text: all.text(),
            diagnostics: all.diagnostics(),
            ..FileReport::default()
        }))
    }

    /// Prints them on standard error.
    pub(super) fn print(&self, quiet: bool) {
        for part in self.all() {
            scene::print_report(&part, quiet);
        }
    }
}

/// A scene with what a row of a table sets in it, if that can be, and what there is to say.
pub(super) fn with_row(
    list: &List,
    item: Item,
    document: &Document,
    columns: &Columns,
) -> (Result<Scene, Failure>, Option<RowFaults>) {
    let (Some(params), Some(row)) = (&list.params, item.row) else {
        return (Err(Failure::Found), None);
    };
    if columns.has_errors() {
        return (Err(Failure::Found), None);
    }
    let settings = match params.settings(row, columns, document.syntax()) {
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

/// What is wrong with the values that a row has set in a document, if anything is.
pub(crate) fn faults_of_row(set: &Document, params: &Params, row: usize) -> Option<RowFaults> {
    let cells = set.setting_diagnostics();
    let cells: Vec<_> = cells
        .map(|(setting, faults)| params.faults(row, setting, faults))
        .collect();
    let is_about_scene = set.has_errors() && !set.diagnostics().is_empty();
    (is_about_scene || !cells.is_empty()).then(|| RowFaults {
        cells,
        document: is_about_scene.then(|| set.findings()),
    })
}
