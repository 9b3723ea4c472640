//! How a scene is read.

use std::{
    path::{Path, PathBuf},
    sync::Arc,
};

use crate::{
    diagnostic::levels::Levels,
    parallel::{Cancel, Pool},
    scene::{
        files::{Disk, Files, Folder},
        read::LARGE,
        set::Setting,
    },
    text::syntax::Syntax,
};

/// How a scene is read, where that differs from what is usual.
///
/// # Examples
///
/// ```
/// use strahl::{Document, ReadOptions, Syntax};
///
/// let text = r#"(
///     camera: Perspective(eye: (0, 0, 9), gaze: (0, 0, -1), fov: 90),
///     geometries: [Spheres(file: "atoms.csv")],
/// )"#;
/// let options = ReadOptions::new().syntax(Syntax::Ron);
/// let read = |options| Document::from_reader("<stdin>", text.as_bytes(), options);
/// let codes = |document: Document| -> Vec<_> {
///     document.diagnostics().iter().map(|fault| fault.code.name()).collect()
/// };
/// assert_eq!(codes(read(&options)?), ["file-not-found"]);
/// assert!(codes(read(&options.clone().without_tables())?).is_empty());
/// # Ok::<(), std::io::Error>(())
/// ```
#[derive(Clone, Debug, Default)]
pub struct ReadOptions {
    pub(crate) syntax: Option<Syntax>,
    pub(crate) levels: Levels,
    folder: Option<PathBuf>,
    outside: bool,
    without_tables: bool,
    without_text: bool,
    files: Option<Arc<dyn Files>>,
    cancel: Option<Cancel>,
    threads: Option<usize>,
    most: Option<usize>,
    pub(crate) settings: Vec<Setting>,
}

impl ReadOptions {
    /// The syntax that the ending of the file tells, the usual warnings, and tables in the folder
    /// of the scene.
    pub fn new() -> Self {
        Self::default()
    }

    /// The syntax, where nothing else may tell it.
    #[must_use]
    pub fn syntax(mut self, syntax: impl Into<Option<Syntax>>) -> Self {
        self.syntax = syntax.into();
        self
    }

    /// The warnings that are wanted.
    #[must_use]
    pub fn levels(mut self, levels: Levels) -> Self {
        self.levels = levels;
        self
    }

    /// The folder of a scene that is no file: where the tables are that it names, instead of the
    /// current folder.
    #[must_use]
    pub fn folder(mut self, folder: impl Into<PathBuf>) -> Self {
        self.folder = Some(folder.into());
        self
    }

    /// Whether the scene may name tables outside of its folder, by an absolute path, by `..` or
    /// through a link. Whoever wrote the scene then chooses among all files that can be read.
    #[must_use]
    pub fn allow_outside(mut self, allow: bool) -> Self {
        self.outside = allow;
        self
    }

    /// Opens no table, and says nothing about what stands in it.
    #[must_use]
    pub fn without_tables(mut self) -> Self {
        self.without_tables = true;
        self
    }

    /// Whether the text of a large scene in which nothing is wrong is kept, as it is unless this says
    /// otherwise. If not, the file is read block by block, which saves the memory where only the scene
    /// is wanted, and [`Document::text`](crate::Document::text) is empty.
    #[must_use]
    pub fn keep_text(mut self, keep: bool) -> Self {
        self.without_text = !keep;
        self
    }

    /// Where the scene and its tables are read from, instead of the disk.
    #[must_use]
    pub fn files(mut self, files: impl Files + 'static) -> Self {
        self.files = Some(Arc::new(files));
        self
    }

    /// Stops reading once `cancel` is cancelled, which then is the error.
    #[must_use]
    pub fn cancel(mut self, cancel: Cancel) -> Self {
        self.cancel = Some(cancel);
        self
    }

    /// Keeps so many diagnostics of each code, instead of 1,000, and counts the others
    /// ([`Document::suppressed`](crate::Document::suppressed)). A file may have a fault in every other
    /// byte.
    #[must_use]
    pub fn max_diagnostics(mut self, most: usize) -> Self {
        self.most = Some(most);
        self
    }

    /// Sets a value of the scene, after all that have been set before.
    #[must_use]
    pub fn set(mut self, setting: Setting) -> Self {
        self.settings.push(setting);
        self
    }

    /// So many threads read a large scene, instead of one for each core; what is read is the same.
    /// 0 means one for each core.
    #[must_use]
    pub fn threads(mut self, threads: usize) -> Self {
        self.threads = (threads > 0).then_some(threads);
        self
    }

    /// Who reads a text of so many bytes.
    pub(crate) fn pool(&self, length: usize) -> Pool {
        // Where threads cannot be had, one is enough.
        if length < LARGE {
            return Pool::Calling;
        }
        Pool::new(self.threads)
    }

    /// The same for a file, whose folder and ending tell more.
    pub(crate) fn of_file(&self, path: &Path) -> Self {
        let folder = path.parent().unwrap_or(Path::new(""));
        Self {
            syntax: self.syntax.or_else(|| Syntax::of_path(path)),
            folder: Some(folder.to_owned()),
            ..self.clone()
        }
    }

    /// The same with tables, for a model in which all is set already.
    pub(crate) fn with_tables(&self) -> Self {
        Self {
            without_tables: false,
            settings: Vec::new(),
            ..self.clone()
        }
    }

    /// Where a table is that the scene names: its path from the current folder.
    pub(crate) fn path_of(&self, table: &str) -> PathBuf {
        self.folder.as_deref().unwrap_or(Path::new("")).join(table)
    }

    /// The files that the scene may name; `None` where none is opened.
    pub(crate) fn tables(&self) -> Option<Folder<'_>> {
        let folder = self.folder.as_deref().unwrap_or(Path::new(""));
        (!self.without_tables).then(|| Folder::new(self.all_files(), folder, self.outside))
    }

    /// How many diagnostics of each code are kept.
    pub(crate) fn most_diagnostics(&self) -> usize {
        const USUAL: usize = 1000;
        self.most.unwrap_or(USUAL)
    }

    /// Where all files are read from.
    pub(crate) fn all_files(&self) -> &dyn Files {
        self.files.as_deref().unwrap_or(&Disk)
    }

    /// Whether the text of a large scene is kept in any case.
    pub(crate) const fn keeps_text(&self) -> bool {
        !self.without_text
    }

    /// Whether reading is to stop.
    pub(crate) fn is_cancelled(&self) -> bool {
        self.cancel.as_ref().is_some_and(Cancel::is_cancelled)
    }
}
