//! `strahl fmt`: the canonical format.

use std::{
    io::{self, BufWriter, Write},
    path::Path,
};

use strahl::{
    Document, ReadOptions, Syntax, image_file::replace_file, jobs::find_scenes, parallel::Cancel,
    text::sanitize,
};

use super::{
    config::ConfigArgs,
    failure::Failure,
    interrupt,
    line_diff::LineDiff,
    paths::{PathArgs, is_dash},
    scene::{self, StdinArgs},
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
    /// Syntax of files with another extension
    #[arg(long, value_name = "SYNTAX", value_parser = scene::syntaxes())]
    input_format: Option<Syntax>,
    #[command(flatten)]
    stdin: StdinArgs,
}

/// Prints the changes to a file in the format of `patch`. The document is dropped first: its tree
/// takes as much memory as the diff.
pub(super) fn print_diff(document: Document, changed: &str) -> Result<(), Failure> {
    let name = sanitize(document.name()).into_owned();
    let text = document.into_text();
    let mut stdout = BufWriter::new(io::stdout().lock());
    LineDiff::new(&text, changed)
        .write_unified(&name, &mut stdout)
        .and_then(|()| stdout.flush())
        .map_err(Failure::stdout)
}

pub(crate) fn run(args: Args) -> Result<(), Failure> {
    let cancel = interrupt::cancel_on_signal();
    // The content of tables does not affect the format.
    let options = ReadOptions::new().without_tables();
    let options = options.syntax(args.input_format);
    // The most serious of several failures decides the result, and none keeps other files from
    // being formatted.
    let mut worst = Ok(());
    let configs = args.config.configs();
    let paths = args.paths.all()?;
    for paths in paths.chunk_by(|one, other| is_dash(one) == is_dash(other)) {
        if paths.first().is_some_and(|path| is_dash(path)) {
            let document = args.stdin.read(options.clone(), args.input_format)?;
            worst = Failure::worst(worst, format(&args, document, None, &cancel));
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
                    format(&args, document, Some(&file.path), &cancel)
                });
            worst = Failure::worst(worst, formatted);
        }
    }
    worst
}

/// Formats a file or standard input, or prints the changes.
fn format(
    args: &Args,
    document: Document,
    file: Option<&Path>,
    cancel: &Cancel,
) -> Result<(), Failure> {
    let Some(formatted) = document.format() else {
        // Only the syntax matters here, so warnings are not printed.
        scene::report(&document, true)?;
        return Err(Failure::Found);
    };
    let has_changed = formatted != document.text();
    match file {
        _ if args.diff && has_changed => {
            Failure::worst(print_diff(document, &formatted), Err(Failure::Found))
        }
        _ if args.check && has_changed => {
            let printed = super::output::print(&format!("{}\n", sanitize(document.name())));
            Failure::worst(printed, Err(Failure::Found))
        }
        _ if args.diff || args.check => Ok(()),
        None => super::output::print(&formatted),
        Some(path) if has_changed => {
            let text = document.text().as_bytes();
            Ok(replace_file(path, text, formatted.as_bytes(), cancel)?)
        }
        Some(_) => Ok(()),
    }
}
