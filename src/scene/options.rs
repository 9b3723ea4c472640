//! Options for reading a scene.

use std::{
    io::Read,
    path::{Component, Path, PathBuf},
    sync::Arc,
};

use crate::{
    diagnostic::{levels::Levels, setters::setters},
    parallel::{Cancel, Pool, reader::UntilCancelled},
    scene::{
        additions::Additions,
        files::{Disk, Files, Folder, without_detours},
        part::PartCache,
        read::LARGE,
        set::Setting,
    },
    text::syntax::Syntax,
};

/// Options for reading a scene.
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
    /// The path of the file that is read, if it is one.
    pub(crate) file: Option<PathBuf>,
    pub(crate) is_part: bool,
    /// The reading that the file belongs to as a part; `None` for the scene itself.
    pub(crate) cache: Option<PartCache>,
    outside: bool,
    without_tables: bool,
    without_text: bool,
    files: Option<Arc<dyn Files>>,
    cancel: Option<Cancel>,
    threads: Option<usize>,
    most: Option<usize>,
    pub(crate) additions: Additions,
    pub(crate) settings: Vec<Setting>,
}

impl ReadOptions {
    /// Creates the default options: the syntax by the file extension, the default warnings, and
    /// tables in the folder of the scene.
    pub fn new() -> Self {
        Self::default()
    }

    setters! {
        /// Sets the syntax of a scene whose file extension does not determine it.
        syntax(syntax: impl Into<Option<Syntax>>) => syntax = syntax.into();

        /// The lint levels of the warnings.
        levels(levels: Levels) => levels = levels;

        /// Sets the folder of a scene that is not a file: the tables and parts it names are in this
        /// folder, not in the current one.
        folder(folder: impl Into<PathBuf>) => folder = Some(folder.into());

        /// Allows the scene to name tables and parts outside of its folder, by an absolute path, by `..`
        /// or through a link. The author of the scene then chooses among all readable files.
        allow_outside(allow: bool) => outside = allow;

        /// Checks a scene without a camera as a part of another one: it needs none, and nothing is said
        /// about what a picture of the part alone would show.
        as_part(is_part: bool) => is_part = is_part;

        /// Keeps the text of a large scene without faults, which is the default. With `false` the file
        /// is read block by block, which saves memory if only the scene is needed, and
        /// [`Document::text`](crate::Document::text) is empty.
        keep_text(keep: bool) => without_text = !keep;

        /// Reads the scene, its tables and its parts from these files instead of the disk.
        files(files: impl Files + 'static) => files = Some(Arc::new(files));

        /// Stops reading with an error once `cancel` is cancelled.
        cancel(cancel: Cancel) => cancel = Some(cancel);

        /// Keeps at most this many diagnostics of each code, 1,000 by default, and counts the others
        /// ([`Document::suppressed`](crate::Document::suppressed)). A file may have a fault in every
        /// other byte.
        max_diagnostics(most: usize) => most = Some(most);

        /// Sets the number of threads that read a large scene; 0 means one per core, the default. The
        /// result does not depend on it.
        threads(threads: usize) => threads = (threads > 0).then_some(threads);
    }

    /// Opens no tables and no parts, and reports nothing about their contents.
    #[must_use]
    pub fn without_tables(mut self) -> Self {
        self.without_tables = true;
        self
    }

    /// Sets a value of the scene, after all values set before.
    #[must_use]
    pub fn set(mut self, setting: Setting) -> Self {
        self.settings.push(setting);
        self
    }

    /// Returns the threads that read a text of this many bytes.
    pub(crate) fn pool(&self, length: usize) -> Pool {
        // If threads cannot be started, one is enough.
        if length < LARGE {
            return Pool::Calling;
        }
        Pool::new(self.threads)
    }

    /// Returns the options for a file, with its folder and the syntax of its extension.
    pub(crate) fn of_file(&self, path: &Path) -> Self {
        let folder = path.parent().unwrap_or(Path::new(""));
        Self {
            syntax: self.syntax.or_else(|| Syntax::of_path(path)),
            folder: Some(folder.to_owned()),
            file: Some(path.to_owned()),
            ..self.clone()
        }
    }

    /// Returns the options for a text with this name, which may be that of a file in the folder.
    pub(crate) fn of_text(&self, name: &str) -> Self {
        let file = Path::new(name).file_name();
        Self {
            file: self
                .file
                .clone()
                .or_else(|| file.map(|file| self.path_of(file))),
            ..self.clone()
        }
    }

    /// Returns the options for a part that the scene names.
    pub(crate) fn of_part(&self, path: &Path, cache: PartCache) -> Self {
        let options = Self {
            syntax: None,
            is_part: true,
            cache: Some(cache),
            ..self.with(Vec::new())
        };
        options.of_file(path)
    }

    /// Returns the options with tables, for a model whose settings are already applied.
    pub(crate) fn with_tables(&self) -> Self {
        Self {
            without_tables: false,
            ..self.with(Vec::new())
        }
    }

    /// Returns the options that set these values in a model that has the additions and the earlier
    /// settings.
    pub(crate) fn with(&self, settings: Vec<Setting>) -> Self {
        Self {
            additions: Additions::default(),
            settings,
            ..self.clone()
        }
    }

    /// Returns the path of a table or a part from the current folder.
    pub(crate) fn path_of(&self, name: impl AsRef<Path>) -> PathBuf {
        // `./a.csv`, `a.csv` and `sub/../a.csv` are one file, unless `sub` is a link.
        let steps = name.as_ref().components();
        let name: PathBuf = steps.filter(|step| *step != Component::CurDir).collect();
        let path = self.folder.as_deref().unwrap_or(Path::new("")).join(name);
        let short = without_detours(&path);
        let found = |path| self.all_files().resolve(path).ok();
        match short != path && found(&short).is_some_and(|file| found(&path) == Some(file)) {
            true => short,
            false => path,
        }
    }

    /// Returns the files that the scene may name; `None` if none are opened.
    pub(crate) fn tables(&self) -> Option<Folder<'_>> {
        let folder = self.folder.as_deref().unwrap_or(Path::new(""));
        (!self.without_tables).then(|| Folder::new(self.all_files(), folder, self.outside))
    }

    /// The maximum number of diagnostics kept of each code.
    pub(crate) fn most_diagnostics(&self) -> usize {
        const USUAL: usize = 1000;
        self.most.unwrap_or(USUAL)
    }

    /// The source of all files.
    pub(crate) fn all_files(&self) -> &dyn Files {
        self.files.as_deref().unwrap_or(&Disk)
    }

    /// The source of all files, for later.
    pub(crate) fn shared_files(&self) -> Arc<dyn Files> {
        self.files.clone().unwrap_or_else(|| Arc::new(Disk))
    }

    /// Returns true if the text of a large scene is always kept.
    pub(crate) const fn keeps_text(&self) -> bool {
        !self.without_text
    }

    /// Returns true if reading should stop.
    pub(crate) fn is_cancelled(&self) -> bool {
        self.cancel.as_ref().is_some_and(Cancel::is_cancelled)
    }

    /// The handle that stops reading, if there is one.
    pub(crate) const fn canceller(&self) -> Option<&Cancel> {
        self.cancel.as_ref()
    }

    /// Returns a reader that fails once reading should stop.
    pub(crate) fn until_cancelled<R: Read>(&self, reader: R) -> UntilCancelled<R> {
        UntilCancelled::new(reader, self.canceller())
    }
}
