//! Parts: other scene files whose geometries a scene takes over, read and built.

use std::{
    collections::BTreeMap,
    path::PathBuf,
    sync::{Arc, Mutex, MutexGuard, PoisonError},
};

use crate::{
    diagnostic::{Diagnostic, Severity, Suppressed},
    scene::{
        format::field::Name, origin::Origin, origins::Origins, scales::Scales, source::Source,
    },
    tracer::{
        error::GeometryError, geometry::Geometry, light::Light, shape::placed::Placer,
        transform::Transform,
    },
};

/// The geometries and lights of a scene file without errors.
#[derive(Debug)]
pub(crate) struct Part {
    /// All geometries in the order of the file, those of tables and inner parts included.
    pub(crate) geometries: Vec<Geometry>,
    /// The lights with their names; `None` if the file is not lit.
    pub(crate) lights: Option<Vec<PartLight>>,
    pub(crate) places: Arc<Places>,
}

impl Part {
    /// The number of ids of its geometries.
    pub(crate) fn count(&self) -> usize {
        self.geometries.iter().map(Geometry::count).sum()
    }

    /// Returns the number of shapes that a copy of it adds to a scene, with those inside of others. A
    /// copy that is placed has places of its own for all that is copied in it.
    pub(crate) fn total(&self, is_placed: bool) -> usize {
        let totals = self.geometries.iter().map(|geometry| {
            let places = match geometry.shape().copies() {
                Some(copies) if is_placed => copies.len(),
                _ => 0,
            };
            geometry.shape().total().saturating_add(places)
        });
        totals.fold(0, usize::saturating_add)
    }

    /// Returns the part with its geometries and lights placed by transforms, from outermost to
    /// innermost.
    pub(crate) fn placed(&self, transforms: &[Arc<Transform>]) -> Result<Self, GeometryError> {
        let mut placer = Placer::new(transforms);
        let transform = placer.transform()?;
        let geometries = self.geometries.iter().map(|geometry| {
            geometry
                .clone()
                .placed(transform.as_deref(), |shape| placer.place(shape))
        });
        let lights = self.lights.iter().flatten().map(|(name, light)| {
            let mut innermost = transforms.iter().rev();
            let light = innermost.try_fold(light.clone(), |light, level| light.placed(level))?;
            Ok((name.clone(), light))
        });
        Ok(Self {
            geometries: geometries.collect::<Result<_, GeometryError>>()?,
            lights: match self.lights {
                Some(_) => Some(lights.collect::<Result<_, GeometryError>>()?),
                None => None,
            },
            places: Arc::clone(&self.places),
        })
    }
}

/// A light with its name.
pub(crate) type PartLight = (Option<Name>, Light);

/// The places of a part's geometries in its file, and the values that determine their colors.
#[derive(Debug)]
pub(crate) struct Places {
    /// The path of the file from the current folder.
    pub(crate) file: Box<str>,
    pub(crate) origins: Origins,
    pub(crate) scales: Scales,
}

/// The place of a geometry in the file of a part.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct PartPlace<'a> {
    /// The path of the file from the current folder.
    pub file: &'a str,
    /// The position in the list of geometries of this file.
    pub origin: Origin,
    /// The name in this file; the rows of a table have that of the table.
    pub name: Option<&'a str>,
    /// The names of the groups in this file that hold it, the outermost first.
    pub groups: Vec<&'a str>,
}

impl Places {
    /// Returns the place of a geometry, by its origin in the part.
    pub(crate) fn at(&self, origin: Origin) -> PartPlace<'_> {
        let (name, groups) = self.origins.names_at(&origin);
        PartPlace {
            file: &self.file,
            origin,
            name,
            groups,
        }
    }

    /// Adds the place of a geometry, by its index in the part, and its places in inner parts.
    pub(crate) fn add_to<'a>(&'a self, places: &mut Vec<PartPlace<'a>>, index: usize) {
        places.push(self.at(self.origins.of(index)));
        if let Some((inner, index)) = self.origins.part_of(index) {
            inner.add_to(places, index);
        }
    }
}

/// The diagnostics of a part's file.
#[derive(Debug)]
pub struct PartFindings {
    pub(crate) name: String,
    pub(crate) source: Option<Arc<Source>>,
    pub(crate) diagnostics: Vec<Diagnostic>,
    pub(crate) suppressed: Suppressed,
    /// The paths of the files that the part names.
    pub(crate) files: Vec<PathBuf>,
}

impl PartFindings {
    /// The path of the file from the current folder.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Returns the text; empty if there are no diagnostics.
    pub fn text(&self) -> &str {
        self.source.as_ref().map_or("", |source| source.text())
    }

    /// Returns the diagnostics, in the order of the text.
    pub fn diagnostics(&self) -> &[Diagnostic] {
        &self.diagnostics
    }

    /// The number of faults beyond the diagnostics.
    pub const fn suppressed(&self) -> Suppressed {
        self.suppressed
    }

    /// Returns true if there is nothing to report.
    pub fn is_empty(&self) -> bool {
        self.diagnostics.is_empty() && self.suppressed.is_empty()
    }

    /// Returns the number of errors.
    pub(crate) fn errors(&self) -> usize {
        let errors = self.diagnostics.iter();
        let errors = errors.filter(|fault| fault.severity == Severity::Error);
        errors.count() + self.suppressed.errors
    }
}

/// A file on the chain from a scene to its parts.
#[derive(Clone, Debug)]
pub(crate) struct File {
    /// The canonical path; empty for a text that is not a file.
    pub(crate) path: PathBuf,
    /// The canonical folder from which the paths in it start.
    pub(crate) folder: PathBuf,
    /// The path from the current folder.
    pub(crate) name: Box<str>,
    /// The path as written in the file that names it.
    pub(crate) written: Box<str>,
}

impl File {
    fn key(&self) -> [PathBuf; 2] {
        [self.folder.clone(), self.path.clone()]
    }
}

/// Files of which each names the next as a part.
pub(crate) type Chain = Vec<File>;

/// The result of reading the file of a part.
#[derive(Debug)]
pub(crate) struct PartFile {
    pub(crate) findings: Arc<PartFindings>,
    /// `None` if the file has errors.
    pub(crate) part: Option<Arc<Part>>,
    pub(crate) needs: Needs,
}

/// The files that a scene depends on.
#[derive(Clone, Debug, Default)]
pub(crate) struct Needs {
    /// The files that the scene itself names, each once.
    pub(crate) files: Vec<PathBuf>,
    /// The parts, inner ones included, each once in the order of first mention.
    pub(crate) parts: Vec<Arc<PartFindings>>,
    /// The number of parts inside one another.
    pub(crate) depth: usize,
    /// The ways from the scene back to a file that names it, directly or through others: one to
    /// each such file.
    pub(crate) chains_back: Vec<Chain>,
}

impl Needs {
    /// Adds a file that the scene names.
    pub(crate) fn add_file(&mut self, path: PathBuf) {
        let mut files = self.files.iter();
        if files.all(|known| known.as_os_str() != path.as_os_str()) {
            self.files.push(path);
        }
    }

    /// Adds a part that the scene names, with its inner parts.
    pub(crate) fn add_part(&mut self, file: &PartFile) {
        self.depth = self.depth.max(file.needs.depth + 1);
        for part in [&file.findings].into_iter().chain(&file.needs.parts) {
            if !self.parts.iter().any(|known| Arc::ptr_eq(known, part)) {
                self.parts.push(Arc::clone(part));
            }
        }
    }
}

/// The reading of a scene and its parts, which reads each file once.
#[derive(Clone, Debug, Default)]
pub(crate) struct PartCache {
    /// The files from the scene to the one that is being read.
    pub(crate) chain: Chain,
    known: Arc<Mutex<KnownParts>>,
    copies: Arc<Mutex<Copies>>,
}

/// The numbers of geometries and lights that are copies, because a part is named again.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Copies {
    pub(crate) geometries: usize,
    pub(crate) lights: usize,
}

/// The parts that have been read, by their folder and their path: the files that a part names are
/// others where a link to it lies in another folder.
type KnownParts = BTreeMap<[PathBuf; 2], Arc<PartFile>>;

impl PartCache {
    /// Returns the cache for a file that the current one names.
    pub(crate) fn inside(&self, file: File) -> Self {
        let mut inside = self.clone();
        inside.chain.push(file);
        inside
    }

    /// Returns a file that has been read.
    pub(crate) fn find(&self, file: &File) -> Option<Arc<PartFile>> {
        self.known().get(&file.key()).cloned()
    }

    /// Keeps a file that has been read.
    pub(crate) fn keep(&self, file: &File, read: &Arc<PartFile>) {
        self.known().insert(file.key(), Arc::clone(read));
    }

    /// Adds copies to those of all files, and returns these.
    pub(crate) fn add_copies(&self, geometries: usize, lights: usize) -> Copies {
        let mut all = self.copies.lock().unwrap_or_else(PoisonError::into_inner);
        all.geometries = all.geometries.saturating_add(geometries);
        all.lights = all.lights.saturating_add(lights);
        *all
    }

    fn known(&self) -> MutexGuard<'_, KnownParts> {
        self.known.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
