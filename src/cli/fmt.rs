//! `strahl fmt`: the one layout.

use std::{io, path::Path};

use similar::TextDiff;
use strahl::{
    Document, Error, ReadOptions, Syntax, image_file::write_file, jobs::find_scenes,
    parallel::Cancel, text::sanitize,
};

use super::{
    Failure,
    config::ConfigArgs,
    interrupt,
    paths::{PathArgs, is_dash},
    scene::{self, STDIN},
};

/// Format scene files; comments are kept. `-` formats standard input to standard output
#[derive(clap::Args)]
#[group(skip)]
pub(crate) struct Args {
    #[command(flatten)]
    paths: PathArgs,
    /// Only list the files that would change; exit with status 1 if there are any
    #[arg(long)]
    check: bool,
    /// Only print a unified diff of the changes; exit with status 1 if there are any
    #[arg(long)]
    diff: bool,
    #[command(flatten)]
    config: ConfigArgs,
    /// Syntax of files with another ending
    #[arg(long, value_name = "SYNTAX", value_parser = scene::syntaxes())]
    input_format: Option<Syntax>,
}

/// What is done about a file that is not in the canonical format.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Mode {
    Write,
    Check,
    Diff,
}

impl Mode {
    /// Prints what would change, if anything would.
    fn report(self, name: &str, text: &str, formatted: &str) -> Result<(), Failure> {
        if text == formatted {
            return Ok(());
        }

        super::print(&match self {
            Self::Diff => unified_diff(name, text, formatted),
            _ => format!("{name}\n"),
        })?;
        Err(Failure::Found)
    }
}

/// What changes in a file, as `patch` reads it.
pub(super) fn unified_diff(name: &str, text: &str, changed: &str) -> String {
    TextDiff::from_lines(text, changed)
        .unified_diff()
        .header(name, name)
        .to_string()
}

pub(crate) fn run(args: Args) -> Result<(), Failure> {
    let mode = match (args.diff, args.check) {
        (true, _) => Mode::Diff,
        (false, true) => Mode::Check,
        (false, false) => Mode::Write,
    };
    let cancel = Cancel::new();
    interrupt::exit_on_signal(cancel.clone());
    // What stands in a table does not change the layout.
    let options = ReadOptions::new().without_tables();
    let options = options.syntax(args.input_format);
    // Of several failures the gravest decides, and none keeps the other files from their layout.
    let mut worst = Ok(());
    let configs = args.config.configs();
    let paths = args.paths.all()?;
    for paths in paths.chunk_by(|one, other| is_dash(one) == is_dash(other)) {
        if paths.first().is_some_and(|path| is_dash(path)) {
            let document = Document::from_reader(STDIN, io::stdin().lock(), &options)
                .map_err(|error| Error::reading_failed(STDIN, error))?;
            worst = Failure::worst(worst, format_stdin(&document, mode));
            continue;
        }
        for file in find_scenes(paths, &args.paths.exclude, &configs)? {
            let formatted = Document::from_path_with(&file.path, &options)
                .map_err(Failure::from)
                .and_then(|document| {
                    if file.folder.is_some() && document.is_no_scene() {
                        args.paths.skip(&file.path);
                        return Ok(());
                    }
                    format_file(&file.path, &document, mode, &cancel)
                });
            worst = Failure::worst(worst, formatted);
        }
    }
    worst
}

fn format_stdin(document: &Document, mode: Mode) -> Result<(), Failure> {
    let Some(formatted) = document.format() else {
        scene::report(document, true)?;
        return Err(Failure::Found);
    };
    if mode == Mode::Write {
        return super::print(&formatted);
    }
    mode.report(STDIN, document.text(), &formatted)
}

fn format_file(
    path: &Path,
    document: &Document,
    mode: Mode,
    cancel: &Cancel,
) -> Result<(), Failure> {
    let Some(formatted) = document.format() else {
        // Whoever asked for a layout does not ask what the values mean.
        scene::report(document, true)?;
        return Err(Failure::Found);
    };
    if mode != Mode::Write {
        return mode.report(
            &sanitize(&path.to_string_lossy()),
            document.text(),
            &formatted,
        );
    }
    if formatted != document.text() {
        write_file(path, formatted.as_bytes(), cancel)?;
    }
    Ok(())
}
