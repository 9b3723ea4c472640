//! `strahl validate`: all problems of scenes.

mod parts;
mod watch;

use std::{
    io::{self, BufWriter, Write},
    path::{Path, PathBuf},
    sync::Arc,
};

use strahl::{
    Diagnostic, Document, ReadOptions, Syntax,
    diagnostic::Code,
    image_file::replace_file,
    jobs::{Checked, Config, Configs, SceneFile, check_files, find_scenes, no_scene},
    parallel::{Cancel, Stage, in_order},
    report::{FileReport, OutputFormat, Report, Summary, limit, reporter},
};

use self::parts::Parts;
use super::{
    config::ConfigArgs,
    failure::Failure,
    fmt::print_diff,
    interrupt,
    levels::LevelArgs,
    params::{Params, Told},
    paths::{PathArgs, is_dash},
    render::source::{RowFaults, faults_of_row},
    rounds::WatchedFiles,
    scene::{self, StdinArgs, ThreadArgs},
    set::{self, SetArgs},
    words::one_of,
};

/// Report every problem in every scene
#[derive(clap::Args)]
#[group(skip)]
pub(crate) struct Args {
    #[command(flatten)]
    paths: PathArgs,
    /// Format of the report on standard output; default: human
    #[arg(
        long,
        value_name = "FORMAT",
        value_parser = one_of(OutputFormat::ALL.iter().copied(), |format| format.name().into())
    )]
    output_format: Option<OutputFormat>,
    /// Maximum number of problems to print per file, errors first; default: 100
    #[arg(long, value_name = "N")]
    max_diagnostics: Option<usize>,
    /// Syntax of files with another extension
    #[arg(long, value_name = "SYNTAX", value_parser = scene::syntaxes())]
    input_format: Option<Syntax>,
    #[command(flatten)]
    stdin: StdinArgs,
    #[command(flatten)]
    threads: ThreadArgs,
    #[command(flatten)]
    tables: scene::TableArgs,
    #[command(flatten)]
    config: ConfigArgs,
    #[command(flatten)]
    set: SetArgs,
    /// Apply the safe fixes and write the files; comments are kept
    #[arg(long, conflicts_with_all = ["diff", "params", "settings"])]
    fix: bool,
    /// Only print the safe fixes, as a unified diff; write nothing
    #[arg(long, conflicts_with_all = ["output_format", "params", "settings"])]
    diff: bool,
    /// Check the scene with each row of a table, .csv or .jsonl, as for `strahl render`
    #[arg(long, value_name = "TABLE")]
    params: Option<PathBuf>,
    #[command(flatten)]
    levels: LevelArgs,
    /// Report again after each change of a scene, of a table that one names, and of `strahl.toml`
    #[arg(long, conflicts_with_all = ["fix", "diff"])]
    watch: bool,
}

/// The maximum number of table rows that are being checked or wait to be reported.
const AT_ONCE: usize = 64;
/// The maximum number of problems printed per file.
const MOST: usize = 100;

pub(crate) fn run(args: Args) -> Result<(), Failure> {
    if args.watch {
        watch::run(&args)
    } else {
        check(&args, None)
    }
}

/// Checks all scenes and prints a report; `files` are those on the disk, unless they are watched.
fn check(args: &Args, files: Option<WatchedFiles>) -> Result<(), Failure> {
    let paths = args.paths.all()?;
    let configs = args.config.configs();
    let first = paths.first().map(|path| configs.of(path)).transpose()?;
    let mut run = Run::new(args, files, &first.unwrap_or_default())?;
    // Paths are checked in the order of the command line, including standard input.
    for paths in paths.split_inclusive(|path| is_dash(path)) {
        match paths.split_last() {
            Some((last, paths)) if is_dash(last) => {
                run.check(paths, &configs)?;
                run.check_stdin(&configs)?;
            }
            _ => run.check(paths, &configs)?,
        }
    }
    run.finish()
}

struct Run<'a> {
    args: &'a Args,
    files: Option<WatchedFiles>,
    params: Option<Params>,
    parts: Parts,
    cancel: Cancel,
    /// The number of fixes that were found.
    fixed: usize,
    reporter: Box<dyn Report + 'a>,
    summary: Summary,
    most: usize,
    /// The failure that the run ends with, regardless of the scenes.
    failure: Option<Failure>,
    /// True once the reader of the report has left. The rest is still checked, for the exit status.
    is_closed: bool,
    /// The faults of the table that have been reported.
    told: Option<Told>,
    /// The folders in which no scene has been found yet.
    empty_folders: Vec<usize>,
}

impl<'a> Run<'a> {
    fn new(args: &'a Args, files: Option<WatchedFiles>, first: &Config) -> Result<Self, Failure> {
        let format = args.output_format.or(first.output_format());
        let format = format.unwrap_or_default();
        if args.watch && matches!(format, OutputFormat::Sarif | OutputFormat::Junit) {
            let name = format.name();
            return Err(Failure::usage(format!(
                "{name} is one document, for one run; with --watch use human, short, json or jsonl"
            )));
        }
        let stdout = BufWriter::new(io::stdout().lock());
        let style = scene::style(&io::stdout());
        let describe = strahl::diagnostic::describe;
        let most = args.max_diagnostics.or(first.max_diagnostics());
        let mut run = Self {
            args,
            files,
            params: None,
            parts: Parts::default(),
            cancel: match args.fix {
                true => interrupt::cancel_on_signal(),
                false => Cancel::new(),
            },
            fixed: 0,
            reporter: reporter(format, style, describe, stdout),
            summary: Summary::default(),
            most: most.unwrap_or(MOST),
            failure: None,
            is_closed: false,
            told: None,
            empty_folders: Vec::new(),
        };
        if let Some(path) = &args.params {
            run.params = run.usable(Params::read(path))?;
            run.told = run
                .params
                .as_ref()
                .map(|params| Told::new(params, run.most));
        }
        Ok(run)
    }

    fn options(&self, config: &Config) -> ReadOptions {
        let args = self.args;
        let options = args.tables.options(config);
        let options = options.levels(args.levels.on(config.levels()));
        let options = options.keep_text(args.params.is_some());
        // Faults that are not printed may still be fixed.
        let options = match args.fix || args.diff {
            true => options,
            false => options.max_diagnostics(self.most),
        };
        let options = args.set.of(options).syntax(args.input_format);
        match &self.files {
            Some(files) => options.files(files.clone()),
            None => options,
        }
    }

    fn fail(&mut self, failure: Failure) {
        self.failure.get_or_insert(failure);
    }

    fn check(&mut self, paths: &[PathBuf], configs: &Configs) -> Result<(), Failure> {
        let files = find_scenes(paths, &self.args.paths.exclude, configs)?;
        self.empty_folders = files.iter().filter_map(|file| file.folder).collect();
        self.empty_folders.dedup();
        self.parts.list(&files);
        let of_files = files.iter().map(|file| configs.of_file(&file.path));
        let of_files: Vec<_> = of_files.collect::<Result<_, _>>()?;
        let mut rest = &*files;
        for same in of_files.chunk_by(Arc::ptr_eq) {
            let (files, others) = rest.split_at(same.len());
            rest = others;
            let options = self.options(&same[0]);
            check_files(
                files,
                &options,
                self.args.threads.count(),
                |checked| match checked {
                    Checked::Document(file, document) if self.waits(&document) => {
                        self.wait(file, document, &options)
                    }
                    checked => self.add(checked, &options),
                },
            )?;
        }
        for (file, options) in self.parts.take_waiting() {
            check_files(&[file], &options, self.args.threads.count(), |checked| {
                self.add(checked, &options)
            })?;
        }
        let mut empty = self.empty_folders.iter();
        if let Some(folder) = empty.next().and_then(|index| paths.get(*index)) {
            self.fail(no_scene(folder).into());
        }
        Ok(())
    }

    fn check_stdin(&mut self, configs: &Configs) -> Result<(), Failure> {
        if self.args.fix {
            let message = "`--fix` cannot write standard input; use `--diff`";
            return Err(Failure::usage(message));
        }
        let stdin = &self.args.stdin;
        let options = self.options(&*configs.of(stdin.path())?);
        let document = stdin.read(options, self.args.input_format)?;
        self.report(document)
    }

    /// Returns true if a scene is to be checked at the end: if it lacks a camera, which a part does not
    /// need, or if `--fix` may change its parts until then.
    fn waits(&mut self, document: &Document) -> bool {
        (self.args.fix && self.parts.note(document)) || document.lacks_a_camera()
    }

    /// Keeps a scene for the end. Its fixes are applied now: it may be a part of another.
    fn wait(
        &mut self,
        file: SceneFile,
        mut document: Document,
        options: &ReadOptions,
    ) -> Result<(), Failure> {
        self.write_fixes(&mut document, &file.path)?;
        self.parts.wait(file, options);
        Ok(())
    }

    fn add(&mut self, checked: Checked, options: &ReadOptions) -> Result<(), Failure> {
        let document = match checked {
            Checked::Document(file, document) => {
                self.empty_folders
                    .retain(|folder| Some(*folder) != file.folder);
                self.fix(document, &file.path, options)?
            }
            Checked::Unreadable(document, _) => {
                self.fail(Failure::Reported);
                document
            }
            Checked::Skipped(file) => {
                self.args.paths.skip(&file.path);
                self.summary.skipped += 1;
                return Ok(());
            }
        };
        self.report(document)
    }

    /// Applies the safe fixes of a file with `--fix`, and returns what is left to report.
    fn fix(
        &mut self,
        mut document: Document,
        path: &Path,
        options: &ReadOptions,
    ) -> Result<Document, Failure> {
        match self.write_fixes(&mut document, path)? {
            true => Ok(Document::from_path_with(path, options)?),
            false => Ok(document),
        }
    }

    /// Writes a file with its safe fixes applied, with `--fix`. Returns true if it has changed.
    fn write_fixes(&mut self, document: &mut Document, path: &Path) -> Result<bool, Failure> {
        let fixed = self.args.fix.then(|| document.fixed()).flatten();
        let Some((fixed, count)) = fixed else {
            return Ok(false);
        };
        let text = document.text().as_bytes();
        replace_file(path, text, fixed.as_bytes(), &self.cancel)?;
        self.fixed += count;
        Ok(true)
    }

    /// Prints the safe fixes of a scene, and counts its faults before them.
    fn show_fixes(&mut self, mut document: Document) -> Result<(), Failure> {
        self.summary.count(&scene::findings(&document));
        let files = self.summary.files;
        for part in document.parts() {
            if self.parts.is_new(part) {
                self.summary.count(&scene::findings_of_part(part));
            }
        }
        self.summary.files = files;
        let Some((fixed, count)) = document.fixed() else {
            return Ok(());
        };
        self.fixed += count;
        self.print(|_| print_diff(document, &fixed))
    }

    /// Prints something, unless the reader of the report has left.
    fn print(
        &mut self,
        print: impl FnOnce(&mut dyn Report) -> Result<(), Failure>,
    ) -> Result<(), Failure> {
        if self.is_closed {
            return Ok(());
        }
        match print(&mut *self.reporter) {
            Err(Failure::Closed { .. }) => self.is_closed = true,
            printed => return printed,
        }
        Ok(())
    }

    fn report(&mut self, document: Document) -> Result<(), Failure> {
        if self.args.diff {
            return self.show_fixes(document);
        }
        let document = &document;
        let timings = document.timings();
        self.report_file(&FileReport {
            time: timings.of(Stage::Read) + timings.of(Stage::Check),
            ..scene::findings(document)
        })?;
        for part in document.parts() {
            if self.parts.is_new(part) {
                self.report_part(&scene::findings_of_part(part))?;
            }
        }
        set::faults(document, |part| match scene::is_new(part) {
            true => self.report_part(part),
            false => Ok(()),
        })?;
        if set::leads_nowhere(document) {
            self.fail(Failure::Reported);
        }
        self.report_rows(document)
    }

    /// Reports the faults of the scene with each row of the table.
    fn report_rows(&mut self, document: &Document) -> Result<(), Failure> {
        let Some(params) = self.params.take().filter(|_| !document.has_errors()) else {
            return Ok(());
        };
        let mut told = self.told.take();
        let columns = params.columns_of(document, None);
        for mut unused in columns.unused.clone() {
            told.iter_mut().for_each(|told| unused.keep_new(told));
            self.report_part(&unused.report())?;
        }
        let check = |row| {
            let settings = params.settings(row, &columns)?;
            let set = document.with(settings);
            Ok(faults_of_row(&set, &params, row))
        };
        let threads = self.args.threads.count();
        let report =
            |faults: Result<Option<RowFaults>, Failure>| match self.usable(faults)?.flatten() {
                Some(mut faults) => {
                    told.iter_mut().for_each(|told| faults.keep_new(told));
                    faults.all().try_for_each(|part| self.report_part(&part))
                }
                None => Ok(()),
            };
        in_order(0..params.len(), threads, AT_ONCE, check, report)?;
        self.params = Some(params);
        self.told = told;
        Ok(())
    }

    /// Returns the value read from a table; `None` if the table is unusable, which is reported.
    fn usable<T>(&mut self, read: Result<T, Failure>) -> Result<Option<T>, Failure> {
        let failure = match read {
            Ok(read) => return Ok(Some(read)),
            Err(failure) => failure,
        };
        match &failure {
            Failure::Table(faults) => self.report_part(&faults.report())?,
            Failure::Library(error) => self.report_part(&FileReport {
                file: &error.path().unwrap_or(Path::new("")).display().to_string(),
                diagnostics: &[Diagnostic::new(Code::Unreadable, 0..0, error.cause())],
                ..FileReport::default()
            })?,
            _ => return Err(failure),
        }
        self.fail(Failure::Reported);
        Ok(None)
    }

    /// Counts and reports a file.
    fn report_file(&mut self, file: &FileReport<'_>) -> Result<(), Failure> {
        let (diagnostics, suppressed) = limit(file.diagnostics, self.most);
        let report = FileReport {
            diagnostics: &diagnostics,
            suppressed: suppressed + file.suppressed,
            ..*file
        };
        self.summary.count(&report);
        self.print(|reporter| reporter.file(&report).map_err(Failure::stdout))
    }

    /// Reports faults of a part, an option or a table that belong to a scene already counted.
    fn report_part(&mut self, part: &FileReport<'_>) -> Result<(), Failure> {
        let files = self.summary.files;
        let reported = self.report_file(part);
        self.summary.files = files;
        reported
    }

    fn finish(mut self) -> Result<(), Failure> {
        if let Some(told) = self.told.take()
            && let Some(rest) = told.rest()
        {
            self.report_part(&rest)?;
        }
        let mut is_closed = self.is_closed;
        if !self.args.diff && !is_closed {
            match self.reporter.finish(&self.summary).map_err(Failure::stdout) {
                Err(Failure::Closed { .. }) => is_closed = true,
                finished => finished?,
            }
        }
        let fixed = match self.fixed {
            0 => String::new(),
            count if self.args.fix => format!(" ({count} fixed)"),
            count => format!(" ({count} can be fixed by `--fix`)"),
        };
        let _ = writeln!(io::stderr(), "{}{fixed}", self.summary.sentence());
        let failure = match self.failure {
            None if self.summary.errors > 0 => Some(Failure::Found),
            failure => failure,
        };
        if is_closed {
            let status = failure.as_ref().map_or(0, Failure::status);
            failure.iter().for_each(Failure::print);
            return Err(Failure::Closed { status });
        }
        failure.map_or(Ok(()), Err)
    }
}
