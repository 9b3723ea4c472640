//! What is wrong with a text: the model decides, the tree explains.

use std::{
    collections::BTreeMap,
    fs::File,
    io::{self, Seek},
    mem,
};

use crate::{
    diagnostic::{Code, Diagnostic, Severity, levels::Levels},
    parallel::timings::{Stage, Watch},
    scene::{
        files,
        format::{geometry::GeometryModel, scene::Model, warning::WarningName},
        load,
        locate::Locator,
        mend::{self, Mended, Repairs},
        options::ReadOptions,
        outline,
        problem::Problem,
        read::{self, LARGE},
        recognize::Recognizer,
        set::Applied,
        tables::{self, Tables},
        validate::{self, StandIns},
    },
    text::{
        nearest::quote,
        syntax::{self, Fault, Syntax, Tree},
    },
};

/// What has been found in a text.
pub(super) struct Checked {
    pub(super) model: Option<Model>,
    pub(super) tables: Option<Tables>,
    pub(super) diagnostics: Vec<Diagnostic>,
    /// What is wrong with each of the settings.
    pub(super) settings: Vec<Vec<Diagnostic>>,
}

impl Checked {
    pub(super) fn refused(diagnostics: Vec<Diagnostic>) -> Self {
        Self {
            model: None,
            tables: None,
            diagnostics,
            settings: Vec::new(),
        }
    }
}

/// A model and what is wrong with it.
pub(super) struct Found {
    pub(super) model: Model,
    pub(super) tables: Option<Tables>,
    pub(super) problems: Vec<Problem>,
    /// What is wrong with each of the settings.
    pub(super) settings: Vec<Vec<Diagnostic>>,
}

impl Found {
    /// What is wrong with the model of a large file, if the fast reader knows it; the file stands at
    /// its start again.
    pub(super) fn in_file(
        mut file: &File,
        syntax: Syntax,
        options: &ReadOptions,
        watch: &Watch,
    ) -> io::Result<Option<Self>> {
        let length = files::length_of_text(file).filter(|length| *length >= LARGE);
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
        let (tables, found) = match options.files() {
            Some(files) if is_wanted => {
                watch.time(Stage::Read, || tables::read(&model, &files, options))
            }
            _ => (Tables::default(), Vec::new()),
        };
        let mut problems = validate::problems(&model, &tables, &options.levels, stand_ins);
        problems.extend(found);
        let is_read = !is_wanted || options.files().is_some();
        Self {
            model,
            tables: is_read.then_some(tables),
            problems,
            settings: Vec::new(),
        }
    }

    /// With its problems where they stand in the text.
    fn placed(mut self, text: &str, tree: &Tree, levels: &Levels) -> Checked {
        let repairs = Repairs::default();
        let locator = Locator::new(text, tree, &repairs);
        let placed = mem::take(&mut self.problems).into_iter().map(|problem| {
            let range = locator.range(&problem.place).unwrap_or_default();
            problem.placed(range, text, |place| locator.range(place))
        });
        let diagnostics = sorted(placed.collect(), &self.model, levels);
        self.checked(diagnostics)
    }

    /// The same, of a text that is asked for if anything is to be placed in it.
    pub(super) fn placed_in<'t>(
        self,
        text: impl FnOnce() -> &'t str,
        syntax: Syntax,
        levels: &Levels,
    ) -> Checked {
        if self.problems.is_empty() {
            return self.checked(Vec::new());
        }
        let text = text();
        let tree = outline::tree(text, syntax, &self.problems);
        self.placed(text, &tree, levels)
    }

    fn checked(self, diagnostics: Vec<Diagnostic>) -> Checked {
        Checked {
            model: Some(self.model),
            tables: self.tables,
            diagnostics,
            settings: self.settings,
        }
    }
}

/// The model of a text with its tables, and everything that is wrong with it, in the order of the
/// text; some of that may have been found already.
pub(super) fn check(
    text: &str,
    found: Option<Found>,
    syntax: Syntax,
    options: &ReadOptions,
    watch: &Watch,
) -> Checked {
    let levels = &options.levels;
    if let Some(found) = found {
        let tree = outline::tree(text, syntax, &found.problems);
        // The file may have become another one meanwhile.
        if tree.faults().is_empty() {
            return found.placed(text, &tree, levels);
        }
    }
    let refused = match watch.time(Stage::Read, || {
        load::model(text, syntax, &options.pool(text.len()))
    }) {
        Ok(model) => {
            let found = Found::of(model, syntax, options, watch);
            return found.placed_in(|| text, syntax, levels);
        }
        Err(refused) => refused,
    };
    let tree = syntax::parse(text, syntax);
    if let Some(range) = Recognizer::new(text, &tree).stamp() {
        let message = "this is a report that strahl wrote, not a scene";
        return Checked::refused(vec![Diagnostic::new(Code::Syntax, range, message)]);
    }
    if !tree.faults().is_empty() {
        return Checked::refused(tree.faults().iter().map(syntax_fault).collect());
    }
    let Mended {
        model,
        mut diagnostics,
        repairs,
    } = mend::mend(text, &tree);
    if let Some(model) = model {
        let locator = Locator::new(text, &tree, &repairs);
        // What lies in a repair is not wrong a second time. What is set has to wait for a scene, and
        // so does what is seen of it.
        let stand_ins = StandIns(locator.replaced("geometries"));
        let found = Found::unset(model, &stand_ins, options, watch);
        let problems = found.problems.into_iter();
        let problems = problems.filter(|problem| problem.code != Code::NothingVisible);
        let placed = problems.filter_map(|problem| {
            let range = locator.range(&problem.place)?;
            Some(problem.placed(range, text, |place| locator.range(place)))
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
    }
    // The tree explains, but ron and serde_json decide.
    if !diagnostics
        .iter()
        .any(|fault| fault.code.severity() == Severity::Error)
    {
        diagnostics.push(refused);
        sort(&mut diagnostics);
    }
    Checked::refused(diagnostics)
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
    let index = fault.path.strip_prefix("geometries[");
    let index = index.and_then(|rest| rest.split_once(']')?.0.parse::<usize>().ok());
    let geometry = index.and_then(|index| model.geometries.get(index));
    let name = geometry.and_then(GeometryModel::name).map(quote);
    let is_told = |name: &String| name == "``" || fault.message.contains(name);
    if let Some(name) = name.filter(|name| !is_told(name)) {
        fault.message = format!("{} (geometry {name})", fault.message);
    }
}

fn sort(found: &mut [Diagnostic]) {
    found.sort_by_key(|fault| (fault.range.start, fault.range.end, fault.code));
}

fn syntax_fault(fault: &Fault) -> Diagnostic {
    let mut diagnostic = Diagnostic::new(Code::Syntax, fault.range.clone(), &*fault.message);
    diagnostic.help.clone_from(&fault.help);
    match &fault.label {
        Some((range, message)) => diagnostic.with_label(range.clone(), &**message),
        None => diagnostic,
    }
}
