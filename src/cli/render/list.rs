//! The pictures of a run: every scene, by every row of a table, at every frame.

use std::{
    collections::HashMap,
    path::{Path, PathBuf},
    sync::{Mutex, PoisonError},
};

use strahl::{
    Document, ImageFormat,
    jobs::{Configs, SceneFile, Shard, find_scenes},
};

use super::{
    Args, format_of, frames::Frames, is_folder, movie, numbers::Numbers, pattern::Pattern,
};
use crate::cli::{Failure, params::Params, paths};

/// The pictures that a run makes, by their numbers.
pub(super) struct List {
    pub(super) scenes: Vec<SceneFile>,
    pub(super) configs: Configs,
    /// What the name of each scene's pictures begins with.
    stems: Vec<String>,
    pub(super) params: Option<Params>,
    numbers: Numbers,
    /// The scene, if it is a single one that had to be read to know its frames.
    read: Mutex<Option<Document>>,
    /// The folder that all names are in.
    pub(super) folder: PathBuf,
    /// Whether folders are made where they are missing.
    pub(super) makes_folders: bool,
    /// A name in that folder.
    pub(super) pattern: Pattern,
    /// Where the report of the run goes.
    pub(super) summary: Option<PathBuf>,
    /// Where the reports of the pictures go, each in a place of its own.
    reports: Option<Pattern>,
    pub(super) shard: Shard,
}

/// One of them.
#[derive(Clone, Copy, Debug)]
pub(super) struct Item {
    pub(super) scene: usize,
    pub(super) row: Option<usize>,
    pub(super) frame: Option<u32>,
    /// The index among the scene's cameras, if there is a picture by each.
    pub(super) camera: usize,
}

impl List {
    pub(super) fn new(args: &Args) -> Result<Self, Failure> {
        let paths = args.paths.all()?;
        let configs = args.config.configs();
        let scenes = find_scenes(&paths, &args.paths.exclude, &configs)?;
        for scene in &scenes {
            configs.of(&scene.path)?;
        }
        let params = args.params.as_deref().map(Params::read).transpose()?;
        // A movie is one file of all its frames.
        let is_movie = movie::format(args).is_some();
        let frames = args.frames().filter(|_| !is_movie);
        let target = target(args, &scenes)?;
        let is_folder = target.as_os_str().is_empty() || is_folder(&target);
        let parts = [
            ("{scene}", true),
            ("_{camera}", args.cameras.is_all()),
            ("_{id}", params.is_some()),
            ("_{frame:04}", frames.is_some()),
        ];
        let (folder, pattern) = match is_folder {
            true => {
                let parts = parts.iter().filter(|(_, is_there)| *is_there);
                let name: String = parts.map(|(part, _)| *part).collect();
                let ending = args.image_format().name();
                (target, Pattern::parse(&format!("{name}.{ending}"))?)
            }
            false => split(&target)?,
        };
        let report = args.report.as_ref().and_then(|report| report.to_str());
        let report = report.map(Pattern::parse).transpose()?;
        let reports = report.filter(|report| report.places().next().is_some());
        if is_movie && reports.is_some() {
            let message = "--report with placeholders is for pictures, not for movies";
            return Err(Failure::usage(message));
        }
        let rows = params.as_ref().map_or(1, Params::len) as u64;
        if matches!(frames, Some(Frames::All)) {
            check_columns(params.as_ref())?;
        }
        let (numbers, read) = Numbers::of(args, &scenes, &configs, rows, frames);
        let stems = scenes.iter().map(|scene| stem(scene, &paths, is_folder));
        let list = Self {
            stems: stems.collect(),
            scenes,
            configs,
            params,
            numbers,
            read: read.into(),
            folder,
            makes_folders: is_folder || pattern.places().next().is_some(),
            pattern,
            summary: args.report.clone().filter(|_| reports.is_none()),
            reports,
            shard: args.shard.unwrap_or(Shard::WHOLE),
        };
        list.check(args)?;
        Ok(list)
    }

    /// The scene that has been read already, if it has been and is not used yet.
    pub(super) fn take_read(&self) -> Option<Document> {
        let mut read = self.read.lock().unwrap_or_else(PoisonError::into_inner);
        read.take()
    }

    /// The names that a picture or a report has places for.
    pub(super) fn places(&self) -> Vec<&str> {
        let patterns = [Some(&self.pattern), self.reports.as_ref()];
        patterns
            .into_iter()
            .flatten()
            .flat_map(Pattern::places)
            .collect()
    }

    /// The last of the frames that are named.
    pub(super) fn last_frame(&self) -> Option<u32> {
        self.numbers.last_named()
    }

    /// How many pictures there are, of all parts.
    pub(super) fn len(&self) -> u64 {
        self.numbers.len()
    }

    /// Whether it is a job, of which a record is kept: more than one scene as its cameras see it.
    pub(super) fn is_job(&self) -> bool {
        self.len() > 1 && !self.numbers.are_views_of_one()
    }

    /// The pictures of this part.
    pub(super) fn numbers(&self) -> impl Iterator<Item = u64> + Send + use<> {
        let shard = self.shard;
        (0..self.len()).filter(move |number| shard.takes(*number))
    }

    /// The pictures of this part that are of one scene.
    pub(super) fn of_scene(&self, scene: usize) -> impl Iterator<Item = u64> {
        let numbers = self.numbers.of_scene(scene);
        numbers.filter(|number| self.shard.takes(*number))
    }

    pub(super) fn item(&self, number: u64) -> Item {
        let (scene, row, frame, camera) = self.numbers.item(number);
        Item {
            scene,
            row: self.params.as_ref().map(|_| row),
            frame,
            camera,
        }
    }

    /// The name of the camera, if there is a picture by each.
    pub(super) fn camera(&self, item: Item) -> Option<&str> {
        self.numbers.camera(item.scene, item.camera)
    }

    /// What a picture is called, in the folder; the place of a single camera stays.
    pub(super) fn name(&self, item: Item) -> Result<String, Failure> {
        self.filled(&self.pattern, item)
    }

    /// Where the report of a picture goes, if it has one of its own.
    pub(super) fn report(&self, item: Item) -> Result<Option<String>, Failure> {
        let reports = self.reports.as_ref();
        reports
            .map(|reports| self.filled(reports, item))
            .transpose()
    }

    fn filled(&self, pattern: &Pattern, item: Item) -> Result<String, Failure> {
        let mut wrong = None;
        let name = pattern.fill(|place| {
            let value = self.value(item, place)?;
            value.map_err(|failure| wrong = Some(failure)).ok()
        });
        wrong.map_or(Ok(name), Err)
    }

    fn value(&self, item: Item, place: &str) -> Option<Result<String, Failure>> {
        match place {
            "scene" => self.stems.get(item.scene).cloned().map(Ok),
            "frame" => item.frame.map(|frame| Ok(frame.to_string())),
            "camera" => Some(Ok(self.camera(item)?.to_owned())),
            _ => self.params.as_ref()?.name(item.row?, place),
        }
    }

    /// The format of the pictures.
    pub(super) fn format(&self) -> Result<ImageFormat, Failure> {
        format_of(self.name(self.item(0))?.as_ref())
    }

    /// What a message calls a picture: by what it is made of.
    pub(super) fn title(&self, item: Item) -> String {
        let mut title = self
            .scenes
            .get(item.scene)
            .map_or_else(String::new, |scene| scene.path.display().to_string());
        if let (Some(params), Some(row)) = (&self.params, item.row) {
            title = format!("{title} with {}", params.row(row));
        }
        if let Some(frame) = item.frame {
            title = format!("{title} at frame {frame}");
        }
        title
    }

    /// Refuses names that cannot be, before anything is drawn.
    fn check(&self, args: &Args) -> Result<(), Failure> {
        for pattern in [Some(&self.pattern), self.reports.as_ref()]
            .into_iter()
            .flatten()
        {
            self.check_places(args, pattern)?;
            self.check_names(pattern)?;
        }
        if args.cameras.is_all() {
            self.check_targets()?;
        }
        if !self.makes_folders && !self.folder.as_os_str().is_empty() && !self.folder.is_dir() {
            return Err(Failure::refused(&self.folder, "there is no such folder"));
        }
        Ok(())
    }

    /// Refuses a pattern by which two pictures would have one name.
    fn check_names(&self, pattern: &Pattern) -> Result<(), Failure> {
        let mut names: HashMap<String, u64> = HashMap::new();
        for number in 0..self.len() {
            let name = self.filled(pattern, self.item(number))?;
            if let Some(first) = names.insert(name, number) {
                let (one, other) = (self.item(first), self.item(number));
                let target = self.folder.join(self.filled(pattern, other)?);
                let (one, other, target) = (self.title(one), self.title(other), target.display());
                let cure = match pattern.places().next() {
                    None => format!("`{target}/` would be a folder for them"),
                    Some(_) => "each picture needs its own name".to_owned(),
                };
                return Err(Failure::usage(format!(
                    "{one} and {other} would both be {target}; {cure}"
                )));
            }
        }
        Ok(())
    }

    /// Refuses folders in the place of pictures, and pictures that are one file by a link.
    fn check_targets(&self) -> Result<(), Failure> {
        let mut known: HashMap<PathBuf, PathBuf> = HashMap::new();
        for number in 0..self.len() {
            let target = self.folder.join(self.name(self.item(number))?);
            let Ok(real) = target.canonicalize() else {
                continue;
            };
            let why = match known.get(&real) {
                _ if real.is_dir() => "is a folder, not a file".to_owned(),
                Some(other) => format!("is the same file as {}", other.display()),
                None => {
                    known.insert(real, target);
                    continue;
                }
            };
            return Err(Failure::refused(&target, why));
        }
        Ok(())
    }

    fn check_places(&self, args: &Args, pattern: &Pattern) -> Result<(), Failure> {
        let mut known = vec!["scene"];
        known.extend(self.numbers.have_frames().then_some("frame"));
        known.extend(args.cameras.has_name().then_some("camera"));
        if let Some(params) = &self.params {
            known.push("id");
            known.extend(params.columns());
        }
        if let Some(place) = pattern.places().find(|place| !known.contains(place)) {
            let known: Vec<_> = known.iter().map(|name| format!("{{{name}}}")).collect();
            let known = known.join(", ");
            return Err(Failure::usage(format!(
                "{pattern}: unknown placeholder {{{place}}}; known are {known}, and {{{{ is a brace"
            )));
        }
        if args.cameras.is_all() && !pattern.has("camera") {
            return Err(Failure::usage(format!(
                "{pattern}: --all-cameras makes several pictures; put {{camera}} into the name"
            )));
        }
        Ok(())
    }
}

/// The folder of the pictures, or the pattern of their names; empty for a single scene.
fn target(args: &Args, scenes: &[SceneFile]) -> Result<PathBuf, Failure> {
    match &args.output {
        Some(output) if paths::is_dash(output) => Err(Failure::usage(
            "several pictures cannot go to standard output; the frames of one scene can, as \
             --image-format y4m",
        )),
        Some(output) => Ok(output.clone()),
        None if matches!(scenes, [scene] if scene.folder.is_none()) => Ok(PathBuf::new()),
        None => Err(Failure::usage(
            "several scenes need -o FOLDER/, the folder of their pictures",
        )),
    }
}

/// Splits a target into the folder of all pictures, whose name has no placeholder, and the rest.
fn split(target: &Path) -> Result<(PathBuf, Pattern), Failure> {
    let text = target.to_str();
    let text = text.ok_or_else(|| Failure::refused(target, "the name is not UTF-8"))?;
    let pattern = Pattern::parse(text)?;
    let end = pattern.beginning().rfind('/').map_or(0, |at| at + 1);
    let (folder, name) = text.split_at(end);
    Ok((folder.into(), Pattern::parse(name)?))
}

/// Refuses a table that says itself how many frames there are.
fn check_columns(params: Option<&Params>) -> Result<(), Failure> {
    let sets_frames = |column: &&str| ["animation", "animation.frames"].contains(column);
    let column = params.and_then(|params| params.columns().find(sets_frames));
    column.map_or(Ok(()), |column| {
        Err(Failure::usage(format!(
            "the column `{column}` changes the number of frames; select frames with --frames, \
             such as --frames 0-9"
        )))
    })
}

/// What stands for a scene in the names of its pictures: in a folder of pictures its path from the
/// folder that was searched, else its name.
fn stem(scene: &SceneFile, paths: &[PathBuf], is_folder: bool) -> String {
    let searched = scene.folder.and_then(|index| paths.get(index));
    let inside = searched.and_then(|folder| scene.path.strip_prefix(folder).ok());
    let path = match inside {
        Some(inside) if is_folder => inside.with_extension(""),
        _ if paths::is_dash(&scene.path) => PathBuf::from("stdin"),
        _ => PathBuf::from(scene.path.file_stem().unwrap_or_default()),
    };
    path.to_string_lossy().replace('\\', "/")
}
