//! The command line: one file per command, each using the library.

mod additions;
mod bounded;
mod camera;
mod cameras;
mod changed_lines;
mod completions;
mod config;
mod convert;
mod depfile;
mod diff;
mod explain;
mod fit;
mod fmt;
mod frame;
mod info;
mod interrupt;
mod legend;
mod levels;
mod line_diff;
mod lsp;
mod man;
mod merge;
mod new;
mod params;
mod paths;
mod picture;
mod pixel;
#[cfg(feature = "preview")]
mod preview;
mod progress;
mod record;
mod render;
mod report;
mod rounds;
mod scene;
mod schema;
mod set;
mod status;
mod suggest;
mod threads;
mod timings;
mod validate;
mod watch;
mod watcher;
mod words;

use std::{
    fmt::Display,
    io::{self, Write},
    path::Path,
    process::ExitCode,
    time::Instant,
};

use clap::{Parser, Subcommand, ValueEnum};
use serde::Serialize;
use strahl::{
    Error, ErrorKind,
    text::{Stamp, Stamped, sanitize},
};

/// Render scenes from RON and JSON files, exactly
#[derive(Parser)]
#[command(name = "strahl", version, max_term_width = 100, after_help = EXIT_STATUS)]
pub(crate) struct Cli {
    #[command(subcommand)]
    command: Command,
}

const EXIT_STATUS: &str = "\
Exit status: 0 done; 1 a scene has errors, pictures differ or are missing; 2 wrong usage, an unreadable file or an impossible \
target; 75 cannot be written now, try again later; 130 interrupted.";

#[derive(Subcommand)]
enum Command {
    Render(render::Args),
    Merge(merge::Args),
    Status(status::Args),
    Info(info::Args),
    Pixel(pixel::Args),
    Legend(legend::Args),
    #[cfg(feature = "preview")]
    Preview(preview::Args),
    Watch(watch::Args),
    Validate(validate::Args),
    Fmt(fmt::Args),
    Lsp(lsp::Args),
    Convert(convert::Args),
    Schema(schema::Args),
    New(new::Args),
    Diff(diff::Args),
    Explain(explain::Args),
    Completions(completions::Args),
    Man(man::Args),
}

/// The name of standard output in messages.
const STDOUT: &str = "<stdout>";

/// The output format of a command's result.
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum OutputFormat {
    /// Human-readable text
    Human,
    /// One JSON object
    Json,
}

/// The reason why a command failed.
#[derive(Debug)]
enum Failure {
    /// Errors in a scene, or pictures that differ or are missing; already printed.
    Found,
    /// Wrong usage or an unreadable file; already printed.
    Reported,
    /// An error from the library.
    Library(Error),
    /// A wrong argument that clap does not detect.
    Usage(String),
    /// An unusable table of values.
    Table(Box<params::TableFaults>),
    /// A closed output: the reader of the result has seen enough. The exit status is that of the
    /// result.
    Closed { status: u8 },
}

impl From<Error> for Failure {
    fn from(error: Error) -> Self {
        Self::Library(error)
    }
}

impl From<serde_json::Error> for Failure {
    fn from(error: serde_json::Error) -> Self {
        Self::usage(error.to_string())
    }
}

impl Failure {
    fn usage(message: impl Into<String>) -> Self {
        Self::Usage(message.into())
    }

    /// Returns the failure for a file that the command cannot use.
    fn refused(path: &Path, why: impl Display) -> Self {
        Self::Usage(format!("{}: {why}", path.display()))
    }

    /// Returns the failure for text that could not be written to standard output.
    fn stdout(error: io::Error) -> Self {
        if error.kind() == io::ErrorKind::BrokenPipe {
            Self::Closed { status: 0 }
        } else {
            Self::Library(Error::writing_failed(STDOUT, error))
        }
    }

    fn status(&self) -> u8 {
        match self {
            Self::Closed { status } => *status,
            Self::Found => 1,
            Self::Reported | Self::Usage(_) | Self::Table(_) => 2,
            Self::Library(error) => match error.kind() {
                ErrorKind::Scene | ErrorKind::Incomplete => 1,
                ErrorKind::Unavailable => 75,
                ErrorKind::Interrupted => interrupt::STATUS,
                _ => 2,
            },
        }
    }

    /// Returns the failure that determines the exit status: 2 before 75 before 1. Prints the
    /// message of the other one.
    fn worst(one: Result<(), Self>, other: Result<(), Self>) -> Result<(), Self> {
        let rank = |failure: &Self| match failure.status() {
            2 => 3,
            75 => 2,
            status => u8::from(status != 0),
        };
        match (one, other) {
            (Err(one), Err(other)) => {
                let (worst, other) = if rank(&one) >= rank(&other) {
                    (one, other)
                } else {
                    (other, one)
                };
                other.print();
                Err(worst)
            }
            (one, other) => one.and(other),
        }
    }

    /// Prints the message, unless it has been printed already.
    fn print(&self) {
        if let Some(message) = self.message() {
            scene::print_error(&message);
        }
    }

    /// Returns the message that has not been printed yet.
    fn message(&self) -> Option<String> {
        match self {
            Self::Found | Self::Reported | Self::Closed { .. } => None,
            Self::Library(error) => Some(error.to_string()),
            Self::Usage(message) => Some(message.clone()),
            Self::Table(faults) => Some(faults.message()),
        }
    }
}

/// Parses the arguments, runs the command and reports its result.
pub(crate) fn run() -> ExitCode {
    let start = Instant::now();
    interrupt::outlive_large_files();
    let done = match Cli::try_parse() {
        Ok(cli) => strahl::parallel::check_memory()
            .map_err(Failure::from)
            .and_then(|()| dispatch(cli.command, start)),
        // Help is a result like any other; only usage errors go to standard error.
        Err(help) if !help.use_stderr() => {
            let printed = help.print().and_then(|()| io::stdout().flush());
            printed.map_err(Failure::stdout)
        }
        Err(mut error) => {
            suggest::improve(&mut error);
            print_usage(&error);
            return ExitCode::from(2);
        }
    };
    let Err(failure) = done else {
        return ExitCode::SUCCESS;
    };
    failure.print();
    ExitCode::from(failure.status())
}

/// Prints the error in the arguments; without colors if one of them contains escape sequences of
/// its own.
fn print_usage(error: &clap::Error) {
    let plain = error.render().to_string();
    let harmless = for_people(&plain);
    let _ = if plain.trim_end() == harmless.trim_end() {
        error.print()
    } else {
        io::stderr().write_all(harmless.as_bytes())
    };
}

fn dispatch(command: Command, start: Instant) -> Result<(), Failure> {
    match command {
        Command::Render(args) => render::run(&args, start),
        Command::Merge(args) => merge::run(&args),
        Command::Status(args) => status::run(&args),
        Command::Info(args) => info::run(args),
        Command::Pixel(args) => pixel::run(args),
        Command::Legend(args) => legend::run(args),
        #[cfg(feature = "preview")]
        Command::Preview(args) => preview::run(&args),
        Command::Watch(args) => watch::run(&args),
        Command::Validate(args) => validate::run(args),
        Command::Fmt(args) => fmt::run(args),
        Command::Lsp(args) => lsp::run(args),
        Command::Convert(args) => convert::run(args),
        Command::Schema(args) => schema::run(args),
        Command::New(args) => new::run(args),
        Command::Diff(args) => diff::run(args),
        Command::Explain(args) => explain::run(args),
        Command::Completions(args) => completions::run(args),
        Command::Man(args) => man::run(args),
    }
}

/// Returns a result as indented JSON.
fn json(stamp: Stamp, result: &impl Serialize) -> Result<String, Failure> {
    let json = serde_json::to_string_pretty(&Stamped::new(stamp, result))?;
    Ok(json + "\n")
}

/// Prints a result in the requested format.
fn print_as<T: Serialize + Display>(
    format: OutputFormat,
    stamp: Stamp,
    result: &T,
) -> Result<(), Failure> {
    print(&match format {
        OutputFormat::Human => for_people(&result.to_string()),
        OutputFormat::Json => json(stamp, result)?,
    })
}

/// Returns a text for people, in which nothing acts on a terminal, whatever names it contains.
fn for_people(text: &str) -> String {
    let lines = text.lines();
    lines
        .flat_map(|line| [sanitize(line), "\n".into()])
        .collect()
}

/// Prints a command's result.
fn print(text: &str) -> Result<(), Failure> {
    let mut stdout = io::stdout().lock();
    let written = stdout.write_all(text.as_bytes());
    written
        .and_then(|()| stdout.flush())
        .map_err(Failure::stdout)
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
