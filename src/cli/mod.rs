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
mod failure;
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
mod output;
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
    io::{self, Write},
    process::ExitCode,
    time::Instant,
};

use clap::{CommandFactory, Parser, Subcommand};

use self::{failure::Failure, output::for_people};

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
    Render(Box<render::Args>),
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
            suggest::improve(&mut error, Cli::command());
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
        Command::Completions(args) => completions::run(args, Cli::command()),
        Command::Man(args) => man::run(args, Cli::command()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_definition_is_consistent() {
        Cli::command().debug_assert();
    }
}
