//! `strahl fmt`: the one layout.

use std::{
    io,
    path::{Path, PathBuf},
};

use strahl::{Cancel, Document, Error, ReadOptions, Syntax, find_scenes, write_file};

use super::{
    Failure, interrupt,
    scene::{self, InputFormat, STDIN},
};

/// Bring scenes into the one layout; comments are kept
#[derive(clap::Args)]
#[group(skip)]
pub(crate) struct Args {
    /// Scene files, folders that are searched for .ron and .json files, or `-`, which formats
    /// standard input to standard output
    #[arg(value_name = "PATH", required = true)]
    paths: Vec<PathBuf>,
    /// Write nothing; list the files that would change, with exit status 1 if there are any
    #[arg(long)]
    check: bool,
    /// Leave out what matches a pattern, as in a .gitignore, when searching folders
    #[arg(long, value_name = "GLOB")]
    exclude: Vec<String>,
    /// The syntax of files whose ending does not tell it
    #[arg(long, value_name = "SYNTAX")]
    input_format: Option<InputFormat>,
}

pub(crate) fn run(args: Args) -> Result<(), Failure> {
    let cancel = Cancel::new();
    interrupt::exit_on_signal(cancel.clone());
    // What stands in a table does not change the layout.
    let options = ReadOptions::new().without_tables();
    let options = options.syntax(args.input_format.map(Syntax::from));
    // Of several failures the gravest decides, and none keeps the other files from their layout.
    let mut worst = Ok(());
    for paths in args
        .paths
        .chunk_by(|one, other| (one == Path::new("-")) == (other == Path::new("-")))
    {
        if paths.first().is_some_and(|path| path == Path::new("-")) {
            let document = Document::from_reader(STDIN, io::stdin().lock(), &options)
                .map_err(|error| Error::reading_failed(STDIN, error))?;
            worst = Failure::worst(worst, format_stdin(&document, args.check));
            continue;
        }
        for file in find_scenes(paths, &args.exclude)? {
            let formatted = Document::from_path_with(&file.path, &options)
                .map_err(Failure::from)
                .and_then(|document| {
                    if file.folder.is_some() && document.is_no_scene() {
                        return Ok(());
                    }
                    format_file(&file.path, &document, args.check, &cancel)
                });
            worst = Failure::worst(worst, formatted);
        }
    }
    worst
}

fn format_stdin(document: &Document, check: bool) -> Result<(), Failure> {
    let Some(formatted) = document.format() else {
        scene::report(document, true)?;
        return Err(Failure::Scene);
    };
    if !check {
        return super::print(&formatted);
    }
    if formatted == document.text() {
        return Ok(());
    }
    super::print(&format!("{STDIN}\n"))?;
    Err(Failure::Scene)
}

fn format_file(
    path: &Path,
    document: &Document,
    check: bool,
    cancel: &Cancel,
) -> Result<(), Failure> {
    let Some(formatted) = document.format() else {
        // Whoever asked for a layout does not ask what the values mean.
        scene::report(document, true)?;
        return Err(Failure::Scene);
    };
    if formatted == document.text() {
        return Ok(());
    }
    if check {
        super::print(&format!("{}\n", path.display()))?;
        return Err(Failure::Scene);
    }
    write_file(path, formatted.as_bytes(), cancel)?;
    Ok(())
}
