//! The command line: one file per command, each a user of the library.

mod completions;
mod interrupt;
mod levels;
mod man;
mod pixel;
mod progress;
mod render;
mod scene;
mod validate;

use std::{fmt, io, io::Write, process::ExitCode};

use clap::{Parser, Subcommand, ValueEnum};
use strahl::{Error, ErrorKind};

/// Renders scenes that are data, exactly.
#[derive(Parser)]
#[command(name = "strahl", version, max_term_width = 100, after_help = EXIT_STATUS)]
pub(crate) struct Cli {
    #[command(subcommand)]
    command: Command,
}

const EXIT_STATUS: &str = "\
Exit status: 0 done; 1 a scene has errors; 2 wrong usage, a file that cannot be read, a target \
that cannot be; 75 could not be written now, trying again may help; 130 interrupted.";

#[derive(Subcommand)]
enum Command {
    Render(render::Args),
    Pixel(pixel::Args),
    Validate(validate::Args),
    Completions(completions::Args),
    Man(man::Args),
}

/// How a command prints its result.
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum OutputFormat {
    /// For people
    Human,
    /// One JSON object
    Json,
}

/// Why a command did not do what it was asked for.
#[derive(Debug)]
enum Failure {
    /// A scene has errors, which have been printed.
    Scene,
    /// A file could not be read, which has been printed.
    Unreadable,
    /// Anything that the library reports.
    Library(Error),
    /// A picture that did not reach the place of this name.
    Picture(&'static str, Error),
    /// A wrong argument that clap does not know of.
    Usage(String),
    /// Standard output could not be written.
    Stdout(io::Error),
}

impl From<Error> for Failure {
    fn from(error: Error) -> Self {
        Self::Library(error)
    }
}

impl Failure {
    fn status(&self) -> u8 {
        match self {
            Self::Scene => 1,
            Self::Unreadable => 2,
            Self::Library(error) | Self::Picture(_, error) => match error.kind() {
                ErrorKind::Scene => 1,
                ErrorKind::Unavailable => 75,
                ErrorKind::Interrupted => interrupt::STATUS,
                _ => 2,
            },
            Self::Usage(_) => 2,
            // A reader that has seen enough is no failure.
            Self::Stdout(error) if error.kind() == io::ErrorKind::BrokenPipe => 0,
            Self::Stdout(error) if error.kind() == io::ErrorKind::StorageFull => 75,
            Self::Stdout(_) => 2,
        }
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Scene => f.write_str("the scene has errors"),
            Self::Unreadable => f.write_str("a file could not be read"),
            Self::Library(error) => error.fmt(f),
            Self::Picture(place, error) => write!(f, "{place}: {error}"),
            Self::Usage(message) => f.write_str(message),
            Self::Stdout(error) => write!(f, "<stdout>: {error}"),
        }
    }
}

/// Parses the arguments, does what they ask for and reports how it went.
pub(crate) fn run() -> ExitCode {
    let done = match Cli::parse().command {
        Command::Render(args) => render::run(args),
        Command::Pixel(args) => pixel::run(args),
        Command::Validate(args) => validate::run(args),
        Command::Completions(args) => completions::run(args),
        Command::Man(args) => man::run(args),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            let status = failure.status();
            // Nobody is there to be told when even this cannot be written.
            if !matches!(failure, Failure::Scene | Failure::Unreadable) && status != 0 {
                let _ = writeln!(io::stderr(), "error: {failure}");
            }
            ExitCode::from(status)
        }
    }
}

/// Prints a command's result.
fn print(text: &str) -> Result<(), Failure> {
    let mut stdout = io::stdout().lock();
    let written = stdout.write_all(text.as_bytes());
    written
        .and_then(|()| stdout.flush())
        .map_err(Failure::Stdout)
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory;

    use super::*;

    #[test]
    fn the_definition_is_consistent() {
        Cli::command().debug_assert();
    }
}
