//! Reads the parts that a scene names, and the parts of these.

use std::{
    mem,
    path::{Path as FilePath, PathBuf},
    sync::Arc,
};

use crate::{
    diagnostic::{Code, plain, reading::folder_of},
    parallel::{Cancel, timings::Timings},
    scene::{
        build,
        check::Checked,
        files::{self, Folder},
        format::{
            geometry::{GeometryModel, PartModel},
            material::Materials,
            scene::Model,
        },
        loaded::Loaded,
        options::ReadOptions,
        part::{Chain, File, Needs, Part, PartCache, PartFile, PartFindings, PartLight, Places},
        place::Place,
        problem::{Focus, Problem},
        tables::{MOST, Tables},
    },
    text::{nearest::quote, syntax::Syntax},
    tracer::error::GeometryError,
};

/// The maximum number of parts inside one another.
const DEEPEST: usize = 32;

/// The maximum number of geometries that are copies, because a part is named again or a list of copies
/// names them, in all files together. A list counts once, with what it is copies of, since all copies
/// share it.
const MOST_COPIES: usize = 1 << 22;

/// The maximum number of such lights.
const MOST_LIGHTS: usize = 1 << 16;

/// Reads all parts of a scene into its tables, and returns their problems.
pub(super) fn read(
    model: &Model,
    tables: &mut Tables,
    folder: &Folder<'_>,
    options: &ReadOptions,
    cache: &PartCache,
) -> (Needs, Vec<Problem>) {
    let rows: usize = tables.contents().map(|(_, content)| content.count()).sum();
    let mut reader = Reader {
        folder,
        options,
        cache: cache.clone(),
        needs: Needs::default(),
        total: model.leaves().count().saturating_add(rows),
    };
    let mut problems = Vec::new();
    for (at, geometry) in model.walk() {
        let Some(named) = geometry.part().filter(|_| !options.is_cancelled()) else {
            continue;
        };
        let place = Place {
            file: &named.file,
            field: "file",
            variant: model.path_of(at),
        };
        let is_placed = !model.transforms(at).is_empty();
        match reader.part(named, &place, is_placed) {
            Ok(part) => {
                let lights = named.lights();
                if lights && part.lights.is_none() {
                    let file = quote(&named.file);
                    let message = format!("this has no effect: {file} has no `lights`");
                    let path = place.variant.field("lights");
                    let problem = Problem::new(Code::NoEffect, path, Focus::Key, message);
                    problems.push(problem.help("remove it"));
                }
                tables.add_part(at, part, lights);
            }
            Err(problem) => problems.push(problem),
        }
    }
    if let Err((at, error)) = tables.place(model) {
        let message = format!("cannot be placed: {error}");
        let own = model.geometry(at).and_then(GeometryModel::transform);
        let (place, focus) = match own {
            Some(_) => (model.path_of(at).field("transform"), Focus::Value),
            None => (model.path_of(at), Focus::Name),
        };
        problems.push(Problem::new(Code::OutOfRange, place, focus, message));
    }
    (reader.needs, problems)
}

/// Adds the copies that a scene holds to its tables and parts, and returns the problems: copies of
/// copies would take any time, so those of all files count together.
pub(super) fn add_copies(model: &Model, tables: &mut Tables, cache: &PartCache) -> Vec<Problem> {
    let mut problems = Vec::new();
    build::copy(model, tables, model.copies().collect(), |at, count| {
        let all = cache.add_copies(count, 0).geometries;
        // Only the first that are too many are reported.
        if all > MOST_COPIES && all.saturating_sub(count) <= MOST_COPIES {
            let message = too_many("these", all, "copies of geometries", MOST_COPIES);
            let place = model.path_of(at).field("of");
            let problem = Problem::new(Code::OutOfRange, place, Focus::Value, message);
            problems.push(problem.help("copy a geometry that holds fewer, such as a mesh"));
        }
        all <= MOST_COPIES
    });
    problems
}

fn too_many(named: &str, found: usize, what: &str, most: usize) -> String {
    format!("with {named} there are {found} {what}, the maximum is {most}")
}

struct Reader<'a> {
    folder: &'a Folder<'a>,
    options: &'a ReadOptions,
    cache: PartCache,
    needs: Needs,
    /// The number of geometries so far.
    total: usize,
}

impl Reader<'_> {
    /// Returns the part that a geometry names; `is_placed` is true if it or a group around it has a
    /// transform.
    fn part(
        &mut self,
        named: &PartModel,
        place: &Place,
        is_placed: bool,
    ) -> Result<Arc<Part>, Problem> {
        let Some(syntax) = Syntax::of_path(FilePath::new(&*named.file)) else {
            let message = "the extension does not determine the syntax, expected .ron or .json";
            let problem = place.problem(Code::InvalidPart, message);
            return Err(
                problem.help("a table is named by `Spheres(file: …)` or `Cylinders(file: …)`")
            );
        };
        let path = self.folder.find(&named.file);
        let path = path.map_err(|refused| place.refused(refused))?;
        let name = self.options.path_of(&*named.file);
        let file = File {
            folder: self.folder_of(&name, &path),
            name: name.display().to_string().into(),
            written: named.file.clone(),
            path,
        };
        if let Some(start) = self.position(&file) {
            let chain = vec![file];
            let problem = self.ring(start, &chain, place);
            self.leads_back(chain);
            return Err(problem);
        }
        let known = self.cache.find(&file);
        let is_copy = known.is_some();
        let read = match known {
            Some(read) => read,
            None if self.cache.chain.len() > DEEPEST => return Err(too_deep(place)),
            None => {
                let read = Arc::new(self.read(&file, syntax, place)?);
                self.cache.keep(&file, &read);
                read
            }
        };
        self.needs.add_part(&read);
        let mut ring = None;
        for chain in &read.needs.chains_back {
            if let Some(start) = chain.last().and_then(|file| self.position(file)) {
                ring.get_or_insert_with(|| self.ring(start, chain, place));
                self.leads_back(chain.clone());
            }
        }
        match (ring, &read.part) {
            (Some(ring), _) => Err(ring),
            (None, Some(_)) if self.cache.chain.len() + read.needs.depth > DEEPEST => {
                Err(too_deep(place))
            }
            (None, Some(part)) => {
                let shines = named.lights();
                let copy = is_copy.then_some(is_placed);
                self.count(part, shines, copy, place)?;
                Ok(Arc::clone(part))
            }
            (None, None) => Err(broken(place, &read.findings)),
        }
    }

    /// Returns the folder from which the paths in a file start: that of its name, which a link may have
    /// in a folder of its own.
    fn folder_of(&self, name: &FilePath, path: &FilePath) -> PathBuf {
        let found = self.options.all_files().resolve(folder_of(name));
        found.unwrap_or_else(|_| path.parent().unwrap_or(path).to_owned())
    }

    /// Returns the place of a file on the chain from the scene to the current file.
    fn position(&self, file: &File) -> Option<usize> {
        let mut chain = self.cache.chain.iter();
        chain.position(|known| known.path == file.path)
    }

    /// Returns the problem of a ring: `chain` leads from the current file to the one at `start` on the
    /// chain to the current file.
    fn ring(&self, start: usize, chain: &Chain, place: &Place) -> Problem {
        let ring = self.cache.chain.iter().skip(start).chain(chain);
        let ring: Vec<_> = ring.map(|file| quote(&file.written)).collect();
        let message = format!("a part of itself: {}", ring.join(" → "));
        let place = place.variant.field("file");
        let problem = Problem::new(Code::PartRing, place, Focus::Value, message);
        problem.help("remove one of the parts in this ring")
    }

    /// Notes that the current file leads back to a file before it.
    fn leads_back(&mut self, mut chain: Chain) {
        let (Some(current), Some(last)) = (self.cache.chain.last(), chain.last()) else {
            return;
        };
        let leads_there = |known: &Chain| known.last().is_some_and(|file| file.path == last.path);
        if current.path != last.path && !self.needs.chains_back.iter().any(leads_there) {
            chain.insert(0, current.clone());
            self.needs.chains_back.push(chain);
        }
    }

    /// Reads, checks and builds a file.
    fn read(&self, file: &File, syntax: Syntax, place: &Place) -> Result<PartFile, Problem> {
        let opened = self.folder.open_found(&file.path);
        let (content, length) = opened.map_err(|refused| place.refused(refused))?;
        let path = PathBuf::from(&*file.name);
        let options = self.options.of_part(&path, self.cache.inside(file.clone()));
        let timings = Timings::new();
        let watch = timings.watch();
        let loaded = Loaded::from_content(content, Some(length), syntax, &options, &watch);
        let loaded =
            loaded.map_err(|error| place.problem(Code::FileNotFound, files::cause(error)))?;
        let invalid = |error: GeometryError| place.problem(Code::InvalidPart, error.to_string());
        part_file(&file.name, loaded, self.options.canceller()).map_err(invalid)
    }

    /// Counts the geometries of a part, and its lights if they shine. Copies of copies would fill any
    /// memory, so those of all files count together; `copy` is true for one with a transform.
    fn count(
        &mut self,
        part: &Part,
        shines: bool,
        copy: Option<bool>,
        place: &Place,
    ) -> Result<(), Problem> {
        self.total = self.total.saturating_add(part.count());
        let lights = part.lights.as_ref().filter(|_| shines).map_or(0, Vec::len);
        let copies = copy.map(|is_placed| self.cache.add_copies(part.total(is_placed), lights));
        let copies = copies.unwrap_or_default();
        for (what, found, most) in [
            ("geometries", self.total, MOST),
            ("copies of geometries", copies.geometries, MOST_COPIES),
            ("copies of lights", copies.lights, MOST_LIGHTS),
        ] {
            if found > most {
                let message = too_many("this part", found, what, most);
                return Err(place.problem(Code::InvalidPart, message));
            }
        }
        Ok(())
    }
}

impl PartCache {
    /// Returns the cache of a scene: that of the scene that names it as a part, or one of its own.
    pub(super) fn of(options: &ReadOptions) -> Self {
        options.cache.clone().unwrap_or_else(|| {
            let file = options.file.as_deref().unwrap_or(FilePath::new(""));
            let found = options.all_files().resolve(file);
            Self::default().inside(File {
                path: found.unwrap_or_default(),
                folder: PathBuf::new(),
                name: file.display().to_string().into(),
                written: file
                    .file_name()
                    .unwrap_or_default()
                    .to_string_lossy()
                    .into(),
            })
        })
    }
}

/// Builds the part of a file that has been read.
fn part_file(
    name: &str,
    loaded: Loaded,
    cancel: Option<&Cancel>,
) -> Result<PartFile, GeometryError> {
    let Loaded {
        source,
        checked: mut found,
        ..
    } = loaded;
    let diagnostics = mem::take(&mut found.diagnostics);
    let findings = PartFindings {
        name: name.to_owned(),
        source: (!diagnostics.is_empty()).then(|| source.into()),
        diagnostics,
        suppressed: found.suppressed,
        files: mem::take(&mut found.needs.files),
    };
    let needs = mem::take(&mut found.needs);
    let part = match findings.errors() {
        0 => part(name, found, cancel)?.map(Arc::new),
        _ => None,
    };
    Ok(PartFile {
        findings: findings.into(),
        part,
        needs,
    })
}

fn part(
    name: &str,
    found: Checked,
    cancel: Option<&Cancel>,
) -> Result<Option<Part>, GeometryError> {
    let (Some(mut model), tables) = (found.model, found.tables.unwrap_or_default()) else {
        return Ok(None);
    };
    let own = model.lights.take();
    let is_lit = own.is_some() || tables.lights().next().is_some();
    let own = own.into_iter().flatten();
    let own = own.map(|light| {
        let name = light.name().map(|name| Box::new(name.into()));
        Ok((name, light.build()?))
    });
    let mut lights: Vec<PartLight> = own.collect::<Result<_, GeometryError>>()?;
    lights.extend(tables.lights().flatten().cloned());
    let materials = Materials::of(model.materials.as_ref())?;
    let list = build::geometries(model.geometries, &materials, tables, cancel)?;
    let places = Places {
        file: name.into(),
        origins: list.origins,
        scales: list.scales,
    };
    Ok(Some(Part {
        geometries: list.geometries,
        lights: is_lit.then_some(lights),
        places: places.into(),
    }))
}

fn too_deep(place: &Place) -> Problem {
    let message = format!("more than {DEEPEST} parts are inside one another");
    place.problem(Code::InvalidPart, message)
}

/// Creates the problem of a part with errors. They are reported in its own file.
fn broken(place: &Place, findings: &PartFindings) -> Problem {
    let errors = match findings.errors() {
        1 => "1 error".to_owned(),
        errors => format!("{errors} errors"),
    };
    let (message, path) = (
        format!("{} has {errors}", quote(place.file)),
        place.variant.field("file"),
    );
    let (first, _) = plain::listing(&[(findings.name(), findings.text(), findings.diagnostics())]);
    Problem::new(Code::InvalidPart, path, Focus::Value, message).help(format!("the first: {first}"))
}
