//! The parts of the scenes in a run: each is reported once.

use std::{
    collections::HashSet,
    path::{Path, PathBuf},
};

use strahl::{ReadOptions, jobs::SceneFile, scene::PartFindings};

/// The parts of the scenes in a run.
#[derive(Default)]
pub(super) struct Parts {
    /// The files of the run, which are reported on their own.
    files: Vec<PathBuf>,
    /// Their canonical paths, resolved when the first part is met.
    listed: Option<HashSet<PathBuf>>,
    /// The canonical paths of the parts so far.
    named: HashSet<PathBuf>,
    /// The files that lack a camera: whether that is a fault is known at the end.
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
        let files = &self.files;
        let listed = || files.iter().map(|file| canonical(file)).collect();
        let listed = self.listed.get_or_insert_with(listed);
        let path = canonical(Path::new(part.name()));
        let is_listed = listed.contains(&path);
        self.named.insert(path) && !is_listed && !part.is_empty()
    }

    /// Keeps a file that lacks a camera for the end of the run.
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
