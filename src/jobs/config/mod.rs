//! `strahl.toml`: the settings of a project for all of its scenes.

mod file;

use std::{
    collections::HashMap,
    io,
    path::{Path, PathBuf},
    sync::{Arc, Mutex, PoisonError},
};

use ignore::gitignore::Gitignore;

use crate::{
    diagnostic::{
        error::Error,
        levels::Levels,
        reading::{folder_of, read_text},
    },
    report::OutputFormat,
    scene::options::ReadOptions,
};

/// The file name.
const NAME: &str = "strahl.toml";
/// The maximum number of bytes in the file.
const LONGEST: u64 = 1 << 20;

/// The contents of a `strahl.toml`; the default applies without one.
#[derive(Debug, Default)]
pub struct Config {
    excluded: Option<Gitignore>,
    levels: Levels,
    max_diagnostics: Option<usize>,
    output_format: Option<OutputFormat>,
    allow_outside: bool,
}

impl Config {
    /// The lint levels of the warnings.
    pub fn levels(&self) -> &Levels {
        &self.levels
    }

    /// Returns the maximum number of diagnostics to print per file.
    pub fn max_diagnostics(&self) -> Option<usize> {
        self.max_diagnostics
    }

    /// Returns the output format for diagnostics.
    pub fn output_format(&self) -> Option<OutputFormat> {
        self.output_format
    }

    /// Returns the options for reading scenes.
    pub fn read_options(&self) -> ReadOptions {
        let options = ReadOptions::new().levels(self.levels.clone());
        options.allow_outside(self.allow_outside)
    }

    /// Returns true if searches of folders skip this file or folder.
    fn excludes(&self, path: &Path, is_folder: bool) -> bool {
        let excluded = self.excluded.as_ref();
        excluded.is_some_and(|excluded| excluded.matched(path, is_folder).is_ignore())
    }
}

/// The `strahl.toml` files, each read once. The nearest one in the folder of a scene or its parents
/// applies, alone.
#[derive(Clone, Debug, Default)]
pub struct Configs(Option<Arc<Mutex<HashMap<PathBuf, FolderConfig>>>>);

/// A folder and its configuration.
#[derive(Clone, Debug, Default)]
struct FolderConfig {
    /// The path without links.
    folder: PathBuf,
    config: Arc<Config>,
}

impl Configs {
    /// Creates a set that searches for files.
    pub fn new() -> Self {
        Self(Some(Arc::default()))
    }

    /// Creates a set that ignores all files.
    pub const fn none() -> Self {
        Self(None)
    }

    /// Returns the configuration for a scene or a folder; the default if the path does not exist.
    ///
    /// # Errors
    ///
    /// Fails if a `strahl.toml` cannot be read or has a fault.
    pub fn of(&self, path: impl AsRef<Path>) -> Result<Arc<Config>, Error> {
        let path = path.as_ref();
        if path.is_dir() {
            return self.in_folder(path).map(|place| place.config);
        }
        self.of_file(path)
    }

    /// Returns the configuration for a scene; the default if its folder does not exist.
    ///
    /// # Errors
    ///
    /// Fails if a `strahl.toml` cannot be read or has a fault.
    pub fn of_file(&self, path: &Path) -> Result<Arc<Config>, Error> {
        let place = self.in_folder(path.parent().unwrap_or(Path::new("")));
        place.map(|place| place.config)
    }

    /// Returns the files whose change may change the configuration for a scene or a folder: one in
    /// its folder, which need not exist, and in each parent up to the first that does.
    pub fn files(&self, path: impl AsRef<Path>) -> Vec<PathBuf> {
        let path = path.as_ref();
        let folder = if path.is_dir() { path } else { folder_of(path) };
        let Some(folder) = self.0.as_ref().and_then(|_| folder.canonicalize().ok()) else {
            return Vec::new();
        };
        let mut files: Vec<_> = folder.ancestors().map(|around| around.join(NAME)).collect();
        let first = files.iter().position(|file| file.exists());
        files.truncate(first.unwrap_or(0) + 1);
        files
    }

    /// Returns true if a path found by a search is excluded.
    pub(crate) fn exclude(&self, path: &Path, is_folder: bool) -> Result<bool, Error> {
        let place = self.in_folder(path.parent().unwrap_or(Path::new("")))?;
        let path = place.folder.join(path.file_name().unwrap_or_default());
        Ok(place.config.excludes(&path, is_folder))
    }

    fn in_folder(&self, folder: &Path) -> Result<FolderConfig, Error> {
        let Some(known) = &self.0 else {
            return Ok(FolderConfig::default());
        };
        let mut known = known.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(place) = known.get(folder) {
            return Ok(place.clone());
        }
        let place = FolderConfig::find(folder, &mut known)?;
        known.insert(folder.to_owned(), place.clone());
        Ok(place)
    }
}

impl FolderConfig {
    /// Returns the nearest file in a folder or its parents.
    fn find(folder: &Path, known: &mut HashMap<PathBuf, Self>) -> Result<Self, Error> {
        let named = if folder == Path::new("") {
            Path::new(".")
        } else {
            folder
        };
        // A scene that cannot be read has an error of its own.
        let Ok(folder) = named.canonicalize() else {
            return Ok(Self::default());
        };
        let mut config = Arc::default();
        for around in folder.ancestors() {
            if let Some(place) = known.get(around) {
                config = Arc::clone(&place.config);
                break;
            }
            if let Some(found) = read(&around.join(NAME))? {
                config = Arc::new(found);
                break;
            }
        }
        let place = Self {
            folder: folder.clone(),
            config,
        };
        known.insert(folder, place.clone());
        Ok(place)
    }
}

/// Reads a file, if it exists.
fn read(path: &Path) -> Result<Option<Config>, Error> {
    match read_text(path, LONGEST) {
        Ok(text) => file::parse(&text, path).map(Some),
        // A path through a file is reported as an error of the scene.
        Err(error) if is_missing(&error) => Ok(None),
        Err(error) => Err(Error::unreadable(path, error)),
    }
}

/// Returns true if there is no such file.
pub(super) fn is_missing(error: &io::Error) -> bool {
    matches!(
        error.kind(),
        io::ErrorKind::NotFound | io::ErrorKind::NotADirectory
    )
}

/// Returns true if there are more patterns to skip files than are worth their memory.
pub(crate) fn are_too_many<'p>(patterns: impl Iterator<Item = &'p str> + Clone) -> bool {
    /// The number of patterns.
    const MOST: usize = 1000;
    /// The number of bytes of all patterns.
    const LONGEST: usize = 1 << 16;
    patterns.clone().count() > MOST || patterns.map(str::len).sum::<usize>() > LONGEST
}
