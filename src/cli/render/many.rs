//! Drawing many pictures in one run.

use std::{
    collections::{BTreeSet, HashMap},
    path::Path,
    sync::{
        Mutex,
        atomic::{AtomicBool, AtomicU64},
    },
    time::Instant,
};

use strahl::{
    ErrorKind, RenderOptions,
    image_file::MovieFormat,
    parallel::{Cancel, Timings, in_order},
    scene::PartFindings,
};

use super::{
    draw::{Made, make_folder},
    items::Item,
    list::List,
    shared::Range,
    source::{Content, Source},
    summary::{Outcome, Summary},
};
use crate::cli::{
    failure::{self, Failure},
    params::Told,
    progress::Progress,
    record::{self, Failed, Line, Recorder, Records},
    render::args::Args,
    report, scene,
    threads::lock,
};

/// The maximum number of pictures being made or waiting to be reported: enough to keep all cores
/// busy, few enough to bound memory.
const AT_ONCE: usize = 64;

/// The steps of the bar for each picture.
pub(super) const STEPS: u64 = 1 << 20;

/// A run of many pictures, shared by all threads.
pub(super) struct Run<'a> {
    pub(super) args: &'a Args,
    pub(super) list: &'a List,
    /// The format of movies, if each file is a movie.
    pub(super) movie: Option<MovieFormat>,
    pub(super) sources: Vec<Source>,
    pub(super) records: Option<(Records, Recorder)>,
    pub(super) render: RenderOptions,
    pub(super) cancel: &'a Cancel,
    pub(super) progress: &'a Progress,
    pub(super) timings: Timings,
    pub(super) rays: AtomicU64,
    pub(super) geometries: AtomicU64,
    /// The parts whose diagnostics have been printed.
    printed_parts: Mutex<BTreeSet<String>>,
    /// The faults of the table that have been printed.
    told: Option<Mutex<Told>>,
    /// The ranges of the colors in the first row of each scene.
    pub(super) ranges: Mutex<HashMap<usize, Vec<Range>>>,
    /// True once a row has others.
    pub(super) ranges_differ: AtomicBool,
}

pub(super) fn run(args: &Args, start: Instant, cancel: &Cancel) -> Result<(), Failure> {
    let list = List::new(args)?;
    let movie = args.movie();
    match movie {
        Some(_) => {
            args.sampling.check_movie()?;
            args.draw.picture.check_movie()?;
        }
        None => args.draw.picture.check(list.format()?)?,
    }
    let items: Vec<&Item> = list.of_part().collect();
    let is_job = list.is_job() || args.resume || args.shard.is_some();
    let records = is_job
        .then(|| open_records(args, &list, &items))
        .transpose()?;
    let progress = args.draw.progress(items.len() as u64 * STEPS);
    let timings = Timings::new();
    let of_scene = |scene| Source::new(list.of_scene(scene).count() as u64);
    let run = Run {
        args,
        sources: (0..list.scenes.len()).map(of_scene).collect(),
        list: &list,
        movie,
        records,
        render: args.draw.options(cancel).timings(timings.clone()),
        cancel,
        progress: &progress,
        timings,
        rays: AtomicU64::new(0),
        geometries: AtomicU64::new(0),
        printed_parts: Mutex::default(),
        ranges: Mutex::default(),
        ranges_differ: AtomicBool::new(false),
        told: list
            .params
            .as_ref()
            .map(|params| Told::new(params, scene::MOST).into()),
    };
    let mut summary = Summary::new(list.summary.is_some());
    let made = |item| run.make(item, 1);
    let take = |made| run.take(made, &mut summary);
    let ended = in_order(items, args.draw.threads(), AT_ONCE, made, take);
    run.tell(|told| {
        if let Some(rest) = told.rest() {
            scene::print_report(&rest, args.draw.quiet);
        }
    });
    if run.ranges_differ.into_inner() && !args.draw.quiet {
        scene::print_warning(match args.fit_all {
            true => {
                "some colors of the rows have different ranges: --fit-all does not change those of \
                 parts, and of geometries that not all rows have; give one by `color_by: (range: …)`"
            }
            false => {
                "the colors of the rows have different ranges, each that of its own values: add \
                 --fit-all for one range, or give it by `color_by: (range: …)`"
            }
        });
    }
    drop(run.records);
    let (timings, rays) = (run.timings, run.rays.into_inner());
    let geometries = run.geometries.into_inner() as usize;
    drop(progress);
    let reported = list.summary.as_ref().map_or(Ok(()), |path| {
        report::write_text(path, &summary.json(&list)?, cancel)
    });
    if !args.draw.quiet && (list.items.len() > 1 || args.resume) {
        summary.print(start.elapsed());
    }
    args.draw.print_timings(start, &timings, rays, geometries);
    Failure::worst(reported, Failure::worst(ended, summary.failure()))
}

/// Returns the records of the folder, and a new one.
fn open_records(args: &Args, list: &List, items: &[&Item]) -> Result<(Records, Recorder), Failure> {
    let folder = match list.folder.as_os_str() {
        name if name.is_empty() => Path::new("."),
        _ => &list.folder,
    };
    if list.makes_folders {
        make_folder(folder)?;
    }
    let records = if args.resume {
        Records::read(folder)?
    } else {
        Records::default()
    };
    let names = items.iter().map(|item| list.name(item));
    let total = list.items.len() as u64;
    let plan = record::plan(list.shard, total, names.collect::<Result<_, _>>()?);
    Ok((records, Recorder::open(folder, &plan)?))
}

impl Run<'_> {
    /// Reports a picture that has been made, or makes it with all threads.
    fn take<'i>(&self, made: Made<'i>, summary: &mut Summary<'i>) -> Result<(), Failure> {
        let item = made.item;
        let mut made = match made.outcome {
            Ok(Outcome::Later) => self.make(item, self.args.draw.threads()),
            _ => made,
        };
        self.print_faults(&mut made);
        let outcome = match made.outcome {
            Ok(outcome) => outcome,
            Err(Failure::Library(error)) if stops(error.kind()) => {
                return Err(Failure::Library(error));
            }
            Err(failure) => {
                let is_new = summary.is_new(&failure);
                if let Some(message) = failure.message().filter(|_| is_new) {
                    let title = self.list.title(item);
                    let print = || failure::print_error(&format!("{title}: {message}"));
                    self.progress.beside(print);
                }
                Outcome::of_failure(&failure)
            }
        };
        if let Some((_, recorder)) = &self.records {
            let picture = self.list.name(item)?;
            let line = match &outcome {
                Outcome::Failed { message, .. } => {
                    let error = message.clone();
                    Some(Line::Failed(Failed { picture, error }))
                }
                Outcome::Skipped => Some(Line::Skipped(picture)),
                _ => None,
            };
            line.map_or(Ok(()), |line| recorder.write(&line))?;
        }
        if !matches!(outcome, Outcome::Drawn(_) | Outcome::Kept(_)) {
            self.progress.add(STEPS);
        }
        summary.add(item, outcome);
        Ok(())
    }

    /// Prints the diagnostics of a picture, and once those of its scene.
    fn print_faults(&self, made: &mut Made) {
        let quiet = self.args.draw.quiet;
        let is_first = self.list.of_scene(made.item.scene).next() == Some(made.item);
        if let Some(base) = made.base.as_deref().filter(|_| is_first) {
            self.progress.beside(|| {
                if let Some(findings) = &base.findings {
                    scene::print_findings_with(findings, quiet, |part| self.is_new(part));
                }
                if let Content::Document(_, columns, _) = &base.content {
                    for mut unused in columns.unused.clone() {
                        self.tell(|told| unused.keep_new(told));
                        scene::print_report(&unused.report(), quiet);
                    }
                }
                match &base.content {
                    Content::Nothing => {
                        self.args
                            .paths
                            .skip(&self.list.scenes[made.item.scene].path);
                    }
                    Content::Refused(failure) => failure.print(),
                    _ => {}
                }
            });
        }
        for faults in &mut made.faults {
            self.tell(|told| faults.keep_new(told));
            let all = || {
                faults
                    .all()
                    .for_each(|part| scene::print_report(&part, quiet))
            };
            self.progress.beside(all);
        }
    }

    /// Calls a function with the faults of the table that have been printed.
    fn tell(&self, tell: impl FnOnce(&mut Told)) {
        if let Some(told) = &self.told {
            tell(&mut lock(told));
        }
    }
    /// Returns true for a part that no scene before has named.
    fn is_new(&self, part: &PartFindings) -> bool {
        lock(&self.printed_parts).insert(part.name().to_owned())
    }
}

/// Returns true if continuing after such an error is pointless.
fn stops(kind: ErrorKind) -> bool {
    matches!(kind, ErrorKind::Unavailable | ErrorKind::Interrupted)
}
