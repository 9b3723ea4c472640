//! A scene file with its text and everything that is wrong with it.

use std::{io, path::Path};

use crate::{
    diagnostic::{Code, Diagnostic, Severity},
    error::{Error, ErrorKind},
    lines::Lines,
    scene::{
        files::{self, Source},
        load,
        model::Model,
        syntax::Syntax,
        validate::{self, Problem},
    },
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
    model: Option<Model>,
    diagnostics: Vec<Diagnostic>,
}

impl Document {
    /// Reads and checks a scene file; its ending tells the syntax.
    ///
    /// # Errors
    ///
    /// A file that cannot be read, and one that is neither `.ron` nor `.json`. A scene with
    /// faults is no error: see [`Document::diagnostics`].
    pub fn from_path(path: impl AsRef<Path>) -> Result<Self, Error> {
        let path = path.as_ref();
        let syntax = Syntax::of_path(path).ok_or_else(|| {
            let message = "a scene file ends with .ron or .json";
            Error::new(ErrorKind::Usage, message).at(path)
        })?;
        Self::from_path_as(path, syntax)
    }

    /// Reads and checks a file of a syntax that its ending does not tell.
    ///
    /// # Errors
    ///
    /// A file that cannot be read.
    pub fn from_path_as(path: impl AsRef<Path>, syntax: Syntax) -> Result<Self, Error> {
        let path = path.as_ref();
        let source = files::read(path)?;
        Ok(Self::new(path.display().to_string(), source, syntax))
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
    ) -> io::Result<Self> {
        let source = files::read_from(reader, 0)?;
        let syntax = syntax.unwrap_or_else(|| Syntax::of_text(&source.text));
        Ok(Self::new(name.into(), source, syntax))
    }

    /// Checks a text; `name` is what reports call it.
    pub fn from_text(name: impl Into<String>, text: impl Into<String>, syntax: Syntax) -> Self {
        let source = Source {
            text: text.into(),
            fault: None,
        };
        Self::new(name.into(), source, syntax)
    }

    fn new(name: String, source: Source, syntax: Syntax) -> Self {
        let mut document = Self {
            name,
            text: source.text,
            model: None,
            diagnostics: Vec::from_iter(source.fault),
        };
        if document.diagnostics.is_empty() {
            document.check(syntax);
        }
        document
    }

    fn check(&mut self, syntax: Syntax) {
        let model = match load::model(&self.text, syntax) {
            Ok(model) => model,
            Err(fault) => {
                self.diagnostics.push(fault);
                return;
            }
        };
        let problems = match validate::version(model.version) {
            Some(problem) => vec![problem],
            None => validate::problems(&model, Code::on_by_default),
        };
        let allowed = model.allow.iter().flatten();
        let allowed: Vec<Code> = allowed.map(|warning| warning.0).collect();
        let wanted = problems
            .into_iter()
            .filter(|problem| !allowed.contains(&problem.code));
        self.diagnostics = wanted.map(placed).collect();
        self.model = Some(model);
    }

    /// What reports call the file.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The text; that of a file which is not text ends soon after the place where it is not.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Everything that is wrong, in the order of the file.
    pub fn diagnostics(&self) -> &[Diagnostic] {
        &self.diagnostics
    }

    /// Whether the scene cannot be rendered.
    pub fn has_errors(&self) -> bool {
        let mut severities = self.diagnostics.iter().map(|fault| fault.severity);
        severities.any(|severity| severity == Severity::Error)
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

fn placed(problem: Problem) -> Diagnostic {
    let path = problem.place.path.to_string();
    let message = format!("{path}: {}", problem.message);
    let mut diagnostic = Diagnostic::new(problem.code, 0..0, message).with_path(path);
    diagnostic.help = problem.help;
    for (_, message) in problem.labels {
        diagnostic = diagnostic.with_label(0..0, message);
    }
    diagnostic
}
