//! `strahl validate`: every problem of every scene.

use std::{
    fs,
    io::{self, BufWriter, Write},
    path::{Path, PathBuf},
};

use clap::ValueEnum;
use strahl::{
    Checked, Document, Error, Syntax, check_files, find_scenes, no_scene,
    report::{FileReport, OutputFormat, Report, Summary, limit, reporter},
};

use super::{
    Failure,
    levels::LevelArgs,
    scene::{self, InputFormat, STDIN},
    set::{self, SetArgs},
};

/// Report every problem of every scene
#[derive(clap::Args)]
#[group(skip)]
pub(crate) struct Args {
    /// Scene files, folders that are searched for .ron and .json files, or `-` for standard input
    #[arg(value_name = "PATH", required_unless_present = "files_from")]
    paths: Vec<PathBuf>,
    /// Read more paths from a file, one in each line; `-` is standard input
    #[arg(long, value_name = "FILE")]
    files_from: Option<PathBuf>,
    /// Leave out what matches a pattern, as in a .gitignore, when searching folders
    #[arg(long, value_name = "GLOB")]
    exclude: Vec<String>,
    /// How to print the problems, on standard output
    #[arg(long, value_name = "FORMAT", default_value = "human")]
    output_format: Format,
    /// How many problems of one file are printed; errors are kept before warnings
    #[arg(long, value_name = "N", default_value_t = 100)]
    max_diagnostics: usize,
    /// The syntax of files whose ending does not tell it
    #[arg(long, value_name = "SYNTAX")]
    input_format: Option<InputFormat>,
    /// How many threads read; the default is one for each core
    #[arg(long, value_name = "N", value_parser = scene::threads())]
    threads: Option<u16>,
    #[command(flatten)]
    tables: scene::TableArgs,
    #[command(flatten)]
    set: SetArgs,
    #[command(flatten)]
    levels: LevelArgs,
}

/// [`OutputFormat`] with the names that clap needs.
#[derive(Clone, Copy)]
struct Format(OutputFormat);

impl ValueEnum for Format {
    fn value_variants<'a>() -> &'a [Self] {
        const ALL: &[Format] = &[
            Format(OutputFormat::Human),
            Format(OutputFormat::Short),
            Format(OutputFormat::Json),
            Format(OutputFormat::Jsonl),
            Format(OutputFormat::Sarif),
            Format(OutputFormat::Github),
            Format(OutputFormat::Junit),
        ];
        ALL
    }

    fn to_possible_value(&self) -> Option<clap::builder::PossibleValue> {
        Some(self.0.name().into())
    }
}

pub(crate) fn run(args: Args) -> Result<(), Failure> {
    let mut paths = args.paths.clone();
    if let Some(list) = &args.files_from {
        paths.extend(read_list(list)?);
    }
    let options = args.tables.options().levels(args.levels.0);
    let options = args
        .set
        .of(options)
        .syntax(args.input_format.map(Syntax::from));
    let stdout = BufWriter::new(io::stdout().lock());
    let style = scene::style(&io::stdout());
    let mut run = Run {
        reporter: reporter(args.output_format.0, style, strahl::describe, stdout),
        summary: Summary::default(),
        most: args.max_diagnostics,
        failure: None,
        empty_folders: Vec::new(),
    };
    // What was named is read in the order in which it was named, with standard input among it.
    for paths in paths.split_inclusive(|path| path == Path::new("-")) {
        let (stdin, paths) = match paths.split_last() {
            Some((last, paths)) if last == Path::new("-") => (true, paths),
            _ => (false, paths),
        };
        let files = find_scenes(paths, &args.exclude)?;
        let threads = args.threads.unwrap_or(0).into();
        run.empty_folders = files.iter().filter_map(|file| file.folder).collect();
        run.empty_folders.dedup();
        check_files(&files, &options, threads, |checked| run.add(checked))?;
        if let Some(folder) = run
            .empty_folders
            .first()
            .and_then(|index| paths.get(*index))
        {
            run.failure = run.failure.or(Some(no_scene(folder).into()));
        }
        if stdin {
            let document = Document::from_reader(STDIN, io::stdin().lock(), &options)
                .map_err(|error| Error::reading_failed(STDIN, error))?;
            run.report(&document)?;
        }
    }
    run.finish()
}

fn read_list(list: &Path) -> Result<Vec<PathBuf>, Failure> {
    let text = if list == Path::new("-") {
        io::read_to_string(io::stdin())
    } else {
        fs::read_to_string(list)
    };
    let text = text.map_err(|error| Error::reading_failed(list, error))?;
    let lines = text.lines().filter(|line| !line.is_empty());
    Ok(lines.map(PathBuf::from).collect())
}

struct Run<'a> {
    reporter: Box<dyn Report + 'a>,
    summary: Summary,
    most: usize,
    /// What the run ends with, whatever the scenes are like.
    failure: Option<Failure>,
    /// The folders in which no scene has been found yet.
    empty_folders: Vec<usize>,
}

impl Run<'_> {
    fn add(&mut self, checked: Checked) -> Result<(), Failure> {
        let document = match checked {
            Checked::Document(file, document) => {
                self.empty_folders
                    .retain(|folder| Some(*folder) != file.folder);
                document
            }
            Checked::Unreadable(document, _) => {
                self.failure = self.failure.take().or(Some(Failure::Unreadable));
                document
            }
            Checked::Skipped(_) => {
                self.summary.skipped += 1;
                return Ok(());
            }
        };
        self.report(&document)
    }

    fn report(&mut self, document: &Document) -> Result<(), Failure> {
        let (diagnostics, suppressed) = limit(document.diagnostics(), self.most);
        let report = FileReport {
            file: document.name(),
            text: document.text(),
            diagnostics: &diagnostics,
            suppressed,
        };
        self.summary.count(&report);
        self.reporter.file(&report).map_err(Failure::stdout)?;
        for (file, text, faults) in set::faults(document) {
            let (diagnostics, suppressed) = limit(faults, self.most);
            let report = FileReport {
                file: &file,
                text,
                diagnostics: &diagnostics,
                suppressed,
            };
            // It is a part of the scene's file, not one of its own.
            let files = self.summary.files;
            self.summary.count(&report);
            self.summary.files = files;
            self.reporter.file(&report).map_err(Failure::stdout)?;
        }
        if set::leads_nowhere(document) {
            self.failure = self.failure.take().or(Some(Failure::Reported));
        }
        Ok(())
    }

    fn finish(self) -> Result<(), Failure> {
        self.reporter
            .finish(&self.summary)
            .map_err(Failure::stdout)?;
        let _ = writeln!(io::stderr(), "{}", self.summary.sentence());
        match self.failure {
            Some(failure) => Err(failure),
            None if self.summary.errors > 0 => Err(Failure::Scene),
            None => Ok(()),
        }
    }
}
