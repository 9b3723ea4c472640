//! A scene file with its text and everything that is wrong with it.

mod text;

use std::{
    io, iter,
    path::{Path, PathBuf},
    sync::Arc,
};

use crate::{
    diagnostic::{
        Code, Diagnostic, Severity, Suppressed,
        error::{Error, ErrorKind},
        plain,
    },
    parallel::timings::{Stage, Timings},
    scene::{
        check::{self, Checked, Found, check},
        convert::{self, Converted, LostComments},
        files::{self, Content, FileText},
        format::{geometry::GeometryModel, scene::Model},
        options::ReadOptions,
        recognize::Recognizer,
        set::{self, FieldLookup, Setting},
        source::Source,
        tables::Tables,
    },
    text::{nearest::nearest, syntax::Syntax},
};

/// The text of a scene, what it says, and what is wrong with it.
///
/// # Examples
///
/// ```
/// use strahl::{Document, Syntax};
///
/// let text = "(camera: Perspective(eye: (0, 0, 0), gaze: (0, 0, -1), fov: 400), geometries: [])";
/// let document = Document::from_text("mine.ron", text, Syntax::Ron);
/// let codes: Vec<_> = document.diagnostics().iter().map(|fault| fault.code.name()).collect();
/// assert_eq!(codes, ["out-of-range", "empty-scene"]);
/// ```
#[derive(Debug)]
pub struct Document {
    name: String,
    source: Arc<Source>,
    is_text: bool,
    options: ReadOptions,
    checked: Checked,
    timings: Timings,
}

impl Document {
    /// Reads and checks a scene file; its ending tells the syntax.
    ///
    /// # Errors
    ///
    /// A file that cannot be read, and one that is neither `.ron` nor `.json`. A scene with
    /// faults is no error: see [`Document::diagnostics`].
    pub fn from_path(path: impl AsRef<Path>) -> Result<Self, Error> {
        Self::from_path_with(path, &ReadOptions::new())
    }

    /// Reads and checks a scene file as `options` say, which may give the syntax of a file whose
    /// ending does not tell it.
    ///
    /// # Errors
    ///
    /// As [`Document::from_path`].
    pub fn from_path_with(path: impl AsRef<Path>, options: &ReadOptions) -> Result<Self, Error> {
        let path = path.as_ref();
        let timings = Timings::new();
        let watch = timings.watch();
        let options = options.of_file(path);
        let opened = watch.time(Stage::Read, || files::open(options.all_files(), path));
        let (content, length) = opened?;
        let syntax = options.syntax.ok_or_else(|| {
            let mut message =
                "the ending does not tell the syntax, expected .ron or .json".to_owned();
            let ending = path.extension().unwrap_or_default().to_string_lossy();
            if let Some(meant) = nearest(&ending, &[Syntax::Ron, Syntax::Json].map(Syntax::name)) {
                message += &format!("; did you mean `.{meant}`?");
            }
            Error::new(ErrorKind::Usage, message).at(path)
        })?;
        let unreadable = |error| Error::unreadable(path, error);
        let found = match &content {
            Content::File(file) if !options.keeps_text() => watch.time(Stage::Check, || {
                Found::in_file(file, length, syntax, &options, &watch)
            }),
            _ => Ok(None),
        };
        let found = found.map_err(unreadable)?;
        let text = match &found {
            Some(found) if found.problems.is_empty() => FileText::default(),
            _ => {
                let expected = length.map_or(0, |length| usize::try_from(length).unwrap_or(0));
                let text = watch.time(Stage::Read, || files::read_from(content, expected));
                text.map_err(unreadable)?
            }
        };
        let name = path.display().to_string();
        let document = Self::new(name, text, found, syntax, options, timings.clone());
        document.unless_cancelled().map_err(|error| error.at(path))
    }

    /// Reads and checks a scene from any source, such as standard input; `name` is what reports
    /// call it, and without a syntax the text tells it ([`Syntax::of_text`]). The tables that the
    /// scene names are looked for in [`ReadOptions::folder`].
    ///
    /// # Errors
    ///
    /// What the reader returns.
    pub fn from_reader(
        name: impl Into<String>,
        reader: impl io::Read,
        options: &ReadOptions,
    ) -> io::Result<Self> {
        let timings = Timings::new();
        let text = timings
            .watch()
            .time(Stage::Read, || files::read_from(reader, 0))?;
        let syntax = options.syntax;
        let syntax = syntax.unwrap_or_else(|| Syntax::of_text(&text.text));
        let document = Self::new(name.into(), text, None, syntax, options.clone(), timings);
        document.unless_cancelled().map_err(io::Error::other)
    }

    /// Checks a text; `name` is what reports call it. The tables that the scene names are looked
    /// for in the current folder.
    pub fn from_text(name: impl Into<String>, text: impl Into<String>, syntax: Syntax) -> Self {
        let text = FileText {
            text: text.into(),
            fault: None,
        };
        let (options, timings) = (ReadOptions::new(), Timings::new());
        Self::new(name.into(), text, None, syntax, options, timings)
    }

    fn new(
        name: String,
        text: FileText,
        found: Option<Found>,
        syntax: Syntax,
        options: ReadOptions,
        timings: Timings,
    ) -> Self {
        let FileText { text, fault } = text;
        let source = Source::new(text, syntax);
        let is_text = fault.is_none();
        let checked = match fault {
            Some(fault) => Checked::refused(vec![fault]),
            None => {
                let watch = timings.watch();
                watch.time(Stage::Check, || check(&source, found, &options, &watch))
            }
        };
        Self {
            name,
            source: source.into(),
            is_text,
            options,
            checked,
            timings,
        }
    }

    /// What stands for a file that could not be read.
    pub(crate) fn unreadable(path: &Path, error: &Error) -> Self {
        Self {
            name: path.display().to_string(),
            source: Source::new(String::new(), Syntax::of_path(path).unwrap_or(Syntax::Ron)).into(),
            is_text: false,
            options: ReadOptions::new(),
            checked: Checked::refused(vec![Diagnostic::new(Code::Unreadable, 0..0, error.cause())]),
            timings: Timings::new(),
        }
    }

    /// The same scene with more values set in it, after those that [`ReadOptions::set`] has set. The
    /// file is not read again; tables are.
    ///
    /// # Examples
    ///
    /// ```
    /// use strahl::{Document, Scene, Syntax};
    ///
    /// let text = "(camera: Orthographic(gaze: (0, 0, -1), eye: (0, 0, 9), scale: 2), geometries: [])";
    /// let scene = Document::from_text("mine.ron", text, Syntax::Ron);
    /// let wrong = scene.with(["camera.scale=-1".parse()?]);
    /// let (_, faults) = wrong.setting_diagnostics().next().unwrap();
    /// assert_eq!(faults[0].code.name(), "out-of-range");
    /// assert!(!scene.with(["camera.scale=3".parse()?]).has_errors());
    /// # Ok::<(), strahl::scene::SettingError>(())
    /// ```
    #[must_use]
    pub fn with(&self, settings: impl IntoIterator<Item = Setting>) -> Self {
        let mut options = self.options.clone();
        options.settings = settings.into_iter().collect();
        match &self.checked.model {
            Some(model) => self.with_model(model.clone(), options),
            None => Self {
                options,
                ..self.findings()
            },
        }
    }

    /// The same text with another model, checked anew.
    fn with_model(&self, model: Model, options: ReadOptions) -> Self {
        let timings = Timings::new();
        let watch = timings.watch();
        let checked = watch.time(Stage::Check, || {
            let found = Found::of(model, self.syntax(), &options, &watch);
            found.placed(&self.source, &options.levels)
        });
        Self {
            options,
            checked,
            timings: timings.clone(),
            ..self.findings()
        }
    }

    /// The document, unless it was not read to its end.
    fn unless_cancelled(self) -> Result<Self, Error> {
        if self.options.is_cancelled() {
            return Err(Error::interrupted());
        }
        Ok(self)
    }

    /// What is told about the scene, without the scene: its name, its text and its diagnostics.
    #[must_use]
    pub fn findings(&self) -> Self {
        Self {
            name: self.name.clone(),
            source: Arc::clone(&self.source),
            is_text: self.is_text,
            options: self.options.clone(),
            checked: self.checked.findings(),
            timings: self.timings.clone(),
        }
    }

    /// Whether the text is neither a scene nor a broken one: what a folder holds besides its scenes.
    ///
    /// An empty text is a broken scene, and so are RON that does not parse and JSON that does not
    /// but has a field of a scene. What parses is a scene if a name at its root is that of one of
    /// its fields, or nearly, unless this program has written it as a report.
    pub fn is_no_scene(&self) -> bool {
        // What is no text at all is broken, whatever it was meant to be.
        if !self.has_errors() || !self.is_text {
            return false;
        }
        !Recognizer::new(self.text(), self.source.tree()).is_scene()
    }

    /// What reports call the file.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The text; that of a file which is not text ends soon after the place where it is not, and that
    /// of a large scene is empty if [`ReadOptions::keep_text`] says so.
    pub fn text(&self) -> &str {
        self.source.text()
    }

    /// The scene as values; `None` if it has not been understood, or was taken apart.
    pub const fn model(&self) -> Option<&Model> {
        self.checked.model.as_ref()
    }

    /// The text with its tree.
    pub(crate) const fn source(&self) -> &Arc<Source> {
        &self.source
    }

    /// The syntax that the text is written in.
    pub fn syntax(&self) -> Syntax {
        self.source.syntax()
    }

    /// How many faults there are beside [`Document::diagnostics`], which hold at most so many of each
    /// code as [`ReadOptions::max_diagnostics`] says.
    pub const fn suppressed(&self) -> Suppressed {
        self.checked.suppressed
    }

    /// Everything that is wrong with the file, in its order.
    pub fn diagnostics(&self) -> &[Diagnostic] {
        &self.checked.diagnostics
    }

    /// What is wrong with values that [`ReadOptions::set`] has set; the places are those in
    /// [`Setting::text`].
    pub fn setting_diagnostics(&self) -> impl Iterator<Item = (&Setting, &[Diagnostic])> {
        let faults = self.checked.settings.iter().map(Vec::as_slice);
        let all = self.options.settings.iter().zip(faults);
        all.filter(|(_, faults)| !faults.is_empty())
    }

    /// What a word is for the scene, where the path of a setting is expected; nothing where the
    /// scene has not been understood.
    pub fn look_up(&self, word: &str) -> FieldLookup {
        let model = self.checked.model.as_ref();
        model.map_or(FieldLookup::Unknown, |model| set::look_up(model, word))
    }

    /// How bad a fault is that something else has with the scene; `None` if it is not to be
    /// reported.
    pub fn severity(&self, code: Code) -> Option<Severity> {
        check::severity(code, self.checked.model.as_ref(), &self.options.levels)
    }

    /// How long it took to read and to check the scene.
    pub fn timings(&self) -> &Timings {
        &self.timings
    }

    /// Whether the scene cannot be rendered.
    pub fn has_errors(&self) -> bool {
        let of_settings = self.checked.settings.iter().flatten();
        let all = self.checked.diagnostics.iter().chain(of_settings);
        let mut severities = all.map(|fault| fault.severity);
        severities.any(|severity| severity == Severity::Error)
    }

    /// The values of the scene in a syntax, in the canonical format, without comments.
    ///
    /// # Errors
    ///
    /// A scene with errors.
    pub fn convert(self, syntax: Syntax) -> Result<Converted, Error> {
        let lost = LostComments::of(self.text(), self.source.tree());
        let (model, _) = self.into_model()?;
        Ok(Converted {
            lost,
            ..convert::convert(model, syntax)
        })
    }

    /// The names of the scene's `cameras`, in the order of the file; of a scene with errors none.
    pub fn cameras(&self) -> impl Iterator<Item = &str> {
        let model = self.checked.model.iter().filter(|_| !self.has_errors());
        model
            .flat_map(Model::all_cameras)
            .filter_map(|(name, _)| name)
    }

    /// The number of frames: 1 without an animation, and of a scene with errors.
    pub fn frames(&self) -> u32 {
        let model = self.checked.model.as_ref().filter(|_| !self.has_errors());
        let animation = model.and_then(|model| model.animation.as_deref());
        animation.map_or(1, |animation| animation.frames)
    }

    /// The tables that the scene names, as it names them.
    pub fn table_names(&self) -> impl Iterator<Item = &str> {
        let geometries = self
            .checked
            .model
            .iter()
            .flat_map(|model| &model.geometries);
        let tables = geometries.filter_map(GeometryModel::table);
        tables.map(|table| &*table.file)
    }

    /// Where the tables are that the scene names, in the same order: their paths from the current
    /// folder.
    pub fn table_paths(&self) -> impl Iterator<Item = PathBuf> {
        self.table_names().map(|name| self.options.path_of(name))
    }

    /// Gives the memory of the tables back, where a document is kept for what it says about them;
    /// who wants them again reads them again.
    pub(crate) fn forget_tables(&mut self) {
        self.checked.tables.take_if(|tables| !tables.is_empty());
    }

    /// The model of a scene without errors, with its tables and its warnings.
    pub(crate) fn into_parts(self) -> Result<(Model, Tables, Vec<Diagnostic>), Error> {
        if self.checked.tables.is_none()
            && !self.has_errors()
            && let Some(model) = &self.checked.model
        {
            return self
                .with_model(model.clone(), self.options.with_tables())
                .into_parts();
        }
        let mut document = self;
        let tables = document.checked.tables.take().unwrap_or_default();
        let (model, warnings) = document.into_model()?;
        Ok((model, tables, warnings))
    }

    /// The model of a scene without errors, with its warnings.
    fn into_model(self) -> Result<(Model, Vec<Diagnostic>), Error> {
        if !self.has_errors()
            && let Some(model) = self.checked.model
        {
            return Ok((model, self.checked.diagnostics));
        }
        let (message, listing) = self.told();
        Err(Error::scene(message, self.checked.diagnostics, listing))
    }

    /// The first error, and all faults with their places: those of the file, then those of what is
    /// set; errors come before warnings.
    fn told(&self) -> (String, String) {
        let of_file = iter::once((self.name(), self.text(), self.diagnostics()));
        let of_settings = self.setting_diagnostics();
        let of_settings =
            of_settings.map(|(setting, faults)| (setting.path(), setting.text(), faults));
        let texts: Vec<_> = of_file.chain(of_settings).collect();
        plain::listing(&texts)
    }
}
