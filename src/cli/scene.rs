//! Reading the scene that a command is given.

use std::{
    io::{self, IsTerminal, Write},
    path::{Path, PathBuf},
};

use clap::ValueEnum;
use strahl::{Diagnostic, Document, Levels, Lines, Severity, Size, Syntax};

use super::Failure;

/// What reports call standard input.
const STDIN: &str = "<stdin>";

/// The scene that a command works on.
#[derive(clap::Args)]
#[group(skip)]
pub(super) struct SceneArgs {
    /// The scene file, .ron or .json; `-` is standard input
    pub(super) scene: PathBuf,
    /// The syntax of the scene, where its ending does not tell it; standard input is JSON if it
    /// begins with `{`, else RON
    #[arg(long, value_name = "SYNTAX")]
    pub(super) input_format: Option<InputFormat>,
}

#[derive(Clone, Copy, ValueEnum)]
pub(super) enum InputFormat {
    Ron,
    Json,
}

impl From<InputFormat> for Syntax {
    fn from(format: InputFormat) -> Self {
        match format {
            InputFormat::Ron => Self::Ron,
            InputFormat::Json => Self::Json,
        }
    }
}

impl SceneArgs {
    pub(super) fn is_stdin(&self) -> bool {
        self.scene == Path::new("-")
    }

    /// Reads and checks the scene.
    pub(super) fn read(&self) -> Result<Document, Failure> {
        let syntax = self.input_format.map(Syntax::from);
        if self.is_stdin() {
            let stdin = io::stdin().lock();
            if stdin.is_terminal() {
                // Somebody who forgot the pipe would wait for ever.
                let _ = writeln!(
                    io::stderr(),
                    "reading a scene from the terminal, until Ctrl-D"
                );
            }
            return Document::from_reader(STDIN, stdin, syntax, &Levels::default())
                .map_err(|error| Failure::Usage(format!("{STDIN}: {error}")));
        }
        Ok(Document::from_path_with(
            &self.scene,
            syntax,
            &Levels::default(),
        )?)
    }
}

/// Prints what is wrong with a scene, on standard error; fails if it has errors.
pub(super) fn report(document: &Document, quiet: bool) -> Result<(), Failure> {
    let lines = Lines::new(document.text());
    let mut stderr = io::stderr().lock();
    for fault in document.diagnostics() {
        if !(quiet && fault.severity == Severity::Warning) {
            let _ = write_fault(&mut stderr, document.name(), &lines, fault);
        }
    }
    if document.has_errors() {
        Err(Failure::Scene)
    } else {
        Ok(())
    }
}

fn write_fault(
    out: &mut impl Write,
    name: &str,
    lines: &Lines,
    fault: &Diagnostic,
) -> io::Result<()> {
    let Diagnostic {
        code,
        severity,
        message,
        ..
    } = fault;
    let place = lines.position(fault.range.start);
    writeln!(
        out,
        "{name}:{}:{}: {severity}[{code}]: {message}",
        place.line, place.column
    )?;
    match &fault.help {
        Some(help) => writeln!(out, "  help: {help}"),
        None => Ok(()),
    }
}

/// Reads a size; its message says what a size is.
pub(super) fn size(text: &str) -> Result<Size, String> {
    text.parse()
        .map_err(|error: strahl::SizeError| error.to_string())
}
