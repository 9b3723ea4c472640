//! Many pictures in one run.

use std::{
    fs,
    path::{Path, PathBuf},
    sync::{
        Arc,
        atomic::{AtomicU64, Ordering},
    },
    time::Instant,
};

use strahl::{Cancel, ErrorKind, ReadOptions, RenderOptions, Scene, Syntax, Timings, in_order};

use super::{
    Args, is_same_file,
    list::{Item, List},
    source::{Base, Content, RowFaults, Source, with_row},
    summary::{Outcome, Summary},
};
use crate::cli::{
    Failure, cameras,
    progress::{Progress, When},
    record::{self, Done, Recorder, Records, Written},
    report,
    scene::{self, SceneArgs},
    timings::{self, Work},
};

/// How many pictures are made or wait to be told of: enough to keep all cores busy, few enough that
/// memory stays flat.
const AT_ONCE: usize = 64;

/// A picture with so many samples in all is drawn by all threads together.
const LARGE: u64 = 1 << 22;

/// How the bar counts: so many steps for each picture.
const STEPS: u64 = 1 << 20;

/// What became of a picture, and what there is to say about it.
struct Made {
    number: u64,
    base: Option<Arc<Base>>,
    faults: Option<RowFaults>,
    outcome: Result<Outcome, Failure>,
}

/// Who draws a picture.
#[derive(Clone, Copy, PartialEq, Eq)]
enum By {
    /// One thread among others, which leaves what is large to all of them.
    One,
    All,
}

struct Run<'a> {
    args: &'a Args,
    list: &'a List,
    sources: Vec<Source>,
    records: Option<(Records, Recorder)>,
    read: ReadOptions,
    render: RenderOptions,
    cancel: &'a Cancel,
    progress: &'a Progress,
    timings: Timings,
    rays: AtomicU64,
    geometries: AtomicU64,
}

pub(super) fn run(args: &Args, start: Instant, cancel: &Cancel) -> Result<(), Failure> {
    let list = List::new(args)?;
    args.picture.check(list.format()?)?;
    let numbers: Vec<u64> = list.numbers().collect();
    let is_job = list.len() > 1 || args.cameras.is_all() || args.resume || args.shard.is_some();
    let records = is_job
        .then(|| open_records(args, &list, &numbers))
        .transpose()?;
    let when = if args.quiet {
        When::Never
    } else {
        args.progress
    };
    let progress = Progress::new(numbers.len() as u64 * STEPS, when);
    let timings = Timings::new();
    let of_scene = |scene| Source::new(list.of_scene(scene).count() as u64);
    let run = Run {
        args,
        sources: (0..list.scenes.len()).map(of_scene).collect(),
        list: &list,
        records,
        read: args.set.of(args.tables.options()),
        render: args
            .picture
            .options()
            .isa(args.simd)
            .cancel(cancel.clone())
            .timings(timings.clone()),
        cancel,
        progress: &progress,
        timings,
        rays: AtomicU64::new(0),
        geometries: AtomicU64::new(0),
    };
    let mut summary = Summary::new(list.summary.is_some());
    let made = |number| run.make(number, By::One);
    let take = |made| run.take(made, &mut summary);
    let ended = in_order(numbers, args.threads(), AT_ONCE, made, take);
    drop(run.records);
    let (timings, rays) = (run.timings, run.rays.into_inner());
    let geometries = run.geometries.into_inner() as usize;
    drop(progress);
    if let Some(path) = &list.summary {
        let json = summary.json(&list);
        let json = json.map_err(|error| Failure::Usage(error.to_string()))?;
        report::write_text(path, &json, cancel)?;
    }
    if is_job && !args.quiet && (list.len() > 1 || args.resume) {
        summary.print(start.elapsed());
    }
    if let Some(format) = args.timings {
        let work = Work {
            start,
            rays,
            geometries,
            threads: RenderOptions::new().threads(args.threads()).thread_count(),
        };
        timings::print(format, &timings, &work);
    }
    Failure::worst(ended, summary.failure())
}

/// The records of the folder, and a new one.
fn open_records(args: &Args, list: &List, numbers: &[u64]) -> Result<(Records, Recorder), Failure> {
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
    let names = numbers.iter().map(|number| list.name(list.item(*number)));
    let plan = record::plan(list.shard, list.len(), names.collect::<Result<_, _>>()?);
    Ok((records, Recorder::open(folder, &plan)?))
}

fn make_folder(folder: &Path) -> Result<(), Failure> {
    let made = fs::create_dir_all(folder);
    made.map_err(|error| strahl::Error::writing_failed(folder, error).into())
}

impl Run<'_> {
    /// Makes a picture, if so many threads may.
    fn make(&self, number: u64, by: By) -> Made {
        let item = self.list.item(number);
        let mut made = Made {
            number,
            base: None,
            faults: None,
            outcome: Ok(Outcome::Later),
        };
        let Some(source) = self.sources.get(item.scene) else {
            return made;
        };
        if let Some(base) = self.base(source, item, by) {
            made.outcome = self.outcome(&base, item, by, &mut made.faults);
            made.base = Some(base);
        }
        if !matches!(made.outcome, Ok(Outcome::Later)) {
            source.done();
        }
        made
    }

    fn base(&self, source: &Source, item: Item, by: By) -> Option<Arc<Base>> {
        let file = self.list.scenes.get(item.scene)?;
        let threads = if by == By::All {
            self.args.threads()
        } else {
            1
        };
        let read = || {
            let scene = SceneArgs {
                scene: file.path.clone(),
                input_format: self.args.input_format,
            };
            let options = self.read.clone().threads(threads);
            let options = options.syntax(self.args.input_format.map(Syntax::from));
            let base = Base::of(file, scene.read(options), self.list);
            match &base.content {
                Content::Scene(scene) => self.timings.include(scene.timings()),
                Content::Document(document, _) => self.timings.include(document.timings()),
                _ => {}
            }
            base
        };
        match by {
            By::One if self.args.threads() != 1 => source.if_small(file, read),
            _ => Some(source.get(read)),
        }
    }

    fn outcome(
        &self,
        base: &Base,
        item: Item,
        by: By,
        faults: &mut Option<RowFaults>,
    ) -> Result<Outcome, Failure> {
        let shown = match &base.content {
            Content::Nothing => return Ok(Outcome::Skipped),
            Content::Unreadable(error) => return Ok(Outcome::failed(2, error)),
            Content::Refused(failure) => {
                let told = failure.message();
                let told = told.unwrap_or_else(|| "the scene has errors".to_owned());
                return Ok(Outcome::failed(failure.status(), told));
            }
            Content::Scene(scene) => self.at_frame(scene, item)?,
            Content::Document(document, columns) => {
                let (scene, found) = with_row(self.list, item, document, columns);
                *faults = found;
                let scene = scene?;
                self.timings.include(scene.timings());
                self.at_frame(&scene, item)?
            }
        };
        let samples = u64::from(self.args.picture.samples(shown.samples()).count());
        let pixels = self.args.picture.pixels(shown.size());
        let is_large = pixels.saturating_mul(samples) >= LARGE;
        if by == By::One && is_large && self.args.threads() != 1 {
            return Ok(Outcome::Later);
        }
        self.draw(shown, base, item, by)
    }

    fn at_frame(&self, scene: &Scene, item: Item) -> Result<Scene, Failure> {
        Ok(match item.frame {
            Some(frame) => scene.frame(frame)?,
            None => scene.clone(),
        })
    }

    /// Draws a picture by each of its cameras, unless it is there.
    fn draw(&self, shown: Scene, base: &Base, item: Item, by: By) -> Result<Outcome, Failure> {
        let name = self.list.name(item)?;
        let names = self.args.cameras.names(&shown)?;
        let pixels = self.args.picture.pixels(shown.size());
        let samples = u64::from(self.args.picture.samples(shown.samples()).count());
        let mut seen = Vec::new();
        let mut scene = shown;
        for camera in names {
            if let Some(name) = &camera {
                scene = cameras::see_by(scene, name)?;
            }
            let file = cameras::name_of(&name, camera.as_deref());
            seen.push((scene.clone(), file, camera));
        }
        let targets = seen.iter().map(|(_, file, _)| self.list.folder.join(file));
        self.check_targets(&targets.collect::<Vec<_>>(), base)?;
        let hashes = seen
            .iter()
            .map(|(scene, file, _)| scene.hash(file, &self.render));
        let hash = hashes.collect::<Result<Vec<_>, _>>()?.join("+");
        if let Some((records, _)) = &self.records {
            let mut done = records.done(&name, Some(&hash));
            let is_whole = |done: &&Done| {
                let mut files = done.files.iter();
                !done.files.is_empty() && files.all(|file| file.is_there(&self.list.folder))
            };
            if let Some(done) = done.find(is_whole) {
                self.progress.add(STEPS);
                return Ok(Outcome::Kept(done.clone()));
            }
        }
        let threads = if by == By::All {
            self.args.threads()
        } else {
            1
        };
        let steps = STEPS / (seen.len() as u64).max(1);
        let mut files = Vec::new();
        for (scene, file, camera) in &seen {
            let sink = self.progress.sink();
            // In small steps, of which together none is lost.
            let drawn = AtomicU64::new(0);
            let step = move |count| {
                let before = drawn.fetch_add(count, Ordering::Relaxed);
                let at = |pixel: u64| {
                    (u128::from(pixel) * u128::from(steps) / u128::from(pixels.max(1))) as u64
                };
                sink(at(before + count) - at(before));
            };
            let options = self.render.clone().threads(threads).on_progress(step);
            let target = self.list.folder.join(file);
            scene.save_with(&target, &options)?;
            if let Some(report) = self.list.report(item)? {
                let report = cameras::name_of(&report, camera.as_deref());
                let image = self.args.picture.image(scene.size(), camera.as_deref());
                let options = self.render.clone().threads(threads);
                report::write(Path::new(&report), scene, &image, &options, self.cancel)?;
            }
            for (path, _) in options.files(Path::new(file))? {
                files.push(path.to_string_lossy().into_owned());
            }
            self.rays.fetch_add(pixels * samples, Ordering::Relaxed);
            let geometries = scene.world().geometries().len() as u64;
            self.geometries.fetch_max(geometries, Ordering::Relaxed);
        }
        let done = Done {
            picture: name,
            hash,
            files: match &self.records {
                Some(_) => self.written(&files)?,
                None => Vec::new(),
            },
        };
        if let Some((_, recorder)) = &self.records {
            self.record(recorder.done(&done))?;
        }
        Ok(Outcome::Drawn(done))
    }

    /// Refuses pictures in the place of each other, of a folder or of what they are made of, and
    /// makes their folders.
    fn check_targets(&self, targets: &[PathBuf], base: &Base) -> Result<(), Failure> {
        for (index, target) in targets.iter().enumerate() {
            let is_it = |other: &&PathBuf| is_same_file(target, other);
            let before = targets.iter().take(index).find(is_it);
            let table = base.tables.iter().find(is_it);
            let why = match (before, table) {
                _ if target.is_dir() => Some("is a folder, not a file".to_owned()),
                (Some(other), _) => Some(format!("is the same file as {}", other.display())),
                (_, Some(table)) => Some(format!(
                    "the picture would overwrite a table, {}",
                    table.display()
                )),
                _ => None,
            };
            if let Some(why) = why {
                return Err(Failure::Usage(format!("{}: {why}", target.display())));
            }
            if let Some(folder) = target.parent().filter(|_| self.list.makes_folders)
                && !folder.is_dir()
            {
                make_folder(folder)?;
            }
        }
        Ok(())
    }

    /// What stands in files that have just been written.
    fn written(&self, files: &[String]) -> Result<Vec<Written>, Failure> {
        let written = files.iter().map(|file| {
            let path: PathBuf = self.list.folder.join(file);
            let written = Written::of(&self.list.folder, file);
            written.map_err(|error| strahl::Error::reading_failed(path, error).into())
        });
        written.collect()
    }

    fn record(&self, written: std::io::Result<()>) -> Result<(), Failure> {
        written.map_err(|error| {
            let folder = self.list.folder.join(record::FOLDER);
            strahl::Error::writing_failed(folder, error).into()
        })
    }

    /// Tells of a picture that has been made, or makes it by all threads.
    fn take(&self, made: Made, summary: &mut Summary) -> Result<(), Failure> {
        let made = match made.outcome {
            Ok(Outcome::Later) => self.make(made.number, By::All),
            _ => made,
        };
        let item = self.list.item(made.number);
        self.tell(&made, item);
        let outcome = match made.outcome {
            Ok(outcome) => outcome,
            Err(Failure::Library(error)) if stops(error.kind()) => {
                return Err(Failure::Library(error));
            }
            Err(failure) => {
                let told = failure.message();
                if let Some(told) = &told {
                    let title = self.list.title(item);
                    let print = || scene::print_error(&format!("{title}: {told}"));
                    self.progress.beside(print);
                }
                let told = told.unwrap_or_else(|| "the scene has errors".to_owned());
                Outcome::failed(failure.status(), told)
            }
        };
        if let Some((_, recorder)) = &self.records {
            let name = self.list.name(item)?;
            self.record(match &outcome {
                Outcome::Failed { message, .. } => recorder.failed(&name, message),
                Outcome::Skipped => recorder.skipped(&name),
                _ => Ok(()),
            })?;
        }
        if !matches!(outcome, Outcome::Drawn(_) | Outcome::Kept(_)) {
            self.progress.add(STEPS);
        }
        summary.add(made.number, outcome);
        Ok(())
    }

    /// Prints what there is to say about a picture; about its scene, once.
    fn tell(&self, made: &Made, item: Item) {
        let quiet = self.args.quiet;
        let is_first = self.list.of_scene(item.scene).next() == Some(made.number);
        if let Some(base) = made.base.as_deref().filter(|_| is_first) {
            self.progress.beside(|| {
                if let Some(findings) = &base.findings {
                    scene::print_findings(findings, quiet);
                }
                match &base.content {
                    Content::Unreadable(error) => scene::print_error(&error.to_string()),
                    Content::Refused(failure) => failure.print(),
                    _ => {}
                }
            });
        }
        if let Some(faults) = &made.faults {
            self.progress.beside(|| faults.print(quiet));
        }
    }
}

/// Whether there is no sense in going on after such an error.
fn stops(kind: ErrorKind) -> bool {
    matches!(kind, ErrorKind::Unavailable | ErrorKind::Interrupted)
}
