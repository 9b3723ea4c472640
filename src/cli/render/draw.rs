//! Drawing one of many pictures.

use std::{
    fs, io,
    path::{Path, PathBuf},
    sync::{
        Arc,
        atomic::{AtomicU64, Ordering},
    },
};

use strahl::{Error, Scene};

use super::{
    items::Item,
    many::{Run, STEPS},
    movie::Movie,
    series::Series,
    shared::{self, Shared},
    source::{Base, Content, RowFaults, Source, with_row},
    summary::Outcome,
};
use crate::cli::{
    cameras,
    failure::Failure,
    paths::{is_dash, is_same},
    record::{Done, Line, Written},
    report,
    threads::lock,
};

/// The total number of samples from which all threads draw a picture together.
const LARGE: u64 = 1 << 22;

/// The outcome of a picture, with its diagnostics.
pub(super) struct Made<'a> {
    pub(super) item: &'a Item,
    pub(super) base: Option<Arc<Base>>,
    pub(super) faults: Vec<RowFaults>,
    pub(super) outcome: Result<Outcome, Failure>,
}

/// The view of one camera, and the name of its picture.
struct NamedView<'b> {
    scene: Scene,
    file: String,
    camera: Option<String>,
    rows: OtherRows<'b>,
}

/// What a picture has in common with other rows of a table.
#[derive(Clone, Copy, Default)]
struct OtherRows<'b> {
    /// The frames, if they are the rows.
    series: Option<Series<'b>>,
    /// The rows that it is seen together with.
    seen_with: Option<&'b Shared>,
}

impl Run<'_> {
    /// Makes a picture with this many threads. A single one of several leaves large pictures and
    /// scenes to all of them together.
    pub(super) fn make<'i>(&self, item: &'i Item, threads: usize) -> Made<'i> {
        let source = &self.sources[item.scene];
        let mut made = Made {
            item,
            base: None,
            faults: Vec::new(),
            outcome: Ok(Outcome::Later),
        };
        if let Some(base) = self.base(source, item, threads) {
            made.outcome = self.outcome(&base, item, threads, &mut made.faults);
            made.base = Some(base);
        }
        if !matches!(made.outcome, Ok(Outcome::Later)) {
            source.done();
        }
        made
    }

    fn base(&self, source: &Source, item: &Item, threads: usize) -> Option<Arc<Base>> {
        let file = &self.list.scenes[item.scene];
        let read = || {
            let read = || self.args.read(&file.path, &self.list.configs, threads);
            let read = self.list.take_read().map_or_else(read, Ok);
            let base = Base::of(file, read, self.list);
            match &base.content {
                Content::Scene(scene) => self.timings.include(scene.timings()),
                Content::Document(document, ..) => self.timings.include(document.timings()),
                _ => {}
            }
            base
        };
        match self.is_all(threads) {
            true => Some(source.get(read)),
            false => source.if_small(file, read),
        }
    }

    fn outcome(
        &self,
        base: &Base,
        item: &Item,
        threads: usize,
        faults: &mut Vec<RowFaults>,
    ) -> Result<Outcome, Failure> {
        let mut others = OtherRows::default();
        let shown = match &base.content {
            Content::Nothing => return Ok(Outcome::Skipped),
            Content::Refused(failure) => return Ok(Outcome::of_failure(failure)),
            Content::Scene(scene) => self.at_frame(scene, item)?,
            // The rows are read by all threads.
            Content::Document(..) if self.list.is_series && !self.is_all(threads) => {
                return Ok(Outcome::Later);
            }
            Content::Document(document, columns, shared) => {
                others.seen_with = shared.as_ref();
                let (scene, found) = match item.row {
                    Some(row) => {
                        let (scene, faults) = with_row(self.list, row, document, columns);
                        (scene, faults.into_iter().collect())
                    }
                    None => {
                        let rows = Series::checked(self.list, document, columns, threads);
                        let ranges_differ = rows.ranges_differ;
                        self.ranges_differ
                            .fetch_or(ranges_differ, Ordering::Relaxed);
                        others.series = rows.series;
                        (rows.first, rows.faults)
                    }
                };
                *faults = found;
                let scene = scene?;
                self.note_ranges(item, &scene);
                self.timings.include(scene.timings());
                self.at_frame(&scene, item)?
            }
        };
        let samples = u64::from(self.args.draw.picture.samples(shown.samples()).count());
        if !self.is_all(threads) {
            let movie = self.movie(&shown, None, others)?;
            let pixels = self.pixels(&shown, movie.as_ref());
            let has_limit = self.args.sampling.time_limit().is_some();
            if has_limit || pixels.saturating_mul(samples) >= LARGE {
                return Ok(Outcome::Later);
            }
        }
        self.draw(shown, others, base, item, threads)
    }

    fn at_frame(&self, scene: &Scene, item: &Item) -> Result<Scene, Failure> {
        Ok(match item.frame {
            Some(frame) => scene.frame(frame)?,
            None => scene.clone(),
        })
    }

    /// Draws a picture by each of its cameras, unless it exists already.
    fn draw(
        &self,
        shown: Scene,
        others: OtherRows,
        base: &Base,
        item: &Item,
        threads: usize,
    ) -> Result<Outcome, Failure> {
        let name = self.list.name(item)?;
        let views = self.views(shown, others, item, &name)?;
        let targets = views.iter().map(|view| self.list.folder.join(&view.file));
        self.check_targets(&targets.collect::<Vec<_>>(), base)?;
        let is_recorded = self.records.is_some() || self.list.summary.is_some();
        let hashes = views.iter().filter(|_| is_recorded);
        let hashes = hashes.map(|view| self.hash(view));
        let hashes = hashes.collect::<Result<Vec<_>, _>>()?;
        // The number of samples within a time is not known before.
        let limit = self.args.sampling.time_limit();
        let limit = limit.map(|limit| format!("{limit:?}"));
        let hash = hashes
            .into_iter()
            .chain(limit)
            .collect::<Vec<_>>()
            .join("+");
        let files = views.iter().map(|view| self.files(view));
        let files = files.collect::<Result<Vec<_>, _>>()?.concat();
        if let Some(done) = self.kept(&name, &hash, &files) {
            self.progress.add(STEPS);
            return Ok(Outcome::Kept(done));
        }
        for view in &views {
            self.draw_view(view, item, threads, STEPS / views.len() as u64)?;
        }
        let mut done = Done {
            picture: name,
            hash,
            files: Vec::new(),
        };
        if is_recorded {
            done.files = self.written(&files)?;
        }
        if let Some((_, recorder)) = &self.records {
            recorder.write(&Line::Done(done.clone()))?;
        }
        Ok(Outcome::Drawn(done))
    }

    /// Returns the movie of a scene, or of the rows of a table, if each file is a movie.
    fn movie<'s>(
        &'s self,
        scene: &'s Scene,
        camera: Option<&'s str>,
        rows: OtherRows<'s>,
    ) -> Result<Option<Movie<'s>>, Failure> {
        let (frames, picture) = (self.args.frames(), &self.args.draw.picture);
        let movie = |format| match rows.series {
            Some(series) => {
                let fps = self.args.fps.unwrap_or(Series::FPS);
                let frame = move |row| {
                    let mut scene = series.scene(row as usize)?;
                    if let Some(name) = camera {
                        scene = cameras::see_by(scene, name)?;
                    }
                    self.seen(scene, rows.seen_with)
                };
                let numbers = (0..series.len() as u32).collect();
                Ok(Movie::new(
                    format,
                    numbers,
                    fps,
                    scene.size(),
                    picture,
                    frame,
                ))
            }
            None => Movie::of(frames, picture, format, scene),
        };
        self.movie.map(movie).transpose()
    }

    fn movie_of<'s>(&'s self, view: &'s NamedView) -> Result<Option<Movie<'s>>, Failure> {
        self.movie(&view.scene, view.camera.as_deref(), view.rows)
    }

    /// Returns the scene of a row as it is seen together with the others.
    fn seen(&self, scene: Scene, with: Option<&Shared>) -> Result<Scene, Failure> {
        let size = self.args.draw.picture.whole(scene.size());
        match with {
            Some(shared) => shared.seen(scene, size),
            None => Ok(scene),
        }
    }

    /// Notes if the colors of a row have other ranges than those of the first one.
    fn note_ranges(&self, item: &Item, scene: &Scene) {
        let found = shared::used_ranges(scene);
        let mut ranges = lock(&self.ranges);
        let first = ranges.entry(item.scene).or_insert_with(|| found.clone());
        let differ = *first != found;
        self.ranges_differ.fetch_or(differ, Ordering::Relaxed);
    }

    /// Returns the number of pixels in the file of a scene.
    fn pixels(&self, scene: &Scene, movie: Option<&Movie>) -> u64 {
        let one = self.args.draw.picture.pixels(scene.size());
        movie.map_or(one, |movie| movie.pixels(&self.args.draw.picture))
    }

    /// Returns a hash of everything that a camera's file depends on.
    fn hash(&self, view: &NamedView) -> Result<String, Failure> {
        match self.movie_of(view)? {
            Some(movie) => movie.hash(&self.render),
            None => Ok(view.scene.hash(&view.file, &self.render)?),
        }
    }

    /// Returns the files of a camera, relative to the folder of the pictures.
    fn files(&self, view: &NamedView) -> Result<Vec<PathBuf>, Failure> {
        let path = PathBuf::from(&view.file);
        if is_dash(&path) {
            return Ok(Vec::new());
        }
        if self.movie.is_some() {
            return Ok(vec![path]);
        }
        let all = self.render.files(&path)?;
        Ok(all.into_iter().map(|(path, _)| path).collect())
    }

    /// Returns the views of all cameras that draw a picture of this name.
    fn views<'b>(
        &self,
        mut scene: Scene,
        rows: OtherRows<'b>,
        item: &Item,
        name: &str,
    ) -> Result<Vec<NamedView<'b>>, Failure> {
        let mut views = Vec::new();
        let cameras = match item.camera.as_deref() {
            Some(camera) => vec![Some(camera.to_owned())],
            None => self.args.cameras.names(&scene)?,
        };
        for camera in cameras {
            if let Some(name) = &camera {
                scene = cameras::see_by(scene, name)?;
            }
            views.push(NamedView {
                scene: self.seen(scene.clone(), rows.seen_with)?,
                file: cameras::name_of(name, camera.as_deref()),
                camera,
                rows,
            });
        }
        Ok(views)
    }

    /// Returns the record of a picture that exists, is complete and was made from the same inputs.
    /// It names exactly the files that this run would make.
    fn kept(&self, name: &str, hash: &str, files: &[PathBuf]) -> Option<Done> {
        let (records, _) = self.records.as_ref()?;
        let is_whole = |done: &&Done| {
            let named = done.files.iter().map(|file| Path::new(&file.file));
            named.eq(files.iter().map(PathBuf::as_path))
                && done
                    .files
                    .iter()
                    .all(|file| file.is_there(&self.list.folder))
        };
        records.done(name, Some(hash)).find(is_whole).cloned()
    }

    /// Draws the view of one camera, in this many steps of the bar, and writes its report.
    fn draw_view(
        &self,
        view: &NamedView,
        item: &Item,
        threads: usize,
        steps: u64,
    ) -> Result<(), Failure> {
        let NamedView {
            scene,
            file,
            camera,
            ..
        } = view;
        let movie = self.movie_of(view)?;
        let pixels = self.pixels(scene, movie.as_ref());
        let sink = self.progress.sink();
        // Counts in small steps that add up exactly.
        let drawn = AtomicU64::new(0);
        let step = move |count| {
            let before = drawn.fetch_add(count, Ordering::Relaxed);
            let at = |pixel: u64| u128::from(pixel) * u128::from(steps) / u128::from(pixels.max(1));
            sink((at(before + count) - at(before)) as u64);
        };
        let options = self.render.clone().threads(threads);
        let watched = options.clone().on_progress(step);
        let path = self.list.folder.join(file);
        let mut samples = self.args.draw.picture.samples(scene.samples()).count();
        match &movie {
            Some(movie) if is_dash(&path) => movie.write(io::stdout().lock(), &watched)?,
            Some(movie) => movie.save(&path, &watched, self.cancel)?,
            None => {
                let quiet = (self.args.resume, self.args.draw.quiet);
                let file = Some(&*path).filter(|path| !is_dash(path));
                let sampling = self.args.sampling;
                let sampled = sampling.sample(scene, file, watched, quiet)?;
                scene.save_with(&path, &sampled.options)?;
                sampled.finish();
                samples = sampled.samples.unwrap_or(samples);
            }
        }
        if let Some(report) = self.list.report(item)? {
            let report = cameras::name_of(&report, camera.as_deref());
            let image = self
                .args
                .draw
                .picture
                .image(scene.size(), camera.as_deref())
                .by_paths(scene.follows_paths().then_some(samples));
            report::write(Path::new(&report), scene, &image, &options, self.cancel)?;
        }
        self.rays
            .fetch_add(pixels * u64::from(samples), Ordering::Relaxed);
        let geometries = scene.world().ids() as u64;
        self.geometries.fetch_max(geometries, Ordering::Relaxed);
        Ok(())
    }

    fn is_all(&self, threads: usize) -> bool {
        threads == self.args.draw.threads()
    }

    /// Rejects pictures that would replace each other, a folder or one of their sources, and
    /// creates their folders.
    fn check_targets(&self, targets: &[PathBuf], base: &Base) -> Result<(), Failure> {
        for (index, target) in targets.iter().enumerate() {
            let is_it = |other: &&PathBuf| is_same(target, other);
            let before = targets.iter().take(index).find(is_it);
            let source = base.files.iter().find(is_it);
            let why = match (before, source) {
                _ if target.is_dir() => Some("is a folder, not a file".to_owned()),
                (Some(other), _) => Some(format!("is the same file as {}", other.display())),
                (_, Some(source)) => Some(format!(
                    "the picture would overwrite a file of its scene, {}",
                    source.display()
                )),
                _ => None,
            };
            if let Some(why) = why {
                return Err(Failure::refused(target, why));
            }
            if let Some(folder) = target.parent().filter(|_| self.list.makes_folders)
                && !folder.is_dir()
            {
                make_folder(folder)?;
            }
        }
        Ok(())
    }

    /// Returns the sizes and checksums of files that were just written.
    fn written(&self, files: &[PathBuf]) -> Result<Vec<Written>, Failure> {
        let folder = &self.list.folder;
        let written = files.iter().map(|file| {
            let written = Written::of(folder, &file.to_string_lossy());
            written.map_err(|error| Error::reading_failed(folder.join(file), error).into())
        });
        written.collect()
    }
}

pub(super) fn make_folder(folder: &Path) -> Result<(), Failure> {
    let made = fs::create_dir_all(folder);
    made.map_err(|error| Error::writing_failed(folder, error).into())
}
