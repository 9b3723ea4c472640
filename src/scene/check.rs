//! The check of a text: the fast reader takes it, or the tree reports its faults.

use std::{
    cell::LazyCell,
    collections::BTreeMap,
    fs::File,
    io::{self, Seek},
};

use crate::{
    diagnostic::{Code, Diagnostic, Severity, Suppressed, levels::Levels, path::Path},
    parallel::timings::{Stage, Watch},
    scene::{
        files,
        format::{
            geometry::{GeometryModel, ordinal::Ordinal},
            scene::Model,
            warning::WarningName,
        },
        locate::Locator,
        meshes, nested,
        options::ReadOptions,
        part::{Needs, PartCache},
        pictures,
        problem::{Focus, Problem, Tally},
        read::{self, LARGE},
        recover::{self, Recovered, text::Repairs},
        set::Applied,
        source::Source,
        tables::{self, Tables},
        validate::{self, Aspects},
    },
    text::{
        nearest::quote,
        syntax::{Syntax, max_faults},
    },
};

/// The result of checking a text.
#[derive(Clone, Debug, Default)]
pub(super) struct Checked {
    pub(super) model: Option<Model>,
    /// The tables and parts of the model; `None` if they were not read or not kept.
    pub(super) tables: Option<Tables>,
    /// The files that the scene depends on.
    pub(super) needs: Needs,
    pub(super) diagnostics: Vec<Diagnostic>,
    /// Counts of the faults that are not kept.
    pub(super) suppressed: Suppressed,
    /// The diagnostics of each setting.
    pub(super) settings: Vec<Vec<Diagnostic>>,
    /// True if the file, or a part that lights it, has `lights`.
    pub(super) has_lights: bool,
}

impl Checked {
    pub(super) fn refused(diagnostics: Vec<Diagnostic>) -> Self {
        Self {
            diagnostics,
            ..Self::default()
        }
    }

    /// The same without the model.
    pub(super) fn findings(&self) -> Self {
        Self {
            needs: self.needs.clone(),
            suppressed: self.suppressed,
            settings: self.settings.clone(),
            has_lights: self.has_lights,
            ..Self::refused(self.diagnostics.clone())
        }
    }
}

/// A model and its problems.
pub(super) struct CheckedModel {
    model: Model,
    pub(super) problems: Vec<Problem>,
    /// All else that was found.
    found: Checked,
}

impl CheckedModel {
    /// Checks the model of a large file, if the fast reader knows it. Rewinds the file to its
    /// start.
    pub(super) fn in_file(
        mut file: &File,
        length: Option<u64>,
        syntax: Syntax,
        options: &ReadOptions,
        watch: &Watch,
    ) -> io::Result<Option<Self>> {
        let length = files::length_of_text(length).filter(|length| *length >= LARGE);
        let Some(length) = length else {
            return Ok(None);
        };
        let model = watch.time(Stage::Read, || {
            read::file(file, length, syntax, &options.pool(length))
        });
        file.rewind()?;
        Ok(model.map(|model| Self::of(model, syntax, options, watch)))
    }

    /// Applies the additions and the settings to a model and returns its problems.
    pub(super) fn of(
        mut model: Model,
        syntax: Syntax,
        options: &ReadOptions,
        watch: &Watch,
    ) -> Self {
        let has_lights = model.lights.is_some();
        options.additions.to(&mut model);
        let applied = Applied::to(&mut model, &options.settings, syntax);
        let mut found = Self::unset(model, &[], options, watch);
        let (settings, problems) = applied.placed(found.problems);
        let sort = |faults| sorted(faults, &found.model, &options.levels);
        found.found.settings = settings.into_iter().map(sort).collect();
        found.problems = problems;
        found.found.has_lights |= has_lights;
        found
    }

    /// Returns the problems of a model and of the tables, parts and meshes that it names, which are
    /// read for this.
    fn unset(
        mut model: Model,
        stand_ins: &[Ordinal],
        options: &ReadOptions,
        watch: &Watch,
    ) -> Self {
        // In a file of another version the names may mean something else.
        let is_known = validate::version(model.version).is_none();
        let (mut has_files, mut has_copies) = (false, false);
        for (_, geometry) in model.walk() {
            has_files |= geometry.file().is_some() || pictures::is_textured(geometry);
            has_copies |= geometry.copies().is_some();
        }
        has_files |= model.pictures().next().is_some() || model.named_textures().next().is_some();
        let is_wanted = is_known && has_files;
        let cache = LazyCell::new(|| PartCache::of(options));
        let (mut tables, mut needs, mut found) = Default::default();
        if let Some(folder) = options.tables().filter(|_| is_wanted) {
            watch.time(Stage::Read, || {
                found = meshes::read(&mut model, &folder, options);
                found.extend(pictures::read(&mut model, &folder, options));
                let (read, problems) = tables::read(&model, &folder, options);
                tables = read;
                found.extend(problems);
                let (of_parts, problems) =
                    nested::read(&model, &mut tables, &folder, options, &cache);
                needs = of_parts;
                found.extend(problems);
            });
        }
        if has_copies {
            found.extend(nested::add_copies(&model, &mut tables, &cache));
        }
        if is_wanted {
            let files = model.walk().filter_map(|(_, geometry)| geometry.file());
            let pictures = model.pictures().map(|picture| &*picture.path);
            let textures = model.textures().map(|texture| &*texture.path);
            let files = files.chain(pictures).chain(textures);
            files.for_each(|file| needs.add_file(options.path_of(file)));
        }
        let most = options.most_diagnostics();
        let aspects = Aspects {
            levels: &options.levels,
            is_part: options.is_part
                && (options.cache.is_some() || model.all_cameras().next().is_none()),
            files_have_errors: found.iter().any(Problem::is_error),
            cancel: options.canceller(),
        };
        let (mut problems, tally) = validate::problems(&model, &tables, &aspects, stand_ins, most);
        problems.extend(found);
        let suppressed = suppressed(&tally, &model, &options.levels);
        // Unreported problems need no place in the text.
        problems
            .retain(|problem| severity(problem.code(), Some(&model), &options.levels).is_some());
        let is_read = !is_wanted || options.tables().is_some();
        let has_lights = tables.lights().next().is_some();
        let found = Checked {
            has_lights,
            tables: is_read.then_some(tables),
            needs,
            suppressed,
            ..Checked::default()
        };
        Self {
            model,
            problems,
            found,
        }
    }

    /// Locates the problems in a text.
    pub(super) fn placed(self, source: &Source, levels: &Levels) -> Checked {
        let mut diagnostics = Vec::new();
        // Without problems, no tree is needed.
        if !self.problems.is_empty() {
            let repairs = Repairs::default();
            let locator = Locator::new(source.text(), source.tree(), &repairs);
            let problems = self.problems.into_iter();
            let placed = problems.map(|problem| {
                let range = locator.range(&problem.diagnostic.path, problem.focus);
                locator.placed(problem, range.unwrap_or_default())
            });
            diagnostics = sorted(placed.collect(), &self.model, levels);
        }
        Checked {
            model: Some(self.model),
            diagnostics,
            ..self.found
        }
    }
}

/// Returns the model of a text with its tables and all its faults, in the order of the text.
/// `found` holds the results of an earlier read of the file, if any.
pub(super) fn check(
    source: &Source,
    found: Option<CheckedModel>,
    options: &ReadOptions,
    watch: &Watch,
) -> Checked {
    let (text, syntax, levels) = (source.text(), source.syntax(), &options.levels);
    if let Some(found) = found {
        return found.placed(source, levels);
    }
    let body = text.strip_prefix('\u{feff}').unwrap_or(text);
    let pool = options.pool(text.len());
    if let Some(model) = watch.time(Stage::Read, || read::model(body, syntax, &pool)) {
        if options.is_cancelled() {
            return Checked::refused(Vec::new());
        }
        return CheckedModel::of(model, syntax, options, watch).placed(source, levels);
    }
    let tree = watch.time(Stage::Read, || source.tree_until(|| options.is_cancelled()));
    if options.is_cancelled() {
        return Checked::refused(Vec::new());
    }
    if let Some(range) = source.stamp() {
        let message = "this is a report that strahl wrote, not a scene";
        return Checked::refused(vec![Diagnostic::new(Code::Syntax, range, message)]);
    }
    let faults = tree.faults();
    let refused = || {
        let faults = faults.iter();
        let faults = faults.map(|fault| recover::nameless::fault(text, tree, fault));
        Checked::refused(faults.collect())
    };
    // Around a broken value all is known, unless there are so many faults that some are not.
    let is_known = faults.len() < max_faults(text.len());
    if !faults.iter().all(|fault| fault.is_of_value && is_known) {
        return refused();
    }
    let Recovered {
        model,
        mut diagnostics,
        tally,
        repairs,
    } = watch.time(Stage::Read, || {
        recover::recover(text, tree, options.most_diagnostics())
    });
    if diagnostics.is_empty() && !faults.is_empty() {
        return refused();
    }
    let (mut more, mut needs) = (Suppressed::default(), Needs::default());
    if let Some(model) = model {
        if diagnostics.is_empty() {
            return CheckedModel::of(model, syntax, options, watch).placed(source, levels);
        }
        let locator = Locator::new(text, tree, &repairs);
        // A fault inside a repair is not reported twice. Settings wait until the scene is complete,
        // and so does the check for visible geometries.
        let stand_ins = locator.stand_ins(&model);
        let found = CheckedModel::unset(model, &stand_ins, options, watch);
        let problems = found.problems.into_iter();
        // Without readable materials no name is known.
        let materials = Path::ROOT.field("materials");
        let is_lost = locator.range(&materials, Focus::Key).is_some()
            && locator.range(&materials, Focus::Value).is_none();
        let lights = Path::ROOT.field("lights");
        let problems = problems.filter(|problem| match problem.code() {
            Code::NothingVisible | Code::CannotFit => false,
            // A light that is not read may shine.
            Code::Unlit | Code::DimLight => {
                !diagnostics.iter().any(|fault| fault.path.is_in(&lights))
            }
            Code::EmptyScene => !loses_a_group(&found.model, &locator),
            Code::UnknownName => !is_lost,
            // Stand-ins may be equal, which says nothing of what they stand for.
            Code::DuplicateGeometry => {
                let path = &problem.diagnostic.path;
                !diagnostics.iter().any(|fault| fault.path.is_in(path))
            }
            _ => true,
        });
        let placed = problems.filter_map(|problem| {
            let range = locator.range(&problem.diagnostic.path, problem.focus)?;
            Some(locator.placed(problem, range))
        });
        let placed: Vec<_> = placed.collect();
        // In a file of another version, everything else that looks wrong may be right.
        if placed
            .iter()
            .any(|fault| fault.code == Code::UnsupportedVersion)
        {
            diagnostics.retain(|fault| fault.code == Code::Syntax);
            diagnostics.extend(placed);
            sort(&mut diagnostics);
            return Checked::refused(diagnostics);
        }
        diagnostics.extend(placed);
        diagnostics = sorted(diagnostics, &found.model, levels);
        more = suppressed(&tally, &found.model, levels) + found.found.suppressed;
        needs = found.found.needs;
    }
    Checked {
        needs,
        suppressed: more,
        ..Checked::refused(diagnostics)
    }
}

/// Returns true if the geometries of a group could not be read: it may not be empty.
fn loses_a_group(model: &Model, locator: &Locator<'_>) -> bool {
    let is_lost = |(at, geometry): (Ordinal, &GeometryModel)| {
        let list = || model.path_of(at).field("geometries");
        geometry.group().is_some() && locator.range(&list(), Focus::Value).is_none()
    };
    model.walk().any(is_lost)
}

/// Counts the faults that are reported but not kept.
fn suppressed(tally: &Tally, model: &Model, levels: &Levels) -> Suppressed {
    let mut found = Suppressed::default();
    for (code, count) in tally.more() {
        if let Some(severity) = severity(code, Some(model), levels) {
            found.count(severity, count);
        }
    }
    found
}

/// Returns the reported diagnostics, in the order of the text.
fn sorted(mut found: Vec<Diagnostic>, model: &Model, levels: &Levels) -> Vec<Diagnostic> {
    let mut known: BTreeMap<Code, Option<Severity>> = BTreeMap::new();
    found.retain_mut(|fault| {
        let entry = known.entry(fault.code);
        let severity = *entry.or_insert_with(|| severity(fault.code, Some(model), levels));
        fault.severity = severity.unwrap_or(fault.severity);
        severity.is_some()
    });
    for fault in &mut found {
        name_geometry(fault, model);
    }
    sort(&mut found);
    found
}

/// Returns the severity of a fault by the lint levels and the scene; `None` if it is not reported.
pub(super) fn severity(code: Code, model: Option<&Model>, levels: &Levels) -> Option<Severity> {
    let allow = model.and_then(|model| model.allow.as_deref());
    let is_allowed = allow.is_some_and(|allow| allow.contains(&WarningName::Known(code)));
    let is_warning = code.severity() == Severity::Warning;
    levels
        .severity(code)
        .filter(|_| !(is_allowed && is_warning))
}

/// Adds the name of the geometry to the message, unless it is already there.
fn name_geometry(fault: &mut Diagnostic, model: &Model) {
    let geometry = model.geometry_on(fault.path.steps());
    let geometry = geometry.and_then(|(at, _)| model.geometry(at));
    let name = geometry.and_then(GeometryModel::name).map(quote);
    let is_told = |name: &String| name == "``" || fault.message.contains(name);
    if let Some(name) = name.filter(|name| !is_told(name)) {
        fault.message = format!("{} (geometry {name})", fault.message);
    }
}

fn sort(found: &mut [Diagnostic]) {
    found.sort_by_key(|fault| (fault.range.start, fault.range.end, fault.code));
}
