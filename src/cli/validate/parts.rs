//! The parts of the scenes in a run: each is reported once.

use std::{
    collections::HashSet,
    path::{Path, PathBuf},
};

use strahl::{Document, ReadOptions, jobs::SceneFile, scene::PartFindings};

/// The parts of the scenes in a run.
#[derive(Default)]
pub(super) struct Parts {
    /// The files of the run, which are reported on their own.
    files: Vec<PathBuf>,
    /// Their canonical paths, resolved when the first part is met.
    listed: Option<HashSet<PathBuf>>,
    /// The canonical paths of the parts so far.
    named: HashSet<PathBuf>,
    /// Those that need no report any more.
    reported: HashSet<PathBuf>,
    /// The files that are checked at the end: those that lack a camera, which may not be a fault, and
    /// those whose parts are fixed before that.
    waiting: Vec<(SceneFile, ReadOptions)>,
}

impl Parts {
    /// Adds files that are going to be checked.
    pub(super) fn list(&mut self, files: &[SceneFile]) {
        self.listed = None;
        self.files
            .extend(files.iter().map(|file| file.path.clone()));
    }

    /// Notes that a scene names a part. Returns true if the part is to be reported now.
    pub(super) fn is_new(&mut self, part: &PartFindings) -> bool {
        let path = canonical(Path::new(part.name()));
        let is_listed = self.is_listed(&path);
        self.named.insert(path.clone());
        self.reported.insert(path) && !is_listed && !part.is_empty()
    }

    /// Notes the parts that a scene names. Returns true if one is reported on its own.
    pub(super) fn note(&mut self, document: &Document) -> bool {
        let mut is_any_listed = false;
        for part in document.parts() {
            let path = canonical(Path::new(part.name()));
            is_any_listed |= self.is_listed(&path);
            self.named.insert(path);
        }
        is_any_listed
    }

    fn is_listed(&mut self, path: &Path) -> bool {
        let files = &self.files;
        let listed = || files.iter().map(|file| canonical(file)).collect();
        self.listed.get_or_insert_with(listed).contains(path)
    }

    /// Keeps a file for the end of the run.
    pub(super) fn wait(&mut self, file: SceneFile, options: &ReadOptions) {
        self.waiting.push((file, options.clone()));
    }

    /// Returns the files that were kept, and the options to check them with: as parts, if a scene
    /// names them.
    pub(super) fn take_waiting(&mut self) -> Vec<(SceneFile, ReadOptions)> {
        let mut waiting = std::mem::take(&mut self.waiting);
        for (file, options) in &mut waiting {
            let is_part = self.named.contains(&canonical(&file.path));
            *options = options.clone().as_part(is_part);
        }
        waiting
    }
}

/// Returns the path of a file without links; a missing file keeps its own.
fn canonical(path: &Path) -> PathBuf {
    path.canonicalize().unwrap_or_else(|_| path.to_owned())
}
