//! What is wrong with a text: the fast reader takes it, or the tree tells.

use std::{
    collections::BTreeMap,
    fs::File,
    io::{self, Seek},
    mem,
};

use crate::{
    diagnostic::{Code, Diagnostic, Severity, Suppressed, levels::Levels, path::Step},
    parallel::timings::{Stage, Watch},
    scene::{
        files,
        format::{geometry::GeometryModel, scene::Model, warning::WarningName},
        locate::Locator,
        mend::{self, Mended, Repairs},
        options::ReadOptions,
        problem::{Problem, Tally, syntax_fault},
        read::{self, LARGE},
        recognize::Recognizer,
        set::Applied,
        source::Source,
        tables::{self, Tables},
        validate::{self, StandIns},
    },
    text::{nearest::quote, syntax::Syntax},
};

/// What has been found in a text.
#[derive(Debug)]
pub(super) struct Checked {
    pub(super) model: Option<Model>,
    /// The tables of the model; `None` if they have not been read, or not been kept.
    pub(super) tables: Option<Tables>,
    pub(super) diagnostics: Vec<Diagnostic>,
    /// How many there are beside them.
    pub(super) suppressed: Suppressed,
    /// What is wrong with each of the settings.
    pub(super) settings: Vec<Vec<Diagnostic>>,
}

impl Checked {
    pub(super) fn refused(diagnostics: Vec<Diagnostic>) -> Self {
        Self {
            model: None,
            tables: None,
            diagnostics,
            suppressed: Suppressed::default(),
            settings: Vec::new(),
        }
    }

    /// The same without the model.
    pub(super) fn findings(&self) -> Self {
        Self {
            suppressed: self.suppressed,
            settings: self.settings.clone(),
            ..Self::refused(self.diagnostics.clone())
        }
    }
}

/// A model and what is wrong with it.
pub(super) struct Found {
    pub(super) model: Model,
    pub(super) tables: Option<Tables>,
    pub(super) problems: Vec<Problem>,
    /// How many there are beside them.
    pub(super) suppressed: Suppressed,
    /// What is wrong with each of the settings.
    pub(super) settings: Vec<Vec<Diagnostic>>,
}

impl Found {
    /// What is wrong with the model of a large file, if the fast reader knows it; the file stands at
    /// its start again.
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

    /// The problems of a model with what is set in it.
    pub(super) fn of(
        mut model: Model,
        syntax: Syntax,
        options: &ReadOptions,
        watch: &Watch,
    ) -> Self {
        let applied = Applied::to(&mut model, &options.settings, syntax);
        let mut found = Self::unset(model, &StandIns::default(), options, watch);
        let (settings, problems) = applied.placed(found.problems);
        let sort = |faults| sorted(faults, &found.model, &options.levels);
        found.settings = settings.into_iter().map(sort).collect();
        found.problems = problems;
        found
    }

    /// The problems of a model and of the tables that it names, which are read for that.
    fn unset(model: Model, stand_ins: &StandIns, options: &ReadOptions, watch: &Watch) -> Self {
        // A file of another version may mean something else by the names in it.
        let is_known = validate::version(model.version).is_none();
        let has_tables = |geometry: &GeometryModel| geometry.table().is_some();
        let is_wanted = is_known && model.geometries.iter().any(has_tables);
        let (tables, found) = match options.tables() {
            Some(files) if is_wanted => {
                watch.time(Stage::Read, || tables::read(&model, &files, options))
            }
            _ => (Tables::default(), Vec::new()),
        };
        let most = options.most_diagnostics();
        let (mut problems, tally) =
            validate::problems(&model, &tables, &options.levels, stand_ins, most);
        problems.extend(found);
        let suppressed = suppressed(&tally, &model, &options.levels);
        // What is not reported needs no place in the text.
        problems.retain(|problem| severity(problem.code, Some(&model), &options.levels).is_some());
        let is_read = !is_wanted || options.tables().is_some();
        Self {
            model,
            tables: is_read.then_some(tables),
            problems,
            suppressed,
            settings: Vec::new(),
        }
    }

    /// With its problems where they stand in a text.
    pub(super) fn placed(mut self, source: &Source, levels: &Levels) -> Checked {
        if self.problems.is_empty() {
            return self.checked(Vec::new());
        }
        let repairs = Repairs::default();
        let locator = Locator::new(source.text(), source.tree(), &repairs);
        let problems = mem::take(&mut self.problems).into_iter();
        let placed = problems.map(|problem| {
            let range = locator.range(&problem.place).unwrap_or_default();
            locator.placed(problem, range)
        });
        let diagnostics = sorted(placed.collect(), &self.model, levels);
        self.checked(diagnostics)
    }

    fn checked(self, diagnostics: Vec<Diagnostic>) -> Checked {
        Checked {
            model: Some(self.model),
            tables: self.tables,
            diagnostics,
            suppressed: self.suppressed,
            settings: self.settings,
        }
    }
}

/// The model of a text with its tables, and everything that is wrong with it, in the order of the
/// text; some of that may have been found already.
pub(super) fn check(
    source: &Source,
    found: Option<Found>,
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
        return Found::of(model, syntax, options, watch).placed(source, levels);
    }
    let tree = watch.time(Stage::Read, || source.tree_until(|| options.is_cancelled()));
    if options.is_cancelled() {
        return Checked::refused(Vec::new());
    }
    if let Some(range) = Recognizer::new(text, tree).stamp() {
        let message = "this is a report that strahl wrote, not a scene";
        return Checked::refused(vec![Diagnostic::new(Code::Syntax, range, message)]);
    }
    if !tree.faults().is_empty() {
        return Checked::refused(tree.faults().iter().map(syntax_fault).collect());
    }
    let Mended {
        model,
        mut diagnostics,
        tally,
        repairs,
    } = watch.time(Stage::Read, || {
        mend::mend(text, tree, options.most_diagnostics())
    });
    let mut more = Suppressed::default();
    if let Some(model) = model {
        if diagnostics.is_empty() {
            return Found::of(model, syntax, options, watch).placed(source, levels);
        }
        let locator = Locator::new(text, tree, &repairs);
        // What lies in a repair is not wrong a second time. What is set has to wait for a scene, and
        // so does what is seen of it.
        let stand_ins = StandIns(locator.replaced("geometries"));
        let found = Found::unset(model, &stand_ins, options, watch);
        let problems = found.problems.into_iter();
        let problems = problems.filter(|problem| problem.code != Code::NothingVisible);
        let placed = problems.filter_map(|problem| {
            let range = locator.range(&problem.place)?;
            Some(locator.placed(problem, range))
        });
        let placed: Vec<_> = placed.collect();
        // Of another version, whatever else seems to be wrong may be right.
        if placed
            .iter()
            .any(|fault| fault.code == Code::UnsupportedVersion)
        {
            return Checked::refused(placed);
        }
        diagnostics.extend(placed);
        diagnostics = sorted(diagnostics, &found.model, levels);
        more = suppressed(&tally, &found.model, levels) + found.suppressed;
    }
    Checked {
        suppressed: more,
        ..Checked::refused(diagnostics)
    }
}

/// How many faults are not kept, of those that are wanted.
fn suppressed(tally: &Tally, model: &Model, levels: &Levels) -> Suppressed {
    let mut found = Suppressed::default();
    for (code, count) in tally.more() {
        if let Some(severity) = severity(code, Some(model), levels) {
            found.count(severity, count);
        }
    }
    found
}

/// The diagnostics that are wanted, in the order of the text.
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

/// How bad a fault is, as the levels and the scene say; `None` if it is not to be reported.
pub(super) fn severity(code: Code, model: Option<&Model>, levels: &Levels) -> Option<Severity> {
    let allow = model.and_then(|model| model.allow.as_deref());
    let is_allowed = allow.is_some_and(|allow| allow.contains(&WarningName::Known(code)));
    let is_warning = code.severity() == Severity::Warning;
    levels
        .severity(code)
        .filter(|_| !(is_allowed && is_warning))
}

/// Adds the name of the geometry that a message is about, unless it is told already.
fn name_geometry(fault: &mut Diagnostic, model: &Model) {
    let geometry = match fault.path.steps() {
        [Step::Field(list), Step::Index(index), ..] if list == Model::LONG => {
            model.geometries.get(*index)
        }
        _ => None,
    };
    let name = geometry.and_then(GeometryModel::name).map(quote);
    let is_told = |name: &String| name == "``" || fault.message.contains(name);
    if let Some(name) = name.filter(|name| !is_told(name)) {
        fault.message = format!("{} (geometry {name})", fault.message);
    }
}

fn sort(found: &mut [Diagnostic]) {
    found.sort_by_key(|fault| (fault.range.start, fault.range.end, fault.code));
}
