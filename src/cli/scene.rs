//! Reading the scene of a command.

use std::{
    collections::BTreeSet,
    convert::Infallible,
    env, fmt,
    io::{self, IsTerminal, Write},
    path::{Path, PathBuf},
    sync::Mutex,
};

use clap::builder::TypedValueParser;
use strahl::{
    Diagnostic, Document, Error, ReadOptions, Syntax,
    diagnostic::{Code, Severity, folder_of},
    jobs::Config,
    report::{FileReport, OutputFormat, Style, Summary, limit, reporter},
    scene::PartFindings,
    text::sanitize,
};
use terminal_size::{Width, terminal_size};

use super::{
    config::ConfigArgs,
    failure::Failure,
    fit::FitArgs,
    paths::is_dash,
    set::{self, SetArgs},
    threads::lock,
    words::one_of,
};

/// The name of standard input in reports.
pub(super) const STDIN: &str = "<stdin>";

/// The maximum number of problems printed before a scene is rendered.
pub(super) const MOST: usize = 100;

/// The scene that a command works on.
#[derive(clap::Args)]
#[group(skip)]
pub(super) struct SceneArgs {
    /// The scene file, .ron or .json; `-` is standard input
    pub(super) scene: PathBuf,
    /// Syntax of a scene with another extension; default for standard input: JSON if it begins with
    /// `{`, otherwise RON
    #[arg(long, value_name = "SYNTAX", value_parser = syntaxes())]
    pub(super) input_format: Option<Syntax>,
    #[command(flatten)]
    pub(super) stdin: StdinArgs,
}

/// The file that standard input stands for.
#[derive(Clone, Default, clap::Args)]
#[group(skip)]
pub(super) struct StdinArgs {
    /// The name of standard input, which need not be a file: it determines the syntax, the folder of
    /// tables and parts, and the strahl.toml
    #[arg(long, value_name = "FILE")]
    stdin_filename: Option<PathBuf>,
}

impl StdinArgs {
    /// Returns the file that standard input stands for, `-` for none.
    pub(super) fn path(&self) -> &Path {
        self.stdin_filename.as_deref().unwrap_or(Path::new("-"))
    }

    /// Reads a scene from standard input.
    pub(super) fn read(
        &self,
        options: ReadOptions,
        syntax: Option<Syntax>,
    ) -> Result<Document, Error> {
        let (name, options) = match &self.stdin_filename {
            Some(path) => {
                let options = options.folder(folder_of(path));
                let syntax = syntax.or_else(|| Syntax::of_path(path));
                (path.display().to_string(), options.syntax(syntax))
            }
            None => (STDIN.to_owned(), options.syntax(syntax)),
        };
        Document::from_reader(&*name, io::stdin().lock(), &options)
            .map_err(|error| Error::reading_failed(STDIN, error))
    }
}

/// The tables and parts that a scene may name.
#[derive(Clone, clap::Args)]
#[group(skip)]
pub(super) struct TableArgs {
    /// Allow scenes to name tables and parts outside their folders
    #[arg(long)]
    allow_outside: bool,
}

impl TableArgs {
    /// Returns the options for reading scenes.
    pub(super) fn options(&self, config: &Config) -> ReadOptions {
        let options = config.read_options();
        if self.allow_outside {
            options.allow_outside(true)
        } else {
            options
        }
    }
}

/// A scene, and the options that change its values.
#[derive(clap::Args)]
#[group(skip)]
pub(super) struct InputArgs {
    #[command(flatten)]
    pub(super) scene: SceneArgs,
    #[command(flatten)]
    tables: TableArgs,
    #[command(flatten)]
    config: ConfigArgs,
    #[command(flatten)]
    set: SetArgs,
    #[command(flatten)]
    fit: FitArgs,
}

impl InputArgs {
    /// Reads and checks the scene, and prints its faults; fails if it has errors.
    pub(super) fn read(&self, threads: usize, quiet: bool) -> Result<Document, Failure> {
        let config = self.config.configs().of(self.scene.place())?;
        let options = self.tables.options(&config).keep_text(false);
        let options = self.fit.of(self.set.of(options.threads(threads)));
        let document = self.scene.read(options)?;
        report(&document, quiet)?;
        Ok(document)
    }
}

/// The number of threads.
#[derive(clap::Args)]
#[group(skip)]
pub(super) struct ThreadArgs {
    // If the machine has no room for that many, the system may end the program while they start.
    /// Number of threads; default: one per core. The result does not depend on it
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
}

impl ThreadArgs {
    /// Returns the number of threads, 0 for one per core.
    pub(super) fn count(&self) -> usize {
        self.threads.unwrap_or(0).into()
    }
}

/// Returns the parser of an option that names a syntax.
pub(super) fn syntaxes() -> impl TypedValueParser<Value = Syntax> {
    one_of(Syntax::ALL.iter().copied(), |syntax| syntax.name().into())
}

impl SceneArgs {
    pub(super) fn is_stdin(&self) -> bool {
        is_dash(&self.scene)
    }

    /// Returns the file that the scene is, or that standard input stands for.
    pub(super) fn place(&self) -> &Path {
        match self.is_stdin() {
            true => self.stdin.path(),
            false => &self.scene,
        }
    }

    /// Reads and checks the scene.
    pub(super) fn read(&self, options: ReadOptions) -> Result<Document, Failure> {
        if self.is_stdin() {
            if io::stdin().is_terminal() {
                // Someone who forgot the pipe would wait forever.
                let _ = writeln!(
                    io::stderr(),
                    "reading a scene from the terminal; end it with Ctrl-D"
                );
            }
            return Ok(self.stdin.read(options, self.input_format)?);
        }
        let options = options.syntax(self.input_format);
        Ok(Document::from_path_with(&self.scene, &options)?)
    }
}

/// Prints the diagnostics of a scene on standard error; fails if it has errors.
pub(super) fn report(document: &Document, quiet: bool) -> Result<(), Failure> {
    print_findings(document, quiet);
    if set::leads_nowhere(document) {
        return Err(Failure::Reported);
    }
    if document.has_errors() {
        Err(Failure::Found)
    } else {
        Ok(())
    }
}

/// Prints the diagnostics of a scene and its parts on standard error.
pub(super) fn print_findings(document: &Document, quiet: bool) {
    print_findings_with(document, quiet, |_| true);
}

/// Prints the diagnostics of a scene and of those of its parts that are wanted.
pub(super) fn print_findings_with(
    document: &Document,
    quiet: bool,
    is_wanted: impl Fn(&PartFindings) -> bool,
) {
    // Printing may have to read the text of the scene, so it is skipped without diagnostics.
    if !document.diagnostics().is_empty() {
        print_report(&findings(document), quiet);
    }
    for part in document.parts().filter(|part| is_wanted(part)) {
        print_report(&findings_of_part(part), quiet);
    }
    let Ok::<(), Infallible>(()) = set::faults(document, |part| {
        print_report(part, quiet);
        Ok(())
    });
}

/// Returns the diagnostics of a scene as a report.
pub(super) fn findings(document: &Document) -> FileReport<'_> {
    FileReport {
        file: document.name(),
        path: document.path(),
        text: document.text(),
        diagnostics: document.diagnostics(),
        suppressed: document.suppressed(),
        ..FileReport::default()
    }
}

/// Returns the diagnostics of a part as a report.
pub(super) fn findings_of_part(part: &PartFindings) -> FileReport<'_> {
    FileReport {
        file: part.name(),
        text: part.text(),
        diagnostics: part.diagnostics(),
        suppressed: part.suppressed(),
        ..FileReport::default()
    }
}

/// Prints a warning about an option on standard error.
pub(super) fn print_warning(message: &str) {
    let _ = writeln!(io::stderr(), "warning: {message}");
}

/// Reports a written file, if standard error is a terminal.
pub(super) fn report_written(path: &Path, what: impl fmt::Display, quiet: bool) {
    let mut stderr = io::stderr().lock();
    if !quiet && stderr.is_terminal() {
        let message = format!("wrote {}{what}", path.display());
        let _ = writeln!(stderr, "{}", sanitize(&message));
    }
}

/// The faults of options that have been printed.
static PRINTED: Mutex<BTreeSet<String>> = Mutex::new(BTreeSet::new());

/// Makes all faults of options new again, for another round of the same work.
pub(super) fn forget_printed() {
    lock(&PRINTED).clear();
}

/// Returns true if a report should be printed. A fault of an option is printed once per scene, or
/// only once if it does not depend on the scene.
pub(super) fn is_new(report: &FileReport<'_>) -> bool {
    let Some(option) = report.option else {
        return true;
    };
    let is_syntax = |fault: &Diagnostic| fault.code == Code::Syntax;
    let scene = match report.diagnostics.iter().all(is_syntax) {
        true => "",
        false => report.file,
    };
    let faults = report.diagnostics.iter().map(|fault| &*fault.message);
    let key = faults.fold(format!("{scene}\n{option}"), |key, fault| {
        key + "\n" + fault
    });
    lock(&PRINTED).insert(key)
}

/// Prints at most `MOST` diagnostics of a text on standard error.
pub(super) fn print_report(report: &FileReport<'_>, quiet: bool) {
    let wanted = |fault: &&Diagnostic| !(quiet && fault.severity == Severity::Warning);
    let diagnostics: Vec<_> = report.diagnostics.iter().filter(wanted).cloned().collect();
    let mut left_out = report.suppressed;
    if quiet {
        left_out.warnings = 0;
    }
    if diagnostics.is_empty() && left_out.is_empty() || !is_new(report) {
        return;
    }
    let (diagnostics, suppressed) = limit(&diagnostics, MOST);
    let report = FileReport {
        diagnostics: &diagnostics,
        suppressed: suppressed + left_out,
        ..*report
    };
    let mut summary = Summary::default();
    summary.count(&report);
    let stderr = io::stderr().lock();
    let mut reporter = reporter(
        OutputFormat::Human,
        style(&stderr),
        strahl::diagnostic::describe,
        stderr,
    );
    // Whoever closed standard error does not want the message.
    let _ = reporter
        .file(&report)
        .and_then(|()| reporter.finish(&summary));
}

/// Returns the style of reports on a stream: colors only on a terminal, and never with `NO_COLOR`.
pub(super) fn style(stream: &impl IsTerminal) -> Style {
    let no_color = env::var_os("NO_COLOR").is_some_and(|value| !value.is_empty());
    if !stream.is_terminal() {
        return Style::default();
    }
    Style {
        color: !no_color && env::var_os("TERM").is_none_or(|term| term != "dumb"),
        width: terminal_size().map_or(Style::default().width, |(Width(width), _)| width.into()),
    }
}
