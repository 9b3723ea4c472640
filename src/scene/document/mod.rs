//! A scene file with its text and its diagnostics.

mod parts;
mod text;

pub use self::parts::Dependency;

use std::{
    io, iter,
    path::{Path as FilePath, PathBuf},
    sync::Arc,
};

use crate::{
    diagnostic::{Code, Diagnostic, Severity, Suppressed, error::Error, plain},
    parallel::{
        Cancel,
        timings::{Stage, Timings},
    },
    scene::{
        check::{self, Checked, CheckedModel},
        convert::{self, Converted, LostComments},
        files::{self, FileText},
        format::{light::LightModel, scene::Model},
        loaded::Loaded,
        options::ReadOptions,
        set::{self, FieldLookup, Setting},
        source::Source,
        tables::Tables,
    },
    text::{nearest::nearest, syntax::Syntax},
};

/// A scene with its text, its values and its diagnostics.
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
    path: Option<PathBuf>,
    source: Arc<Source>,
    is_text: bool,
    options: ReadOptions,
    checked: Checked,
    timings: Timings,
}

impl Document {
    /// Reads and checks a scene file; its extension determines the syntax.
    ///
    /// # Errors
    ///
    /// Fails if the file cannot be read, or is neither `.ron` nor `.json`. A scene with faults is
    /// not an error: see [`Document::diagnostics`].
    pub fn from_path(path: impl AsRef<FilePath>) -> Result<Self, Error> {
        Self::from_path_with(path, &ReadOptions::new())
    }

    /// Reads and checks a scene file with `options`, which may give the syntax of a file with
    /// another extension.
    ///
    /// # Errors
    ///
    /// As [`Document::from_path`].
    pub fn from_path_with(
        path: impl AsRef<FilePath>,
        options: &ReadOptions,
    ) -> Result<Self, Error> {
        let path = path.as_ref();
        let timings = Timings::new();
        let watch = timings.watch();
        let options = options.of_file(path);
        let opened = watch.time(Stage::Read, || files::open(options.all_files(), path));
        let (content, length) = opened?;
        let syntax = options.syntax.ok_or_else(|| {
            let mut message =
                "the extension does not determine the syntax, expected .ron or .json".to_owned();
            let ending = path.extension().unwrap_or_default().to_string_lossy();
            if let Some(meant) = nearest(&ending, &[Syntax::Ron, Syntax::Json].map(Syntax::name)) {
                message += &format!("; did you mean `.{meant}`?");
            }
            Error::refused(message).at(path)
        })?;
        let loaded = Loaded::from_content(content, length, syntax, &options, &watch);
        let loaded = loaded.map_err(|error| Error::unreadable(path, error))?;
        let name = path.display().to_string();
        let document = Self {
            path: unnamed(path),
            ..Self::new(name, loaded, options, timings.clone())
        };
        document.unless_cancelled().map_err(|error| error.at(path))
    }

    /// Reads and checks a scene from any source, such as standard input.
    ///
    /// `name` is the name in reports. Without a syntax in `options`, it is detected from the text
    /// ([`Syntax::of_text`]). Tables and parts are looked up in [`ReadOptions::folder`].
    ///
    /// # Errors
    ///
    /// Returns the errors of the reader.
    pub fn from_reader(
        name: impl Into<String>,
        reader: impl io::Read,
        options: &ReadOptions,
    ) -> io::Result<Self> {
        let name = name.into();
        let timings = Timings::new();
        let watch = timings.watch();
        let text = watch.time(Stage::Read, || {
            files::read_from(options.until_cancelled(reader), 0)
        })?;
        let options = options.of_text(&name);
        let syntax = options.syntax;
        let syntax = syntax.unwrap_or_else(|| Syntax::of_text(&text.text));
        let loaded = Loaded::from_text(text, None, syntax, &options, &watch);
        let document = Self::new(name, loaded, options, timings.clone());
        document.unless_cancelled().map_err(io::Error::other)
    }

    /// Checks a text; `name` is its name in reports. Tables and parts are looked up in the current folder.
    pub fn from_text(name: impl Into<String>, text: impl Into<String>, syntax: Syntax) -> Self {
        Self::checked(name.into(), text.into(), syntax, ReadOptions::new())
    }

    /// Checks a text with these options.
    fn checked(name: String, text: String, syntax: Syntax, options: ReadOptions) -> Self {
        let (text, timings) = (FileText { text, fault: None }, Timings::new());
        let loaded = Loaded::from_text(text, None, syntax, &options, &timings.watch());
        Self::new(name, loaded, options, timings.clone())
    }

    fn new(name: String, loaded: Loaded, options: ReadOptions, timings: Timings) -> Self {
        let Loaded {
            source,
            is_text,
            checked,
        } = loaded;
        Self {
            name,
            path: None,
            source: source.into(),
            is_text,
            options,
            checked,
            timings,
        }
    }

    /// Creates the document of a file that could not be read.
    pub(crate) fn unreadable(path: &FilePath, error: &Error) -> Self {
        Self {
            name: path.display().to_string(),
            path: unnamed(path),
            source: Source::new("", Syntax::of_path(path).unwrap_or(Syntax::Ron)).into(),
            is_text: false,
            options: ReadOptions::new(),
            checked: Checked::refused(vec![Diagnostic::new(Code::Unreadable, 0..0, error.cause())]),
            timings: Timings::new(),
        }
    }

    /// Returns the scene with more values set, after those of [`ReadOptions::set`]. The file is not
    /// read again; tables and parts are.
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
        let options = self.options.with(settings.into_iter().collect());
        match &self.checked.model {
            Some(model) => self.with_model(model.clone(), options),
            None => Self {
                options,
                ..self.findings()
            },
        }
    }

    /// Returns the same text with another model, checked again.
    fn with_model(&self, model: Model, options: ReadOptions) -> Self {
        let timings = Timings::new();
        let watch = timings.watch();
        let checked = watch.time(Stage::Check, || {
            let found = CheckedModel::of(model, self.syntax(), &options, &watch);
            let checked = found.placed(&self.source, &options.levels);
            Checked {
                has_lights: self.checked.has_lights,
                ..checked
            }
        });
        Self {
            options,
            checked,
            timings: timings.clone(),
            ..self.findings()
        }
    }

    /// The handle that cancels the reading, if there is one.
    pub(crate) const fn canceller(&self) -> Option<&Cancel> {
        self.options.canceller()
    }

    /// Returns the document, or an error if reading was cancelled.
    fn unless_cancelled(self) -> Result<Self, Error> {
        if self.options.is_cancelled() {
            return Err(Error::interrupted());
        }
        Ok(self)
    }

    /// Returns the document without its scene: the name, the text and the diagnostics.
    #[must_use]
    pub fn findings(&self) -> Self {
        Self {
            name: self.name.clone(),
            path: self.path.clone(),
            source: Arc::clone(&self.source),
            is_text: self.is_text,
            options: self.options.clone(),
            checked: self.checked.findings(),
            timings: self.timings.clone(),
        }
    }

    /// Returns true if the text is neither a scene nor a broken one, like the other files in a
    /// folder of scenes.
    ///
    /// An empty text is a broken scene. So is RON that does not parse, and JSON that does not parse
    /// but has a field of a scene. A text that parses is a scene if a name at its root is, or
    /// resembles, one of its fields, unless this program wrote it as a report.
    pub fn is_no_scene(&self) -> bool {
        // A file that is not text is broken, whatever it was meant to be.
        if !self.has_errors() || !self.is_text {
            return false;
        }
        !self.source.is_scene()
    }

    /// Returns the name of the file in reports.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Returns the path of the file if it is not UTF-8, so that the name differs from it.
    pub fn path(&self) -> Option<&FilePath> {
        self.path.as_deref()
    }

    /// Returns the text. It ends soon after the first place that is not text, and is empty for a
    /// large scene if [`ReadOptions::keep_text`] is off.
    pub fn text(&self) -> &str {
        self.source.text()
    }

    /// Returns the text, and drops all else.
    pub fn into_text(self) -> String {
        match Arc::try_unwrap(self.source) {
            Ok(source) => source.into_text(),
            Err(shared) => shared.text().to_owned(),
        }
    }

    /// Returns the scene as values; `None` if it could not be read, or was removed.
    pub const fn model(&self) -> Option<&Model> {
        self.checked.model.as_ref()
    }

    /// Returns the text with its tree.
    pub const fn source(&self) -> &Arc<Source> {
        &self.source
    }

    /// Returns the syntax of the text.
    pub fn syntax(&self) -> Syntax {
        self.source.syntax()
    }

    /// Returns the number of faults beyond [`Document::diagnostics`], which holds at most
    /// [`ReadOptions::max_diagnostics`] of each code.
    pub const fn suppressed(&self) -> Suppressed {
        self.checked.suppressed
    }

    /// Returns the diagnostics of the file, in the order of its text.
    pub fn diagnostics(&self) -> &[Diagnostic] {
        &self.checked.diagnostics
    }

    /// Returns the diagnostics of values set by [`ReadOptions::set`]; their places are in
    /// [`Setting::text`].
    pub fn setting_diagnostics(&self) -> impl Iterator<Item = (&Setting, &[Diagnostic])> {
        let faults = self.checked.settings.iter().map(Vec::as_slice);
        let all = self.options.settings.iter().zip(faults);
        all.filter(|(_, faults)| !faults.is_empty())
    }

    /// Looks up a word in the place of a setting's path; [`FieldLookup::Unknown`] if the scene
    /// could not be read.
    pub fn look_up(&self, word: &str) -> FieldLookup {
        let model = self.checked.model.as_ref();
        model.map_or(FieldLookup::Unknown, |model| set::look_up(model, word))
    }

    /// Returns the fault of a setting whose path leads nowhere in this scene.
    pub fn path_fault(&self, setting: &Setting) -> Option<Diagnostic> {
        set::path_fault(self.checked.model.as_ref()?, setting, self.syntax())
    }

    /// Returns the severity in this scene of a fault found elsewhere; `None` if it is not reported.
    pub fn severity(&self, code: Code) -> Option<Severity> {
        check::severity(code, self.checked.model.as_ref(), &self.options.levels)
    }

    /// Returns true if the file or a part, and not [`ReadOptions::headlight`], gives the scene
    /// `lights`.
    pub const fn has_lights(&self) -> bool {
        self.checked.has_lights
    }

    /// Returns the time that reading and checking took.
    pub fn timings(&self) -> &Timings {
        &self.timings
    }

    /// Returns true if the scene cannot be rendered.
    pub fn has_errors(&self) -> bool {
        let of_settings = self.checked.settings.iter().flatten();
        let all = self.checked.diagnostics.iter().chain(of_settings);
        let mut severities = all.map(|fault| fault.severity);
        severities.any(|severity| severity == Severity::Error)
    }

    /// Converts the scene to a syntax, in the canonical format, without comments.
    ///
    /// # Errors
    ///
    /// Fails if the scene has errors, or is nested too deep for the syntax.
    pub fn convert(self, syntax: Syntax) -> Result<Converted, Error> {
        let lost = LostComments::of(self.text(), self.source.tree());
        let name = self.name.clone();
        let (model, _) = self.into_model()?;
        let converted = convert::convert(model, syntax);
        match converted.fault {
            Some(fault) => Err(Error::refused(fault).at(FilePath::new(&name))),
            None => Ok(Converted { lost, ..converted }),
        }
    }

    /// Returns the names of the scene's `cameras`, in the order of the file; none if the scene has
    /// errors.
    pub fn cameras(&self) -> impl Iterator<Item = &str> {
        let model = self.checked.model.iter().filter(|_| !self.has_errors());
        model
            .flat_map(Model::all_cameras)
            .filter_map(|(name, _)| name)
    }

    /// Returns the number of frames: 1 without an animation, or if the scene has errors.
    pub fn frames(&self) -> u32 {
        let model = self.checked.model.as_ref().filter(|_| !self.has_errors());
        let animation = model.and_then(|model| model.animation.as_deref());
        animation.map_or(1, |animation| animation.frames)
    }

    /// Returns the names of the scene's `lights` and then of those of its parts, in their order,
    /// `None` for one without; none if the scene could not be read.
    pub fn light_names(&self) -> impl Iterator<Item = Option<&str>> {
        let model = self.checked.model.iter();
        let own = model.flat_map(|model| model.lights.iter().flatten());
        let of_parts = self.checked.tables.iter().flat_map(Tables::lights);
        let of_parts = of_parts.flatten().map(|(name, _)| name.as_ref());
        let of_parts = of_parts.map(|name| name.map(|name| &***name));
        own.map(LightModel::name).chain(of_parts)
    }

    /// Frees the memory of the tables when a document is kept only for its diagnostics; later uses
    /// read them again.
    pub(crate) fn forget_tables(&mut self) {
        let model = self.checked.model.iter_mut();
        let model = model.filter(|_| !self.checked.needs.files.is_empty());
        let forget = |model: &mut Model| model.forget_meshes() + model.forget_pictures();
        let forgotten: usize = model.map(forget).sum();
        let tables = &mut self.checked.tables;
        tables.take_if(|tables| forgotten > 0 || !tables.is_empty());
    }

    /// Returns the model of a scene without errors, with its tables and warnings.
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

    /// Returns copies of the model of a scene without errors and of its tables, which are read again
    /// if they were not kept.
    fn model_and_tables(&self) -> Result<(Model, Tables), Error> {
        let copy = Self {
            checked: self.checked.clone(),
            ..self.findings()
        };
        let (model, tables, _) = copy.into_parts()?;
        Ok((model, tables))
    }

    /// The model of a scene without errors, with its warnings.
    fn into_model(self) -> Result<(Model, Vec<Diagnostic>), Error> {
        if !self.has_errors()
            && let Some(model) = self.checked.model
        {
            return Ok((model, self.checked.diagnostics));
        }
        let (message, listing) = self.messages();
        Err(Error::scene(message, self.checked.diagnostics, listing))
    }

    /// Returns the first error, and all faults with their places: first those of the file, then
    /// those of the settings and of the parts; errors precede warnings.
    fn messages(&self) -> (String, String) {
        let of_file = iter::once((self.name(), self.text(), self.diagnostics()));
        let of_settings = self.setting_diagnostics();
        let of_settings =
            of_settings.map(|(setting, faults)| (setting.path(), setting.text(), faults));
        let of_parts = self.parts();
        let of_parts = of_parts.map(|part| (part.name(), part.text(), part.diagnostics()));
        let texts: Vec<_> = of_file.chain(of_settings).chain(of_parts).collect();
        plain::listing(&texts)
    }
}

/// Returns a path whose name in reports is not its own.
fn unnamed(path: &FilePath) -> Option<PathBuf> {
    path.to_str().is_none().then(|| path.to_owned())
}
