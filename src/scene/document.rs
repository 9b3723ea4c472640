//! A scene file with its text and everything that is wrong with it.

use std::{io, mem, ops::Range, path::Path};

use crate::{
    diagnostic::{Code, Diagnostic, Label, Severity},
    error::{Error, ErrorKind},
    levels::Levels,
    lines::Lines,
    scene::{
        convert::{self, Converted},
        fields,
        files::{self, Source},
        fmt, load,
        locate::Locator,
        mend::{self, Mended, Repairs},
        model::{Model, WarningName},
        nearest::quote,
        problem::Problem,
        syntax::{self, Fault, Syntax},
        validate,
    },
    timings::{Stage, Timings, Watch},
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
    text: String,
    syntax: Syntax,
    is_text: bool,
    model: Option<Model>,
    diagnostics: Vec<Diagnostic>,
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
        Self::from_path_with(path, None, &Levels::default())
    }

    /// Reads and checks a scene file of a syntax that its ending need not tell, with the warnings
    /// that are wanted.
    ///
    /// # Errors
    ///
    /// As [`Document::from_path`].
    pub fn from_path_with(
        path: impl AsRef<Path>,
        syntax: Option<Syntax>,
        levels: &Levels,
    ) -> Result<Self, Error> {
        let path = path.as_ref();
        let timings = Timings::new();
        let file = timings.watch().time(Stage::Read, || files::open(path))?;
        let syntax = syntax.or_else(|| Syntax::of_path(path)).ok_or_else(|| {
            let message = "the ending does not tell the syntax, expected .ron or .json";
            Error::new(ErrorKind::Usage, message).at(path)
        })?;
        let source = timings
            .watch()
            .time(Stage::Read, || files::read(&file, path))?;
        let name = path.display().to_string();
        Ok(Self::new(name, source, syntax, levels, timings))
    }

    /// Reads and checks a scene from any source, such as standard input; `name` is what reports
    /// call it, and without a syntax the text tells it ([`Syntax::of_text`]).
    ///
    /// # Errors
    ///
    /// What the reader returns.
    pub fn from_reader(
        name: impl Into<String>,
        reader: impl io::Read,
        syntax: Option<Syntax>,
        levels: &Levels,
    ) -> io::Result<Self> {
        let timings = Timings::new();
        let source = timings
            .watch()
            .time(Stage::Read, || files::read_from(reader, 0))?;
        let syntax = syntax.unwrap_or_else(|| Syntax::of_text(&source.text));
        Ok(Self::new(name.into(), source, syntax, levels, timings))
    }

    /// Checks a text; `name` is what reports call it.
    pub fn from_text(name: impl Into<String>, text: impl Into<String>, syntax: Syntax) -> Self {
        let source = Source {
            text: text.into(),
            fault: None,
        };
        let (levels, timings) = (Levels::default(), Timings::new());
        Self::new(name.into(), source, syntax, &levels, timings)
    }

    fn new(
        name: String,
        source: Source,
        syntax: Syntax,
        levels: &Levels,
        timings: Timings,
    ) -> Self {
        let Source { text, fault } = source;
        let is_text = fault.is_none();
        let (model, diagnostics) = match fault {
            Some(fault) => (None, vec![fault]),
            None => {
                let watch = timings.watch();
                watch.time(Stage::Check, || check(&text, syntax, levels, &watch))
            }
        };
        Self {
            name,
            text,
            syntax,
            is_text,
            model,
            diagnostics,
            timings,
        }
    }

    /// What stands for a file that could not be read.
    pub(crate) fn unreadable(path: &Path, error: &Error) -> Self {
        Self {
            name: path.display().to_string(),
            text: String::new(),
            syntax: Syntax::of_path(path).unwrap_or(Syntax::Ron),
            is_text: false,
            model: None,
            diagnostics: vec![Diagnostic::new(Code::Unreadable, 0..0, error.cause())],
            timings: Timings::new(),
        }
    }

    /// Whether the text has none of the fields by which a scene can be told.
    pub fn is_no_scene(&self) -> bool {
        // What is no text at all is broken, whatever it was meant to be.
        if !self.has_errors() || !self.is_text {
            return false;
        }
        let tree = syntax::parse(&self.text, self.syntax);
        let keys = tree.root().into_iter().flat_map(|root| tree.fields(root));
        let mut names = keys.map(|(key, _)| {
            let node = tree.node(key);
            let text = self.text.get(node.range()).unwrap_or("");
            mend::key_name(text, self.syntax, node.kind())
        });
        !names.any(|name| fields::telling().any(|field| field == name))
    }

    /// What reports call the file.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The text; that of a file which is not text ends soon after the place where it is not.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// The syntax that the text is written in.
    pub fn syntax(&self) -> Syntax {
        self.syntax
    }

    /// Everything that is wrong, in the order of the file.
    pub fn diagnostics(&self) -> &[Diagnostic] {
        &self.diagnostics
    }

    /// How long it took to read and to check the scene.
    pub fn timings(&self) -> &Timings {
        &self.timings
    }

    /// Whether the scene cannot be rendered.
    pub fn has_errors(&self) -> bool {
        let mut severities = self.diagnostics.iter().map(|fault| fault.severity);
        severities.any(|severity| severity == Severity::Error)
    }

    /// The text in the one layout; `None` if it has syntax faults, or is no text.
    ///
    /// # Examples
    ///
    /// ```
    /// use strahl::{Document, Syntax};
    ///
    /// let text = "(camera:Orthographic(scale:3,), geometries:[]) // mine";
    /// let document = Document::from_text("mine.ron", text, Syntax::Ron);
    /// let formatted = "(\n    camera: Orthographic(scale: 3),\n    geometries: [],\n) // mine\n";
    /// assert_eq!(document.format().as_deref(), Some(formatted));
    /// ```
    pub fn format(&self) -> Option<String> {
        let is_syntax = |fault: &Diagnostic| fault.code == Code::Syntax;
        if !self.is_text || self.diagnostics.iter().any(is_syntax) {
            return None;
        }
        let tree = syntax::parse(&self.text, self.syntax);
        Some(fmt::format(&self.text, &tree))
    }

    /// The scene in a syntax, in the one layout; what stands in the text besides the values is
    /// dropped, and told.
    ///
    /// # Errors
    ///
    /// A scene with errors.
    pub fn convert(self, syntax: Syntax) -> Result<Converted, Error> {
        let tree = syntax::parse(&self.text, self.syntax);
        let (model, _) = self.into_model()?;
        Ok(convert::convert(model, &tree, syntax))
    }

    /// The model of a scene without errors, with its warnings.
    pub(crate) fn into_model(self) -> Result<(Model, Vec<Diagnostic>), Error> {
        let error = |fault: &&Diagnostic| fault.severity == Severity::Error;
        let message = self.diagnostics.iter().find(error).map(|first| {
            let place = Lines::new(&self.text).position(first.range.start);
            let (name, code, message) = (&self.name, first.code, &first.message);
            format!(
                "{name}:{}:{}: error[{code}]: {message}",
                place.line, place.column
            )
        });
        match (self.model, message) {
            (Some(model), None) => Ok((model, self.diagnostics)),
            (_, message) => {
                let message = message.unwrap_or_else(|| "the scene has errors".to_owned());
                Err(Error::scene(message, self.diagnostics))
            }
        }
    }
}

/// The model of a text, and everything that is wrong with it, in the order of the text.
fn check(
    text: &str,
    syntax: Syntax,
    levels: &Levels,
    watch: &Watch,
) -> (Option<Model>, Vec<Diagnostic>) {
    let refused = match watch.time(Stage::Read, || load::model(text, syntax)) {
        Ok(model) => {
            let problems = validate::problems(&model, levels);
            if problems.is_empty() {
                return (Some(model), Vec::new());
            }
            let tree = syntax::parse(text, syntax);
            let repairs = Repairs::default();
            let locator = Locator::new(text, &tree, &repairs);
            let placed = problems.into_iter().map(|problem| {
                let range = locator.range(&problem.place).unwrap_or_default();
                placed(problem, range, text, &locator)
            });
            let diagnostics = sorted(placed.collect(), &model, levels);
            return (Some(model), diagnostics);
        }
        Err(refused) => refused,
    };
    let tree = syntax::parse(text, syntax);
    if !tree.faults().is_empty() {
        return (None, tree.faults().iter().map(syntax_fault).collect());
    }
    let Mended {
        model,
        mut diagnostics,
        repairs,
    } = mend::mend(text, &tree);
    if let Some(model) = model {
        let locator = Locator::new(text, &tree, &repairs);
        // What lies in a repair is not wrong a second time.
        let problems = validate::problems(&model, levels).into_iter();
        let placed = problems.filter_map(|problem| {
            let range = locator.range(&problem.place)?;
            Some(placed(problem, range, text, &locator))
        });
        let placed: Vec<_> = placed.collect();
        // Of another version, whatever else seems to be wrong may be right.
        if placed
            .iter()
            .any(|fault| fault.code == Code::UnsupportedVersion)
        {
            return (None, placed);
        }
        diagnostics.extend(placed);
        diagnostics = sorted(diagnostics, &model, levels);
    }
    // The tree explains, but ron and serde_json decide.
    if !diagnostics
        .iter()
        .any(|fault| fault.code.severity() == Severity::Error)
    {
        diagnostics.push(refused);
        sort(&mut diagnostics);
    }
    (None, diagnostics)
}

/// The diagnostics that are wanted, in the order of the text.
fn sorted(mut found: Vec<Diagnostic>, model: &Model, levels: &Levels) -> Vec<Diagnostic> {
    let allow = model.allow.as_deref().unwrap_or_default();
    let is_allowed = |code: &&Code| allow.contains(&WarningName::Known(**code));
    let allowed: Vec<_> = Code::WARNINGS.iter().filter(is_allowed).collect();
    found.retain_mut(|fault| {
        let allowed = allowed.contains(&&fault.code);
        let severity = levels.severity(fault.code).filter(|_| !allowed);
        fault.severity = severity.unwrap_or(fault.severity);
        severity.is_some()
    });
    sort(&mut found);
    found
}

fn sort(found: &mut [Diagnostic]) {
    found.sort_by_key(|fault| (fault.range.start, fault.range.end, fault.code));
}

fn syntax_fault(fault: &Fault) -> Diagnostic {
    let mut diagnostic = Diagnostic::new(Code::Syntax, fault.range.clone(), &*fault.message);
    diagnostic.help.clone_from(&fault.help);
    match &fault.label {
        Some((range, message)) => diagnostic.with_label(range.clone(), &**message),
        None => diagnostic,
    }
}

fn placed(problem: Problem, mut range: Range<usize>, text: &str, locator: &Locator) -> Diagnostic {
    let mut labels: Vec<Label> = Vec::new();
    for (place, message) in problem.labels {
        if let Some(range) = locator.range(&place) {
            labels.push(Label { range, message });
        }
    }
    // Which of two keys is the later one only the text knows.
    if problem.code == Code::GazeOrLookAt
        && let Some(label) = labels.first_mut()
        && label.range.start > range.start
    {
        mem::swap(&mut label.range, &mut range);
    }
    let mut message = problem.message;
    if problem.shows_value {
        // As it is written: 1e999 has become infinite, and 5e-324 would have 324 digits.
        let source = text.get(range.clone()).unwrap_or_default();
        message = format!("{message}, found {}", quote(source));
    }
    Diagnostic {
        severity: problem.code.severity(),
        code: problem.code,
        range,
        message,
        help: problem.help,
        path: problem.place.path.to_string(),
        labels,
    }
}
