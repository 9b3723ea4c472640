//! `strahl validate`: every problem of every scene.

use std::{
    io::{self, BufWriter, Write},
    path::{Path, PathBuf},
    sync::Arc,
};

use strahl::{
    Diagnostic, Document, Error, ReadOptions, Syntax,
    diagnostic::Code,
    image_file::write_file,
    jobs::{Checked, Config, Configs, SceneFile, check_files, find_scenes, no_scene},
    parallel::{Cancel, Stage, in_order},
    report::{FileReport, OutputFormat, Report, Summary, limit, reporter},
    text::sanitize,
};

use super::{
    Failure,
    config::ConfigArgs,
    fmt::unified_diff,
    interrupt,
    levels::LevelArgs,
    params::Params,
    paths::{PathArgs, is_dash},
    render::source::{RowFaults, faults_of_row},
    scene::{self, STDIN, ThreadArgs},
    set::{self, SetArgs},
    words::one_of,
};

/// Report every problem of every scene
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
    /// Syntax of files with another ending
    #[arg(long, value_name = "SYNTAX", value_parser = scene::syntaxes())]
    input_format: Option<Syntax>,
    #[command(flatten)]
    threads: ThreadArgs,
    #[command(flatten)]
    tables: scene::TableArgs,
    #[command(flatten)]
    config: ConfigArgs,
    #[command(flatten)]
    set: SetArgs,
    /// Apply the cures that are certain, and write the files; comments are kept
    #[arg(long, conflicts_with_all = ["diff", "params", "settings"])]
    fix: bool,
    /// Only print the cures that are certain, as a unified diff; write nothing
    #[arg(long, conflicts_with_all = ["output_format", "params", "settings"])]
    diff: bool,
    /// Check the scene with each row of a table, .csv or .jsonl, as for `strahl render`
    #[arg(long, value_name = "TABLE")]
    params: Option<PathBuf>,
    #[command(flatten)]
    levels: LevelArgs,
}

/// How many rows of a table are checked or wait to be told of.
const AT_ONCE: usize = 64;
/// The most problems of one file that are printed.
const MOST: usize = 100;

pub(crate) fn run(args: Args) -> Result<(), Failure> {
    let paths = args.paths.all()?;
    let configs = args.config.configs();
    let first = paths.first().map(|path| configs.of(path)).transpose()?;
    let first = first.unwrap_or_default();
    let most = args.max_diagnostics.or(first.max_diagnostics());
    let most = most.unwrap_or(MOST);
    let options = |config: &Config| {
        let levels = args.levels.on(config.levels());
        let options = args.tables.options(config).levels(levels);
        let options = options.keep_text(args.params.is_some());
        // What is not told may still be cured.
        let options = match args.fix || args.diff {
            true => options,
            false => options.max_diagnostics(most),
        };
        let options = args.set.of(options);
        options.syntax(args.input_format)
    };
    let cancel = Cancel::new();
    if args.fix {
        interrupt::exit_on_signal(cancel.clone());
    }
    let format = args.output_format.or(first.output_format());
    let format = format.unwrap_or_default();
    let stdout = BufWriter::new(io::stdout().lock());
    let style = scene::style(&io::stdout());
    let mut run = Run {
        params: None,
        cures: match (args.fix, args.diff) {
            (true, _) => Cures::Write(cancel),
            (false, true) => Cures::Show,
            (false, false) => Cures::Tell,
        },
        cured: 0,
        threads: args.threads.count(),
        reporter: reporter(format, style, strahl::diagnostic::describe, stdout),
        summary: Summary::default(),
        most,
        failure: None,
        paths: &args.paths,
        has_told_columns: false,
        empty_folders: Vec::new(),
    };
    run.params = match args.params.as_deref().map(Params::read) {
        Some(read) => run.usable(read)?,
        None => None,
    };
    // What was named is read in the order in which it was named, with standard input among it.
    for paths in paths.split_inclusive(|path| is_dash(path)) {
        let (stdin, paths) = match paths.split_last() {
            Some((last, paths)) if is_dash(last) => (true, paths),
            _ => (false, paths),
        };
        let files = find_scenes(paths, &args.paths.exclude, &configs)?;
        let threads = args.threads.count();
        run.empty_folders = files.iter().filter_map(|file| file.folder).collect();
        run.empty_folders.dedup();
        for (config, files) in by_config(&files, &configs)? {
            let options = options(&config);
            check_files(files, &options, threads, |checked| {
                run.add(checked, &options)
            })?;
        }
        if let Some(folder) = run
            .empty_folders
            .first()
            .and_then(|index| paths.get(*index))
        {
            run.failure = run.failure.or(Some(no_scene(folder).into()));
        }
        if stdin {
            if args.fix {
                let message = "`--fix` writes files, and standard input is none; use `--diff`";
                return Err(Failure::Usage(message.to_owned()));
            }
            let options = options(&*configs.of("-")?);
            let document = Document::from_reader(STDIN, io::stdin().lock(), &options)
                .map_err(|error| Error::reading_failed(STDIN, error))?;
            run.report(&document)?;
        }
    }
    run.finish()
}

/// Files that follow each other and have one configuration.
type Group<'f> = (Arc<Config>, &'f [SceneFile]);

/// The files in groups of one configuration.
fn by_config<'f>(files: &'f [SceneFile], configs: &Configs) -> Result<Vec<Group<'f>>, Failure> {
    let all = files.iter().map(|file| configs.of(&file.path));
    let all: Vec<_> = all.collect::<Result<_, _>>()?;
    let mut rest = files;
    let mut groups = Vec::new();
    for same in all.chunk_by(Arc::ptr_eq) {
        let (these, others) = rest.split_at(same.len());
        rest = others;
        groups.extend(same.first().map(|config| (Arc::clone(config), these)));
    }
    Ok(groups)
}

/// What is done about faults whose cure is certain.
enum Cures {
    /// They are told.
    Tell,
    /// The changes are printed.
    Show,
    /// The files are written, unless that is cancelled.
    Write(Cancel),
}

struct Run<'a> {
    paths: &'a PathArgs,
    params: Option<Params>,
    cures: Cures,
    /// How many cures were found.
    cured: usize,
    threads: usize,
    reporter: Box<dyn Report + 'a>,
    summary: Summary,
    most: usize,
    /// What the run ends with, whatever the scenes are like.
    failure: Option<Failure>,
    /// Whether the columns of the table that are not used have been told.
    has_told_columns: bool,
    /// The folders in which no scene has been found yet.
    empty_folders: Vec<usize>,
}

impl Run<'_> {
    fn add(&mut self, checked: Checked, options: &ReadOptions) -> Result<(), Failure> {
        let document = match checked {
            Checked::Document(file, document) => {
                self.empty_folders
                    .retain(|folder| Some(*folder) != file.folder);
                self.cure(document, &file.path, options)?
            }
            Checked::Unreadable(document, _) => {
                self.failure = self.failure.take().or(Some(Failure::Unreadable));
                document
            }
            Checked::Skipped(file) => {
                self.paths.skip(&file.path);
                self.summary.skipped += 1;
                return Ok(());
            }
        };
        self.report(&document)
    }

    /// Writes the cures of a file that are certain, if that is wanted; what is left to report.
    fn cure(
        &mut self,
        document: Document,
        path: &Path,
        options: &ReadOptions,
    ) -> Result<Document, Failure> {
        let Cures::Write(cancel) = &self.cures else {
            return Ok(document);
        };
        let Some((fixed, count)) = document.fixed() else {
            return Ok(document);
        };
        write_file(path, fixed.as_bytes(), cancel)?;
        self.cured += count;
        Ok(Document::from_path_with(path, options)?)
    }

    /// Prints the cures of a scene that are certain, and counts what is wrong with it as it is.
    fn show_cures(&mut self, document: &Document) -> Result<(), Failure> {
        self.summary.count(&FileReport {
            diagnostics: document.diagnostics(),
            suppressed: document.suppressed(),
            ..FileReport::default()
        });
        let Some((fixed, count)) = document.fixed() else {
            return Ok(());
        };
        self.cured += count;
        super::print(&unified_diff(
            &sanitize(document.name()),
            document.text(),
            &fixed,
        ))
    }

    fn report(&mut self, document: &Document) -> Result<(), Failure> {
        if matches!(self.cures, Cures::Show) {
            return self.show_cures(document);
        }
        let timings = document.timings();
        let (diagnostics, suppressed) = limit(document.diagnostics(), self.most);
        let report = FileReport {
            file: document.name(),
            text: document.text(),
            diagnostics: &diagnostics,
            suppressed: suppressed + document.suppressed(),
            time: timings.of(Stage::Read) + timings.of(Stage::Check),
            ..FileReport::default()
        };
        self.summary.count(&report);
        self.reporter.file(&report).map_err(Failure::stdout)?;
        for (option, text, diagnostics) in set::faults(document) {
            let part = FileReport {
                file: document.name(),
                option: Some(&option),
                text,
                diagnostics,
                ..FileReport::default()
            };
            if scene::is_new(&part) {
                self.report_part(&part)?;
            }
        }
        if set::leads_nowhere(document) {
            self.failure = self.failure.take().or(Some(Failure::Reported));
        }
        self.report_rows(document)
    }

    /// Reports what is wrong with the scene once the rows of the table are set in it.
    fn report_rows(&mut self, document: &Document) -> Result<(), Failure> {
        let Some(params) = self.params.take().filter(|_| !document.has_errors()) else {
            return Ok(());
        };
        let columns = params.columns_of(document, None);
        // The same for all scenes but for what was probably meant.
        if !std::mem::replace(&mut self.has_told_columns, true) {
            for unused in &columns.unused {
                self.report_part(&unused.report())?;
            }
        }
        let check = |row| {
            let settings = params.settings(row, &columns, document.syntax())?;
            let set = document.with(settings);
            Ok(faults_of_row(&set, &params, row))
        };
        let threads = self.threads;
        let report = |faults| match self.usable(faults)?.flatten() {
            Some(faults) => self.report_row(&faults),
            None => Ok(()),
        };
        in_order(0..params.len(), threads, AT_ONCE, check, report)?;
        self.params = Some(params);
        Ok(())
    }

    /// What came of a table of values, if it can be used; if not, that is reported.
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
        self.failure = self.failure.take().or(Some(Failure::Reported));
        Ok(None)
    }

    fn report_row(&mut self, faults: &RowFaults) -> Result<(), Failure> {
        faults.all().try_for_each(|part| self.report_part(&part))
    }

    /// Reports faults of an option or a table, which belong to a scene that has been counted.
    fn report_part(&mut self, part: &FileReport<'_>) -> Result<(), Failure> {
        let (diagnostics, suppressed) = limit(part.diagnostics, self.most);
        let report = FileReport {
            diagnostics: &diagnostics,
            suppressed,
            ..*part
        };
        let files = self.summary.files;
        self.summary.count(&report);
        self.summary.files = files;
        self.reporter.file(&report).map_err(Failure::stdout)
    }

    fn finish(self) -> Result<(), Failure> {
        if !matches!(self.cures, Cures::Show) {
            self.reporter
                .finish(&self.summary)
                .map_err(Failure::stdout)?;
        }
        let cured = match (&self.cures, self.cured) {
            (_, 0) => String::new(),
            (Cures::Write(_), count) => format!(" ({count} fixed)"),
            (_, count) => format!(" ({count} can be fixed by `--fix`)"),
        };
        let _ = writeln!(io::stderr(), "{}{cured}", self.summary.sentence());
        match self.failure {
            Some(failure) => Err(failure),
            None if self.summary.errors > 0 => Err(Failure::Scene),
            None => Ok(()),
        }
    }
}
