//! The pictures of a run: each scene with each row of a table at each frame.

use std::{
    collections::HashMap,
    path::{Path, PathBuf},
    sync::Mutex,
};

use strahl::{
    Document, ImageFormat,
    jobs::{Configs, SceneFile, Shard, find_scenes},
};

use super::{
    frames::Frames,
    items::{Item, items},
    pattern::Pattern,
};
use crate::cli::{
    failure::Failure,
    params::Params,
    paths,
    render::{
        args::Args,
        output::{format_of, is_folder},
    },
    threads::lock,
};

/// The pictures that a run makes.
pub(super) struct List {
    pub(super) scenes: Vec<SceneFile>,
    pub(super) configs: Configs,
    /// The beginning of the picture names of each scene.
    stems: Vec<String>,
    pub(super) params: Option<Params>,
    /// The frames to draw, if there is a picture per frame.
    frames: Option<Frames>,
    /// The pictures of all parts, in order.
    pub(super) items: Vec<Item>,
    /// The scene, if it is the only one and had to be read to count its frames.
    read: Mutex<Option<Document>>,
    /// The folder that contains all names.
    pub(super) folder: PathBuf,
    /// True if missing folders are created.
    pub(super) makes_folders: bool,
    /// The pattern of names in that folder.
    pub(super) pattern: Pattern,
    /// The destination of the report on the run.
    pub(super) summary: Option<PathBuf>,
    /// The destinations of the reports on the pictures, one for each.
    reports: Option<Pattern>,
    pub(super) shard: Shard,
    /// True if each scene becomes one movie, with a frame for each row of the table.
    pub(super) is_series: bool,
    /// True if all rows are framed together and share the ranges of their colors.
    pub(super) shares: bool,
}

impl List {
    pub(super) fn new(args: &Args) -> Result<Self, Failure> {
        let paths = args.paths.all()?;
        let configs = args.draw.config.configs();
        let scenes = find_scenes(&paths, &args.paths.exclude, &configs)?;
        for scene in &scenes {
            configs.of(&scene.path)?;
        }
        let params = args.params.as_deref().map(Params::read).transpose()?;
        // A movie is a single file of all frames.
        let is_movie = args.movie().is_some();
        let frames = args.frames().filter(|_| !is_movie);
        let may_be_series = is_movie && params.is_some() && scenes.len() == 1;
        let target = target(args, &scenes, may_be_series)?;
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
        if matches!(frames, Some(Frames::All)) {
            check_columns(params.as_ref())?;
        }
        let names_row = |name: &str| {
            let mut columns = params.iter().flat_map(Params::columns);
            name == "id" || columns.any(|column| column == name)
        };
        let is_series = is_movie && params.is_some() && !pattern.places().any(names_row);
        let rows = params.as_ref().filter(|_| !is_series).map(Params::len);
        let (items, read) = items(args, &scenes, &configs, rows, frames);
        let stems = scenes.iter().map(|scene| stem(scene, &paths, is_folder));
        let list = Self {
            stems: stems.collect(),
            scenes,
            configs,
            params,
            frames: frames.cloned(),
            items,
            read: read.into(),
            folder,
            makes_folders: is_folder || pattern.places().next().is_some(),
            pattern,
            summary: args.report.clone().filter(|_| reports.is_none()),
            reports,
            shard: args.shard.unwrap_or(Shard::WHOLE),
            is_series,
            shares: args.fit_all,
        };
        list.check(args)?;
        if args.fps.is_some() && !list.is_series {
            let message = "--fps is for a movie with a frame per row of --params; for an animation, set \
                           animation.fps";
            return Err(Failure::usage(message));
        }
        Ok(list)
    }

    /// Returns the scene that has been read already, the first time this is called.
    pub(super) fn take_read(&self) -> Option<Document> {
        lock(&self.read).take()
    }

    /// Returns the patterns of the names of pictures and reports.
    fn patterns(&self) -> impl Iterator<Item = &Pattern> {
        std::iter::once(&self.pattern).chain(&self.reports)
    }

    /// Returns the placeholders in the names of pictures and reports.
    pub(super) fn places(&self) -> Vec<&str> {
        self.patterns().flat_map(Pattern::places).collect()
    }

    /// Returns the last of the named frames.
    pub(super) fn last_frame(&self) -> Option<u32> {
        match &self.frames {
            Some(Frames::Named(named)) => named.iter().max().copied(),
            _ => None,
        }
    }

    /// Returns true if this is a job, which has a record: more than one scene as seen by its
    /// cameras.
    pub(super) fn is_job(&self) -> bool {
        let shown = |item: &Item| (item.scene, item.row, item.frame);
        let mut others = self.items.iter().skip(1);
        others.any(|item| item.camera.is_none() || shown(item) != shown(&self.items[0]))
    }

    /// Returns the pictures of this part.
    pub(super) fn of_part(&self) -> impl Iterator<Item = &Item> {
        let items = self.items.iter();
        items.filter(|item| self.shard.takes(item.number))
    }

    /// Returns the pictures of this part that belong to one scene.
    pub(super) fn of_scene(&self, scene: usize) -> impl Iterator<Item = &Item> {
        let first = self.items.partition_point(|item| item.scene < scene);
        let items = self.items.iter().skip(first);
        let items = items.take_while(move |item| item.scene == scene);
        items.filter(|item| self.shard.takes(item.number))
    }

    /// Returns the name of a picture in the folder; the placeholder for a single camera stays.
    pub(super) fn name(&self, item: &Item) -> Result<String, Failure> {
        self.filled(&self.pattern, item)
    }

    /// Returns the destination of a picture's report, if it has its own.
    pub(super) fn report(&self, item: &Item) -> Result<Option<String>, Failure> {
        let reports = self.reports.as_ref();
        reports
            .map(|reports| self.filled(reports, item))
            .transpose()
    }

    fn filled(&self, pattern: &Pattern, item: &Item) -> Result<String, Failure> {
        let mut wrong = None;
        let name = pattern.fill(|place| {
            let value = self.value(item, place)?;
            value.map_err(|failure| wrong = Some(failure)).ok()
        });
        wrong.map_or(Ok(name), Err)
    }

    fn value(&self, item: &Item, place: &str) -> Option<Result<String, Failure>> {
        match place {
            "scene" => Some(Ok(self.stems[item.scene].clone())),
            "frame" => item.frame.map(|frame| Ok(frame.to_string())),
            "camera" => Some(Ok(item.camera.as_deref()?.to_owned())),
            _ => self.params.as_ref()?.name(item.row?, place),
        }
    }

    /// Returns the format of the pictures.
    pub(super) fn format(&self) -> Result<ImageFormat, Failure> {
        let first = self.items.first();
        let name = first.map_or_else(|| Ok(self.pattern.to_string()), |item| self.name(item));
        format_of(name?.as_ref())
    }

    /// Returns the name of a picture in messages, from its sources.
    pub(super) fn title(&self, item: &Item) -> String {
        let mut title = self.scenes[item.scene].path.display().to_string();
        if let (Some(params), Some(row)) = (&self.params, item.row) {
            title = format!("{title} with {}", params.row(row));
        }
        if let Some(frame) = item.frame {
            title = format!("{title} at frame {frame}");
        }
        title
    }

    /// Rejects impossible names before anything is drawn.
    fn check(&self, args: &Args) -> Result<(), Failure> {
        for pattern in self.patterns() {
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

    /// Rejects a pattern that gives two pictures the same name.
    fn check_names(&self, pattern: &Pattern) -> Result<(), Failure> {
        let mut names: HashMap<String, &Item> = HashMap::new();
        for other in &self.items {
            let name = self.filled(pattern, other)?;
            if let Some(one) = names.insert(name, other) {
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

    /// Rejects folders in the place of pictures, and pictures that are the same file through a
    /// link.
    fn check_targets(&self) -> Result<(), Failure> {
        let mut known: HashMap<PathBuf, PathBuf> = HashMap::new();
        for item in &self.items {
            let target = self.folder.join(self.name(item)?);
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
        known.extend(self.frames.is_some().then_some("frame"));
        known.extend(args.cameras.has_name().then_some("camera"));
        if let Some(params) = &self.params {
            known.push("id");
            known.extend(params.columns());
        }
        if let Some(place) = pattern.places().find(|place| !known.contains(place)) {
            let known: Vec<_> = known.iter().map(|name| format!("{{{name}}}")).collect();
            let known = known.join(", ");
            return Err(Failure::usage(format!(
                "{pattern}: unknown placeholder {{{place}}}; expected one of {known}; {{{{ is a brace"
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

/// Returns the folder of the pictures or the pattern of their names; empty for a single scene.
fn target(args: &Args, scenes: &[SceneFile], is_series: bool) -> Result<PathBuf, Failure> {
    match &args.output {
        Some(output) if paths::is_dash(output) && !is_series => Err(Failure::usage(
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

/// Rejects a table that sets the number of frames itself.
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

/// Returns the part of picture names that stands for a scene: in a folder of pictures its path from
/// the searched folder, otherwise its name.
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
