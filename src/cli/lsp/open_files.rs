//! Texts that the editor has not saved, in front of the files on the disk.

use std::{
    io, mem,
    path::{Path, PathBuf},
    sync::{Arc, Mutex},
};

use strahl::scene::{Content, Files, Memory};

use crate::cli::threads::lock;

/// The open files: tables, and scenes that may be parts of others. Clones share them.
#[derive(Clone, Debug, Default)]
pub(super) struct OpenFiles(Arc<Mutex<Memory>>);

impl OpenFiles {
    pub(super) fn open(&self, path: &Path, text: &str) {
        let mut files = lock(&self.0);
        *files = mem::take(&mut *files).with(path, text.as_bytes());
    }

    pub(super) fn close(&self, path: &Path) {
        let mut files = lock(&self.0);
        *files = mem::take(&mut *files).without(path);
    }

    /// Returns a file, or those in a folder, as they are now. The lock is not held while the disk is
    /// read.
    fn within(&self, path: &Path) -> Memory {
        lock(&self.0).within(path)
    }

    /// Returns the files as they are now.
    pub(super) fn now(&self) -> Memory {
        lock(&self.0).clone()
    }
}

impl Files for OpenFiles {
    fn resolve(&self, path: &Path) -> io::Result<PathBuf> {
        self.within(path).resolve(path)
    }

    fn length(&self, path: &Path) -> io::Result<Option<u64>> {
        self.within(path).length(path)
    }

    fn open(&self, path: &Path) -> io::Result<Content> {
        self.within(path).open(path)
    }

    fn list(&self, folder: &Path) -> io::Result<Vec<(String, bool)>> {
        self.within(folder).list(folder)
    }
}
