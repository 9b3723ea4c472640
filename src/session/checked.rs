//! The result of a check.

use std::{
    fs, io,
    path::{Path, PathBuf},
    sync::Arc,
    time::{Duration, Instant, SystemTime},
};

use crate::{pipeline::Scene, scene::document::Document};

/// How much too early a file system may tell that a file was modified.
const COARSE: Duration = Duration::from_millis(20);

/// The result of a check.
#[derive(Debug)]
pub struct Checked {
    pub(super) began: (Instant, SystemTime),
    pub(super) version: u64,
    pub(super) revision: u64,
    pub(super) document: Document,
    pub(super) files: Vec<PathBuf>,
    pub(super) scene: Option<Ready>,
    pub(super) is_broken: bool,
}

/// The last scene without errors.
#[derive(Clone, Debug)]
pub struct Ready {
    /// The first revision with the same pictures: that of a text with another comment stays.
    pub revision: u64,
    /// The scene.
    pub scene: Arc<Scene>,
}

impl Checked {
    /// The time at which the check began: the files were read later.
    pub const fn began(&self) -> Instant {
        self.began.0
    }

    /// Returns true if a file may have been modified or replaced since the check began, as far as the
    /// file system tells.
    pub fn may_precede(&self, file: &Path) -> bool {
        let changed = fs::metadata(file).and_then(|file| changed(&file));
        changed.is_ok_and(|time| time + COARSE >= self.began.1)
    }

    /// The version of the text.
    pub const fn version(&self) -> u64 {
        self.version
    }

    /// The number of checks before this one that were not cancelled.
    pub const fn revision(&self) -> u64 {
        self.revision
    }

    /// The text with its diagnostics.
    pub const fn document(&self) -> &Document {
        &self.document
    }

    /// The paths of the files that the scene depends on: tables, and parts with theirs.
    pub fn files(&self) -> &[PathBuf] {
        &self.files
    }

    /// Returns the scene of this text, or the last one before it without errors.
    pub const fn scene(&self) -> Option<&Ready> {
        self.scene.as_ref()
    }

    /// Returns true if the text has errors, so that [`Checked::scene`] is of an earlier one.
    pub const fn is_broken(&self) -> bool {
        self.is_broken
    }
}

/// Returns the time at which the content of a file was modified or got its name.
#[cfg(unix)]
fn changed(file: &fs::Metadata) -> io::Result<SystemTime> {
    use std::os::unix::fs::MetadataExt;
    let seconds = Duration::from_secs(file.ctime().try_into().unwrap_or(0));
    let part = Duration::from_nanos(file.ctime_nsec().try_into().unwrap_or(0));
    Ok(file
        .modified()?
        .max(SystemTime::UNIX_EPOCH + seconds + part))
}

#[cfg(not(unix))]
fn changed(file: &fs::Metadata) -> io::Result<SystemTime> {
    file.modified()
}
